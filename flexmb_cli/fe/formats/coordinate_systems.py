"""Rectangular, cylindrical and spherical coordinate systems in which programs give positions of nodes."""

from typing import Any, NamedTuple

import numpy as np

# Sine of the least angle between two directions that span a system.
LEAST_SPAN = 1e-9


class CoordinateSystem(NamedTuple):
    """A system of coordinates x y z (R), R theta z (C) or R theta phi (S), theta from the z axis."""

    type: str  # R, C or S
    origin: Any  # (3,), m
    axes: Any  # (3, 3), x y z in columns

    def basic(self, values: Any) -> Any:
        """Return the position (3,), m, of the point at `values`, angles in degrees."""
        r, theta, last = values
        if self.type != "R":
            around = np.radians(theta if self.type == "C" else last)
            across = r if self.type == "C" else r * np.sin(np.radians(theta))
            height = last if self.type == "C" else r * np.cos(np.radians(theta))
            r, theta, last = across * np.cos(around), across * np.sin(around), height
        return self.origin + self.axes @ (r, theta, last)


BASIC = CoordinateSystem("R", np.zeros(3), np.eye(3))


def spanned(first: Any, second: Any) -> Any:
    """Return axes in columns: along `first` (3,), towards `second` (3,), across both; None on one line."""
    across = np.cross(first, second)
    size = np.linalg.norm(across)
    if not size > LEAST_SPAN * np.linalg.norm(first) * np.linalg.norm(second):
        return None
    a, c = first / np.linalg.norm(first), across / size
    return np.column_stack([a, np.cross(c, a), c])


def rotation(axis: Any, degrees: float) -> Any:
    """Return the matrix (3, 3) of a turn about `axis` (3,)."""
    axis, angle = axis / np.linalg.norm(axis), np.radians(degrees)
    crossed = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * crossed + (1.0 - np.cos(angle)) * (crossed @ crossed)
