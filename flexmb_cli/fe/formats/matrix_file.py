"""Content of a matrix file, the choice among several matrices in it, and the exception of all readers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

# Names that Nastran gives square matrices end so; the first in a file are meant, of K and M in one set.
SETS = ("AAX", "AA", "XX", "XX1", "GG")
# Letter: beginning of Nastran's name, beginnings of other names; G: geometric (differential) stiffness,
# B: viscous damping.
NAMES = {"M": ("M", ("M",)), "K": ("K", ("K", "STIF")), "G": ("KD", ("K",)), "B": ("B", ("B", "VISC"))}
STRUCTURAL = ("K4", "STRUCTURAL")  # beginnings of names of structural damping
TRANSLATIONS, ROTATIONS, MODAL = (1, 2, 3), (4, 5, 6), 0  # components of rows


class FEFileFault(Exception):
    """A file of a finite-element program cannot be used; the text names file, line, rule and remedy.

    `id` is the stable identifier of the fault.
    """

    def __init__(self, message: str, id: str = ""):
        super().__init__(message)
        self.id = id


@dataclass(frozen=True)
class MatrixFile:
    """A square matrix as its file has it: k entries, counted from 0.

    `one_triangle`: the entries off the diagonal stand for their mirror images too.  `equations`
    (size, 2): node and component of every row: translations 1 2 3 and rotations 4 5 6 along and about the
    displacement axes of the node, or 0 of a modal coordinate, whose number no node has; rows without entries
    may be missing.  None: rows follow the node table, those of its first node first.  `digits`: significant
    digits of the longest number as it is printed, final zeros included; 0 for binary files.
    """

    size: int
    rows: np.ndarray  # (k,) int64
    columns: np.ndarray  # (k,) int64
    values: np.ndarray  # (k,) float64
    one_triangle: bool
    equations: np.ndarray | None = None
    digits: int = 0


def labelled(entries: np.ndarray, values: np.ndarray, one_triangle: bool | None = None) -> MatrixFile:
    """The matrix of entries given by node and component, (k, 4) integers: row node, row component, column ...

    Rows are numbered by node and component, ascending; those of rotations and modal coordinates without any
    entry but zeros, as of solid elements, are left out.  Whether one triangle is given is found out from the
    entries when it is None.
    """
    of_points = np.isin(entries[:, 1::2], TRANSLATIONS).all(axis=1)
    entries, values = entries[of_points | (values != 0.0)], values[of_points | (values != 0.0)]
    pairs = entries.reshape(-1, 2)
    equations, index = np.unique(pairs, axis=0, return_inverse=True)
    rows, columns = index.reshape(-1, 2).T
    if one_triangle is None:
        one_triangle = not has_both_triangles(rows, columns, len(equations))
    return MatrixFile(len(equations), rows, columns, values, one_triangle, equations)


def of_strings(name: str, size: int, strings: list[tuple[int, int, np.ndarray]]) -> MatrixFile:
    """The full matrix of strings: first row and column, from 0, and the values that follow each other."""
    for row, column, values in strings:
        if not 0 <= column < size:
            raise FEFileFault(f"{name}: column {column + 1} lies outside 1..{size}", id="FE-068")
        if row < 0 or row + len(values) > size:
            message = f"rows {row + 1} to {row + len(values)} of column {column + 1} lie outside 1..{size}"
            raise FEFileFault(f"{name}: {message}", id="FE-069")
    rows = [np.arange(row, row + len(values)) for row, _, values in strings]
    columns = [np.full(len(values), column) for _, column, values in strings]
    i, j = (np.concatenate(part) if part else np.zeros(0, int) for part in (rows, columns))
    values = np.concatenate([part for _, _, part in strings]) if strings else np.zeros(0)
    return MatrixFile(size, i, j, values.astype(float), False)


def has_both_triangles(rows: np.ndarray, columns: np.ndarray, size: int) -> bool:
    """Return whether any entry off the diagonal has its mirror image among the entries."""
    return bool(len(mirrored(rows, columns, size)))


def mirrored(rows: np.ndarray, columns: np.ndarray, size: int) -> np.ndarray:
    """Return the numbers of the entries off the diagonal whose mirror images are entries, too."""
    off = np.flatnonzero(rows != columns)
    forward = rows[off].astype(np.int64) * size + columns[off]
    images = columns[off].astype(np.int64) * size + rows[off]
    return off[np.isin(forward, images, assume_unique=False)]


def size_hint(size: int, nodes: float) -> str:
    """Return what a matrix with more rows than three a node may have, "" for one with fewer."""
    return "; has it other nodes, or rotations of beams and shells?" if size > 3 * nodes else ""


def check_labels(name: str, equations: np.ndarray, causes: str) -> None:
    """Refuse `equations` (size, 2) of the file `name` in which a node and direction stand twice."""
    labels, counts = np.unique(equations, axis=0, return_counts=True)
    twice = labels[counts > 1]
    if len(twice):
        (node, direction), size = twice[0], len(equations)
        raise FEFileFault(
            f"{name} repeats {len(twice)} of {size} labels: node {node}, direction {direction} stands "
            f"{counts.max()} times{causes}",
            id="FE-201",
        )


class NamedMatrix(NamedTuple):
    """A matrix of a file, which is read when it is chosen."""

    name: str  # in capitals
    usable: bool  # whether its heading says that it is square and real
    read: Callable[[], MatrixFile]  # raises FEFileFault


def chosen(file: str, matrices: Sequence[NamedMatrix], letter: str, name: str) -> MatrixFile:
    """Return the matrix `name` of the file; of an empty name the only one, or the one `letter` (M K G) means.

    Raises FEFileFault, which names the candidates, where none or several may be meant.
    """
    names = [matrix.name for matrix in matrices]
    likely = [name.upper()] if name else names if len(names) == 1 else _likely(matrices, letter)
    fitting = [matrix for matrix in matrices if matrix.name in likely]
    _refuse_structural_damping(file, fitting or (matrices if letter == "B" else ()), letter, name)
    if len(fitting) != 1:
        which = f"{len(fitting)} may be meant" if fitting else f"no {name or letter} among them is meant"
        which += f" ({', '.join(likely[:20])})" if fitting else ""
        message = f"{file} holds {', '.join(names[:20])}: {which}; name a square real one on a card FEMX"
        raise FEFileFault(message, id="FE-043")
    return fitting[0].read()


def _refuse_structural_damping(file: str, matrices: Sequence[NamedMatrix], letter: str, name: str) -> None:
    structural = [matrix.name for matrix in matrices if matrix.name.startswith(STRUCTURAL)]
    if structural and (letter == "B" or not name):
        raise FEFileFault(
            f"{file}: {structural[0]} is structural damping, which has a meaning at one frequency, not in "
            "time: give half of its loss factor as ratio of the modes on DAMF or DAMP; FEMX names others",
            id="FE-329",
        )


def _likely(matrices: Sequence[NamedMatrix], letter: str) -> list[str]:
    usable = list(dict.fromkeys(matrix.name for matrix in matrices if matrix.usable))
    (prefix, beginnings), partner = NAMES[letter], "K" if letter == "M" else "M"
    present = [end for end in SETS if prefix + end in usable]
    paired = [end for end in present if partner + end in usable]
    if present:
        return [prefix + (paired or present)[0]]
    return [name for name in usable if name.startswith(beginnings) and not name.startswith(STRUCTURAL)]
