"""Singular positions of a mechanism that moves under forces: its joints lose a rank there.

The integration steps over them where the motion is smooth.  They show as minima of the last singular
value that counts, which are then sought between the rows.
"""

from bisect import insort
from collections.abc import Iterator, Mapping
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...kernels.constrained.accelerations import evaluate_jacobian
from ...kernels.constrained.speeds import move
from ...model.joints import DEPENDENT, Equation
from ..checkpoint import OtherRun, taken
from ..constrained.state import ConstrainedState
from ..constrained.system import PositionGaps, dense_jacobian, is_large, new_work, sparse_jacobian
from ..projection import Corrections, Instant, project
from .conditioning import (
    NEARLY_SINGULAR,
    Conditioning,
    Passed,
    PassedSingularities,
    condition_text,
    conditioning_of,
    least_by_thirds,
    owners_text,
    weakest_owners,
)
from .sparse_rank import order_of_pivots, sparse_conditioning

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


SINGULAR_CONDITION = 1e4  # condition; mechanisms have 10 to 1000
CROSSED = 1e5  # condition
BESIDE = 1e-5  # of the length scale, rad
MOST_REPORTED = 6


def conditioning_of_speeds(analysis: ConstrainedState, jacobian: "np.ndarray | csr_matrix") -> Conditioning:
    """Return the conditioning of a scaled Jacobian (m, n) on speeds, by the rank that the analysis counts."""
    rank = max(1, int(analysis.work.rank[0]))
    if isinstance(jacobian, np.ndarray):
        return conditioning_of(jacobian, rank)
    return sparse_conditioning(jacobian, np.sort(analysis.work.order[:rank]))


def weakest_of_speeds(analysis: ConstrainedState, state: np.ndarray) -> tuple[float, list[Equation]]:
    """Condition of the independent equations of a ConstrainedState at a state (N,), and the weakest ones.

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


def is_singular(analysis: ConstrainedState, q: np.ndarray, start: np.ndarray) -> bool:
    """Return whether two motions of a ConstrainedState cross near q (n + b,), its joints sound at the start.

    So near to it in time a mere lock is further from losing a rank, by the square root.
    """
    if analysis.work.rank[0] < 1:
        return False
    gaps = PositionGaps(analysis.arrays, analysis.system, new_work(analysis.arrays))
    here, usual = (
        conditioning_of_speeds(analysis, gaps.jacobian(place.copy())).condition for place in (q, start)
    )
    return here > max(CROSSED, NEARLY_SINGULAR * usual)


def rank_at(analysis: ConstrainedState, r: np.ndarray, p: np.ndarray) -> int:
    """Return the rank at rigid bodies' origins r (bodies, 3), m, and Euler parameters p (bodies, 4)."""
    jacobian = analysis.gaps.jacobian(np.hstack([r, p]).ravel())
    if not isinstance(jacobian, np.ndarray):
        return order_of_pivots(jacobian)[1]
    values = np.linalg.svd(jacobian, compute_uv=False)
    return int(np.sum(values > DEPENDENT * values.max(initial=0.0)))


def has_gained_rank(analysis: ConstrainedState) -> bool:
    """Return whether equations that repeated others at the start of a ConstrainedState no longer do."""
    evaluate_jacobian(
        analysis.system, analysis.work, analysis.integration.z[: analysis.arrays.coordinate_scale.size].copy()
    )
    rank = int(analysis.work.rank[0])
    if is_large(analysis.arrays):
        return order_of_pivots(sparse_jacobian(analysis.work))[1] > rank
    values = np.linalg.svd(dense_jacobian(analysis.work), compute_uv=False)
    return bool(len(values) > rank and values[rank] > values[0] / SINGULAR_CONDITION**2)


def repeating_here_only(analysis: ConstrainedState) -> list[Equation]:
    """Equations that repeat others at the state of a ConstrainedState and not beside it, one of each owner.

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


MOST_CERTAIN_CONDITION = 1e6  # a position between rows is found to about the square root of round-off
SOUGHT = 3  # rows between which a singular position is sought
LOOKS = 300  # rows of a run that are looked at
MOST_WORK = 2_000_000  # multiplications of one look: larger mechanisms are not looked at
CANDIDATE = 0.3  # of the usual smallest singular value, at a row where it is least
BETWEEN = Corrections(met=1e-9, most=7, dependent=1e-6)  # of a position between two rows


class Row(NamedTuple):
    """A report row that was looked at."""

    t: float  # s
    q: Any  # coordinates (N,); None of an old row
    value: float  # its last singular value that counts, as a share of the largest


class PassedDynamicSingularities(PassedSingularities):
    """Looks for singular positions between the report rows of a ConstrainedState.

    They are sought on the straight line of coordinates between two rows, brought back to the equations.
    """

    most_reported = MOST_REPORTED

    def __init__(self, analysis: ConstrainedState):
        arrays = analysis.arrays
        work = len(arrays.equations) * arrays.speeds * min(len(arrays.equations), arrays.speeds)
        small = 0 < work <= MOST_WORK and not is_large(arrays)
        super().__init__(analysis.warnings, arrays.equations, small)
        self.analysis = analysis
        self.stride = max(1, analysis.grid.rows // LOOKS)
        self.seen: list[Row] = []
        self.row = 0
        self.sorted: list[float] = []  # the values seen

    @cached_property
    def gaps(self) -> PositionGaps:
        """Residuals and Jacobians between the rows, by a work of their own."""
        arrays = self.analysis.arrays
        return PositionGaps(arrays, self.analysis.system, new_work(arrays))

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return what was seen, as arrays: of old rows only the value is needed."""
        last = self.seen[-SOUGHT:]
        return {
            "seen/counts": np.array([self.row, self.notes.count]),
            "seen/values": np.array([row.value for row in self.seen]),
            "seen/times": np.array([row.t for row in last]),
            "seen/positions": np.array([row.q for row in last]),
        }

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Continue from what was seen up to a checkpoint."""
        self.row, self.notes.count = taken(checkpoint, "seen/counts", (2,), np.int64).tolist()
        values, times = (taken(checkpoint, f"seen/{name}", (None,)).tolist() for name in ("values", "times"))
        size = self.analysis.arrays.coordinate_scale.size
        positions = taken(checkpoint, "seen/positions", (len(times), size) if times else (0,))
        old = len(values) - len(times)
        if old < 0:
            raise OtherRun("seen/values")
        self.sorted = sorted(values)
        last = zip(times, positions, values[old:], strict=True)
        self.seen = [*(Row(np.nan, None, value) for value in values[:old]), *(Row(*row) for row in last)]

    def suspected(self, times: np.ndarray, states: np.ndarray) -> Iterator[tuple[Row, Row, Row]]:
        """Yield three rows about each minimum; `states` of the rows at `times` have coordinates first."""
        chosen = np.arange(-self.row % self.stride, len(times), self.stride)
        self.row += len(times)
        if not self.active or self.notes.full or not chosen.size:
            return
        positions = states[chosen, : self.analysis.arrays.coordinate_scale.size]
        for row in map(Row, times[chosen].tolist(), positions, self._smallest(positions)):
            if self.notes.full:
                return
            self.seen.append(row)
            insort(self.sorted, row.value)
            if self._least_in_the_middle():
                yield self.seen[-3], self.seen[-2], self.seen[-1]

    def _smallest(self, positions: np.ndarray) -> list[float]:
        """The last singular value that counts, of the largest, at each of `positions` (k, N)."""
        jacobians = np.array([self.gaps.jacobian(q) for q in positions])
        values = np.linalg.svd(jacobians, compute_uv=False)
        return (values[:, int(self.analysis.work.rank[0]) - 1] / values[:, 0]).tolist()

    def _least_in_the_middle(self) -> bool:
        """Return whether the row before the last is a minimum, and much below what is usual."""
        if len(self.seen) < 3:
            return False
        before, here, after = (row.value for row in self.seen[-3:])
        return here <= before and here < after and here < CANDIDATE * self._usual()

    def _usual(self) -> float:
        """The median of the values seen; numpy's imports more than all this file takes."""
        values, middle = self.sorted, len(self.sorted) // 2
        return values[middle] if len(values) % 2 else 0.5 * (values[middle - 1] + values[middle])

    def located(self, interval: tuple[Row, Row, Row]) -> Iterator[Passed]:
        """Yield the singular position before the row in the middle, or else the one after it."""
        for first, last in (interval[:2], interval[1:]):
            x = least_by_thirds(partial(self._value_at, first, last))
            q, value = self._at(first, last, x)
            if value < 1.0 / SINGULAR_CONDITION:
                yield Passed(q, first.t + x * (last.t - first.t), self._expected, True)
                return

    @property
    def _expected(self) -> np.ndarray:
        return self.analysis.integration.angles[0]

    def _at(self, first: Row, last: Row, x: float) -> tuple[np.ndarray, float]:
        """Position at the part x of the way between two rows, and its smallest value; inf if open."""
        t, q = first.t + x * (last.t - first.t), (1.0 - x) * first.q + x * last.q
        q, gap = project(Instant(self.gaps, t, self._expected), q, BETWEEN)
        return q, self._smallest(q[None])[0] if np.max(np.abs(gap)) <= BETWEEN.met else np.inf

    def _value_at(self, first: Row, last: Row, x: float) -> float:
        return self._at(first, last, x)[1]

    def conditioning(self, passed: Passed) -> Conditioning:
        """Return the conditioning of the Jacobian on speeds there."""
        return conditioning_of_speeds(self.analysis, self.gaps.jacobian(passed.q))

    def sentence(self, passed: Passed, weak: Conditioning, owners: list[Equation]) -> str:
        """Say that the motion could branch there."""
        conditioning = condition_text(weak.condition, MOST_CERTAIN_CONDITION)
        return (
            f"near t = {passed.t:.4g} s the motion passes a singular position of {owners_text(owners)} "
            f"({conditioning}), where it could branch; it continues smoothly"
        )
