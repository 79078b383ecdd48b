"""Small motions of a mechanism: static equilibrium, and eigenfrequencies and damping about a position.

The free speeds that elimination finds are the coordinates y of small motions.  With the constraints
met at every displaced position, their accelerations y'' = a(y, y') are differentiated by central
differences of fourth order, and y'' + C y' + K y = 0 gives the eigenvalues.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from ..errors import AnalysisError, Fault
from ..kernels.constrained_solve import accelerations
from ..kernels.constrained_system import NO_INERTIA, SOLVED
from ..kernels.constraint_projection import project_position, project_speeds
from ..kernels.speeds import move
from .constrained_motion import ConstrainedMotion
from .constrained_start import inertia_failure

STEP = 1e-3  # scaled displacement of the differences; their error is of its fourth power
STENCIL = ((-2.0, 1.0 / 12.0), (-1.0, -8.0 / 12.0), (1.0, 8.0 / 12.0), (2.0, -1.0 / 12.0))
SHORT_STENCIL = ((-1.0, -0.5), (1.0, 0.5))  # of second order, enough to find the way to an equilibrium
MOST_ITERATIONS = 60
LARGEST_MOVE = 0.2  # scaled length of one correction towards equilibrium
NO_STIFFNESS = 1e-10  # of the largest eigenvalue
SETTLED = 1e-9  # scaled correction that counts as none
# Share of the largest eigenvalue, and 1/s, below which one is that of a motion nothing holds: the differences
# leave 1e-12 or so of the largest stiffness, and eigenvalues are its roots.
AT_REST = 1e-5


@dataclass(frozen=True)
class Modes:
    """Small motions of a mechanism with f freedoms, slowest first.

    `eigenvalues` (2 f,): of the first-order system, 1/s.  `frequency` (k,): damped frequencies of the
    oscillating pairs, Hz; `damping` (k,): their damping ratios.  `shapes` (k, n): speeds of each mode, in the
    scale of the speeds, the largest part 1.  `growing`, `decaying`: exponents of the motions that grow or
    fade without oscillating, 1/s.  `unheld`: how many of the 2 f eigenvalues are zero but for round-off.
    """

    eigenvalues: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    growing: np.ndarray
    decaying: np.ndarray
    unheld: int


class SmallMotions(ABC):
    """Small motions y of f freedoms about a position, scaled; a formulation's subclass finds accelerations.

    `motions` (n, f): speeds per unit of each free speed; `scale` (n,): of the speeds.
    """

    motions: np.ndarray
    scale: np.ndarray
    t: float

    @property
    def freedoms(self) -> int:
        """f."""
        return self.motions.shape[1]

    @abstractmethod
    def free_accelerations(self, y, yd) -> np.ndarray:
        """Scaled accelerations (f,) of the free coordinates changed by y and yd."""

    @abstractmethod
    def stand_at(self, y) -> None:
        """Put the analysis to rest at the position changed by y."""

    def stiffness(self, stencil=STENCIL) -> np.ndarray:
        """∂a/∂y (f, f)."""
        return self._differences(stencil, lambda step: self.free_accelerations(step, 0.0 * step))

    def damping(self) -> np.ndarray:
        """∂a/∂y' (f, f)."""
        return self._differences(STENCIL, lambda step: self.free_accelerations(0.0 * step, step))

    @abstractmethod
    def turning(self) -> np.ndarray:
        """T (f, f) of y' = v + T y, v the changes of the free speeds, which may be about axes that turn."""

    def speed_shift(self) -> np.ndarray:
        """E (f, f): by how much the free speeds change, E y, when a displacement makes all speeds fit it."""
        return np.zeros((self.freedoms, self.freedoms))

    def first_order(self) -> np.ndarray:
        """Matrix (2 f, 2 f) of y and v: y' = v + T y, v' = K y + C (v - E y)."""
        C = self.damping()
        below = self.stiffness() - C @ self.speed_shift()
        return np.block([[self.turning(), np.eye(self.freedoms)], [below, C]])

    def _differences(self, stencil, accelerations):
        derivative = np.zeros((self.freedoms, self.freedoms))
        for k, direction in enumerate(np.eye(self.freedoms)):
            for place, weight in stencil:
                derivative[:, k] += weight / STEP * accelerations(place * STEP * direction)
        return derivative


class ConstrainedSmallMotions(SmallMotions):
    """Small motions about the position and speeds at which `analysis` has been started."""

    def __init__(self, analysis: ConstrainedMotion):
        self.analysis = analysis
        self.coordinates = analysis.arrays.coordinate_scale.size
        self.q = analysis.march.z[: self.coordinates].copy()
        self.u = analysis.march.z[self.coordinates : -1].copy()
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
        move(self.analysis.arrays.bodies, q, self.motions @ y)
        near = analysis.march.turns[2]
        self._refuse(project_position(analysis.system, analysis.work, q, self.t, near))
        self._refuse(project_speeds(analysis.system, analysis.work, q, u, self.t)[0])
        return q, u

    def free_accelerations(self, y, yd) -> np.ndarray:
        """Scaled accelerations (f,) of the free coordinates."""
        return (self._rates(*self.displaced(y, yd)) / self.scale)[self.free]

    def turning(self) -> np.ndarray:
        """T (f, f): small turns s in body axes have the rates s' = v - omega x s."""
        turned = np.zeros_like(self.motions)
        for body in range(self.analysis.arrays.bodies):
            own = slice(6 * body + 3, 6 * body + 6)
            turned[own] = -np.cross(self.u[own], self.motions[own].T).T
        return (turned / self.scale[:, None])[self.free]

    def speed_shift(self) -> np.ndarray:
        """E (f, f), zero at rest."""
        none = np.zeros(self.freedoms)
        if not self.u.any():
            return super().speed_shift()
        return self._differences(
            STENCIL, lambda step: ((self.displaced(step, none)[1] - self.u) / self.scale)[self.free]
        )

    def stand_at(self, y) -> None:
        """Put the analysis to rest at the position changed by y."""
        z = self.analysis.march.z
        z[: self.coordinates] = self.displaced(y, np.zeros(self.freedoms))[0]
        z[self.coordinates :] = 0.0


def modes(analysis: ConstrainedMotion) -> Modes:
    """Modes about the position and speeds at which `analysis` has been started.

    Raises AnalysisError at a singular position and where a motion has no inertia.
    """
    return modes_of(ConstrainedSmallMotions(analysis))


def modes_of(motions: SmallMotions) -> Modes:
    """Modes of the small motions, and what neither oscillates nor is held."""
    f = motions.freedoms
    values, vectors = np.linalg.eig(motions.first_order())
    order = np.lexsort((values.imag, np.round(np.abs(values), 9)))
    values, vectors = values[order], vectors[:, order]
    moving = np.abs(values) > AT_REST * np.max(np.abs(values), initial=1.0)
    swings = moving & (values.imag > 1e-7 * np.abs(values))
    straight = values.real[moving & (np.abs(values.imag) <= 1e-7 * np.abs(values))]
    shapes = (motions.motions @ vectors[:f, swings]).T / motions.scale
    sizes = np.max(np.abs(shapes), axis=1, keepdims=True, initial=0.0)
    return Modes(
        eigenvalues=values,
        frequency=values.imag[swings] / (2.0 * np.pi),
        damping=-values.real[swings] / np.abs(values[swings]),
        shapes=shapes / np.where(sizes > 0.0, sizes, 1.0),
        growing=straight[straight > 0.0],
        decaying=straight[straight < 0.0],
        unheld=int(np.sum(~moving)),
    )


def bring_to(analysis: ConstrainedMotion, time: float) -> None:
    """Start `analysis` and let it move to `time`, s.  Raises as its `rows` do."""
    grid = analysis.grid
    if time <= grid.start:
        analysis.start()
        return
    analysis.grid = replace(grid, end=time, step=time - grid.start)
    for _ in analysis.rows():
        pass


def settle(analysis, small_motions=ConstrainedSmallMotions) -> None:
    """Bring a started `analysis` to rest in an equilibrium: the one it stands in, else one it can fall into.

    Newton's method, with steps reversed along motions that would grow, which lead to unstable positions.
    `small_motions`: the class of its formulation.  Raises AnalysisError when none is found.
    """
    start = small_motions(analysis)
    start.stand_at(np.zeros(start.freedoms))
    for _ in range(MOST_ITERATIONS):
        motions = small_motions(analysis)
        none = np.zeros(motions.freedoms)
        step = _downhill(motions.stiffness(SHORT_STENCIL), motions.free_accelerations(none, none))
        size = np.max(np.abs(step), initial=0.0)
        motions.stand_at(step * min(1.0, LARGEST_MOVE / size) if size > 0.0 else step)
        if size <= SETTLED:
            return
    message = (
        f"no static equilibrium was found in {MOST_ITERATIONS} iterations; begin nearer to it, or see "
        "whether drivers or forces keep the mechanism moving"
    )
    raise AnalysisError(Fault("error", message), motions.t)


def _downhill(stiffness, accelerations):
    """Newton's step, turned round along eigenvectors whose motions grow."""
    if not accelerations.size:
        return accelerations
    values, vectors = np.linalg.eig(stiffness)
    least = NO_STIFFNESS * np.max(np.abs(values), initial=1.0)
    parts = np.linalg.lstsq(vectors, accelerations.astype(complex), rcond=NO_STIFFNESS)[0]
    divisors = np.where(values.real < 0.0, -values, values)
    held = np.abs(values) > least
    # A motion without stiffness nor force stays; one with a force goes as far as one correction may.
    loose = np.where(np.abs(parts) > SETTLED * least, LARGEST_MOVE, 0.0) * np.sign(parts.real)
    return (vectors @ np.where(held, parts / np.where(held, divisors, 1.0), loose)).real
