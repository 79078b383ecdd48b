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

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import Fault, ModelError, Place


@dataclass(frozen=True)
class GeneralJoint:
    """A point P_j and axes of body j that keep to the point P_i and axes of body i; body -1 is the ground.

    `axes`: unit vectors x, y, z in the axes of body i, with which those of body j coincide at the start;
    `held`: which of `DIRECTIONS`.  `leaning`: of a constant angle the unit vector, axes of body j, whose
    angle to z stays that of the start; None for all others.  `turned` (3, 3): takes vectors from the axes of
    body i to those of body j where the joint is caught; None: where the motion starts.
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
    turned: Any = None

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
        turned = turned if self.turned is None else self.turned
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
class Switch:
    """A joint of a line JOINT or a driver of a line DRIVE, `part` by its name, that is caught or let go.

    `catches`: whether it holds from then on, or no longer.  At a `time`, s, or when a quantity reaches a
    value: `quantity` is its name in results, or of a line OUTPUT; `rising`: whether it reaches `value` from
    below.
    """

    name: str
    part: str
    catches: bool
    time: float | None = None
    quantity: str = ""
    value: float = 0.0
    rising: bool = True
    place: Place | None = None


def is_off_at_start(switches: Sequence[Switch]) -> bool:
    """Return whether a part with these switches holds nothing at first: caught, and not let go before."""
    caught = [one for one in switches if one.catches]
    freed = [one.time for one in switches if not one.catches and one.time is not None]
    return bool(caught) and not any(
        one.time is not None and freed and min(freed) < one.time for one in caught
    )


def refuse_switches(elements: Any, command: str) -> None:
    """Raise ModelError if elements, or None, have lines CATCH or RELEASE, which a command does not follow."""
    if elements is not None and elements.switches:
        message = f"{command} catches nothing and lets nothing go; leave out this line in a copy of the deck"
        first = elements.switches[0]
        raise ModelError([Fault("error", message, first.place, first.name, id="SOLVE-192")])
