"""One table of the constraint types: name, kernel code, equations, geometry, the dialects' words.

The codes are what the kernels switch on (`kernels/kinematics/constraints.py`); a test ties the table to the
files in `kernels/joints/` and to the counts of `EQUATIONS` there.
"""

from ..quick_dataclass import dataclass


@dataclass(frozen=True)
class JointType:
    """A constraint type.  `points` are the local points the YOUNG deck gives, in its order."""

    name: str
    code: int
    equations: int
    points: tuple[str, ...] = ()
    young_count: str = ""


JOINT_TYPES = (
    JointType("spherical", 1, 3, ("P_i", "P_j"), "NSPHER"),
    JointType("universal", 2, 4, ("P_i", "P_j", "Q_i", "Q_j"), "NUNIVE"),
    JointType("revolute", 3, 5, ("P_i", "P_j", "Q_i", "Q_j"), "NREVOL"),
    JointType("cylindrical", 4, 4, ("P_i", "P_j", "Q_i", "Q_j"), "NCYLIN"),
    JointType("translational", 5, 5, ("P_i", "P_j", "Q_i", "Q_j", "H_i", "H_j"), "NTRANS"),
    JointType("screw", 6, 5, ("P_i", "P_j", "Q_i", "Q_j", "H_i", "H_j"), "NSCREW"),
)

# Constraints that are no joints: one equation each, but for the rotational driver, which takes the
# place of its body's normalisation and has two.
SIMPLIFIED = JointType("simplified", 7, 1, young_count="NSIMPL")
DISTANCE = JointType("distance", 8, 1, young_count="NSIMP2")
DRIVER = JointType("driver", 9, 1, young_count="NDRIVE")
NORMALISATION = JointType("normalisation", 10, 1)

BY_NAME = {kind.name: kind for kind in (*JOINT_TYPES, SIMPLIFIED, DISTANCE, DRIVER, NORMALISATION)}
