"""The position with the least residual near another one, by least squares."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.joints import JOINT_TYPES
from .levenberg_marquardt import least_squares
from .position import Evaluator

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...model.arrays.kinematic import KinematicArrays


PRESCRIBED_WEIGHT = 1e4


def nearest_position(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The position with the least residual that a least-squares search from q finds, and its residual.

    What the deck prescribes (held and driven coordinates, |p| = 1) weighs so much more than the
    joints that a gap shows where the user would see it: in a joint.
    """
    scale = evaluator.arrays.column_scale
    weights = np.where(_of_joints(evaluator.arrays), 1.0, PRESCRIBED_WEIGHT)

    def residual(x: np.ndarray) -> Any:
        return weights * evaluator.residual(x * scale, t, expected)

    if evaluator.is_large:
        x, weighted = _sparse_least_squares(evaluator, residual, weights, q / scale)
    else:
        x, weighted = least_squares(
            residual, lambda x: weights[:, None] * evaluator.jacobian(x * scale), q / scale
        )
    return x * scale, weighted / weights


def _sparse_least_squares(
    evaluator: Evaluator, residual: "Callable[..., Any]", weights: np.ndarray, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """As `least_squares`, for so many equations that scipy's sparse matrices are loaded in any case."""
    from scipy import optimize
    from scipy.sparse import diags

    scale = evaluator.arrays.column_scale

    def jacobian(x: np.ndarray) -> Any:
        residual(x)
        return diags(weights) @ evaluator.sparse_matrix(x * scale)

    result = optimize.least_squares(
        residual, x, jacobian, tr_solver="lsmr", xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=200
    )
    return result.x, result.fun


def _of_joints(arrays: "KinematicArrays") -> np.ndarray:
    """Return which equations are those of joints (equations,)."""
    constraints = arrays.constraints
    joints = np.isin(constraints["kind"], [kind.code for kind in JOINT_TYPES])
    rows = np.arange(len(arrays.equations))
    return joints[np.searchsorted(constraints["first_row"], rows, side="right") - 1]
