"""Cards of shapes in the axes of other bodies."""

import math
from dataclasses import replace

import numpy as np

from ..mechanism import Vector
from ..shapes import ShapeCard, turning

_FLAT = 1e-12  # cosine of the second angle below which the other two turn about one axis


def shifted(shape: ShapeCard, body: int, r: np.ndarray, A: np.ndarray) -> ShapeCard:
    """Return the shape on `body`, in whose axes the old frame lies at `r` (3,), turned by `A` (3, 3)."""
    x, y, z = map(float, np.asarray(r) + A @ np.array(shape.offset))
    turned = angles_of(A @ turning(shape.angles))
    return replace(shape, body=body, offset=(x, y, z), angles=turned)


def angles_of(R: np.ndarray) -> Vector:
    """Return the angles about the fixed axes x, y, z in turn of a rotation matrix (3, 3); rad."""
    cosine = math.hypot(R[0, 0], R[1, 0])
    beta = math.atan2(-R[2, 0], cosine)
    if cosine < _FLAT:
        return math.atan2(-R[1, 2], R[1, 1]) + 0.0, beta, 0.0
    return math.atan2(R[2, 1], R[2, 2]) + 0.0, beta + 0.0, math.atan2(R[1, 0], R[0, 0]) + 0.0


def notes_of(shapes: tuple[ShapeCard, ...]) -> tuple[str, ...]:
    """Return what a reader of a deck that names STL files should know."""
    return ("STL files keep their names: copy them beside this deck",) if any(s.file for s in shapes) else ()
