"""What inputs and outputs of a linearised mechanism are called in the terms of its dialect."""

from ...model.flexible_mechanism import NodePoint
from ...quick_dataclass import dataclass


@dataclass(frozen=True)
class Terms:
    """A dialect's names for what acts on a mechanism and what is observed of it.

    `loads`: names of the loads in the order of their records, and whether one in a joint is a force;
    `drivers`: names, and whether they prescribe a length; `joints`: name and the point on each of its two
    bodies; `points`: name and body of the points of interest.
    """

    loads: tuple[tuple[str, bool], ...]
    drivers: tuple[tuple[str, bool], ...]
    joints: tuple[tuple[str, NodePoint, NodePoint], ...]
    points: tuple[tuple[str, int], ...]
