"""Content of a matrix file, and the one exception of all file readers."""

import numpy as np

from ...quick_dataclass import dataclass


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
    (size, 2): node and direction (1 2 3) of every row; None: rows follow the node table, x y z of its
    first node first.  `digits`: significant digits of the longest number as it is printed, final zeros
    included; 0 for binary files.
    """

    size: int
    rows: np.ndarray  # (k,) int64
    columns: np.ndarray  # (k,) int64
    values: np.ndarray  # (k,) float64
    one_triangle: bool
    equations: np.ndarray | None = None
    digits: int = 0


def labelled(entries: np.ndarray, values: np.ndarray, one_triangle: bool | None = None) -> MatrixFile:
    """The matrix of entries given by node and direction, (k, 4) integers: row node, row direction, column ...

    Rows are numbered by node and direction, ascending.  Whether one triangle is given is found out
    from the entries when it is None.
    """
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
    off = rows != columns
    forward = rows[off].astype(np.int64) * size + columns[off]
    mirrored = columns[off].astype(np.int64) * size + rows[off]
    return bool(np.isin(forward, mirrored, assume_unique=False).any())
