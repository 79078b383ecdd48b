"""Derivatives of a kinematic motion by a number of its mechanism: direct differentiation.

Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), chapter 3: the position meets
Φ(q, t; p) = 0, so that Φ_q q_p = -Φ_p; velocity and acceleration meet Φ_q q̇ - ν = 0 and Φ_q q̈ - γ = 0, whose
derivatives along (q_p, q̇_p) give q̇_p and q̈_p by the same matrix.  What depends on p is evaluated for
neighbours of the mechanism at given coordinates; none of them is solved.
"""

from collections.abc import Callable, Mapping

import numpy as np

from ...kernels.kinematics.newton import defects_of_rows
from ..linearisation.motion import sum_of_pairs
from .analysis import KinematicAnalysis
from .position import DENSE_LIMIT, Evaluator

# Of coordinates or rates: the first correction of a neighbour, which is of the square of the change, and the
# last one.
LARGEST_CORRECTION, ROUND_OFF_OF_STATE = 1e-3, 1e-15
MOST_CORRECTIONS = 8
LARGEST_BLOCK = 2**21  # entries of matrices of rows together
Solve = Callable[[np.ndarray], np.ndarray]


class ForkedEquations(Exception):
    """The equations of neighbours are others than those of the mechanism, or change by a jump."""


def neighbouring_states(
    analysis: KinematicAnalysis,
    times: np.ndarray,
    states: np.ndarray,
    neighbours: Mapping[float, KinematicAnalysis],
    h: float,
    *,
    closed: bool,
) -> dict[float, np.ndarray]:
    """Return states (T, 3, n), q, q̇ and q̈, of each of the neighbours, near those at times (T,).

    neighbours: mechanisms whose number is larger by each place of the stencil times h.  Their states lie on
    the tangent, or if `closed` on their own motion, as forces need it.  Raises ForkedEquations.
    """
    base = analysis.arrays
    like = base.bodies_of.shape, base.constraints["kind"].tolist()
    others = {s: _Defects(one) for s, one in neighbours.items()}
    for one in others.values():
        arrays = one.evaluator.arrays
        if (arrays.bodies_of.shape, arrays.constraints["kind"].tolist()) != like or arrays.screw_angles.size:
            raise ForkedEquations
    own, size = _Defects(analysis), states.shape[2]
    of_step = {s: states.copy() for s in others}
    count = 1 if size > DENSE_LIMIT else max(1, LARGEST_BLOCK // size**2)
    for first in range(0, len(times), count):
        rows = slice(first, first + count)
        solve = own.solver(states[rows, 0], times[rows])
        derivatives = _derivatives(others, states[rows], times[rows], h, solve)
        for s, one in others.items():
            of_step[s][rows] += s * h * derivatives
            most = MOST_CORRECTIONS if closed else 1
            corrected = _corrected(one, of_step[s][rows], times[rows], solve, most)
            if closed:
                of_step[s][rows] = corrected
    return of_step


def _derivatives(
    others: Mapping[float, "_Defects"], states: np.ndarray, times: np.ndarray, h: float, solve: Solve
) -> np.ndarray:
    """Return the derivatives (T, 3, n) of states by the number."""
    derivatives = np.zeros_like(states)
    for order in range(3):

        def defects(s: float, order: int = order) -> np.ndarray:
            return others[s].of(order, states + s * h * derivatives, times)

        derivatives[:, order] = -solve(sum_of_pairs(defects) / h)
    return derivatives


def _corrected(one: "_Defects", states: np.ndarray, times: np.ndarray, solve: Solve, most: int) -> np.ndarray:
    """Return the states of a neighbour at states on the tangent, which are off by the square of the change.

    `most`: corrections of each order.  Raises ForkedEquations where they are off by more: the equations jump.
    """
    scale, states = one.evaluator.arrays.column_scale, states.copy()
    for order in range(3):
        for iteration in range(most):
            step = solve(one.of(order, states, times))
            states[:, order] -= step
            largest = np.max(np.abs(states[:, order]) / scale, axis=1)
            size = float(np.max(np.max(np.abs(step) / scale, axis=1) / (1.0 + largest)))
            if iteration == 0 and not size < LARGEST_CORRECTION:
                raise ForkedEquations
            if size < ROUND_OFF_OF_STATE:
                break
    return states


class _Defects:
    """Residuals of the equations of a mechanism, of their first and of their second derivative."""

    def __init__(self, analysis: KinematicAnalysis):
        self.system = analysis.system
        self.evaluator: Evaluator = analysis.evaluator
        self.expected = self.evaluator.arrays.screw_angles
        self.m = self.evaluator.arrays.row_scale.size

    def of(self, order: int, states: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return Φ, Φ_q q̇ - ν or Φ_q q̈ - γ (T, m) by `order` at states (T, 3, n), unscaled."""
        defects = np.zeros((len(times), self.m))
        defects_of_rows(self.system, self.evaluator.work, states, times, order, self.expected, defects)
        return defects

    def solver(self, positions: np.ndarray, times: np.ndarray) -> Solve:
        """Return the function that solves Φ_q x = b, b (T, m) at each of the positions (T, n).

        Raises ForkedEquations where equations repeat others.
        """
        evaluator, arrays = self.evaluator, self.evaluator.arrays
        if self.m != positions.shape[1]:
            raise ForkedEquations
        if self.m > DENSE_LIMIT:
            from scipy.sparse.linalg import splu

            [position], [time] = positions, times
            evaluator.residual(position, time, self.expected)
            solve = splu(evaluator.sparse_matrix(position).tocsc()).solve
            return lambda b: solve(b[0] / arrays.row_scale)[None] * arrays.column_scale
        matrices = np.empty((len(times), self.m, self.m))
        for k, time in enumerate(times.tolist()):
            evaluator.residual(positions[k], time, self.expected)
            matrices[k] = evaluator.jacobian(positions[k])
        inverses = np.linalg.inv(matrices)
        return lambda b: (inverses @ (b / arrays.row_scale)[:, :, None])[:, :, 0] * arrays.column_scale
