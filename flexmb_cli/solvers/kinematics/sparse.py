"""Factors of Φ_q for mechanisms too large for dense ones, with which the continuation is the same.

They are SuperLU's (scipy) on a fixed pattern, with the fill-reducing order of the columns found once.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ...kernels.kinematics.continuation import continuation
from ...kernels.kinematics.newton import PIVOT, LinearSolver, System, Work
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
        found: np.ndarray = self.lu.solve(right_side)[self.order]
        return found


def odd(permutation: np.ndarray) -> bool:
    """Return whether a permutation (n,) is made of an odd number of exchanges: n less its cycles."""
    cycles = connected_components(
        csc_matrix((np.ones(permutation.size), (range(permutation.size), permutation)))
    )[0]
    return bool((permutation.size - cycles) % 2)


class SparseContinuation:
    """Follows a large mechanism; `follow` has the arguments and the result of the kernel of that name."""

    def __init__(self, evaluator: Evaluator, repeated: tuple[int, ...] = (), dependent: tuple[int, ...] = ()):
        self.evaluator = evaluator
        self.factors = SparseFactors(evaluator, repeated, dependent)
        self._fill_rows = continuation(LinearSolver(self._factorise, self._solve), made=_as_it_is)

    def _factorise(self, _system: System, _work: Work, q: np.ndarray) -> int:
        return self.factors.factorise(q)

    def _solve(self, _system: System, _work: Work, right_side: np.ndarray, solution: np.ndarray) -> float:
        arrays = self.evaluator.arrays
        x = self.factors.solve(right_side / arrays.row_scale)
        solution[:] = x * arrays.column_scale
        return float(np.max(np.abs(x)))

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
        system, work = self.evaluator.system, self.evaluator.work
        new, expected = np.empty_like(state), np.empty(len(motion))
        return int(self._fill_rows(system, work, state, motion, clock, times, out, audit, new, expected))


def _as_it_is(function: Callable[..., Any]) -> Callable[..., Any]:
    """SuperLU cannot be called by compiled code."""
    return function
