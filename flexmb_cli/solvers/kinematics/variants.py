"""Mechanisms that differ from one in the functions of drivers and in points of interest: solved together.

Nothing that is made of a mechanism for its kinematics depends on these numbers but the places where they
stand themselves (`model.arrays.kinematic`).  Only plain motions count: what takes a search, a look at
singular positions or a message is left to a `KinematicAnalysis` of its own.
"""

import numpy as np

from ...kernels.kinematics.variants import follow_variants
from ...model.diagnostics import LARGEST_NUMBER
from ...model.driver_angles import LARGEST_ANGLE
from ...model.joints import DRIVER
from ..assembly import NEAR, displacements
from ..singular.kinematic_singularities import FEW
from .analysis import KinematicAnalysis
from .driver_axes import on_axes
from .rows import Rows, rows_of
from .state import DENSE_ELIMINATION

ATTEMPTS_A_ROW = 4  # steps to a row beyond which a motion is not plain


class Variants:
    """Variants of the mechanism of an analysis; `at_once`: how many the kernel is given together, or 0."""

    def __init__(self, analysis: KinematicAnalysis):
        self.analysis, self.mechanism = analysis, analysis.mechanism
        mechanism, arrays = self.mechanism, analysis.arrays
        self.functions = np.array([(d.C, d.B, d.A) for d in mechanism.drivers], dtype=float).reshape(-1, 3)
        self.points = np.array([point.s for point in mechanism.points], dtype=float).reshape(-1, 3)
        self._times = np.array([mechanism.time.time(k) for k in range(mechanism.time.rows)])
        self._attempts = ATTEMPTS_A_ROW * self._times.size
        self._driven = np.flatnonzero(arrays.constraints["kind"] == DRIVER.code)
        # Its constraints are written to.
        self._system = analysis.system._replace(constraints=arrays.constraints.copy())
        self.at_once = 0
        if arrays.q.size <= DENSE_ELIMINATION and self._drivers_hold_alone():
            self.at_once = analysis.steps_at_once // self._attempts

    def _drivers_hold_alone(self) -> bool:
        """Return whether no driver holds a coordinate that others may hold, at a value to be compared."""
        driven = [driver.body for driver in self.mechanism.drivers]
        held = {item.body for item in self.mechanism.simplified}
        held.update(ground.body for ground in self.mechanism.grounds)
        return len(set(driven)) == len(driven) and held.isdisjoint(driven)

    def solve(self, functions: np.ndarray, points: np.ndarray) -> tuple[Rows, np.ndarray]:
        """Return the report rows of all cases, one behind the other, and which cases are plain (cases,).

        functions (cases, drivers, 3): C, B, A of each driver; points (cases, points, 3): m, body axes.
        Rows of a case that is not plain mean nothing.
        """
        arrays, cases, times = self.analysis.arrays, len(functions), self._times
        out = np.zeros((cases, times.size, 3, arrays.q.size))
        audit, plain = np.zeros((cases, times.size, 3)), np.zeros(cases, dtype=bool)
        start = arrays.q, arrays.screw_angles, float(self._attempts)
        follow_variants(self._system, self._driven, functions, *start, times, out, audit, plain)
        states, s = out.reshape(-1, 3, arrays.q.size), np.repeat(points, times.size, axis=0)
        joints = self.analysis.joints.with_turns
        rows = rows_of(self.mechanism, np.tile(times, cases), states, audit.reshape(-1, 3), joints, s)
        plain &= self._is_allowed(functions, points) & self._is_near(out[:, 0, 0])
        plain &= (audit[:, 1:, 2] <= FEW).all(axis=1)  # else singular positions are looked for
        return rows, plain & on_axes(self.mechanism, rows).reshape(cases, -1).all(axis=1)

    def _is_allowed(self, functions: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return whether the deck of a case is without fault (cases,); others judge large angles."""
        t = max(abs(self.mechanism.time.start), abs(self.mechanism.time.end))
        C, B, A = np.moveaxis(np.abs(functions), 2, 0)
        numbers = np.concatenate([functions, points], axis=1)
        allowed = (np.abs(numbers) <= LARGEST_NUMBER).all(axis=(1, 2))
        return allowed & (C + t * (B + 0.5 * t * A) <= 0.5 * LARGEST_ANGLE).all(axis=1)

    def _is_near(self, first: np.ndarray) -> np.ndarray:
        """Return whether the first position (cases, n) is so near the estimates that none is sought."""
        search, q = self.analysis.search, self.analysis.arrays.q
        cases, bodies = len(first), q.size // 7
        way, turn = displacements(np.tile(q, cases), first.ravel(), cases * bodies)
        moved = np.maximum(way / (search.size * search.length), turn).reshape(cases, bodies)
        return moved.max(axis=1) <= NEAR
