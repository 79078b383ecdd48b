"""First position of a mechanism when Newton from the deck's estimates fails, and what to say then.

Joints that a deck's body estimates leave wide open while they nearly close the others are likely a slip: a
lost minus sign or exchanged digits often give another mechanism, which assembly closes without complaint.
"""

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ...model.arrays.kinematic import KinematicArrays
from ...model.joints import DEPENDENT, JOINT_TYPES, Equation
from ..assembly import DAMPINGS, Sized, is_closed, nearest_of
from ..projection import Corrections, Instant, Position, improving, project
from ..singular.mobility import (
    MOST_DENSE,
    Gap,
    Mobility,
    about,
    dense_mobility,
    gap_norms,
    motion_text,
    worst_gaps,
)
from .position import Evaluator, Poses

if TYPE_CHECKING:
    from ..constrained.system import PositionGaps


WIDE_ESTIMATE = 0.05  # of the length scale
OPEN_ESTIMATE = 0.005  # of the length scale: more than estimates of three digits leave
OPEN_BY_OTHERS = 10.0  # of the widest gap elsewhere
CLOSE_ESTIMATE = 0.01  # of the length scale
FEWEST_CLOSE = 3  # owners that show that the estimates are careful
MOST_GAPS_NAMED = 3


def wide_estimates(
    evaluator: "Evaluator | PositionGaps", q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[list[Gap], float]:
    """Return the widest gaps that the estimates q leave, widest first, and the largest of the others, m.

    `expected`: angles of screws, rad.  There are none where gaps are wide as a rule, or small: then the
    estimates are rough, or right.  Angles and Euler parameters are left out: attitudes may be far off.
    """
    widest, length = _widest_lengths(evaluator, evaluator.residual(q, t, expected))
    return _parted(widest, sum(abs(gap.value) > WIDE_ESTIMATE * length for gap in widest), length)


def open_estimates(
    evaluator: "Evaluator | PositionGaps", q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[list[Gap], float, bool]:
    """Return gaps as `wide_estimates` does and True; where there are none, those far wider than all others.

    6.01 typed for 6.10 opens a joint by a hundredth of the size, where three digits leave a thousandth.
    """
    wide, rest = wide_estimates(evaluator, q, t, expected)
    if wide:
        return wide, rest, True
    widest, length = _widest_lengths(evaluator, evaluator.residual(q, t, expected))
    count, sizes = 0, [abs(gap.value) for gap in widest]
    for k, (size, following) in enumerate(pairwise(sizes), start=1):
        if size > max(OPEN_ESTIMATE * length, OPEN_BY_OTHERS * following):
            count = k
    return *_parted(widest, count, length), False


def _parted(widest: list[Gap], count: int, length: float) -> tuple[list[Gap], float]:
    """Return the first `count` gaps and the size of the next, m; none where the others are not close."""
    rest = [abs(gap.value) for gap in widest[count:]]
    careful = sum(size <= CLOSE_ESTIMATE * length for size in rest)
    if not count or careful < max(FEWEST_CLOSE, len(widest) - careful):
        return [], 0.0
    return widest[:count], rest[0]


def slip_note(wide: list[Gap], rest: float, *, far: bool) -> Fault:
    """Return the note of `check` on joints that assembly closed; `far`: bodies moved far."""
    message = f"{'assembly had to move bodies far: ' * far}{slip_sentence(wide, rest)}"
    return about("note", message, *(gap.equation for gap in wide), id="SOLVE-055")


def slip_sentence(wide: list[Gap], rest: float) -> str:
    """Return which joints the estimates leave open, and what may be wrong."""
    named = "; ".join(gap.text for gap in wide[:MOST_GAPS_NAMED])
    more = f" and {len(wide) - MOST_GAPS_NAMED} more" if len(wide) > MOST_GAPS_NAMED else ""
    return (
        f"the body estimates leave a gap at {named}{more}, elsewhere {rest:.1e} m at most: is a sign, a "
        "digit or a body number wrong there, or in an estimate?"
    )


def _widest_lengths(evaluator: "Evaluator | PositionGaps", scaled: np.ndarray) -> tuple[list[Gap], float]:
    """Return the widest gap in m of every owner that has equations of length, the widest first, and the
    length scale.
    """
    widest: dict[str, Gap] = {}
    sizes = scaled * evaluator.arrays.row_scale
    for equation, size in zip(evaluator.arrays.equations, sizes, strict=True):
        known = widest.get(equation.owner)
        if equation.is_length and (known is None or abs(size) > abs(known.value)):
            widest[equation.owner] = Gap(equation, float(size))
    length = max((gap.equation.scale for gap in widest.values()), default=1.0)
    return sorted(widest.values(), key=lambda gap: -abs(gap.value)), length


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
    match = sized.search(q, DAMPINGS[0])
    weights = np.where(_of_joints(evaluator.arrays), 1.0, PRESCRIBED_WEIGHT)
    if not np.max(np.abs(evaluator.residual(match, t, expected))) <= NEARLY_MET:
        match = sized.search(match, DAMPINGS[0], weights=weights)
    return match, evaluator.residual(match, t, expected)


def _of_joints(arrays: KinematicArrays) -> np.ndarray:
    """Return which equations are those of joints (equations,)."""
    constraints = arrays.constraints
    joints = np.isin(constraints["kind"], [kind.code for kind in JOINT_TYPES])
    rows = np.arange(len(arrays.equations))
    return joints[np.searchsorted(constraints["first_row"], rows, side="right") - 1]


ADVICE = (
    "check these joints' points and the body estimates; estimates that are too far are found by changing "
    "lengths in small steps from a mechanism that closes"
)
# Shortest corrections also converge among redundant equations.  A wider gap than the last number is real:
# they would only spread it.
POLISH = Corrections(met=1e-13, most=20, dependent=DEPENDENT, hopeless=1e-6)


def assemble_by_search(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The position (7 n,) nearest to the estimates q (7 n,) that meets the equations, and its residual (m,).

    Where none does, that which meets them best.  `expected`: angles of screws, rad.
    """
    instant = Instant(evaluator, t, expected)

    def finish(start: np.ndarray) -> Position:
        return instant.at(start) if evaluator.is_large else project(instant, start, POLISH, improving)

    sized = sized_equations(evaluator, q, t, expected)
    found, gap = nearest_of(sized, q, finish)
    return (found, gap) if is_closed(gap) else nearest_position(evaluator, found, t, expected)


def assembly_failure(
    evaluator: "Evaluator | PositionGaps",
    gap: np.ndarray,
    t: float,
    estimates: tuple[np.ndarray, np.ndarray] | None = None,
) -> AnalysisError:
    """The mechanism of the deck cannot be put together at its first time, t.

    `gap` (m,): scaled residual.  `estimates`: coordinates of the deck and the angles of screws there, where a
    slip may show.
    """
    worst = worst_gaps(evaluator.arrays, gap)
    wide, rest = wide_estimates(evaluator, estimates[0], t, estimates[1]) if estimates else ([], 0.0)
    left = "; ".join(one.text for one in worst) or "no gap is left, but the position is singular"
    message = (
        f"at t = {t:.6g} s the mechanism cannot be assembled from the estimates; what is left of the worst "
        f"constraints: {left}; {slip_sentence(wide, rest) if wide else ADVICE}"
    )
    owners = (one.equation for one in (*wide, *worst))
    return AnalysisError(about("error", message, *owners, id="SOLVE-052"), t, gap_norms(worst))


def too_large_to_rank(equations: int, most: int, t: float) -> AnalysisError:
    """The position closes, but Newton finds no way there, and singular values would take hours."""
    message = (
        f"at t = {t:.6g} s equations repeat others, or something moves that nothing determines; of "
        f"{equations} equations flexmb does not look for which (of {most} at most): leave bodies out until "
        "it does"
    )
    return AnalysisError(Fault("error", message, id="SOLVE-009"), t)


def free_motion_error(
    evaluator: Evaluator, q: np.ndarray, mobility: Mobility, motion: np.ndarray, t: float
) -> ModelError:
    """Something can move along the null vector `motion` (7 n,) that neither joints nor drivers determine."""
    doubled = "; ".join(_group(group) for group in mobility.redundant)
    message = (
        f"at t = {t:.6g} s a motion is left that nothing determines: {motion_text(evaluator, q, motion)}; "
        "constrain it (a simplified constraint or a driver) in place of an equation that repeats others: "
        f"{doubled}"
    )
    return ModelError([about("error", message, *_placed(mobility), id="SOLVE-053")])


def redundancy_warning(mobility: Mobility) -> Fault:
    """Some equations repeat others, yet every motion is determined."""
    groups = "; ".join(_group(group) for group in mobility.redundant)
    message = f"redundant equations, consistent with the others: {groups}"
    return about("warning", message, *_placed(mobility), id="SOLVE-054")


def _placed(mobility: Mobility) -> list[Equation]:
    return [e for group in mobility.redundant for e in group if e.place]


def _group(equations: tuple[Equation, ...], most: int = 6) -> str:
    names = [e.name for e in equations[:most]]
    more = f" and {len(equations) - most} more" if len(equations) > most else ""
    return "one of " + ", ".join(names) + more if len(equations) > 1 else names[0]


def mobility(evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray) -> Mobility:
    """Rank analysis of the scaled Jacobian at an assembled position q (7 n,), by singular values.

    Of large mechanisms by elimination, which finds the same groups in time and memory of their size.
    """
    evaluator.residual(q, t, expected)
    if q.size > MOST_DENSE:
        from ..singular.sparse_rank import order_of_pivots, sparse_mobility

        matrix, name = evaluator.sparse_matrix(q), evaluator.arrays.coordinate_name
        return sparse_mobility(matrix, *order_of_pivots(matrix), evaluator.arrays.equations, name)
    return dense_mobility(evaluator.jacobian(q), evaluator.arrays.equations, evaluator.arrays.coordinate_name)
