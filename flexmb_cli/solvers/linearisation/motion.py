"""Linearised motion about a state of a mechanism, in joint coordinates that turn with the motion.

Displacements d (n,) and speeds u (n,) of all bodies satisfy du = d' + k(d), where k is the rotation of
the axes in which angular velocities are resolved.  The independent coordinates are y = L d, with
functionals L (f, n) of axes that turn with the motion, and v = L du.  With d = Z y for displacements
that the constraints allow, L Z = 1,

    y' = v + (L' - L k) Z y,    v' = L' du + L du'.

For a steady motion seen from its turning axes the coefficients are constant.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ...errors import AnalysisError

DIFFERENCE_STEP = 1e-3  # scaled displacement of the differences; their error is of its fourth power
STENCIL = ((-2.0, 1.0 / 12.0), (-1.0, -8.0 / 12.0), (1.0, 8.0 / 12.0), (2.0, -1.0 / 12.0))
# Part of the motion's own time scale over which the coefficients are compared, and the share of the
# largest one in a row that may change.
TIME_SHARE, CONSTANT = 3e-3, 1e-6
CANCELLED = 1e-10  # of the square of the largest speed
FAR = 0.3  # scaled displacement up to which an accelerating motion is followed
SAME_EIGENVALUE, SLOWEST_EIGENVALUE = (
    1e-5,
    1e-6,
)  # relative change of an eigenvalue, and share of the largest one


def differentiated(function: Callable[..., Any], h: float) -> Any:
    """Return the derivative of function(x) at x = 0 by differences of fourth order with the step h."""
    return sum(weight / h * function(place * h) for place, weight in STENCIL)


def sum_of_pairs(values: Callable[[float], np.ndarray]) -> np.ndarray:
    """Return the sum of weights and values at the places of STENCIL: 0 for values all alike."""
    pairs = [weight * (values(place) - values(-place)) for place, weight in STENCIL if place > 0.0]
    return np.sum(pairs, axis=0)


def without_motions(x: np.ndarray, Z: np.ndarray, L: np.ndarray) -> np.ndarray:
    """Return x (n,) less what the constraints allow of it: L times the result is 0."""
    return x - Z @ (L @ x)


class LinearisedMotion(ABC):
    """Linearised motion with f degrees of freedom; a formulation's subclass evaluates its equations.

    `L`, `L_rate` (f, n) and `Z` (n, f) as above; `scale` (n,): units of the speeds; `free` (f,): numbers of
    the independent coordinates among the n of `names`; `axes`: what they are resolved in.
    """

    L: np.ndarray
    L_rate: np.ndarray
    Z: np.ndarray
    scale: np.ndarray
    free: np.ndarray
    inverse: np.ndarray  # (n, m) generalised inverse of J, whose rows are of `gaps` as they are scaled
    axes: str
    t: float
    duration: float  # s, of the run; 0 of a single row
    signals: Any  # `model.arrays.signals.Signals`
    u: np.ndarray  # (n,) speeds
    rate: np.ndarray  # (n,) their rates

    @property
    def dofs(self) -> int:
        """Return f."""
        return self.free.size

    @property
    def units(self) -> np.ndarray:
        """Return the scales (f,) of the independent coordinates."""
        return self.scale[self.free]

    @abstractmethod
    def changed(self, d: np.ndarray, w: np.ndarray) -> Any:
        """Return the state where the position is displaced by d and the speeds are changed by w."""

    @abstractmethod
    def rates(self, state: Any, t: float) -> np.ndarray:
        """Return u' (n,) of a state that meets the constraints."""

    @abstractmethod
    def near(self, state: Any, t: float) -> "LinearisedMotion":
        """Return the same coordinates near a state, where it meets the constraints."""

    @abstractmethod
    def speeds_of(self, state: Any) -> np.ndarray:
        """Return the speeds (n,) of a state."""

    @abstractmethod
    def functionals(self, state: Any) -> np.ndarray:
        """Return L (f, n) at a state."""

    @abstractmethod
    def moved_on(self, state: Any, d: np.ndarray) -> Any:
        """Return a state displaced by d."""

    @abstractmethod
    def companion(self, d: np.ndarray) -> np.ndarray:
        """Return the change w (n,) of the speeds, L w = 0, that the displacement d causes."""

    @abstractmethod
    def turned(self, d: np.ndarray) -> np.ndarray:
        """Return k(d) (n,)."""

    @abstractmethod
    def standing(self, y: np.ndarray) -> Any:
        """Return the state displaced by y (scaled), with the independent coordinates at rest."""

    @abstractmethod
    def stand_at(self, y: np.ndarray) -> None:
        """Put the analysis to the position displaced by y (scaled), its independent coordinates at rest."""

    @abstractmethod
    def state_with(self, change: np.ndarray) -> Any:
        """Return the state where the states of signals are changed (s,)."""

    @abstractmethod
    def mass_times(self, x: np.ndarray) -> np.ndarray:
        """Return the mass matrix (n, n) times columns x (n, k) of speeds, at the state."""

    def acceleration_at(self, d: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return u' (n,) where the position is displaced by d and the speeds by w."""
        return self.rates(self.changed(d, w), self.t)

    def acceleration_after(self, h: float, rate: np.ndarray) -> np.ndarray:
        """Return u' (n,) after the short time h, s, of a motion with u' = rate now."""
        return self.rates(self.changed(h * self.u, h * rate), self.t + h)

    def later(self, h: float, rate: np.ndarray, jerk: np.ndarray) -> "LinearisedMotion":
        """Return the same coordinates after the time h, s, of a motion with u' = rate, u'' = jerk now."""
        d = h * (self.u + 0.5 * h * (rate + h / 3.0 * jerk))
        return self.near(self.changed(d, h * (rate + 0.5 * h * jerk)), self.t + h)

    def elsewhere(self, d: np.ndarray, w: np.ndarray) -> "LinearisedMotion":
        """Return the same coordinates where the position is displaced by d and the speeds by w."""
        return self.near(self.changed(d, w), self.t)

    def rate_of_functionals(self, state: Any) -> np.ndarray:
        """Return the rate (f, n) of L at a state that moves with its speeds."""
        return self.along_motion(self.functionals, state)

    def along_motion(self, function: Callable[[Any], np.ndarray], state: Any) -> np.ndarray:
        """Return the rate of a function of the state, which moves with its speeds."""
        u = self.speeds_of(state)
        size = np.max(np.abs(u) / self.scale, initial=0.0)
        if size == 0.0:
            return np.zeros_like(function(state))
        return differentiated(lambda time: function(self.moved_on(state, time * u)), DIFFERENCE_STEP / size)

    def standing_accelerations(self, y: np.ndarray) -> np.ndarray:
        """Return the scaled accelerations (f,) of the coordinates displaced by y (scaled) and at rest."""
        state = self.standing(y)
        rates = self.rate_of_functionals(state) @ self.speeds_of(state)
        return (rates + self.functionals(state) @ self.rates(state, self.t)) / self.units

    def projected(self, gaps: np.ndarray) -> np.ndarray:
        """Return x (n,) with J x = gaps, L x = 0."""
        return without_motions(self.inverse @ gaps, self.Z, self.L)

    def variation(self, function: Callable[..., Any], d: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return the derivative of function(d, w) along the displacement d and the speeds w."""
        size = np.max(np.abs(d) / self.scale, initial=0.0) or np.max(np.abs(w) / self.scale, initial=0.0)
        return differentiated(lambda share: function(share * d, share * w), DIFFERENCE_STEP / (size or 1.0))

    def position_rates(self, d: np.ndarray) -> np.ndarray:
        """Return what a displacement d adds to y' (f,) beside v."""
        return self.L_rate @ d - self.L @ self.turned(d)

    def speed_rates(self, w: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Return v' (f,) of changes w of the speeds and of their rates."""
        return self.L_rate @ w + self.L @ acceleration

    def tangents(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield displacement and change of speeds for every state, y then v, in their units."""
        still = np.zeros(self.scale.size)
        for k, unit in enumerate(self.units):
            d = unit * self.Z[:, k]
            yield d, self.companion(d)
        for k, unit in enumerate(self.units):
            yield still, unit * self.Z[:, k]

    def first_order(self) -> np.ndarray:
        """Return A (2 f, 2 f) of y and v in their units."""
        f = self.dofs
        A = np.zeros((2 * f, 2 * f))
        for k, (d, w) in enumerate(self.tangents()):
            A[:f, k] = (self.position_rates(d) + (self.L @ w if k >= f else 0.0)) / self.units
            A[f:, k] = self.speed_rates(w, self.variation(self.acceleration_at, d, w)) / self.units
        return A

    def with_states(self, A: np.ndarray) -> np.ndarray:
        """Return A (2 f + s, 2 f + s) with the s states of signals after y and v."""
        f, s = self.dofs, self.signals.states.size
        whole = np.zeros((2 * f + s, 2 * f + s))
        whole[: 2 * f, : 2 * f] = A

        def rates(d: np.ndarray, w: np.ndarray) -> np.ndarray:
            self.acceleration_at(d, w)
            return self.signals.rates.copy()

        for k, (d, w) in enumerate(self.tangents() if s else ()):
            whole[2 * f :, k] = self.variation(rates, d, w)
        for k, one in enumerate(np.eye(s)):
            response = differentiated(lambda x, one=one: self._response_to_states(x * one), DIFFERENCE_STEP)
            whole[f : 2 * f, 2 * f + k] = self.L @ response[:-s] / self.units
            whole[2 * f :, 2 * f + k] = response[-s:]
        return whole

    def _response_to_states(self, change: np.ndarray) -> np.ndarray:
        """Return u' and the rates of the states of signals that are changed (s,)."""
        acceleration = self.rates(self.state_with(change), self.t)
        self.state_with(np.zeros_like(change))
        return np.concatenate([acceleration, self.signals.rates])

    def is_constant(self, A: np.ndarray) -> bool:
        """Return whether the coefficients A stay the same along the motion.

        A steady motion is followed for a short while.  One that accelerates also shows by A at the position
        that its accelerations lead to, and at the speeds that they give where nothing opposes them.
        """
        pace, shift, left = self.path(A)[0], *self._destination(A)
        there: list[Callable[[], LinearisedMotion]] = [lambda: self.soon(A), lambda: self.soon(A, 2.0)]
        if (
            np.max(np.abs(shift), initial=0.0) > CONSTANT
            or np.max(np.abs(left), initial=0.0) > CONSTANT / pace**2
        ):
            there.append(lambda: self.elsewhere(*self._far_change(shift, left)))
        try:
            return all(self._agrees(A, place().first_order(), pace) for place in there)
        except AnalysisError:
            # A singular position is not far.
            return False

    def _far_change(self, shift: np.ndarray, left: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        shift = shift * min(1.0, FAR / max(np.max(np.abs(shift), initial=0.0), FAR))
        return self.Z @ (self.units * shift), self.Z @ (self.units * left) * self.duration

    def _agrees(self, A: np.ndarray, other: np.ndarray, pace: float) -> bool:
        """Return whether entries, row by row, and eigenvalues of two matrices are the same."""
        f, change = self.dofs, np.abs(other - A)
        for rows, columns, power in ((0, 0, 1), (1, 0, 2), (1, 1, 1)):
            block = slice(rows * f, (rows + 1) * f), slice(columns * f, (columns + 1) * f)
            size = np.max(np.abs(A[block]), axis=1, initial=pace**-power)
            if np.any(change[block] > CONSTANT * size[:, None]):
                return False
        sizes, others = (np.sort(np.abs(np.linalg.eigvals(matrix))) for matrix in (A, other))
        floor = np.max(sizes, initial=0.0) * SLOWEST_EIGENVALUE
        return bool(np.all(np.abs(others - sizes) <= SAME_EIGENVALUE * sizes + floor))

    def path(self, A: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Return the time, s, in which the motion changes by one unit, its u' and u'' (n,)."""
        rate = self._rate_without_residue(A)
        h = DIFFERENCE_STEP * self._pace(self.u, rate)
        jerk = differentiated(lambda time: self.acceleration_after(time, rate), h)
        return self._pace(self.u, rate, jerk), rate, jerk

    def soon(self, A: np.ndarray, share: float = 1.0) -> "LinearisedMotion":
        """Return the same coordinates a short while later, `share` of the first one."""
        pace, rate, jerk = self.path(A)
        return self.later(share * TIME_SHARE * pace, rate, jerk)

    def _pace(self, *derivatives: Any) -> float:
        """Time, s, in which one of the derivatives changes the position by one unit, at most the run."""
        rates = [
            np.max(np.abs(v) / self.scale, initial=0.0) ** (1.0 / k) for k, v in enumerate(derivatives, 1)
        ]
        return float(1.0 / max(*rates, 1.0 / (self.duration or 1.0)))

    def _destination(self, A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the displacements (f,) by the accelerations, and accelerations (f,) that nothing opposes."""
        f = self.dofs
        pushed = self.speed_rates(self.u, self.rate) / self.units
        # Accelerations of turning that cancel leave round-off.
        floor = CANCELLED * np.max(np.abs(self.u) / self.scale, initial=0.0) ** 2
        pushed = np.where(np.abs(pushed) > floor, pushed, 0.0)
        shift = np.linalg.lstsq(A[f:, :f], -pushed, rcond=1e-12)[0] if f else pushed
        left = pushed + A[f:, :f] @ shift
        largest = np.max(np.abs(pushed), initial=0.0)
        return shift, np.where(np.abs(left) > 1e-6 * largest, left, 0.0)

    def _rate_without_residue(self, A: np.ndarray) -> np.ndarray:
        """u' without the accelerations that an equilibrium found by iteration leaves in stiff coordinates."""
        shift, left = self._destination(A)
        if np.max(np.abs(shift), initial=0.0) > CONSTANT or np.any(left):
            return self.rate
        return self.rate - self.Z @ self.speed_rates(self.u, self.rate)

    def standing_stiffness(self, stencil: tuple[tuple[float, float], ...]) -> np.ndarray:
        """Return the derivative (f, f) of the accelerations of the coordinates held at rest."""
        derivative = np.zeros((self.dofs, self.dofs))
        for k, direction in enumerate(np.eye(self.dofs)):
            for place, weight in stencil:
                derivative[:, k] += (
                    weight
                    / DIFFERENCE_STEP
                    * self.standing_accelerations(place * DIFFERENCE_STEP * direction)
                )
        return derivative
