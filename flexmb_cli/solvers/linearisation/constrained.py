"""Eigenfrequencies and damping of the linearised motion of a mechanism, and its absolute formulation."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.constrained.accelerations import accelerations, evaluate_jacobian
from ...kernels.constrained.angle_unwrapping import EXPECTED
from ...kernels.constrained.mass_matrix import mass_matrices, mass_times
from ...kernels.constrained.projection import project_position, project_speeds, rate_gap
from ...kernels.constrained.speeds import move
from ...kernels.constrained.system import GAMMA, NO_INERTIA, SOLVED, System
from ..constrained.analysis import LinearisableMotion
from ..constrained.start import inertia_failure
from ..constrained.system import dense_jacobian
from .joint_coordinates import AXES, OWN, JointCoordinates
from .motion import LinearisedMotion, without_motions

if TYPE_CHECKING:
    from ..constrained.young_dynamics import ForwardDynamics


# Share of the largest eigenvalue, and 1/s, below which one is that of a motion nothing holds: the differences
# leave 1e-12 or so of the largest stiffness, and eigenvalues are its roots.
AT_REST = 1e-5


@dataclass(frozen=True)
class Modes:
    """Modes of a mechanism with f degrees of freedom, slowest first.

    `eigenvalues` (2 f,): of the first-order system, 1/s.  `frequency` (k,): damped frequencies of the
    oscillating pairs, Hz; `damping` (k,): their damping ratios.  `shapes` (k, n): displacements of each mode,
    in the scale of the speeds, the largest part 1.  `growing`, `decaying`: exponents of the motions that grow
    or fade without oscillating, 1/s.  `unheld`: how many of the 2 f eigenvalues are zero but for round-off.
    `constant`: whether the coefficients stay the same along the motion.  States of signals have eigenvalues,
    too; `degrees_of_freedom` is f.
    """

    eigenvalues: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    growing: np.ndarray
    decaying: np.ndarray
    unheld: int
    degrees_of_freedom: int
    constant: bool = True


class ConstrainedLinearised(LinearisedMotion):
    """Linearised motion about the position and speeds at which `analysis` has been started.

    `state`: position, speeds and time in their place; `free`: the independent coordinates, where they are
    chosen already.
    """

    AXES = AXES

    def __init__(
        self, analysis: LinearisableMotion, axes: str = OWN, state: Any = None, free: np.ndarray | None = None
    ):
        self.analysis, self.axes = analysis, axes
        self.system = analysis.system
        arrays, z = analysis.arrays, analysis.integration.z
        self.count = arrays.coordinate_scale.size
        speeds = z[self.count : self.count + arrays.speeds]
        here = z[: self.count].copy(), speeds.copy(), float(analysis.clock["t"][0])
        self.q, self.u, self.t = state or here
        self.signals = self.system.signals
        end = self.count + arrays.speeds
        self.states = z[end : end + self.signals.states.size].copy()
        at = self.state_with(0.0 * self.states)
        self.scale, self.duration = arrays.speed_scale, analysis.grid.end - analysis.grid.start
        self.coordinates = JointCoordinates(arrays, axes)
        self.rate = self.rates(at, self.t)
        L, work = self.coordinates.functionals(self.q), analysis.work
        jacobian = dense_jacobian(work)
        chosen = self.coordinates.independent(L, jacobian, int(work.rank[0])) if free is None else free
        self.free, self.L = chosen, L[chosen]
        self.Z = self._motions(self.L)
        self.L_rate = self.rate_of_functionals(at)
        self.inverse = self.scale[:, None] * np.linalg.pinv(jacobian, analysis.dependent)

    def _motions(self, L: np.ndarray) -> np.ndarray:
        """Displacements (n, f) that the constraints factorised last allow, one for each coordinate."""
        Z = self.analysis.work.motions[:, : len(L)] * self.scale[:, None]
        return Z @ np.linalg.inv(L @ Z)

    def functionals(self, state: Any) -> np.ndarray:
        """Return L (f, n) at a position and speeds."""
        return self.coordinates.functionals(state[0])[self.free]

    def speeds_of(self, state: Any) -> np.ndarray:
        """Return the speeds (n,) of a position and speeds."""
        return state[1]

    def moved(self, q: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Return the position q displaced by d."""
        q = q.copy()
        move(self.analysis.arrays.bodies, q, d)
        return q

    def moved_on(self, state: Any, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return a position, displaced by d, and its speeds."""
        return self.moved(state[0], d), state[1]

    def changed(self, d: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the position displaced by d, and the speeds changed by w."""
        return self.moved(self.q, d), self.u + w

    def rates(self, state: Any, t: float) -> np.ndarray:
        """Return u' (n,) at a position and speeds that meet the constraints."""
        ud = np.zeros(self.scale.size)
        self.refuse(accelerations(self.system, self.analysis.work, *state, t, ud)[0])
        return ud

    def refuse(self, code: int) -> None:
        """Raise AnalysisError for a code of the kernels other than SOLVED."""
        if code == NO_INERTIA:
            raise inertia_failure(self.analysis, self.t)
        if code != SOLVED:
            message = (
                f"at t = {self.t:.6g} s the mechanism is at a singular position: it cannot be linearised"
            )
            raise AnalysisError(Fault("error", message, id="SOLVE-014"), self.t)

    def rate_gaps(self, d: np.ndarray, w: np.ndarray, system: System | None = None) -> np.ndarray:
        """Return what the speeds, changed by w, lack to meet the constraints displaced by d (m,), scaled."""
        work, system = self.analysis.work, system or self.system
        evaluate_jacobian(system, work, self.moved(self.q, d))
        rate_gap(system, work, self.u + w, self.t)
        return work.rows[GAMMA] / self.analysis.arrays.row_scale

    def companion(self, d: np.ndarray) -> np.ndarray:
        """Return the change w (n,) of the speeds, L w = 0, that the displacement d causes."""
        return self.projected(self.variation(self.rate_gaps, d, np.zeros_like(d)))

    def turned(self, d: np.ndarray) -> np.ndarray:
        """Return k(d): omega × the rotation of every body, in its axes."""
        out = np.zeros_like(d)
        bodies = 6 * self.analysis.arrays.bodies
        angles = d[:bodies].reshape(-1, 6)[:, 3:]
        out[:bodies].reshape(-1, 6)[:, 3:] = np.cross(self.u[:bodies].reshape(-1, 6)[:, 3:], angles)
        return out

    def state_with(self, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the state where the states of signals, which the kernels have at hand, are changed (s,)."""
        self.signals.states[:] = self.states + change
        return self.q, self.u

    def mass_times(self, x: np.ndarray) -> np.ndarray:
        """Return the mass matrix (n, n) times columns x (n, k) of speeds, at the state."""
        work, columns, product = self.analysis.work, [], np.zeros(len(x))
        evaluate_jacobian(self.system, work, self.q)
        mass_matrices(self.system, work, self.q)
        for column in x.T:
            mass_times(self.system, work, np.ascontiguousarray(column), product)
            columns.append(product.copy())
        return np.array(columns).reshape(-1, len(x)).T

    def near(self, state: Any, t: float) -> "ConstrainedLinearised":
        """Return the same coordinates near a position and speeds, where they meet the constraints."""
        analysis, (q, u) = self.analysis, state
        self.refuse(project_position(self.system, analysis.work, q, t, analysis.integration.angles[EXPECTED]))
        self.refuse(project_speeds(self.system, analysis.work, q, u, t)[0])
        return ConstrainedLinearised(analysis, self.axes, (q, u, t), self.free)

    def standing(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return position and speeds displaced by y (scaled), with the independent coordinates at rest."""
        analysis, q = self.analysis, self.moved(self.q, self.Z @ (self.units * y))
        self.refuse(
            project_position(self.system, analysis.work, q, self.t, analysis.integration.angles[EXPECTED])
        )
        u = np.zeros_like(self.u)
        self.refuse(project_speeds(self.system, analysis.work, q, u, self.t)[0])
        L = self.functionals((q, u))
        return q, without_motions(u, self._motions(L), L)

    def stand_at(self, y: np.ndarray) -> None:
        """Put the analysis to the position displaced by y (scaled), its independent coordinates at rest."""
        z = self.analysis.integration.z
        end = self.count + self.analysis.arrays.speeds
        z[: self.count], z[self.count : end] = self.standing(y)


def linearised(
    analysis: Any, formulation: Any = ConstrainedLinearised
) -> tuple[LinearisedMotion, np.ndarray, bool]:
    """Return the motion linearised about the state of `analysis`, A `with_states`, whether it is constant.

    Of the axes of `formulation` the first that make A constant are taken; where none do, the first.
    Raises AnalysisError at a singular position and where a motion has no inertia.
    """
    candidates: list[tuple[LinearisedMotion, np.ndarray, bool]] = []
    for axes in formulation.AXES:
        motion = formulation(analysis, axes)
        A = motion.first_order()
        if motion.is_constant(A):
            return motion, motion.with_states(A), True
        candidates.append((motion, motion.with_states(A), False))
    return candidates[0]


def modes(analysis: "ForwardDynamics", formulation: type = ConstrainedLinearised) -> Modes:
    """Return the modes about the state of `analysis`; raises as `linearised`."""
    return modes_of(*linearised(analysis, formulation))


def modes_of(motion: LinearisedMotion, A: np.ndarray, constant: bool) -> Modes:
    """Return the modes of A, as of `with_states`, and what neither oscillates nor is held."""
    f = motion.dofs
    values, vectors = np.linalg.eig(A)
    order = np.lexsort((values.imag, np.round(np.abs(values), 9)))
    values, vectors = values[order], vectors[:, order]
    moving = np.abs(values) > AT_REST * np.max(np.abs(values), initial=1.0)
    swings = moving & (values.imag > 1e-7 * np.abs(values))
    straight = values.real[moving & (np.abs(values.imag) <= 1e-7 * np.abs(values))]
    shapes = (motion.Z * motion.units @ vectors[:f, swings]).T / motion.scale
    sizes = np.max(np.abs(shapes), axis=1, keepdims=True, initial=0.0)
    return Modes(
        eigenvalues=values,
        frequency=values.imag[swings] / (2.0 * np.pi),
        damping=-values.real[swings] / np.abs(values[swings]),
        shapes=shapes / np.where(sizes > 0.0, sizes, 1.0),
        growing=straight[straight > 0.0],
        decaying=straight[straight < 0.0],
        unheld=int(np.sum(~moving)),
        degrees_of_freedom=f,
        constant=constant,
    )


def bring_to(analysis: LinearisableMotion, time: float) -> None:
    """Start `analysis` and let it move to `time`, s.  Raises as its `rows` do."""
    grid = analysis.grid
    if time <= grid.start:
        analysis.start()
        return
    analysis.grid = replace(grid, end=time, step=time - grid.start)
    for _ in analysis.rows():
        pass
