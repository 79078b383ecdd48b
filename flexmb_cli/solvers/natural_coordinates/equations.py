"""A mechanism of a YOUNG deck in natural coordinates: origins and direction vectors, no Euler parameters.

After García de Jalón and Bayo: a body is its origin r and the columns d1 d2 d3 of its rotation matrix, twelve
coordinates.  Points and vectors are linear in them, and all equations are linear or products of two vectors:

    Φ = L X - f(t)   or   (L1 X) · (L2 X) - c.

The second formulation of `verify`: it shares no equation with the kernels.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...errors import Fault, ModelError
from ...model.mechanism import Driver, Mechanism

SIZE = 12
LINES = {"revolute", "universal", "spherical", "cylindrical", "translational"}
# The coordinates whose difference is 4 e0 e_k: components (column, row) of the rotation matrix.
ANTISYMMETRIC = {4: ((1, 2), (2, 1)), 5: ((2, 0), (0, 2)), 6: ((0, 1), (1, 0))}


@dataclass
class NaturalEquations:
    """Equations of n bodies: `linear` rows with functions of time, `products` of vectors.

    `driven`: for each driver the numbers of its linear rows.
    """

    bodies: int
    linear: list[Any] = field(default_factory=list)
    functions: list[Any] = field(default_factory=list)
    products: list[Any] = field(default_factory=list)
    driven: list[Any] = field(default_factory=list)

    def close(self) -> None:
        """Turn the rows into arrays, when all are there."""
        n = SIZE * self.bodies
        self.L = np.array(self.linear).reshape(-1, n)
        self.L1, self.L2 = (np.array([row[k] for row in self.products]).reshape(-1, 3, n) for k in (0, 1))
        self.c = np.array([row[2] for row in self.products])

    def residual(self, X: np.ndarray, t: float) -> np.ndarray:
        """Return Φ at coordinates X (12 n,) and time t."""
        f = np.array([function(t)[0] for function in self.functions])
        return np.append(self.L @ X - f, np.einsum("ri,ri->r", self.L1 @ X, self.L2 @ X) - self.c)

    def jacobian(self, X: np.ndarray) -> np.ndarray:
        """Return ∂Φ/∂X."""
        products = np.einsum("ri,rin->rn", self.L1 @ X, self.L2) + np.einsum(
            "ri,rin->rn", self.L2 @ X, self.L1
        )
        return np.vstack([self.L, products])

    def rates(self, t: float) -> np.ndarray:
        """Return what J V must be."""
        return np.append([function(t)[1] for function in self.functions], np.zeros(len(self.c)))

    def accelerations(self, V: np.ndarray, t: float) -> np.ndarray:
        """Return what J dV/dt must be."""
        products = -2.0 * np.einsum("ri,ri->r", self.L1 @ V, self.L2 @ V)
        return np.append([function(t)[2] for function in self.functions], products)

    def add_linear(self, form: np.ndarray, value: float | np.ndarray | tuple[float, float, float]) -> None:
        """Add rows `form` X = value, a number for each or a function t → (value, rate, acceleration)."""
        values = [value] if callable(value) else [_constant(v) for v in np.broadcast_to(value, len(form))]
        self.linear += list(form)
        self.functions += values

    def add_product(self, one: np.ndarray, other: np.ndarray, value: float = 0.0) -> None:
        """Add the row (one X) · (other X) = value."""
        self.products.append((one, other, value))


def _constant(value: float) -> Callable[..., Any]:
    return lambda t: (float(value), 0.0, 0.0)


def point(bodies: int, body: int, place: tuple[float, float, float]) -> np.ndarray:
    """Return the form (3, 12 n) of a point of a body."""
    return vector(bodies, body, place, 1.0)


def vector(
    bodies: int, body: int, components: np.ndarray | tuple[float, float, float], origin: float = 0.0
) -> np.ndarray:
    """Return the form (3, 12 n) of a vector in the axes of a body."""
    form = np.zeros((3, SIZE * bodies))
    form[:, SIZE * body : SIZE * body + SIZE] = np.kron([origin, *components], np.eye(3))
    return form


def natural_equations(mechanism: Mechanism) -> NaturalEquations:
    """Return the equations of a mechanism; raises ModelError for what they do not hold."""
    _refuse_foreign(mechanism)
    n = len(mechanism.bodies)
    equations = NaturalEquations(n)
    for body in range(n):
        for a in range(3):
            for b in range(a, 3):
                equations.add_product(
                    vector(n, body, np.eye(3)[a]), vector(n, body, np.eye(3)[b]), float(a == b)
                )
    for joint in mechanism.joints:
        _add_joint(equations, joint)
    turned = {driver.body for driver in mechanism.drivers if driver.direction > 3}
    for item in mechanism.simplified:
        if item.direction < 4 or item.body not in turned:
            _hold(equations, item.body, item.direction, item.value)
    for pair in mechanism.distances:
        form = point(n, pair.i, (0,) * 3) - point(n, pair.j, (0,) * 3)
        equations.add_linear(form[pair.direction - 1 : pair.direction], pair.value)
    for ground in mechanism.grounds:
        equations.add_linear(point(n, ground.body, (0,) * 3), ground.values[:3])
        e = np.sin(np.array(ground.values[3:]) / 2.0)
        _fix(equations, ground.body, rotation_of((np.sqrt(max(0.0, float(1.0 - e @ e))), *e)))
    for driver in mechanism.drivers:
        _drive(equations, driver)
    equations.close()
    return equations


def _refuse_foreign(mechanism: Any) -> None:
    faults = [
        Fault(
            "error",
            f"a {joint.kind} joint is not carried over to natural coordinates",
            joint.place,
            joint.name,
            id="SOLVE-019",
        )
        for joint in mechanism.joints
        if joint.kind not in LINES
    ]
    message = "an Euler parameter that is held is carried over to natural coordinates at 0 only"
    for item in (*mechanism.simplified, *mechanism.distances):
        if item.direction > 3 and (item.value or item in mechanism.distances):
            faults.append(Fault("error", message, item.place, item.name, id="SOLVE-020"))
    if faults:
        raise ModelError(faults)


def _add_joint(equations: Any, joint: Any) -> None:
    n = equations.bodies
    i, j = point(n, joint.i, joint.P_i), point(n, joint.j, joint.P_j)
    axis = vector(n, joint.j, _unit(joint.s_j)) if any(joint.s_j) else None
    if joint.kind in ("spherical", "universal", "revolute"):
        equations.add_linear(i - j, 0.0)
    if joint.kind == "universal":
        equations.add_product(vector(n, joint.i, _unit(joint.s_i)), axis)
    if joint.kind in ("revolute", "cylindrical", "translational"):
        across = [vector(n, joint.i, u) for u in _across(joint.s_i)]
        for u in across:
            equations.add_product(u, axis)
        for u in across if joint.kind != "revolute" else ():
            equations.add_product(u, j - i)
    if joint.kind == "translational":
        equations.add_product(vector(n, joint.i, _unit(joint.h_i)), vector(n, joint.j, _unit(joint.h_j)))


def _unit(v: np.ndarray | tuple[float, float, float]) -> np.ndarray:
    return np.array(v, float) / np.linalg.norm(v)


def _across(v: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors at right angles to v and to each other."""
    s = _unit(v)
    u = _unit(np.cross(s, np.eye(3)[int(np.argmin(np.abs(s)))]))
    return u, np.cross(s, u)


def _hold(equations: Any, body: int, direction: Any, value: Any) -> None:
    if direction < 4:
        equations.add_linear(point(equations.bodies, body, (0,) * 3)[direction - 1 : direction], value)
        return
    (a, i), (b, j) = ANTISYMMETRIC[direction]
    columns = [vector(equations.bodies, body, np.eye(3)[column]) for column in (a, b)]
    equations.add_linear((columns[0][i] - columns[1][j])[None], 0.0)


def _fix(equations: NaturalEquations, body: int, D: np.ndarray) -> Any:
    for a in range(3):
        equations.add_linear(vector(equations.bodies, body, np.eye(3)[a]), D[:, a])


def _drive(equations: Any, driver: Driver) -> None:
    first = len(equations.linear)
    if driver.direction < 4:
        row = point(equations.bodies, driver.body, (0,) * 3)[driver.direction - 1 : driver.direction]
        equations.add_linear(row, lambda t: driver_function(driver, t))
    else:
        for a in range(3):
            form = vector(equations.bodies, driver.body, np.eye(3)[a])
            for i in range(3):
                equations.add_linear(form[i : i + 1], _turning(driver, i, a))
    equations.driven.append(range(first, len(equations.linear)))


def driver_function(driver: Driver, t: float) -> tuple[float, float, float]:
    """Return coordinate, rate and acceleration of a driver."""
    return driver.C + driver.B * t + 0.5 * driver.A * t * t, driver.B + driver.A * t, driver.A


def _turning(driver: Driver, i: int, a: int) -> Any:
    """Return component (i, a) of the rotation matrix as a function of time, with two derivatives."""

    def function(t: float) -> tuple[Any, Any, Any]:
        angle, rate, acceleration = driver_function(driver, t)
        D, slope, bend = turned(driver.direction - 4, angle)
        return D[i, a], slope[i, a] * rate, slope[i, a] * acceleration + bend[i, a] * rate**2

    return function


def turned(axis: int, angle: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the rotation matrix (3, 3) about a global axis, and its two derivatives by the angle."""
    K = np.cross(np.eye(3)[axis], np.eye(3)).T
    s, c = np.sin(angle), np.cos(angle)
    return np.eye(3) + s * K + (1.0 - c) * K @ K, c * K + s * K @ K, -s * K + c * K @ K


def rotation_of(p: np.ndarray | tuple[float, float, float, float]) -> np.ndarray:
    """Return the rotation matrix (3, 3), body to global axes, of Euler parameters (4,)."""
    e0, e = p[0], np.array(p[1:])
    return (2 * e0 * e0 - 1) * np.eye(3) + 2 * np.outer(e, e) + 2 * e0 * np.cross(e, np.eye(3)).T
