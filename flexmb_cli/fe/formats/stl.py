"""STL files, text and binary: triangles whose equal corners become one vertex.

3D Systems, "StereoLithography Interface Specification" (1988): a binary file has 80 bytes of title, the
number of its triangles, and 50 bytes for each (normal, three corners, two bytes unused), little-endian.
Some writers begin binary files with "solid", too, so the file's length distinguishes the two types.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import visible
from .file_text import bytes_of
from .matrix_file import FEFileFault

# Triangles of a file: more are too many for a page, and nobody sees them.
MOST_TRIANGLES = 200_000
LONGEST_WORD = 40  # characters of a word that a message repeats
LARGEST_STL = 2**27  # bytes: a triangle takes 50 in a binary file, some 250 in text
_HEADER_BYTES, _TRIANGLE_BYTES = 84, 50
_RECORD = np.dtype(
    [
        ("normal", "<f4", 3),  # unit vector outwards, often wrong in files and not read
        ("corners", "<f4", (3, 3)),  # of the triangle, a row each, in the file's unit
        ("unused", "<u2"),  # bytes of attributes that programs add
    ]
)
_CORNER = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
_FACET = re.compile(rb"\bendfacet\b", re.IGNORECASE)
_ENDING = re.compile(rb"\bendsolid\b[^\n]*\s*\Z", re.IGNORECASE)


def read_stl(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 3) in the file's unit and triangles (m, 3) of rows of them.

    Raises FEFileFault for a file that cannot be read, is damaged, or has too many triangles.
    """
    raw = bytes_of(path, LARGEST_STL)
    announced = int.from_bytes(raw[80:_HEADER_BYTES], "little") if len(raw) >= _HEADER_BYTES else -1
    if len(raw) == _HEADER_BYTES + _TRIANGLE_BYTES * announced:
        corners = _binary(path.name, raw, announced)
    elif raw[:1024].lstrip().lower().startswith(b"solid") and b"\0" not in raw[:1024]:
        corners = _text(path.name, raw)
    else:
        message = "is not an STL file: it neither begins with 'solid', nor has it the length of a binary one"
        if announced >= 0:
            message += (
                f" (84 + 50 × {announced} bytes for the {announced} triangles that it announces; it has "
                f"{len(raw)}); write it again"
            )
        raise FEFileFault(f"{path.name} {message}", id="FE-075")
    if not np.isfinite(corners).all():
        raise FEFileFault(f"{path.name} has corners that are not finite; write it again", id="FE-076")
    return _joined(path.name, corners)


def hull_corners(path: Path) -> np.ndarray:
    """Return the corners (n, 3) of the convex hull of a file's triangles, in its unit; none if it is flat.

    Raises FEFileFault as `read_stl`.
    """
    from scipy.spatial import ConvexHull, QhullError

    vertices, _ = read_stl(path)
    try:
        corners: np.ndarray = vertices[np.sort(ConvexHull(vertices).vertices)]
    except QhullError:
        return np.zeros((0, 3))
    return corners


def _binary(name: str, raw: bytes, count: int) -> Any:
    _check_count(name, count)
    return np.frombuffer(raw, _RECORD, count, _HEADER_BYTES)["corners"].reshape(-1, 3).astype(float)


def _text(name: str, raw: bytes) -> Any:
    facets = sum(1 for _ in _FACET.finditer(raw))
    _check_count(name, facets)
    if not _ENDING.search(raw):
        message = f"{name} does not end with 'endsolid': the file was cut off; write it again"
        raise FEFileFault(message, id="FE-077")
    words = [word for match in _CORNER.finditer(raw) for word in match.groups()]
    if len(words) != 9 * facets:
        message = f"{name} has {len(words) // 3} corners and {facets} triangles, which have three each"
        raise FEFileFault(message, id="FE-078")
    try:
        return np.array(words, dtype=bytes).astype(float).reshape(-1, 3)
    except ValueError:
        wrong = visible(next(word for word in words if not _is_number(word)).decode(errors="replace"))
        message = f"{name} has a corner that is not a number: it reads {wrong[:LONGEST_WORD]}"
        raise FEFileFault(message, id="FE-079") from None


def _is_number(word: bytes) -> bool:
    try:
        np.array(word).astype(float)
    except ValueError:
        return False
    return True


def _check_count(name: str, count: int) -> None:
    if not count:
        raise FEFileFault(f"{name} has no triangles", id="FE-080")
    if count > MOST_TRIANGLES:
        message = f"{name} has {count} triangles; at most {MOST_TRIANGLES} are drawn: write a coarser file"
        raise FEFileFault(message, id="FE-081")


def _joined(name: str, corners: np.ndarray) -> tuple[Any, Any]:
    """Vertices that differ, and triangles with three of them."""
    vertices, index = np.unique(corners + 0.0, axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    a, b, c = triangles.T
    whole = triangles[(a != b) & (b != c) & (c != a)]
    if not len(whole):
        raise FEFileFault(f"{name} has no triangle whose corners differ", id="FE-082")
    return vertices, whole
