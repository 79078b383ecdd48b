"""Joint coordinates that a deck gives at the start: the assembled mechanism is led to them."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.angle_unwrapping import fill_angles
from ...model.arrays.system import SystemArrays
from ...model.joint_elements import JointDriver, JointStart
from ...model.time_functions import POLYNOMIAL, MotionFunction
from .first_position import assemble
from .state import ConstrainedState
from .system import PositionGaps, constrained_system, new_work, starts_sparse

LONGEST_LEAD = (
    0.25  # rad, or lengths of the mechanism: a position is then near the one before, and angles know turns
)
AT_REST = MotionFunction(POLYNOMIAL, (0.0, 0.0, 0.0, 0.0))


def led_to_values(
    analysis: ConstrainedState,
    driven_arrays: Callable[[tuple[JointDriver, ...]], SystemArrays],
    q: np.ndarray,
    t: float,
    tolerance: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates (n + b,) with the values of lines START, and angles; raises AnalysisError.

    q (n + b,) meets all equations of the mechanism; `tolerance` as in `assemble`; `driven_arrays`: those of
    the mechanism with further drivers, whose equations are the last.
    """
    starts = [item for item in analysis.elements.starts if item.value is not None]
    angles = analysis.arrays.angles
    if not starts:
        return q, angles
    drivers = tuple(JointDriver(s.name, s.joint, s.coordinate, AT_REST, s.place) for s in starts)
    arrays = driven_arrays(drivers)
    gaps = PositionGaps(arrays, constrained_system(arrays), new_work(arrays))
    gaps.sparse = starts_sparse(arrays)
    # The equations of the values are the last ones.
    rows = np.arange(len(arrays.equations) - len(starts), len(arrays.equations))
    sizes, constants = arrays.row_scale[rows], arrays.primitives["constant"][rows - len(arrays.bodies_of)]
    begin = gaps.residual(q, t, arrays.angles)[rows] * sizes
    way = np.array([item.value for item in starts]) - begin
    parts = max(1, math.ceil(np.max(np.abs(way) / sizes) / LONGEST_LEAD))
    for part in range(1, parts + 1):
        values = begin + way * (part / parts)
        arrays.primitives["constant"][rows - len(arrays.bodies_of)] = constants + values
        try:
            q = assemble(gaps, t, tolerance, q)[0]
        except AnalysisError as failure:
            raise _unmet(starts, values, t, failure) from failure
        arrays.angles[:] = _counted(gaps, q, arrays.angles)
        angles = _counted(analysis.gaps, q, angles)
    return q, angles


def _counted(gaps: PositionGaps, q: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return the angles at q that are nearest to those expected, rad."""
    counted = expected.copy()
    fill_angles(gaps.system, gaps.work, q, expected, counted)
    return counted


def _unmet(
    starts: Sequence[JointStart], values: np.ndarray, t: float, failure: AnalysisError
) -> AnalysisError:
    item, value = starts[0], values[0]
    others = f" beside {', '.join(one.name for one in starts[1:])}" if starts[1:] else ""
    message = (
        f"at t = {t:.6g} s the mechanism cannot be brought to {item.coordinate} {item.value:.6g} of "
        f"{item.name}{others}: joints and drivers do not let it pass {value:.6g}; change the value, or leave "
        "out what contradicts it"
    )
    return AnalysisError(Fault("error", message, item.place, item.name, id="SOLVE-130"), t, failure.norms)
