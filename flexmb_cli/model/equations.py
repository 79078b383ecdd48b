"""The scalar equations of a mechanism: whose they are, in what unit, and where they stand in the deck."""

import math

from ..errors import Place
from ..quick_dataclass import dataclass
from .mechanism import Joint


@dataclass(frozen=True)
class Equation:
    """One scalar equation: whose it is, which one, and where its owner stands in the deck.

    `scale` is the unit its residual is measured in; `factor` turns the kernel's row (unit vectors)
    into the source's (vectors as typed).
    """

    owner: str
    part: str
    place: Place | None
    scale: float
    factor: float = 1.0
    is_length: bool = False

    @property
    def name(self) -> str:
        """Readable name, such as "universal joint 1, s_i · s_j"."""
        return f"{self.owner}, {self.part}"

    @property
    def unit(self) -> str:
        """Unit of the residual: m, or 1 for unit vectors and Euler parameters."""
        return "m" if self.is_length else "1"


def joint_equations(joint: Joint, length: float) -> list[Equation]:
    """Equations of a joint in the order of its kernel; `length` is the mechanism's length scale, m."""
    size_i, size_j, size_h = (math.hypot(*v) for v in (joint.s_i, joint.s_j, joint.h_i))
    size_hj = math.hypot(*joint.h_j)
    points = [("x", True, 1.0), ("y", True, 1.0), ("z", True, 1.0)]
    arms = [("s_i · s_j", False, size_i * size_j)]
    p1 = [("s_i × s_j, 1st", False, size_i * size_j), ("s_i × s_j, 2nd", False, size_i * size_j)]
    p2 = [("s_i × d, 1st", True, size_i), ("s_i × d, 2nd", True, size_i)]
    parts = {
        "spherical": points,
        "universal": points + arms,
        "revolute": points + p1,
        "cylindrical": p1 + p2,
        "translational": p1 + p2 + [("h_i · h_j", False, size_h * size_hj)],
        "screw": p1 + p2 + [("slide and turn", True, 1.0)],
    }
    return [
        Equation(joint.name, part, joint.place, length if is_length else 1.0, factor, is_length)
        for part, is_length, factor in parts[joint.kind]
    ]
