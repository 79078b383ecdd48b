"""The continuation of `kernels.kinematics.continuation` for mechanisms too large for dense factors.

The same predictor, Newton iteration and acceptance test; the linear algebra is SuperLU's (scipy) on a
fixed pattern, with the fill-reducing order of the columns found once.
"""

from typing import Any

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ...kernels.kinematics import constraints as equations
from ...kernels.kinematics import continuation as dense
from ...kernels.kinematics.newton import (
    CONVERGED,
    ITERATIONS,
    LAST_CORRECTION,
    PIVOT,
    REFINED,
    SINGULAR,
    SOLVED_RESIDUAL,
    STALLED,
    reach_of,
)
from ...kernels.linalg.rotation import RATE, REMAINDER, rotation_rates
from .position import Evaluator


class SparseFactors:
    """SuperLU factors of scaled Jacobians that share one pattern and one order of the columns.

    `repeated`: rows that repeat others, `dependent`: as many coordinates that follow from the others; a row
    of the one and a column of the other are replaced by a 1, so that those coordinates are left as they are.
    """

    def __init__(self, evaluator: Evaluator, repeated: tuple[int, ...] = (), dependent: tuple[int, ...] = ()):
        self.evaluator = evaluator
        self.order = None
        self.repeated, self.dependent = np.array(repeated, dtype=int), np.array(dependent, dtype=int)
        self._find_pattern()

    def _find_pattern(self) -> None:
        """Entries that are not zero at a position without symmetry can be nonzero anywhere."""
        size = self.evaluator.arrays.q.size
        generic = np.random.default_rng(1996).uniform(0.3, 1.0, size)
        self.evaluator.residual(generic, 0.0, self.evaluator.arrays.screw_angles)
        rows, columns, values = self.evaluator.entries(generic)
        replaced = np.isin(rows, self.repeated) | np.isin(columns, self.dependent)
        self.kept = np.flatnonzero(np.where(replaced, 0.0, values).ravel())
        self.rows = np.append(rows.ravel()[self.kept], self.repeated)
        self.columns = np.append(columns.ravel()[self.kept], self.dependent)

    def factorise(self, q: np.ndarray) -> int:
        """Factors at the q of the evaluator's last residual; sign of the determinant, 0 if singular."""
        values = np.append(self.evaluator.entries(q)[2].ravel()[self.kept], np.ones(self.repeated.size))
        shape = (q.size, q.size)
        columns = self.columns if self.order is None else self.order[self.columns]
        matrix = csc_matrix((values, (self.rows, columns)), shape)
        try:
            self.lu = splu(matrix, permc_spec="COLAMD" if self.order is None else "NATURAL")
        except RuntimeError:  # SuperLU: "Factor is exactly singular"
            return 0
        if self.order is None:
            self.order = self.lu.perm_c.copy()
            return self.factorise(q)
        pivots = self.lu.U.diagonal()
        if not np.abs(pivots).min() > self.evaluator.system.limits[PIVOT]:
            return 0
        turned = np.count_nonzero(pivots < 0.0) + odd(self.lu.perm_r) + odd(self.lu.perm_c)
        return -1 if turned % 2 else 1

    def solve(self, right_side: np.ndarray) -> np.ndarray:
        """Scaled unknowns for a scaled right-hand side; those of dependent coordinates are 0."""
        if self.repeated.size:
            right_side = right_side.copy()
            right_side[self.repeated] = 0.0
        return self.lu.solve(right_side)[self.order]


def odd(permutation: np.ndarray) -> bool:
    """Return whether a permutation is made of an odd number of exchanges: n less its cycles."""
    cycles = connected_components(
        csc_matrix((np.ones(permutation.size), (range(permutation.size), permutation)))
    )[0]
    return bool((permutation.size - cycles) % 2)


class SparseContinuation:
    """Follows a large mechanism; `follow` has the arguments and the result of the kernel of that name."""

    def __init__(self, evaluator: Evaluator, repeated: tuple[int, ...] = (), dependent: tuple[int, ...] = ()):
        self.evaluator = evaluator
        self.arrays = evaluator.arrays
        self.system = evaluator.system
        self.factors = SparseFactors(evaluator, repeated, dependent)

    def newton(
        self, q: np.ndarray, t: float, expected: np.ndarray, limit: float, most: int
    ) -> tuple[int, int, int]:
        """Improve q in place until only round-off is left; returns (code, iterations, sign)."""
        previous, sign = np.inf, 0
        for iteration in range(1, most + 1):
            gap = self.evaluator.residual(q, t, expected)
            if not np.all(np.isfinite(gap)):
                return STALLED, iteration, sign
            sign = self.factors.factorise(q)
            if not sign:
                return SINGULAR, iteration, sign
            correction = self.factors.solve(gap)
            size = np.max(np.abs(correction))
            shrink = min(1.0, limit / size) if size > 0.0 else 1.0
            q -= shrink * correction * self.arrays.column_scale
            reach = reach_of(self.system, q)
            if size <= LAST_CORRECTION * reach:
                left = np.max(np.abs(self.evaluator.residual(q, t, expected)))
                return (CONVERGED if left <= SOLVED_RESIDUAL * reach else STALLED), iteration, sign
            if iteration > 3 and shrink == 1.0 and size > previous:
                return STALLED, iteration, sign
            previous = size
        return STALLED, most, sign

    def rates(self, q: np.ndarray, t: float, qd: np.ndarray, qdd: np.ndarray) -> float:
        """Fill qd and qdd at a position found by `newton`; returns the largest |dΦ/dt|."""
        work, constraints = self.evaluator.work, self.system.constraints
        right_side = work.vectors[1]
        equations.velocity(constraints, t, right_side)
        matrix = self.evaluator.sparse_matrix(q)
        gap = self._solve_refined(matrix, right_side, qd)
        rotation_rates(q, qd, work.rotations[RATE], work.rotations[REMAINDER])
        equations.acceleration(constraints, q, qd, t, work.rotations, right_side)
        self._solve_refined(matrix, right_side, qdd)
        return gap

    def _solve_refined(self, matrix: Any, right_side: np.ndarray, solution: np.ndarray) -> float:
        scaled = right_side / self.arrays.row_scale
        x = self.factors.solve(scaled)
        for _ in range(3):
            rest = scaled - matrix @ x
            if np.max(np.abs(rest)) <= REFINED * np.max(np.abs(x)):
                break
            x += self.factors.solve(rest)
        solution[:] = x * self.arrays.column_scale
        return np.max(np.abs(rest * self.arrays.row_scale))

    def attempt(
        self,
        state: np.ndarray,
        motion: np.ndarray,
        t: float,
        t_new: float,
        limit: float,
        most: int,
        new: np.ndarray,
        expected: np.ndarray,
    ) -> tuple[float, float, int, int, float]:
        """One step, as the kernel's `attempt`."""
        h = t_new - t
        dense.predict(state, h, new[0])
        dense.screws_expected(motion, h, expected)
        code, iterations, sign = self.newton(new[0], t_new, expected, limit, most)
        if code != CONVERGED:
            return np.inf, 0.0, sign, iterations, np.inf
        gap = self.rates(new[0], t_new, new[1], new[2])
        return *dense.defect(self.system, state, new, h), sign, iterations, gap

    def advance(
        self,
        state: np.ndarray,
        motion: np.ndarray,
        clock: np.ndarray,
        target: float,
        new: np.ndarray,
        expected: np.ndarray,
    ) -> tuple[bool, float]:
        """Carry `state` to `target`, as the kernel's `advance`."""
        assembling = clock[dense.NEXT_LENGTH] == 0.0
        limit = dense.LARGEST_ASSEMBLY_CORRECTION if assembling else dense.NO_LIMIT
        most = int(self.system.limits[ITERATIONS]) if assembling else dense.STEP_ITERATIONS
        gap = 0.0
        while clock[dense.TIME] < target or clock[dense.NEXT_LENGTH] == 0.0:
            if clock[dense.BUDGET] <= 0.0:
                return False, gap
            clock[dense.BUDGET] -= 1.0
            t, t_new = clock[dense.TIME], dense.step_to(clock, target)
            off, moved, sign = np.inf, 0.0, 0
            if not dense.angle_too_far(self.system.constraints, t, t_new):
                off, moved, sign, iterations, gap = self.attempt(
                    state, motion, t, t_new, limit, most, new, expected
                )
                clock[dense.SPENT] += iterations
            if dense.acceptable(clock, off, moved, sign):
                dense.accept(self.system, self.evaluator.work, new, expected, state, motion)
                dense.after_success(clock, t_new, off, sign)
            else:
                clock[dense.NEXT_LENGTH] = 0.5 * (t_new - t)
                if dense.is_barred(clock, target):
                    return False, gap
        return True, gap

    def follow(
        self,
        state: np.ndarray,
        motion: np.ndarray,
        clock: np.ndarray,
        times: np.ndarray,
        out: np.ndarray,
        audit: np.ndarray,
    ) -> int:
        """Fill report rows; returns the number of rows reached."""
        new, expected = np.empty_like(state), np.empty(len(motion))
        for row, target in enumerate(times):
            arrived, gap = self.advance(state, motion, clock, target, new, expected)
            if not arrived:
                return row
            out[row] = state
            audit[row] = np.max(np.abs(self.evaluator.work.vectors[0])), gap, clock[dense.SPENT]
            clock[dense.SPENT] = 0.0
        return len(times)
