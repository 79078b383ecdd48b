"""Shapes of rigid bodies, with the numbers of their cards, so that they can be written as other cards."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ..mechanism import Vector
from ..shapes import turning

_FLAT = 1e-12  # cosine of the second angle below which the other two turn about one axis


@dataclass(frozen=True)
class RigidShape:
    """A primitive of `kind` of `model.shapes`, or an STL `file` in units of `unit` lengths of the deck.

    `body` as in `RigidModel`; the middle (origin of a file) `offset` and the `angles` about the fixed axes
    x, y, z in turn are in its axes.
    """

    body: int
    kind: str
    sizes: Vector = (0.0, 0.0, 0.0)
    offset: Vector = (0.0, 0.0, 0.0)
    angles: Vector = (0.0, 0.0, 0.0)
    file: str = ""
    unit: float = 1.0


def shifted(shape: RigidShape, body: int, r: np.ndarray, A: np.ndarray) -> RigidShape:
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


def notes_of(shapes: tuple[RigidShape, ...]) -> tuple[str, ...]:
    """Return what a reader of a deck that names STL files should know."""
    return ("STL files keep their names: copy them beside this deck",) if any(s.file for s in shapes) else ()
