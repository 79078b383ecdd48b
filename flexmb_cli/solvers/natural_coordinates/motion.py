"""Motion of a YOUNG deck's mechanism in natural coordinates, and the forces that drive it.

Kinematics: Newton steps on Φ(X, t), rates and accelerations by linear least squares.  Forward dynamics: a
mass matrix that is constant, M dV/dt = Q + Jᵀ λ, J dV/dt = γ, integrated by SciPy's DOP853 from row to row.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...model.arrays.dynamic import inertia_matrix
from ...model.joints import DEPENDENT
from ...model.loads import DynamicModel
from ...model.mechanism import Mechanism
from .equations import SIZE, natural_equations, point, rotation_of, vector

EQUATIONS_MET = 1e-13
MOST_STEPS = 50
LARGEST_ROW_TURN = 0.05  # rad: what a direction turns from one position of kinematics to the next


@dataclass(frozen=True)
class NaturalRows:
    """T rows: coordinates and two derivatives (T, 12 n), efforts of the drivers (T, drivers)."""

    time: np.ndarray
    X: np.ndarray
    V: np.ndarray
    A: np.ndarray
    effort: np.ndarray


class NaturalMotion:
    """A mechanism in natural coordinates, with the masses and loads of a dynamic model if there is one."""

    def __init__(self, mechanism: Mechanism, model: DynamicModel | None = None):
        self.mechanism, self.model = mechanism, model
        self.equations = natural_equations(mechanism)
        self.M = mass_matrix(model) if model else None

    def kinematic(self, first: np.ndarray) -> NaturalRows:
        """Return the rows of the motion that the drivers prescribe, from near the coordinates `first`."""
        grid = self.mechanism.time
        t, X = grid.start, self._closed(first, grid.start)
        rows = []
        for k in range(grid.rows):
            X = self._moved_to(X, t, grid.time(k))
            t = grid.time(k)
            V, A = self._rates(X, t)
            rows.append((t, X, V, A, self._efforts(X, V, A, t)))
        return _rows(rows)

    def forward(self, first: np.ndarray, speeds: np.ndarray) -> NaturalRows:
        """Return the rows of the motion under the loads, from coordinates and speeds near those given."""
        from scipy.integrate import solve_ivp

        grid = self.mechanism.time
        X, V, rows = first, speeds, []
        for k in range(grid.rows):
            t = grid.time(k)
            X, V = self._on_equations(X, V, t)
            free = self._independent(X)
            rows.append((t, X, V, self._acceleration(X, V, t, free), np.zeros(0)))
            if k + 1 == grid.rows:
                break

            def slope(time: float, state: np.ndarray, free: np.ndarray = free) -> np.ndarray:
                X, V = np.split(state, 2)
                return np.append(V, self._acceleration(X, V, time, free))

            solution = solve_ivp(
                slope, (t, grid.time(k + 1)), np.append(X, V), "DOP853", rtol=1e-10, atol=1e-12
            )
            if not solution.success:
                raise AnalysisError(
                    Fault("error", f"natural coordinates: {solution.message}", id="SOLVE-021"), t
                )
            X, V = np.split(solution.y[:, -1], 2)
        return _rows(rows)

    def _closed(self, X: np.ndarray, t: float) -> np.ndarray:
        """Return the nearest coordinates that meet all equations; raises AnalysisError."""
        for _ in range(MOST_STEPS):
            gap = self.equations.residual(X, t)
            if np.max(np.abs(gap)) <= EQUATIONS_MET:
                break
            step = _least(self.equations.jacobian(X), gap)
            X = X - step
            if np.max(np.abs(step)) <= 1e-15 * max(1.0, np.max(np.abs(X))):
                break
        if not np.max(np.abs(self.equations.residual(X, t))) <= 1e-9:
            message = f"at t = {t:.6g} s Newton's method in natural coordinates ends at a gap"
            raise AnalysisError(Fault("error", message, id="SOLVE-022"), t)
        return X

    def _moved_to(self, X: np.ndarray, t: float, end: float) -> Any:
        """Return the coordinates at `end`, from those at t by steps that turn no body far."""
        while t < end:
            V, A = self._rates(X, t)
            turning = np.max(np.abs(V.reshape(-1, SIZE)[:, 3:]))
            h = min(end - t, LARGEST_ROW_TURN / max(turning, 1e-300))
            t = end if end - t <= h * (1 + 1e-9) else t + h
            X = self._closed(X + h * V + 0.5 * h * h * A, t)
        return X

    def _rates(self, X: np.ndarray, t: float) -> tuple[Any, Any]:
        J = self.equations.jacobian(X)
        V = _least(J, self.equations.rates(t))
        return V, _least(J, self.equations.accelerations(V, t))

    def _on_equations(self, X: np.ndarray, V: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
        X = self._closed(X, t)
        J = self.equations.jacobian(X)
        return X, V + _least(J, self.equations.rates(t) - J @ V)

    def _independent(self, X: np.ndarray) -> np.ndarray:
        """Return the numbers of equations that do not repeat others at X."""
        from scipy.linalg import qr

        R, order = qr(self.equations.jacobian(X).T, mode="r", pivoting=True)
        size = np.abs(np.diag(R))
        return np.sort(order[: int(np.sum(size > DEPENDENT * size[0]))])

    def _acceleration(self, X: np.ndarray, V: np.ndarray, t: float, free: np.ndarray) -> np.ndarray:
        J = self.equations.jacobian(X)[free]
        gamma = self.equations.accelerations(V, t)[free]
        count = len(free)
        matrix = np.block([[self.M, J.T], [J, np.zeros((count, count))]])
        return np.linalg.solve(matrix, np.append(self.forces(X, V), gamma))[: X.size]

    def _efforts(self, X: np.ndarray, V: np.ndarray, A: np.ndarray, t: float) -> np.ndarray:
        """Return what each driver delivers: the work of M A - Q along the motion of that driver alone."""
        if self.M is None:
            return np.zeros(0)
        rest, J, efforts = self.M @ A - self.forces(X, V), self.equations.jacobian(X), []
        for driver, rows in zip(self.mechanism.drivers, self.equations.driven, strict=True):
            rates = np.zeros(len(J))
            rates[rows] = self.equations.rates(t)[rows]
            speed = driver.B + driver.A * t
            efforts.append(rest @ _least(J, rates) / speed if speed else np.nan)
        return np.array(efforts)

    def forces(self, X: np.ndarray, V: np.ndarray) -> np.ndarray:
        """Return the generalised forces of all loads."""
        model, n = self.model, len(self.mechanism.bodies)
        assert model is not None, "a mechanism without masses has no forces"
        Q = np.zeros(SIZE * n)
        for mass in model.masses:
            Q += mass.mass * np.array(model.gravity) @ point(n, mass.body, mass.centre)
        for force in model.forces:
            F = np.array(force.force, float)
            Q += (vector(n, force.body, F) @ X if force.following else F) @ point(n, force.body, force.point)
        for torque in model.torques:
            own = slice(SIZE * torque.body + 3, SIZE * torque.body + SIZE)
            T = np.array(torque.torque, float)
            T = vector(n, torque.body, T) @ X if torque.following else T
            # T · ω with ω = Σ d_a × (dd_a/dt) / 2.
            Q[own] += 0.5 * np.cross(T, X[own].reshape(3, 3)).ravel()
        for spring in model.springs:
            (i, j, P_i, P_j), (stiffness, rest, damping, *_) = spring.measure, spring.values
            form = point(n, j, P_j) - point(n, i, P_i)
            d, rate = form @ X, form @ V
            length = np.linalg.norm(d)
            if length > 0.0:
                pull = stiffness * (length - rest) + damping * (d @ rate) / length
                Q -= pull * d / length @ form
        return Q


def mass_matrix(model: DynamicModel) -> np.ndarray:
    """Return the constant mass matrix (12 n, 12 n): 2 T of a body is Σ E_ab (V_a · V_b)."""
    n = len(model.mechanism.bodies)
    M = np.zeros((SIZE * n, SIZE * n))
    for item in model.masses:
        c, m = np.array(item.centre, float), item.mass
        J = inertia_matrix(item.inertia) + m * (c @ c * np.eye(3) - np.outer(c, c))
        second = 0.5 * np.trace(J) * np.eye(3) - J
        own = slice(SIZE * item.body, SIZE * item.body + SIZE)
        M[own, own] = np.kron(
            np.block([[np.full((1, 1), m), m * c[None]], [m * c[:, None], second]]), np.eye(3)
        )
    return M


def coordinates_of(position: np.ndarray, euler_parameters: np.ndarray) -> np.ndarray:
    """Return X (12 n,) of origins (n, 3) and Euler parameters (n, 4)."""
    pairs = zip(position, euler_parameters, strict=True)
    return np.concatenate(
        [np.concatenate([r, rotation_of(p / np.linalg.norm(p)).T.ravel()]) for r, p in pairs]
    )


def speeds_of(X: np.ndarray, velocity: np.ndarray, angular_velocity: np.ndarray) -> np.ndarray:
    """Return V (12 n,) at X of the velocities of the origins and the angular velocities, global axes."""
    V = np.zeros((len(velocity), 4, 3))
    V[:, 0] = velocity
    V[:, 1:] = np.cross(angular_velocity[:, None], X.reshape(-1, 4, 3)[:, 1:])
    return V.ravel()


def _least(J: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(J, b, rcond=DEPENDENT)[0]


def _rows(rows: list[tuple[float, np.ndarray, np.ndarray, np.ndarray, np.ndarray]]) -> NaturalRows:
    return NaturalRows(*(np.array(column) for column in zip(*rows, strict=True)))
