"""Matrix Market exchange format: coordinate and array, real, general and symmetric.

Boisvert, Pozo, Remington, NISTIR 5935 (1996).  Rows follow the node table: x y z of its first node first.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .file_text import check_range, filled, line_fault, lines_of, table, whole
from .matrix_file import FEFileFault, MatrixFile, check_labels

BANNER = "%%matrixmarket"


def read_matrix_market(path: Path) -> MatrixFile:
    """The matrix at `path`.  Raises FEFileFault."""
    lines = lines_of(path)
    layout, symmetric = _kind(path.name, lines)
    start = next((i for i, line in enumerate(lines) if i and line.strip() and line[0] != "%"), None)
    if start is None:
        raise FEFileFault(f"{path.name} ends before the line of its size", id="FE-040")
    reader = _coordinate if layout == "coordinate" else _array
    body, numbers = filled(lines[start + 1 :], before=start + 1)
    return reader(path.name, (lines[start], start + 1), body, numbers, symmetric)


def read_node_vector(path: Path) -> np.ndarray:
    """Node and direction (1 2 3) of every row, (3 k, 2), from a vector of k node numbers.

    Its entry k is the node of rows 3 k - 2 to 3 k, as ANSYS' APDL Math exports the order of its equations.
    """
    name, lines = path.name, lines_of(path)
    layout, _ = _kind(name, lines)
    body, numbers = filled(lines[1:], comment="%", before=1)
    rows, columns = _sizes(name, body[0], numbers[0], 2) if layout == "array" and body else (0, 0)
    if columns != 1 or rows < 1:
        message = f"the node numbers of a mapping are a vector, layout array of one column, not {columns}"
        raise FEFileFault(f"{name}: {message}", id="FE-202")
    _check_count(name, len(body) - 1, rows)
    nodes = whole(name, table(name, body[1:], numbers[1:], 1, "a node"), numbers[1:], "nodes")[:, 0]
    equations: np.ndarray = np.column_stack([np.repeat(nodes, 3), np.tile([1, 2, 3], rows)])
    check_labels(name, equations, "; each node stands once, for its three rows")
    return equations


def _kind(name: str, lines: list[str]) -> tuple[Any, Any]:
    words = lines[0].lower().split() if lines else []
    if not words or words[0] != BANNER:
        message = "a Matrix Market file begins with %%MatrixMarket; is the format another?"
        raise line_fault(name, 1, message, id="FE-114")
    if len(words) < 5 or words[1] != "matrix" or words[2] not in ("coordinate", "array"):
        message = "expected %%MatrixMarket matrix coordinate|array real general|symmetric"
        raise line_fault(name, 1, message, id="FE-115")
    if words[3] not in ("real", "integer", "double"):
        raise line_fault(name, 1, f"the matrix must be real; this one is {words[3]}", id="FE-116")
    if words[4] not in ("general", "symmetric"):
        message = f"the matrix must be symmetric or general; this one is {words[4]}"
        raise line_fault(name, 1, message, id="FE-117")
    return words[2], words[4] == "symmetric"


def _sizes(name: str, line: str, number: int, count: int) -> list[int]:
    sizes = whole(name, table(name, [line], [number], count, "the size"), [number], "sizes")
    return [int(size) for size in sizes[0]]


def _size(name: str, line: str, number: int, count: int) -> list[int]:
    size = _sizes(name, line, number, count)
    if size[0] != size[1] or size[0] < 1:
        message = f"the matrix must be square; it has {size[0]} rows, {size[1]} columns"
        raise line_fault(name, number, message, id="FE-111")
    return size


def _coordinate(
    name: str, heading: tuple[str, int], body: list[str], numbers: Sequence[int], symmetric: bool
) -> MatrixFile:
    size, _, count = _size(name, *heading, 3)
    _check_count(name, len(body), count)
    entries = table(name, body, numbers, 3, "row, column and value")
    where = whole(name, entries[:, :2], numbers, "row and column")
    check_range(name, where, numbers, size)
    rows, columns = where.T - 1
    if symmetric and (rows < columns).any():
        first = int(np.flatnonzero(rows < columns)[0])
        message = "an entry above the diagonal, while the file declares a lower triangle"
        raise line_fault(name, numbers[first], message, id="FE-118")
    return MatrixFile(size, rows, columns, entries[:, 2], symmetric)


def _array(
    name: str, heading: tuple[str, int], body: list[str], numbers: Sequence[int], symmetric: bool
) -> MatrixFile:
    size = _size(name, *heading, 2)[0]
    count = size * (size + 1) // 2 if symmetric else size * size
    _check_count(name, len(body), count)
    values = table(name, body, numbers, 1, "a value")[:, 0]
    columns, rows = np.triu_indices(size) if symmetric else np.indices((size, size)).reshape(2, -1)
    return MatrixFile(size, rows, columns, values, symmetric)


def _check_count(name: str, present: int, announced: int) -> None:
    if present != announced:
        message = f"{name} announces {announced} entries and holds {present}; was it cut off, or edited?"
        raise FEFileFault(message, id="FE-041")
