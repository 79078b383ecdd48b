"""The program YOUNG (1996) run anew: Newton's method, velocities and accelerations at every report time.

Liang Yong (1996), Appendix A, unit YOUNG_2: each position begins at the one before, and Newton's method ends
where no coordinate changes by more than FEPS.  Velocities and accelerations are solved with the Jacobian
of that position, errors included.

Equations of single coordinates: simplified, distance and ground constraints, drivers, normalisation.

Liang Yong (1996), sections 4.2.7 and 4.2.8 and Appendix A, unit YOUNG_4.  No error of these shows in a
listing.  The function of a driver is taken as C + B t + A t²/2, where the scan of the source reads A t/2.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault, ModelError
from ...model.attitudes import Attitudes, held_coordinate
from ...model.mechanism import Distance, Joint, Mechanism
from ..kinematics.joint_motion import JointMotion, WholeTurns
from ..kinematics.rows import Rows, rows_of
from . import equations
from .equations import MOST_BODIES, State, along, coincident, orthogonal, parallel, stacked
from .errors import ALL_ERRORS, EMULATED, WRONG_INDEX
from .screw import ScrewZero, screw_row, screw_zero
from .vectors import product, solved, tilde


@dataclass(frozen=True)
class Single:
    """One equation: coefficients by coordinate (7 body + k), residual, right-hand sides."""

    coefficients: dict[int, float]
    residual: float
    nu: float = 0.0
    gamma: float = 0.0


def held(mechanism: Mechanism, q: np.ndarray) -> list[Single]:
    """Simplified and distance constraints, then grounded bodies; q (bodies, 7)."""
    gaps = [_value(q, item.body, item.direction, item.value) for item in mechanism.simplified]
    gaps += [_difference(q, item) for item in mechanism.distances]
    for ground in mechanism.grounds:
        gaps += [_value(q, ground.body, k, value) for k, value in enumerate(ground.values, start=1)]
    return gaps


def _value(q: np.ndarray, body: int, direction: int, value: float) -> Single:
    coordinate, target = held_coordinate(direction, value)
    return Single({7 * body + coordinate: 1.0}, q[body, coordinate] - target)


def _difference(q: np.ndarray, item: Distance) -> Single:
    coordinate = item.direction - 1 if item.direction <= 3 else item.direction
    gap = q[item.i, coordinate] - q[item.j, coordinate] - item.value
    return Single({7 * item.i + coordinate: 1.0, 7 * item.j + coordinate: -1.0}, gap)


def driven(mechanism: Mechanism, q: np.ndarray, qd: np.ndarray, t: float) -> list[Single]:
    """One equation of a translation, two of a rotation, (4.59) to (4.64); q, qd (bodies, 7)."""
    rows = []
    for driver in mechanism.drivers:
        function = driver.C + (driver.B + 0.5 * driver.A * t) * t
        rate, second = driver.B + driver.A * t, driver.A
        first, k = 7 * driver.body, driver.direction
        if k <= 3:
            rows.append(Single({first + k - 1: 1.0}, q[driver.body, k - 1] - function, rate, second))
            continue
        e0, ek = q[driver.body, 3], q[driver.body, k]
        e0d, ekd = qd[driver.body, 3], qd[driver.body, k]
        turning = 0.5 * (rate * e0d + second * e0), -0.5 * (rate * ekd + second * ek)
        rows.append(Single({first + k: 1.0}, ek - math.sin(0.5 * function), 0.5 * rate * e0, turning[0]))
        rows.append(Single({first + 3: 1.0}, e0 - math.cos(0.5 * function), -0.5 * rate * ek, turning[1]))
    return rows


def normalised(bodies: list[int], q: np.ndarray, qd: np.ndarray) -> list[Single]:
    """|p|² = 1 of the `bodies`, numbers from 0; q, qd (bodies, 7)."""
    rows = []
    for body in bodies:
        p, pd = q[body, 3:], qd[body, 3:]
        coefficients = {7 * body + 3 + k: 2.0 * p[k] for k in range(4)}
        sizes = (float(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]) for v in (p, pd))
        size, rate = sizes
        rows.append(Single(coefficients, size - 1.0, 0.0, -2.0 * rate))
    return rows


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
        solution = solved(matrix, right, self.limits["smallest_pivot"])
        if solution is None:
            raise _failure(t, f"a pivot is not larger than EPSLU = {self.limits['smallest_pivot']:g}")
        return solution

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

    def _joint(self, number: int, joint: Joint) -> equations.Rows:
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


BLOCK = 64  # rows


class AsPrinted:
    """One run over the report times; `warnings` says that the numbers are not those of the mechanism.

    The audit of the rows is that of the equations without errors: it shows what the errors do.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        settings: dict[str, Any] | None = None,
        errors: frozenset[str] = ALL_ERRORS,
        block: int = BLOCK,
    ):
        if len(mechanism.bodies) > MOST_BODIES:
            reported = f"the program of 1996 holds {MOST_BODIES} bodies, the deck has {len(mechanism.bodies)}"
            raise ModelError([Fault("error", f"{reported}; run it without --as-printed", id="SOLVE-031")])
        self.mechanism, self.block, self.joints = mechanism, block, JointMotion(mechanism)
        self.program = Program(mechanism, errors, settings)
        self.reference = Program(mechanism, frozenset())
        # Screws count slide and turn from the estimates.
        self.reference.residuals(*self.program.state.motion, mechanism.time.time(0))
        self.warnings = [Fault("note", EMULATED, id="SOLVE-032")]

    def rows(self) -> Iterator[Rows]:
        """Yield the report rows in blocks; raises AnalysisError where the program fails."""
        return self.joints.continued(self._blocks(), WholeTurns(self.joints.turning))

    def _blocks(self) -> Iterator[Rows]:
        grid = self.mechanism.time
        for first in range(0, grid.rows, self.block):
            times = [grid.time(k) for k in range(first, min(first + self.block, grid.rows))]
            rows = [self._row(t) for t in times]
            states, audit = (np.array(part) for part in zip(*rows, strict=True))
            yield rows_of(self.mechanism, np.array(times), states, audit, self.joints.of)

    def _row(self, t: float) -> tuple[np.ndarray, tuple[float, float, int]]:
        """States (3, 7 n), and residuals of positions and speeds with Newton's iterations."""
        state, iterations = self.program.advance(t)
        gap, rate = self.reference.residuals(state[0], state[1], t)
        return state.reshape(3, -1), (gap, rate, iterations)
