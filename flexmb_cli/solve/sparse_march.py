"""The march of `kernels.kinematic_march` for mechanisms too large for dense factors.

The same predictor, Newton iteration and acceptance test; the linear algebra is SuperLU's (scipy) on a
fixed pattern, with the fill-reducing order of the columns found once.
"""

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from ..kernels import constraints as equations
from ..kernels import kinematic_march as dense
from ..kernels.newton import CONVERGED, LAST_CORRECTION, REFINED, ROUND_OFF, SINGULAR, STALLED
from ..kernels.rotation import rotation_rates
from .position import Evaluator

RATE, REMAINDER = 1, 2


class SparseFactors:
    """SuperLU factors of scaled Jacobians that share one pattern and one order of the columns."""

    def __init__(self, evaluator: Evaluator):
        self.evaluator = evaluator
        self.order = None
        self._find_pattern()

    def _find_pattern(self):
        """Entries that are not zero at a position without symmetry can be nonzero anywhere."""
        size = self.evaluator.arrays.q.size
        generic = np.random.default_rng(1996).uniform(0.3, 1.0, size)
        self.evaluator.residual(generic, 0.0, self.evaluator.arrays.screw_angles)
        rows, columns, values = self.evaluator.entries(generic)
        self.kept = np.flatnonzero(values.ravel())
        self.rows, self.columns = rows.ravel()[self.kept], columns.ravel()[self.kept]

    def factorise(self, q) -> bool:
        """Factors at the q of the evaluator's last residual; False where it is singular."""
        values = self.evaluator.entries(q)[2].ravel()[self.kept]
        shape = (q.size, q.size)
        columns = self.columns if self.order is None else self.order[self.columns]
        matrix = csc_matrix((values, (self.rows, columns)), shape)
        try:
            self.lu = splu(matrix, permc_spec="COLAMD" if self.order is None else "NATURAL")
        except RuntimeError:  # SuperLU: "Factor is exactly singular"
            return False
        if self.order is None:
            self.order = self.lu.perm_c.copy()
            return self.factorise(q)
        pivots = np.abs(self.lu.U.diagonal())
        return bool(pivots.min() > self.evaluator.system.limits[1])

    def solve(self, right_side) -> np.ndarray:
        """Scaled unknowns for a scaled right-hand side."""
        return self.lu.solve(right_side)[self.order]


class SparseMarch:
    """Marches a large mechanism; `march` has the arguments and the result of the kernel of that name."""

    def __init__(self, evaluator: Evaluator):
        self.evaluator = evaluator
        self.arrays = evaluator.arrays
        self.system = evaluator.system
        self.factors = SparseFactors(evaluator)

    def newton(self, q, t, near, limit, most):
        """Improve q in place until only round-off is left; returns (code, iterations)."""
        previous = np.inf
        for iteration in range(1, most + 1):
            gap = self.evaluator.residual(q, t, near)
            if not np.all(np.isfinite(gap)):
                return STALLED, iteration
            if not self.factors.factorise(q):
                return SINGULAR, iteration
            correction = self.factors.solve(gap)
            size = np.max(np.abs(correction))
            shrink = min(1.0, limit / size) if size > 0.0 else 1.0
            q -= shrink * correction * self.arrays.column_scale
            if size <= LAST_CORRECTION:
                left = np.max(np.abs(self.evaluator.residual(q, t, near)))
                return (CONVERGED if left <= ROUND_OFF else STALLED), iteration
            if iteration > 3 and shrink == 1.0 and size > previous:
                return STALLED, iteration
            previous = size
        return STALLED, most

    def rates(self, q, t, qd, qdd):
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

    def _solve_refined(self, matrix, right_side, solution):
        scaled = right_side / self.arrays.row_scale
        x = self.factors.solve(scaled)
        for _ in range(3):
            rest = scaled - matrix @ x
            if np.max(np.abs(rest)) <= REFINED * np.max(np.abs(x)):
                break
            x += self.factors.solve(rest)
        solution[:] = x * self.arrays.column_scale
        return np.max(np.abs(rest * self.arrays.row_scale))

    def attempt(self, state, motion, t, t_new, limit, most, new, near):
        """One step: (defect, iterations, velocity residual), as the kernel's `attempt`."""
        h = t_new - t
        dense.predict(state, h, new[0])
        dense.screws_expected(motion, h, near)
        code, iterations = self.newton(new[0], t_new, near, limit, most)
        if code != CONVERGED:
            return np.inf, iterations, np.inf
        gap = self.rates(new[0], t_new, new[1], new[2])
        return dense.defect(self.system, state, new, h), iterations, gap

    def advance(self, state, motion, clock, target, new, near):
        """Carry `state` to `target`, as the kernel's `advance`."""
        smallest = dense.SMALLEST_STEP * (target - clock[dense.TIME])
        assembling = clock[dense.STEP] == 0.0
        limit = dense.ASSEMBLY_LIMIT if assembling else dense.NO_LIMIT
        most = int(self.system.limits[2]) if assembling else dense.STEP_ITERATIONS
        total, gap = 0, 0.0
        while clock[dense.TIME] < target or clock[dense.STEP] == 0.0:
            t, t_new = clock[dense.TIME], dense.step_to(clock, target)
            off = np.inf
            if not dense.turns_too_far(self.system.constraints, t, t_new):
                off, iterations, gap = self.attempt(state, motion, t, t_new, limit, most, new, near)
                total += iterations
            if off <= 1.0 or (assembling and off < np.inf):
                dense.accept(self.system, self.evaluator.work, new, near, state, motion)
                dense.after_success(clock, t_new, off)
            else:
                clock[dense.STEP] = 0.5 * (t_new - t)
                if clock[dense.STEP] <= smallest:
                    return False, total, gap
        return True, total, gap

    def march(self, state, motion, clock, times, out, audit):
        """Fill report rows; returns the number of rows reached."""
        new, near = np.empty_like(state), np.empty(len(motion))
        for row, target in enumerate(times):
            arrived, total, gap = self.advance(state, motion, clock, target, new, near)
            if not arrived:
                return row
            out[row] = state
            audit[row] = np.max(np.abs(self.evaluator.work.vectors[0])), gap, total
        return len(times)
