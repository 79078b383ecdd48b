"""The scalar equations of a mechanism: whose they are, in what unit, and where they stand in the deck."""

import math
from dataclasses import dataclass

from ..errors import Place
from .joints import BY_NAME
from .mechanism import Joint

DEPENDENT = 1e-9  # of the largest singular value: equations with a smaller one repeat others


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
    sizes = {vector: math.hypot(*getattr(joint, vector)) for vector in ("s_i", "s_j", "h_i", "h_j")}
    return [
        Equation(
            joint.name,
            part,
            joint.place,
            length if is_length else 1.0,
            math.prod((sizes[vector] for vector in vectors), start=1.0),
            is_length,
        )
        for part, is_length, vectors in BY_NAME[joint.kind].parts
    ]
