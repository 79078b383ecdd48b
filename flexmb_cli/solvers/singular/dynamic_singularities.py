"""Singular positions of a mechanism that moves under forces: its joints lose a rank there, by name."""

from bisect import insort
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...kernels.constrained.accelerations import evaluate_jacobian
from ...kernels.constrained.speeds import move
from ..checkpoint import OtherRun, taken
from ..constrained.flexible_start import PositionGaps
from ..constrained.system import new_work
from .weakest import (
    NEARLY_SINGULAR,
    SingularityNotes,
    condition_text,
    conditioning_of,
    owners_text,
    weakest_owners,
)

MOST_CERTAIN_CONDITION = 1e6  # a position between rows is found to about the square root of round-off
SINGULAR_CONDITION = 1e4  # condition; mechanisms have 10 to 1000
CROSSED = 1e5  # condition
BESIDE = 1e-5  # of the length scale, rad
MOST_REPORTED = 6
SOUGHT = 3  # rows between which a singular position is sought
LOOKS = 300  # rows of a run that are looked at
MOST_WORK = 2_000_000  # multiplications of one look: larger mechanisms are not looked at
CANDIDATE = 0.3  # of the usual smallest singular value, at a row where it is least
POSITION_FOUND = 1e-9  # scaled gap of a position between two rows
HALVINGS = 40


def weakest_of_speeds(analysis: Any, state: np.ndarray) -> tuple[float, list]:
    """Condition of the independent equations of a ConstrainedMotion at a state, and those that are weakest.

    The condition is the largest over the last singular value that is counted in the rank.
    """
    coordinates = analysis.arrays.coordinate_scale.size
    q = state[:coordinates].copy()
    if not np.all(np.isfinite(q)) or not analysis.arrays.equations:
        return 1.0, []
    evaluate_jacobian(analysis.system, analysis.work, q)
    return _weakest(analysis, analysis.work.jacobian)


def _weakest(analysis: Any, jacobian: Any) -> Any:
    rank = int(analysis.work.rank[0])
    if rank < 1:
        return 1.0, []
    found = conditioning_of(jacobian, rank)
    return found.condition, weakest_owners(analysis.arrays.equations, found.combination, MOST_REPORTED)


def is_singular(analysis: Any, q: np.ndarray, start: Any) -> bool:
    """Return whether two motions of a ConstrainedMotion cross near q, and its joints were sound at the start.

    So near to it in time a mere lock is further from losing a rank, by the square root.
    """
    gaps = PositionGaps(analysis.arrays, analysis.system, new_work(analysis.arrays))
    here, usual = (_weakest(analysis, gaps.jacobian(place.copy()))[0] for place in (q, start))
    return here > max(CROSSED, NEARLY_SINGULAR * usual)


def has_gained_rank(analysis: Any) -> bool:
    """Return whether equations that repeated others at the start of a ConstrainedMotion no longer do."""
    evaluate_jacobian(
        analysis.system, analysis.work, analysis.integration.z[: analysis.arrays.coordinate_scale.size].copy()
    )
    values, rank = np.linalg.svd(analysis.work.jacobian, compute_uv=False), int(analysis.work.rank[0])
    return len(values) > rank and values[rank] > values[0] / SINGULAR_CONDITION**2


def repeating_here_only(analysis: Any) -> list:
    """Equations that repeat others at the state of a ConstrainedMotion and not beside it, one of each owner.

    Beside it is a small part of some motion that all equations allow: where equations go on repeating
    others, as in planar loops, it leaves their rank as it was to second order.
    """
    arrays, work = analysis.arrays, analysis.work
    q, rank = analysis.integration.z[: arrays.coordinate_scale.size].copy(), int(work.rank[0])
    if not np.all(np.isfinite(q)) or not arrays.equations:
        return []
    evaluate_jacobian(analysis.system, work, q)
    free = np.linalg.svd(work.jacobian)[2][rank:]
    motion = np.random.default_rng(0).uniform(-1.0, 1.0, len(free)) @ free
    move(arrays.bodies, q, BESIDE * motion * arrays.speed_scale)
    evaluate_jacobian(analysis.system, work, q)
    left, values, _ = np.linalg.svd(work.jacobian)
    if len(values) > rank and values[rank] > values[0] / SINGULAR_CONDITION**2:
        return weakest_owners(arrays.equations, left[:, rank], MOST_REPORTED)
    return []


class PassedDynamicSingularities:
    """Looks for singular positions between the report rows of a ConstrainedMotion; notes go to its warnings.

    The integration steps over them where the motion is smooth.  They show as minima of the last singular
    value that counts, which are then sought between the rows, on the straight line of coordinates brought
    back to the equations.
    """

    def __init__(self, analysis: Any):
        self.analysis = analysis
        arrays = analysis.arrays
        self.gaps = PositionGaps(arrays, analysis.system, new_work(arrays))
        work = len(arrays.equations) * arrays.speeds * min(len(arrays.equations), arrays.speeds)
        self.active = 0 < work <= MOST_WORK
        self.stride = max(1, analysis.grid.rows // LOOKS)
        self.seen: list[Any] = []
        self.row, self.notes = 0, SingularityNotes(analysis.warnings)
        self.sorted: list[float] = []  # the values seen

    @property
    def checkpoint(self) -> dict:
        """Return what was seen, as arrays: of old rows only the value is needed."""
        last = self.seen[-SOUGHT:]
        return {
            "seen/counts": np.array([self.row, self.notes.count]),
            "seen/values": np.array([value for _, _, value in self.seen]),
            "seen/times": np.array([t for t, _, _ in last]),
            "seen/positions": np.array([q for _, q, _ in last]),
        }

    def restore(self, checkpoint: Mapping) -> None:
        """Go on from what was seen up to a checkpoint."""
        self.row, self.notes.count = taken(checkpoint, "seen/counts", (2,), np.int64).tolist()
        values, times = (taken(checkpoint, f"seen/{name}", (None,)).tolist() for name in ("values", "times"))
        size = self.analysis.arrays.coordinate_scale.size
        positions = taken(checkpoint, "seen/positions", (len(times), size) if times else (0,))
        old = len(values) - len(times)
        if old < 0:
            raise OtherRun("seen/values")
        self.sorted = sorted(values)
        last = zip(times, positions, values[old:], strict=True)
        self.seen = [*((np.nan, None, value) for value in values[:old]), *last]

    def look(self, times: np.ndarray, states: np.ndarray) -> None:
        """Look at report rows at `times`, in order, with coordinates first in `states`."""
        size = self.analysis.arrays.coordinate_scale.size
        for t, state in zip(times, states, strict=True):
            if self.active and self.row % self.stride == 0 and not self.notes.full:
                value = self._smallest(state[:size].copy())
                self.seen.append((float(t), state[:size].copy(), value))
                insort(self.sorted, value)
                self._judge()
            self.row += 1

    def _smallest(self, q: np.ndarray) -> float:
        """The last singular value that counts, of the largest."""
        values = np.linalg.svd(self.gaps.jacobian(q), compute_uv=False)
        return float(values[int(self.analysis.work.rank[0]) - 1] / values[0])

    def _judge(self) -> None:
        """Search about the row before the last, if it is a minimum; old rows are kept for what is usual."""
        if len(self.seen) < 3:
            return
        before, here, after = (value for _, _, value in self.seen[-3:])
        if here <= before and here < after and here < CANDIDATE * self._usual():
            for first, last in ((self.seen[-3], self.seen[-2]), (self.seen[-2], self.seen[-1])):
                if self._search(first, last):
                    return

    def _usual(self) -> float:
        """The median of the values seen; numpy's imports more than all this file takes."""
        values, middle = self.sorted, len(self.sorted) // 2
        return values[middle] if len(values) % 2 else 0.5 * (values[middle - 1] + values[middle])

    def _search(self, first: Any, last: Any) -> Any:
        """Seek the least singular value between two rows by thirds; tell it where it is singular."""
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            thirds = low + (high - low) / 3.0, high - (high - low) / 3.0
            values = [self._at(first, last, x)[1] for x in thirds]
            low, high = (low, thirds[1]) if values[0] < values[1] else (thirds[0], high)
        q, value = self._at(first, last, 0.5 * (low + high))
        if not value < 1.0 / SINGULAR_CONDITION:
            return False
        self._tell(first[0] + 0.5 * (low + high) * (last[0] - first[0]), q)
        return True

    def _at(self, first: Any, last: Any, x: Any) -> Any:
        """Position at the part x of the way between two rows, and its smallest value; inf if open."""
        gaps, arrays = self.gaps, self.analysis.arrays
        t, q = first[0] + x * (last[0] - first[0]), (1.0 - x) * first[1] + x * last[1]
        for _ in range(8):
            gap = gaps.residual(q, t, self.analysis.integration.angles[0])
            if np.max(np.abs(gap)) <= POSITION_FOUND:
                return q, self._smallest(q)
            step = np.linalg.lstsq(gaps.jacobian(q), gap, rcond=1e-6)[0]
            move(arrays.bodies, q, -step * arrays.speed_scale)
        return q, np.inf

    def _tell(self, t: float, q: np.ndarray) -> None:
        condition, owners = _weakest(self.analysis, self.gaps.jacobian(q))
        conditioning = condition_text(condition, MOST_CERTAIN_CONDITION)
        sentence = (
            f"near t = {t:.4g} s the motion passes a singular position of {owners_text(owners)} "
            f"({conditioning}), where it could branch; it goes on smoothly"
        )
        self.notes.add(sentence, owners)
