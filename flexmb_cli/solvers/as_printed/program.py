"""The program YOUNG (1996) run anew: Newton's method, velocities and accelerations at every report time.

Liang Yong (1996), Appendix A, unit YOUNG_2: each position begins at the one before, and Newton's method ends
where no coordinate changes by more than FEPS.  Velocities and accelerations are solved with the Jacobian
of that position, errors included.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...model.attitudes import Attitudes
from ...model.mechanism import Joint, Mechanism
from .equations import Rows, State, along, coincident, orthogonal, parallel, stacked
from .errors import ALL_ERRORS, WRONG_INDEX
from .screw import ScrewZero, screw_row, screw_zero
from .single import driven, held, normalised
from .vectors import product, solved, tilde

# NRMAX, FEPS, EPSLU by the names of `KinematicSettings`.
LIMITS = {"most_iterations": 250, "tolerance": 1e-4, "smallest_pivot": 1e-5}
ZERO_ENTRY = 1e-3  # in the unit of the deck: an entry of the matrix of s_i that counts as zero


@dataclass(frozen=True)
class Equations:
    """The system of one evaluation: Jacobian (n, n), residuals and right-hand sides (n,)."""

    jacobian: np.ndarray
    residual: np.ndarray
    nu: np.ndarray
    gamma: np.ndarray


class Program:
    """One mechanism as the program has it in its memory.

    `errors`: those of `errors.ALL_ERRORS` that are made; none: the program as it was meant.  `settings` may
    hold other values of LIMITS.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        errors: frozenset[str] = ALL_ERRORS,
        settings: dict[str, Any] | None = None,
    ):
        self.limits = LIMITS | (settings or {})
        self.mechanism = mechanism
        q = np.array([(*body.r, *body.p) for body in mechanism.bodies], dtype=float)
        self.state = State(q, np.zeros_like(q), errors)
        turned = Attitudes(mechanism).driven
        self._normalised = [body for body in range(len(q)) if body not in turned]
        self._pairs: dict[int, list[int]] = {}
        self._zeros: dict[int, ScrewZero] = {}

    def advance(self, t: float) -> tuple[np.ndarray, int]:
        """Coordinates, rates and second derivatives (3, n, 7) at the time t, and Newton's iterations.

        Raises AnalysisError where the program would print CONVERGENCE FAILED.
        """
        iterations = self._position(t)
        system = self._system(t)
        self.state.qd = self._solve(system.jacobian, system.nu, t).reshape(-1, 7)
        # Evaluated anew, since the overrun finds other numbers in the memory.
        system = self._system(t)
        qdd = self._solve(system.jacobian, system.gamma, t).reshape(-1, 7)
        return np.stack([self.state.q, self.state.qd, qdd]), iterations

    def residuals(self, q: np.ndarray, qd: np.ndarray, t: float) -> tuple[float, float]:
        """The largest residuals of the equations and of their rates at a given motion."""
        self.state.q, self.state.qd = q, qd
        system = self._system(t)
        rates = product(system.jacobian, qd.ravel()) - system.nu
        return float(np.max(np.abs(system.residual))), float(np.max(np.abs(rates)))

    def _position(self, t: float) -> int:
        for iteration in range(1, self.limits["most_iterations"] + 1):
            system = self._system(t)
            change = self._solve(system.jacobian, system.residual, t)
            self.state.q = self.state.q - change.reshape(-1, 7)
            largest = float(np.max(np.abs(change)))
            if largest <= self.limits["tolerance"]:
                return iteration
        raise _failure(t, f"the position still changes by {largest:.2g} after {iteration} iterations")

    def _solve(self, matrix: np.ndarray, right: np.ndarray, t: float) -> np.ndarray:
        found = solved(matrix, right, self.limits["smallest_pivot"])
        if found is None:
            raise _failure(t, f"a pivot is not larger than EPSLU = {self.limits['smallest_pivot']:g}")
        return found

    def _system(self, t: float) -> Equations:
        n, state = self.state.q.size, self.state
        jacobian, residual, nu, gamma = np.zeros((n, n)), np.zeros(n), np.zeros(n), np.zeros(n)
        row = 0
        for number, joint in enumerate(self.mechanism.joints):
            rows = self._joint(number, joint)
            part = slice(row, row + len(rows.residual))
            jacobian[part, 7 * joint.i : 7 * joint.i + 7] = rows.of_i
            jacobian[part, 7 * joint.j : 7 * joint.j + 7] = rows.of_j
            residual[part], gamma[part] = rows.residual, rows.gamma
            row = part.stop
        singles = held(self.mechanism, state.q) + driven(self.mechanism, state.q, state.qd, t)
        for single in singles + normalised(self._normalised, state.q, state.qd):
            jacobian[row, list(single.coefficients)] = list(single.coefficients.values())
            residual[row], nu[row], gamma[row] = single.residual, single.nu, single.gamma
            row += 1
        return Equations(jacobian, residual, nu, gamma)

    def _joint(self, number: int, joint: Joint) -> Rows:
        state = self.state
        if joint.kind == "spherical":
            return coincident(state, joint)
        if joint.kind == "universal":
            crossed = orthogonal(state, joint.i, joint.j, joint.s_i, joint.s_j)
            return stacked(coincident(state, joint), crossed)
        state.behind_j = float(state.vector(joint.i, joint.P_i)[0])
        pair = self._pair(number, joint)
        if joint.kind == "revolute":
            return stacked(coincident(state, joint), parallel(state, joint, False).chosen(pair))
        wrong = WRONG_INDEX in state.errors
        rows = [parallel(state, joint, wrong).chosen(pair), along(state, joint).chosen(pair)]
        if joint.kind == "translational":
            rows.append(orthogonal(state, joint.i, joint.j, joint.h_i, joint.h_j))
        elif joint.kind == "screw":
            if number not in self._zeros:
                self._zeros[number] = screw_zero(state, joint)
            rows.append(screw_row(state, joint, self._zeros[number]))
        return stacked(*rows)

    def _pair(self, number: int, joint: Joint) -> list[int]:
        """The two of three rows that the program chooses at its first evaluation, and keeps."""
        if number not in self._pairs:
            entries = np.abs(tilde(self.state.vector(joint.i, joint.s_i))) > ZERO_ENTRY
            self._pairs[number] = _two_rows(*(int(row.sum()) for row in entries))
        return self._pairs[number]


def _two_rows(first: int, second: int, third: int) -> list[int]:
    """The choice by the numbers of entries: three conditions, of which the last that holds counts."""
    pair = [0, 1 if second >= third else 2]
    if second >= third:
        pair = [1, 0 if first >= third else 2]
    if third >= first and third >= second:
        pair = [2, 1 if second >= first else 0]
    return pair


def _failure(t: float, reported: Any) -> AnalysisError:
    return AnalysisError(
        Fault("error", f"at t = {t:.6g} s the program of 1996 fails: {reported}", id="SOLVE-033"), t
    )
