"""The position of a mechanism nearest to estimates, and the one with the least residual where none closes."""

from typing import TYPE_CHECKING

import numpy as np

from ...model.joints import JOINT_TYPES
from ..assembly import DAMPINGS, Sized
from ..projection import Instant
from .position import Evaluator, Poses

if TYPE_CHECKING:
    from ...model.arrays.kinematic import KinematicArrays


PRESCRIBED_WEIGHT = 1e4
NEARLY_MET = 1e-6  # scaled residual: corrections close what is left


def sized_equations(evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray) -> Sized:
    """Return the equations at t for searches near the estimates q (7 n,)."""
    return Sized(Instant(evaluator, t, expected), Poses(evaluator), q, len(evaluator.arrays.body_names))


def nearest_position(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The position with the least residual that a least-squares search from q finds, and its residual.

    Where gaps are left, what the deck prescribes (held and driven coordinates) weighs so much more than the
    joints that they show where the user would see them: in a joint.
    """
    # The search keeps |p|, and a start aside of a position has another.
    poses = q.reshape(-1, 7).copy()
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)
    q = poses.ravel()
    sized = sized_equations(evaluator, q, t, expected)
    found = sized.search(q, DAMPINGS[0])
    weights = np.where(_of_joints(evaluator.arrays), 1.0, PRESCRIBED_WEIGHT)
    if not np.max(np.abs(evaluator.residual(found, t, expected))) <= NEARLY_MET:
        found = sized.search(found, DAMPINGS[0], weights=weights)
    return found, evaluator.residual(found, t, expected)


def _of_joints(arrays: "KinematicArrays") -> np.ndarray:
    """Return which equations are those of joints (equations,)."""
    constraints = arrays.constraints
    joints = np.isin(constraints["kind"], [kind.code for kind in JOINT_TYPES])
    rows = np.arange(len(arrays.equations))
    return joints[np.searchsorted(constraints["first_row"], rows, side="right") - 1]
