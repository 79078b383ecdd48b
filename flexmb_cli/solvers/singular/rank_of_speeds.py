"""The rank of the Jacobian on speeds at a state of a constrained motion: what is weakest, what repeats."""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.accelerations import evaluate_jacobian
from ...kernels.constrained.speeds import move
from ...model.equations import DEPENDENT, Equation
from ..constrained.large_start import is_large, sparse_jacobian
from ..constrained.position import PositionGaps
from ..constrained.system import dense_jacobian, new_work
from .sparse_rank import order_of_pivots, sparse_conditioning
from .weakest import NEARLY_SINGULAR, Conditioning, conditioning_of, weakest_owners

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ..constrained.analysis import ConstrainedMotion


SINGULAR_CONDITION = 1e4  # condition; mechanisms have 10 to 1000
CROSSED = 1e5  # condition
BESIDE = 1e-5  # of the length scale, rad
MOST_REPORTED = 6


def conditioning_of_speeds(
    analysis: "ConstrainedMotion", jacobian: "np.ndarray | csr_matrix"
) -> Conditioning:
    """Return the conditioning of a scaled Jacobian (m, n) on speeds, by the rank that the analysis counts."""
    rank = max(1, int(analysis.work.rank[0]))
    if isinstance(jacobian, np.ndarray):
        return conditioning_of(jacobian, rank)
    return sparse_conditioning(jacobian, np.sort(analysis.work.order[:rank]))


def weakest_of_speeds(analysis: "ConstrainedMotion", state: np.ndarray) -> tuple[float, list[Equation]]:
    """Condition of the independent equations of a ConstrainedMotion at a state (N,), and the weakest ones.

    The condition is the largest over the last singular value that is counted in the rank.
    """
    coordinates = analysis.arrays.coordinate_scale.size
    q = state[:coordinates].copy()
    if not np.all(np.isfinite(q)) or not analysis.arrays.equations:
        return 1.0, []
    evaluate_jacobian(analysis.system, analysis.work, q)
    if analysis.work.rank[0] < 1:
        return 1.0, []
    large = is_large(analysis.arrays)
    weak = conditioning_of_speeds(
        analysis, sparse_jacobian(analysis.work) if large else dense_jacobian(analysis.work)
    )
    return weak.condition, weakest_owners(analysis.arrays.equations, weak.combination, MOST_REPORTED)


def is_singular(analysis: "ConstrainedMotion", q: np.ndarray, start: np.ndarray) -> bool:
    """Return whether two motions of a ConstrainedMotion cross near q (n + b,), its joints sound at the start.

    So near to it in time a mere lock is further from losing a rank, by the square root.
    """
    if analysis.work.rank[0] < 1:
        return False
    gaps = PositionGaps(analysis.arrays, analysis.system, new_work(analysis.arrays))
    here, usual = (
        conditioning_of_speeds(analysis, gaps.jacobian(place.copy())).condition for place in (q, start)
    )
    return here > max(CROSSED, NEARLY_SINGULAR * usual)


def rank_at(analysis: "ConstrainedMotion", r: np.ndarray, p: np.ndarray) -> int:
    """Return the rank at rigid bodies' origins r (bodies, 3), m, and Euler parameters p (bodies, 4)."""
    gaps = PositionGaps(analysis.arrays, analysis.system, analysis.work)
    jacobian = gaps.jacobian(np.hstack([r, p]).ravel())
    if not isinstance(jacobian, np.ndarray):
        return order_of_pivots(jacobian)[1]
    values = np.linalg.svd(jacobian, compute_uv=False)
    return int(np.sum(values > DEPENDENT * values.max(initial=0.0)))


def has_gained_rank(analysis: "ConstrainedMotion") -> bool:
    """Return whether equations that repeated others at the start of a ConstrainedMotion no longer do."""
    evaluate_jacobian(
        analysis.system, analysis.work, analysis.integration.z[: analysis.arrays.coordinate_scale.size].copy()
    )
    rank = int(analysis.work.rank[0])
    if is_large(analysis.arrays):
        return order_of_pivots(sparse_jacobian(analysis.work))[1] > rank
    values = np.linalg.svd(dense_jacobian(analysis.work), compute_uv=False)
    return bool(len(values) > rank and values[rank] > values[0] / SINGULAR_CONDITION**2)


def repeating_here_only(analysis: "ConstrainedMotion") -> list[Equation]:
    """Equations that repeat others at the state of a ConstrainedMotion and not beside it, one of each owner.

    Beside it is a small part of some motion that all equations allow: where equations go on repeating
    others, as in planar loops, it leaves their rank as it was to second order.  Not looked for in large
    mechanisms.
    """
    arrays, work = analysis.arrays, analysis.work
    q, rank = analysis.integration.z[: arrays.coordinate_scale.size].copy(), int(work.rank[0])
    if not np.all(np.isfinite(q)) or not arrays.equations or is_large(arrays):
        return []
    evaluate_jacobian(analysis.system, work, q)
    free = np.linalg.svd(dense_jacobian(work))[2][rank:]
    motion = np.random.default_rng(0).uniform(-1.0, 1.0, len(free)) @ free
    move(arrays.bodies, q, BESIDE * motion * arrays.speed_scale)
    evaluate_jacobian(analysis.system, work, q)
    left, values, _ = np.linalg.svd(dense_jacobian(work))
    if len(values) > rank and values[rank] > values[0] / SINGULAR_CONDITION**2:
        return weakest_owners(arrays.equations, left[:, rank], MOST_REPORTED)
    return []
