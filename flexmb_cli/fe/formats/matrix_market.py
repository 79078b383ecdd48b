"""Matrix Market exchange format: coordinate and array, real, general and symmetric.

Boisvert, Pozo, Remington, NISTIR 5935 (1996).  Rows follow the node table: x y z of its first node first.
"""

from pathlib import Path
from typing import Any

import numpy as np

from .file_text import check_range, line_fault, lines_of, table, whole
from .matrix_file import FEFileFault, MatrixFile

_BANNER = "%%matrixmarket"


def read_matrix_market(path: Path) -> MatrixFile:
    """The matrix at `path`.  Raises FEFileFault."""
    lines = lines_of(path)
    layout, symmetric = _kind(path.name, lines)
    start = next((i for i, line in enumerate(lines) if i and line.strip() and line[0] != "%"), None)
    if start is None:
        raise FEFileFault(f"{path.name} ends before the line of its size", id="FE-040")
    reader = _coordinate if layout == "coordinate" else _array
    body = lines[start + 1 :]
    while body and not body[-1].strip():
        body.pop()
    return reader(path.name, lines[start], body, start + 1, symmetric)


def _kind(name: str, lines: list[str]) -> tuple[Any, Any]:
    words = lines[0].lower().split() if lines else []
    if not words or words[0] != _BANNER:
        raise line_fault(
            name, 1, "a Matrix Market file begins with %%MatrixMarket; is the format another?", id="FE-114"
        )
    if len(words) < 5 or words[1] != "matrix" or words[2] not in ("coordinate", "array"):
        raise line_fault(
            name, 1, "%%MatrixMarket matrix coordinate|array real general|symmetric wanted", id="FE-115"
        )
    if words[3] not in ("real", "integer", "double"):
        raise line_fault(name, 1, f"the matrix must be real; this one is {words[3]}", id="FE-116")
    if words[4] not in ("general", "symmetric"):
        raise line_fault(
            name, 1, f"the matrix must be symmetric or general; this one is {words[4]}", id="FE-117"
        )
    return words[2], words[4] == "symmetric"


def _size(name: str, line: str, number: int, count: int) -> np.ndarray:
    size = whole(name, table(name, [line], [number], count, "the size"), [number], "sizes")[0]
    if size[0] != size[1] or size[0] < 1:
        raise line_fault(
            name, number, f"the matrix must be square; it has {size[0]} rows, {size[1]} columns", id="FE-111"
        )
    found: np.ndarray = size
    return found


def _coordinate(name: str, line: str, body: list[str], number: int, symmetric: bool) -> MatrixFile:
    size, _, count = _size(name, line, number, 3)
    _check_count(name, len(body), count)
    numbers = range(number + 1, number + 1 + len(body))
    entries = table(name, body, numbers, 3, "row, column and value")
    where = whole(name, entries[:, :2], numbers, "row and column")
    check_range(name, where, numbers, size)
    rows, columns = where.T - 1
    if symmetric and (rows < columns).any():
        first = int(np.flatnonzero(rows < columns)[0])
        message = "an entry above the diagonal, while the file declares a lower triangle"
        raise line_fault(name, numbers[first], message, id="FE-118")
    return MatrixFile(int(size), rows, columns, entries[:, 2], symmetric)


def _array(name: str, line: str, body: list[str], number: int, symmetric: bool) -> MatrixFile:
    size = int(_size(name, line, number, 2)[0])
    count = size * (size + 1) // 2 if symmetric else size * size
    _check_count(name, len(body), count)
    values = table(name, body, range(number + 1, number + 1 + len(body)), 1, "a value")[:, 0]
    columns, rows = np.triu_indices(size) if symmetric else np.indices((size, size)).reshape(2, -1)
    return MatrixFile(size, rows, columns, values, symmetric)


def _check_count(name: str, found: int, announced: int) -> None:
    if found != announced:
        raise FEFileFault(
            f"{name} announces {announced} entries and holds {found}; was it cut off, or edited?", id="FE-041"
        )
