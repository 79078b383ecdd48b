"""One table of the types of joints and constraints: points, equations, joint coordinates.

The codes are what the kernels switch on (`kernels/kinematics/constraints.py`); a test ties the table to the
files in `kernels/kinematics/joints/` and to the counts of `EQUATIONS` there.  The words of decks stand in the
`DIALECT` of each dialect.
"""

import math
from dataclasses import dataclass
from typing import Any

from ..errors import Place
from .mechanism import Joint

ANGLE, STROKE = "angle", "stroke"
ANGLES_OF_CROSS = ("angle1", "angle2")  # of a cross on body i about s_i, and of body j on it about s_j
PITCH, DISTANCE_OF_POINTS = "pitch", "distance"

# Equations: what they say, whether in m, and the vectors as typed by whose lengths the kernel divides them.
POINTS = (("x", True, ()), ("y", True, ()), ("z", True, ()))
RIGHT_ANGLE = (("s_i · s_j", False, ("s_i", "s_j")),)
PARALLEL = (("s_i × s_j, 1st", False, ("s_i", "s_j")), ("s_i × s_j, 2nd", False, ("s_i", "s_j")))
ON_AXIS = (("s_i × d, 1st", True, ("s_i",)), ("s_i × d, 2nd", True, ("s_i",)))
NO_TURN = (("h_i · h_j", False, ("h_i", "h_j")),)
THREAD = (("slide and turn", True, ()),)


@dataclass(frozen=True)
class JointType:
    """A type of joint or constraint.

    `code`: what the kernels of kinematics switch on, 0 for joints between nodes only.  `points`: local points
    that decks give, in their order.  `parts`: its equations by name.  `coordinates`: the joint coordinates
    that it leaves, `turns` others in which elements act, which results do not have.  `size`: what the number
    is that belongs to it, "" for none.  `meets`: whether every point of body i is where that of body j is at
    the start.
    """

    name: str
    code: int
    equations: int
    points: tuple[str, ...] = ()
    parts: tuple[Any, ...] = ()
    coordinates: tuple[str, ...] = ()
    turns: tuple[str, ...] = ()
    size: str = ""
    meets: bool = True

    @property
    def sprung(self) -> str:
        """The joint coordinate in which a spring of a VSDF deck acts: the angle, or else the stroke."""
        return ANGLE if ANGLE in self.coordinates else STROKE

    def points_on(self, side: str) -> int:
        """Return how many points decks give on body "i" or "j"."""
        return sum(point.endswith(side) for point in self.points)


_P, _Q, _H = ("P_i", "P_j"), ("Q_i", "Q_j"), ("H_i", "H_j")

JOINT_TYPES = (
    JointType("spherical", 1, 3, _P, POINTS),
    JointType("universal", 2, 4, _P + _Q, POINTS + RIGHT_ANGLE, turns=ANGLES_OF_CROSS, meets=False),
    JointType("revolute", 3, 5, _P + _Q, POINTS + PARALLEL, (ANGLE,)),
    JointType("cylindrical", 4, 4, _P + _Q, PARALLEL + ON_AXIS, (ANGLE, STROKE)),
    JointType("translational", 5, 5, _P + _Q + _H, PARALLEL + ON_AXIS + NO_TURN, (STROKE,)),
    JointType("screw", 6, 5, _P + _Q + _H, PARALLEL + ON_AXIS + THREAD, (ANGLE, STROKE), size=PITCH),
)

# Joints between nodes, besides those: their equations stand in `model/arrays/node_joints.py`.
NODE_JOINT_TYPES = (
    JointType("fixed", 0, 6, _P + _Q + _H),
    JointType("revolute-spherical", 0, 2, (*_P, "Q_i"), size=DISTANCE_OF_POINTS, meets=False),
    JointType("spherical-spherical", 0, 1, _P, size=DISTANCE_OF_POINTS, meets=False),
)

# Joints in lines of the block ELEMENTS, see `general_joints`.
DIRECTIONS = ("tx", "ty", "tz", "rx", "ry", "rz")  # displacements, then turns
# Directions that each case leaves free.
CASES: dict[str, tuple[str, ...]] = {
    "weld": (),
    "inline": ("tz", "rx", "ry", "rz"),
    "inplane": ("tx", "ty", "rx", "ry", "rz"),
    "parallel": ("tx", "ty", "tz", "rz"),
}
CONSTANT_ANGLE = "angle"

# Constraints that are no joints: one equation each, but for the rotational driver, which takes the
# place of its body's normalisation and has two.
SIMPLIFIED = JointType("simplified", 7, 1)
DISTANCE = JointType("distance", 8, 1)
DRIVER = JointType("driver", 9, 1)
NORMALISATION = JointType("normalisation", 10, 1)

BY_NAME = {
    kind.name: kind for kind in (*JOINT_TYPES, *NODE_JOINT_TYPES, SIMPLIFIED, DISTANCE, DRIVER, NORMALISATION)
}

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
