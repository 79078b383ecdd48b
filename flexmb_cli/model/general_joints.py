"""Joints that hold some of six directions between two bodies: the law of which others are cases.

| case | holds |
|---|---|
| weld | x, y, z and all turns |
| inline | x, y: the point stays on the line along z |
| inplane | z: the point stays in the plane across z |
| parallel | turns about x and y: z stays parallel |
| angle | the angle between an axis of each body |

With a single turn held, about z for instance, it is that of a universal joint: x of the first body stays at
right angles to y of the second.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import Fault, ModelError, Place


@dataclass(frozen=True)
class GeneralJoint:
    """A point P_j and axes of body j that keep to the point P_i and axes of body i; body -1 is the ground.

    `axes`: unit vectors x, y, z in the axes of body i, with which those of body j coincide at the start;
    `held`: which of `DIRECTIONS`.  `leaning`: of a constant angle the unit vector, axes of body j, whose
    angle to z stays that of the start; None for all others.
    """

    name: str
    i: int
    j: int
    P_i: Any  # point of the first: (3,) body axes, m, or a node
    P_j: Any  # point of the second
    axes: tuple[tuple[float, float, float], ...]
    held: tuple[bool, ...]
    leaning: tuple[float, float, float] | None = None
    place: Place | None = None

    @property
    def slides(self) -> list[tuple[str, np.ndarray]]:
        """Return names and unit vectors (3,), axes of body i, along which the point is held."""
        return [(f"along {'xyz'[k]}", np.array(self.axes[k])) for k in range(3) if self.held[k]]

    @property
    def holds_turns(self) -> bool:
        """Return whether it holds any turn, for which ends need an attitude."""
        return any(self.held[3:]) or self.leaning is not None

    @property
    def rows(self) -> int:
        """Return the number of its equations."""
        return sum(self.held) + (self.leaning is not None)

    def turns(self, turned: np.ndarray) -> list[tuple[str, np.ndarray, np.ndarray, float]]:
        """Return names, v (3,) in axes of body i, w (3,) in those of body j, and the value that w . v keeps.

        `turned` (3, 3): takes vectors from the axes of body i to those of body j at the start.
        """
        if self.leaning is not None:
            v, w = np.array(self.axes[2]), np.array(self.leaning)
            return [("angle of the axes", v, w, float(w @ turned @ v))]
        e, held = np.array(self.axes), [k for k in range(3) if self.held[3 + k]]
        if len(held) == 1:
            a, b = (held[0] + 1) % 3, (held[0] + 2) % 3
            pairs = [(a, b)]
        elif len(held) == 2:
            [free] = {0, 1, 2} - set(held)
            pairs = [(k, free) for k in held]
        else:
            pairs = [((k + 2) % 3, (k + 1) % 3) for k in held]
        names = [f"turn about {'xyz'[k]}" for k in held]
        return [(name, e[a], turned @ e[b], 0.0) for name, (a, b) in zip(names, pairs, strict=True)]


def frame_of(axis: np.ndarray, across: np.ndarray | None) -> tuple[tuple[float, float, float], ...]:
    """Return unit vectors x, y, z with z along `axis` (3,) and x as near to `across` (3,) as may be."""
    z = axis / np.linalg.norm(axis)
    if across is None:
        across = np.eye(3)[int(np.argmin(np.abs(np.round(z, 12))))]
    x = across - (across @ z) * z
    x = x / np.linalg.norm(x)
    return tuple((float(v[0]), float(v[1]), float(v[2])) for v in (x, np.cross(z, x), z))


@dataclass(frozen=True)
class Release:
    """A joint of a line JOINT, by its name, let go at a `time`, s, or when a quantity reaches a value.

    `quantity`: its name in results, or of a line OUTPUT; `rising`: whether it reaches `value` from below.
    """

    name: str
    joint: str
    time: float | None = None
    quantity: str = ""
    value: float = 0.0
    rising: bool = True
    place: Place | None = None


def refuse_releases(elements: Any, command: str) -> None:
    """Raise ModelError if elements, or None, have releases, which a command does not follow."""
    if elements is not None and elements.releases:
        message = f"{command} lets no joints go; leave out this line in a copy of the deck"
        first = elements.releases[0]
        raise ModelError([Fault("error", message, first.place, first.name, id="SOLVE-192")])


def without_joints(model: Any, names: Collection[str]) -> Any:
    """Return a dynamic model, flexible mechanism or tree without the general joints of these names."""
    generals = tuple(joint for joint in model.elements.generals if joint.name not in names)
    changed = {"elements": replace(model.elements, generals=generals)}
    if hasattr(model, "closures"):
        changed["closures"] = tuple(c for c in model.closures if not (c.general and c.name in names))
    return replace(model, **changed)
