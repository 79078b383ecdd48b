"""Small motions of a mechanism: static equilibrium, and eigenfrequencies and damping about a position.

The free speeds that elimination finds are the coordinates y of small motions.  With the constraints
met at every displaced position, their accelerations y'' = a(y, y') are differentiated by central
differences of fourth order, and y'' + C y' + K y = 0 gives the eigenvalues.
"""

from dataclasses import dataclass

import numpy as np

from ..errors import AnalysisError, Fault
from ..kernels.constrained_solve import accelerations
from ..kernels.constrained_system import NO_INERTIA, SOLVED
from ..kernels.constraint_projection import project_position, project_speeds
from ..kernels.speeds import move
from .constrained_dynamics import ForwardDynamics
from .constrained_start import inertia_failure

STEP = 1e-3  # scaled displacement of the differences; their error is of its fourth power
STENCIL = ((-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0))
MOST_ITERATIONS = 60
LARGEST_MOVE = 0.2  # scaled length of one correction towards equilibrium
SETTLED = 1e-9  # scaled correction that counts as none


@dataclass(frozen=True)
class Modes:
    """Small motions of a mechanism with f freedoms, slowest first.

    `eigenvalues` (2 f,): of the first-order system, 1/s.  `frequency` (k,): damped frequencies of the
    oscillating pairs, Hz; `damping` (k,): their damping ratios.  `shapes` (k, 6 bodies): speeds of each
    mode, the largest scaled part 1.  `growing`: exponents of the motions that grow, 1/s.
    """

    eigenvalues: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    growing: np.ndarray


class SmallMotions:
    """Accelerations of the free speeds of `analysis` about the position and speeds it has been started at."""

    def __init__(self, analysis: ForwardDynamics):
        self.analysis = analysis
        bodies = len(analysis.mechanism.bodies)
        self.q = analysis.march.z[: 7 * bodies].copy()
        self.u = analysis.march.z[7 * bodies : 13 * bodies].copy()
        self.t = float(analysis.clock["t"][0])
        self.scale = analysis.arrays.speed_scale
        self._choose_freedoms()

    def _choose_freedoms(self):
        work = self.analysis.work
        self._rates(self.q, self.u)
        rank, m = int(work.rank[0]), work.jacobian.shape[0]
        self.free = work.order[m + rank :].copy()
        self.motions = work.motions[:, : self.free.size] * self.scale[:, None]

    def _rates(self, q, u):
        """u̇ at a position and speeds that meet the constraints."""
        analysis, ud = self.analysis, np.zeros_like(u)
        code, _ = accelerations(analysis.system, analysis.work, q, u, self.t, ud)
        self._refuse(code)
        return ud

    def _refuse(self, code):
        if code == NO_INERTIA:
            raise inertia_failure(self.analysis, self.t)
        if code != SOLVED:
            message = (
                f"at t = {self.t:.6g} s the mechanism is at a singular position, its small motions are open"
            )
            raise AnalysisError(Fault("error", message), self.t)

    def displaced(self, y, yd):
        """Position and speeds with the free coordinates changed by y and the free speeds by yd, scaled."""
        analysis, q, u = self.analysis, self.q.copy(), self.u + self.motions @ yd
        move(len(self.analysis.mechanism.bodies), q, self.motions @ y)
        near = analysis.march.turns[2]
        self._refuse(project_position(analysis.system, analysis.work, q, self.t, near))
        self._refuse(project_speeds(analysis.system, analysis.work, q, u, self.t)[0])
        return q, u

    def free_accelerations(self, y, yd) -> np.ndarray:
        """Scaled accelerations (f,) of the free coordinates."""
        return (self._rates(*self.displaced(y, yd)) / self.scale)[self.free]

    def derivatives(self) -> tuple[np.ndarray, np.ndarray]:
        """∂a/∂y and ∂a/∂y' (f, f)."""
        f = self.free.size
        of_position, of_speed = np.zeros((f, f)), np.zeros((f, f))
        for k, direction in enumerate(np.eye(f)):
            for place, weight in STENCIL:
                step, share = place * STEP * direction, weight / (12.0 * STEP)
                of_position[:, k] += share * self.free_accelerations(step, 0.0 * step)
                of_speed[:, k] += share * self.free_accelerations(0.0 * step, step)
        return of_position, of_speed


def modes(analysis: ForwardDynamics) -> Modes:
    """Modes about the position and speeds at which `analysis` has been started.

    Raises AnalysisError at a singular position and where a motion has no inertia.
    """
    motions = SmallMotions(analysis)
    of_position, of_speed = motions.derivatives()
    f = motions.free.size
    first_order = np.block([[np.zeros((f, f)), np.eye(f)], [of_position, of_speed]])
    values, vectors = np.linalg.eig(first_order)
    order = np.lexsort((values.imag, np.round(np.abs(values), 9)))
    values, vectors = values[order], vectors[:, order]
    swings = values.imag > 1e-7 * np.abs(values)
    shapes = (motions.motions @ vectors[:f, swings]).T
    sizes = np.max(np.abs(shapes / motions.scale), axis=1, keepdims=True, initial=0.0)
    return Modes(
        eigenvalues=values,
        frequency=values.imag[swings] / (2.0 * np.pi),
        damping=-values.real[swings] / np.abs(values[swings]),
        shapes=shapes / np.where(sizes > 0.0, sizes, 1.0),
        growing=values.real[values.real > 1e-7 * np.max(np.abs(values), initial=1.0)],
    )


def settle(analysis: ForwardDynamics) -> None:
    """Bring a started `analysis` to rest in the equilibrium that Newton's method finds from its position.

    Raises AnalysisError when none is found.
    """
    bodies = len(analysis.mechanism.bodies)
    analysis.march.z[7 * bodies : 13 * bodies] = 0.0
    for _ in range(MOST_ITERATIONS):
        motions = SmallMotions(analysis)
        f = motions.free.size
        of_position, _ = motions.derivatives()
        rest = motions.free_accelerations(np.zeros(f), np.zeros(f))
        step = np.linalg.lstsq(of_position, -rest, rcond=1e-10)[0]
        size = np.max(np.abs(step), initial=0.0)
        step *= min(1.0, LARGEST_MOVE / size) if size > 0.0 else 1.0
        analysis.march.z[: 7 * bodies] = motions.displaced(step, np.zeros(f))[0]
        if size <= SETTLED:
            return
    message = (
        f"no static equilibrium was found in {MOST_ITERATIONS} iterations; begin nearer to it, or see "
        "whether drivers or forces keep the mechanism moving"
    )
    raise AnalysisError(Fault("error", message), motions.t)
