"""The matrix that is meant where a file holds several: Nastran's punch and OP4 files, Abaqus' sections."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from .matrix_file import FEFileFault, MatrixFile

# Names that Nastran gives square matrices end so; the first in a file are meant, of K and M in one set.
SETS = ("AAX", "AA", "XX", "GG")
# Beginnings of the names of mass, stiffness and geometric (differential) stiffness, the last three of any.
PREFIXES = {"M": "M", "K": "K", "G": "KD"}
BEGINNINGS = {"M": ("M",), "K": ("K", "STIF"), "G": ("K",)}
MEANINGS = {"M": "mass matrix", "K": "stiffness matrix", "G": "geometric stiffness matrix"}


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
    wanted = name.upper() or (names[0] if len(names) == 1 else _meant(file, matrices, letter))
    fitting = [matrix for matrix in matrices if matrix.name == wanted]
    if len(fitting) != 1:
        count = f"{len(fitting)} matrices" if fitting else "no matrix"
        raise FEFileFault(
            f"{file} holds {count} {wanted}, but {_listed(names)}; card FEMX names the one that is meant"
        )
    return fitting[0].read()


def _meant(file: str, matrices: Sequence[NamedMatrix], letter: str) -> str:
    names = [matrix.name for matrix in matrices]
    usable = dict.fromkeys(matrix.name for matrix in matrices if matrix.usable)
    prefix, partner = PREFIXES[letter], "K" if letter == "M" else "M"
    present = [end for end in SETS if prefix + end in usable]
    paired = [end for end in present if partner + end in usable]
    if present:
        return prefix + (paired or present)[0]
    # K4AA and the like hold structural damping.
    fitting = [name for name in usable if name.startswith(BEGINNINGS[letter]) and name[:2] != "K4"]
    if len(fitting) == 1:
        return fitting[0]
    which = f"{_listed(fitting)} may be" if fitting else "none of them has the name of"
    raise FEFileFault(
        f"{file} holds {_listed(names)}: {which} the {MEANINGS[letter]}, square and real; write its name on "
        "a card FEMX",
        id="FE-043",
    )


def _listed(names: Sequence[str], most: int = 12) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
