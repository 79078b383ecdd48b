"""Shapes of rigid bodies in a result: their surfaces, and where their bodies carry them."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import h5py
import numpy as np

from ..hdf5.shapes import BODY, CORNERS, POSITION
from ..hdf5.stored_result import Damaged, check_shapes

_SHAPES = {POSITION: "v3", BODY: "v", CORNERS: "k3"}


@dataclass(frozen=True, eq=False)
class BodyShape:
    """All shapes of a body, 0 the ground: `vertices` (n, 3), m, body axes; `triangles` (m, 3) of their rows.

    `origin` (T, 3), `turn` (T, 3, 3): body to global axes.
    """

    number: int
    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    origin: np.ndarray
    turn: np.ndarray

    def places(self, row: int) -> np.ndarray:
        """Positions (n, 3) of the vertices in a row, global axes."""
        found: np.ndarray = self.origin[row] + self.vertices @ self.turn[row].T
        return found

    @property
    def corners(self) -> np.ndarray:
        """Positions (T, 8, 3) of the corners of the box around the shapes, along the axes of the body."""
        ends = np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])
        box = np.array([[ends[k, i] for i, k in enumerate(corner)] for corner in product((0, 1), repeat=3)])
        found: np.ndarray = self.origin[:, None] + np.matmul(box, np.swapaxes(self.turn, -1, -2))
        return found


def body_shapes(
    result: h5py.File, names: tuple[str, ...], origin: np.ndarray, turn: np.ndarray
) -> Iterator[BodyShape]:
    """The shapes of `result`, body by body, the ground first.

    `origin` (T, b, 3) and `turn` (T, b, 3, 3) of all bodies.  Raises `Damaged`.
    """
    if POSITION not in result:
        return
    check_shapes(result, _SHAPES, {})
    places, owner, triangles = (result[path][:] for path in _SHAPES)
    triangles = _checked(triangles, owner, len(names)) - 1
    still = np.zeros((len(origin), 3)), np.tile(np.eye(3), (len(origin), 1, 1))
    for number in np.unique(owner).tolist():
        own = owner == number
        row = np.cumsum(own) - 1
        faces = row[triangles[own[triangles[:, 0]]]]
        motion = (origin[:, number - 1], turn[:, number - 1]) if number else still
        yield BodyShape(number, names[number - 1] if number else "ground", places[own], faces, *motion)


def _checked(triangles: np.ndarray, owner: np.ndarray, bodies: int) -> Any:
    if triangles.dtype.kind not in "iu" or owner.dtype.kind not in "iu":
        raise Damaged(f"/{CORNERS} or /{BODY} holds no whole numbers")
    if not len(triangles) or triangles.min() < 1 or triangles.max() > len(owner):
        raise Damaged(f"/{CORNERS} names a vertex outside 1..{len(owner)}")
    if owner.min() < 0 or owner.max() > bodies:
        raise Damaged(f"/{BODY} names a body outside 0..{bodies}")
    if (owner[triangles - 1] != owner[triangles[:, :1] - 1]).any():
        raise Damaged(f"a triangle of /{CORNERS} joins two bodies")
    return triangles
