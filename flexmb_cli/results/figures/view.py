"""From where a mechanism is looked at: which way is up, and whether it moves in a plane."""

from dataclasses import dataclass
from typing import Any

import numpy as np

# A mechanism this much thinner than it is long counts as planar.
PLANAR = 1e-6


@dataclass(frozen=True)
class View:
    """`up` and the direction `eye` from the mechanism to the viewer, unit vectors."""

    up: tuple[float, float, float]
    eye: tuple[float, float, float]


def view_of(places: np.ndarray, gravity: np.ndarray) -> View:
    """The view of `places` (N, 3), everything at all times; up is against `gravity` (3,), else z.

    A planar mechanism is looked at along its normal, so that positive angles about it turn
    counter-clockwise; with no gravity in its plane, y is up where it can be.
    """
    up = -gravity / np.linalg.norm(gravity) if np.any(gravity) else np.array([0.0, 0.0, 1.0])
    normal = _normal(places)
    if normal is None:
        return View(_plain(up), _plain(_aside(up)))
    in_plane = up - (up @ normal) * normal
    if np.linalg.norm(in_plane) < 0.5:
        y = np.array([0.0, 1.0, 0.0])
        in_plane = y - (y @ normal) * normal
    if np.linalg.norm(in_plane) < 0.5:
        in_plane = np.array([1.0, 0.0, 0.0])
    return View(_plain(in_plane), _plain(normal))


def _normal(places: np.ndarray) -> np.ndarray | None:
    """Normal (3,) of the plane of all places; None when they fill space or only a line."""
    centred = places - places.mean(axis=0)
    if len(places) <= 2:
        return None
    _, size, axes = np.linalg.svd(centred, full_matrices=False)
    if size[2] > PLANAR * size[0] or size[1] <= PLANAR * size[0]:
        return None
    normal = axes[2]
    found: np.ndarray | None = normal * np.sign(normal[np.argmax(np.abs(normal))])
    return found


def _aside(up: np.ndarray) -> np.ndarray:
    """The direction to a viewer who stands to the side and a little above."""
    across = np.roll(np.abs(up).round(), 1) if np.count_nonzero(np.abs(up).round()) == 1 else np.eye(3)[0]
    side = np.cross(up, across)
    found: np.ndarray = 0.75 * side + 1.0 * across + 0.55 * up
    return found


def _plain(vector: np.ndarray) -> tuple[Any, ...]:
    return tuple(float(round(x, 9)) + 0.0 for x in vector / np.linalg.norm(vector))
