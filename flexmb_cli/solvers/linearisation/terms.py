"""Names of inputs and outputs of a linearised mechanism in the terms of its dialect."""

from dataclasses import dataclass

from ...model.flexible_mechanism import NodePoint
from ...model.joint_elements import JointElements, parts_in_arrays
from ...model.laws import DRIVING


@dataclass(frozen=True)
class Terms:
    """A dialect's names for what acts on a mechanism and what is observed of it.

    `loads`: names of the loads in the order of their records, "" for one that is no input, and whether one
    in a joint is a force;
    `drivers`: names, and whether they prescribe a length; `joints`: name and the point on each of its two
    bodies; `points`: name and body of the points of interest; `efforts`: places of the drivers among those
    of the rows; `motors`: name, whether a force, and the number of its record.
    """

    loads: tuple[tuple[str, bool], ...]
    drivers: tuple[tuple[str, bool], ...]
    joints: tuple[tuple[str, NodePoint, NodePoint], ...]
    points: tuple[tuple[str, int], ...]
    efforts: tuple[int, ...] | None = None
    motors: tuple[tuple[str, bool, int], ...] = ()


def motors_of(elements: JointElements, first: int) -> tuple[tuple[str, bool, int], ...]:
    """The motors among loads whose force elements begin with the number `first`."""
    return tuple(
        (item.name, not item.turning, first + place)
        for item, place in parts_in_arrays(elements.forces)
        if item.law in DRIVING
    )
