"""Derivatives of a kinematic motion by a number of its mechanism: direct differentiation.

Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), chapter 3: the position meets
Φ(q, t; p) = 0, so that Φ_q q_p = -Φ_p; velocity and acceleration meet Φ_q q̇ - ν = 0 and Φ_q q̈ - γ = 0, whose
derivatives along (q_p, q̇_p) give q̇_p and q̈_p by the same matrix.  What depends on p is evaluated for
neighbours of the mechanism at given coordinates; none of them is solved.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...kernels.kinematics import constraints as equations
from ...kernels.linalg.rotation import RATE, REMAINDER, rotation_rates
from ..linearisation.motion import sum_of_pairs
from .analysis import KinematicAnalysis
from .position import DENSE_LIMIT, Evaluator

# Of coordinates or rates: the first correction of a neighbour, which is of the square of the change, and the
# last one.
LARGEST_CORRECTION, ROUND_OFF_OF_STATE = 1e-3, 1e-15
MOST_CORRECTIONS = 8


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
    own = _Defects(analysis)
    found = {s: states.copy() for s in others}
    for row, t in enumerate(times.tolist()):
        solve = own.solver(states[row, 0], t)
        derivative = _derivative(others, states[row], t, h, solve)
        for s, one in others.items():
            found[s][row] += s * h * derivative
            corrected = _corrected(one, found[s][row], t, solve)
            if closed:
                found[s][row] = corrected
    return found


def _derivative(
    others: Mapping[float, "_Defects"], state: np.ndarray, t: float, h: float, solve: Any
) -> np.ndarray:
    """Return the derivatives (3, n) of a state by the number; solve(b): by the matrix Φ_q there."""
    derivative = np.zeros_like(state)
    for order in range(3):

        def defects(s: float, order: int = order) -> np.ndarray:
            return others[s].of(order, state + s * h * derivative, t)

        derivative[order] = -solve(sum_of_pairs(defects) / h)
    return derivative


def _corrected(one: "_Defects", state: np.ndarray, t: float, solve: Any) -> np.ndarray:
    """Return the state of a neighbour at a state on the tangent, which is off by the square of the change.

    Raises ForkedEquations where it is off by more: the equations jump.
    """
    scale, state = one.evaluator.arrays.column_scale, state.copy()
    for order in range(3):
        for iteration in range(MOST_CORRECTIONS):
            step = solve(one.of(order, state, t))
            state[order] -= step
            size = np.max(np.abs(step) / scale) / (1.0 + np.max(np.abs(state[order]) / scale))
            if iteration == 0 and not size < LARGEST_CORRECTION:
                raise ForkedEquations
            if size < ROUND_OFF_OF_STATE:
                break
    return state


class _Defects:
    """Residuals of the equations of a mechanism, of their first and of their second derivative."""

    def __init__(self, analysis: KinematicAnalysis):
        self.evaluator: Evaluator = analysis.evaluator
        arrays = self.evaluator.arrays
        self.constraints, self.expected = analysis.system.constraints, arrays.screw_angles
        self.bodies, self.m = arrays.bodies_of, arrays.row_scale.size

    def of(self, order: int, state: np.ndarray, t: float) -> np.ndarray:
        """Return Φ, Φ_q q̇ - ν or Φ_q q̈ - γ (m,) by `order` at a state (3, n), unscaled."""
        q, work = state[0], self.evaluator.work
        residual: np.ndarray = self.evaluator.residual(q, t, self.expected) * self.evaluator.arrays.row_scale
        if order == 0:
            return residual
        rows = self.evaluator.rows(q)
        halves = state[order].reshape(-1, 7)[self.bodies].reshape(self.m, 14)
        right_side = np.zeros(self.m)
        if order == 1:
            equations.velocity(self.constraints, t, right_side)
        else:
            rotation_rates(q, state[1], work.rotations[RATE], work.rotations[REMAINDER])
            equations.acceleration(self.constraints, q, state[1], t, work.rotations, right_side)
        found: np.ndarray = np.sum(rows * halves, axis=1) - right_side
        return found

    def solver(self, q: np.ndarray, t: float) -> Any:
        """Return the function that solves Φ_q x = b; raises ForkedEquations where equations repeat others."""
        evaluator, arrays = self.evaluator, self.evaluator.arrays
        evaluator.residual(q, t, self.expected)
        if self.m != q.size:
            raise ForkedEquations
        if self.m > DENSE_LIMIT:
            from scipy.sparse.linalg import splu

            solve = splu(evaluator.sparse_matrix(q).tocsc()).solve
        else:
            from scipy.linalg import lu_factor, lu_solve

            factors = lu_factor(evaluator.jacobian(q))

            def solve(b: np.ndarray) -> np.ndarray:
                found: np.ndarray = lu_solve(factors, b)
                return found

        return lambda b: solve(b / arrays.row_scale) * arrays.column_scale
