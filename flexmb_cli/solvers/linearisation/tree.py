"""Linearised motion of a tree, with open or closed loops and elements, in its hinge and elastic coordinates.

The speeds are rates of the coordinates; those of a hinge with three rotations are about axes of its
parent.  Closed loops leave some coordinates independent: J u = 0 for the rates of the gaps.
"""

import math
from typing import Any

import numpy as np

from ...errors import AnalysisError, Fault
from ...kernels.tree.composite_mass import set_mass
from ...kernels.tree.kane import SOLVED
from ...kernels.tree.motion import derivative, parts
from ...model.arrays.tree_elements import REPEATED
from ...model.arrays.tree_frames import rotation_matrix
from ...model.joints import DEPENDENT
from ...model.tree import ROTATION, Tree
from ..tree.analysis import TreeAnalysis, hold_functions
from ..tree.assembly import assemble_tree
from ..tree.breakpoints import breakpoints
from ..tree.loop_assembly import displaced, gap_rates, jacobian_of_gaps, measured, prescribe
from .joint_coordinates import OWN, PARENT, PREFERENCE, dependent_columns
from .motion import LinearisedMotion, without_motions

CLOSED_SHARE, STAYS_OPEN = 1e-14, 1e-9  # gaps of the size of the tree: as good as closed, and refused
MOST_CORRECTIONS = 12


class TreeLinearised(LinearisedMotion):
    """Linearised motion about the state of a TreeAnalysis, or about `state`: its vector and time."""

    AXES = (PARENT, OWN)

    def __init__(
        self,
        analysis: TreeAnalysis,
        axes: str = PARENT,
        state: tuple[np.ndarray, float] | None = None,
        free: np.ndarray | None = None,
    ):
        self.analysis, self.arrays, self.axes = analysis, analysis.arrays, axes
        self.z, self.t = state or (analysis.state.copy(), float(analysis.clock["t"][0]))
        if state is None:
            hold_functions_at(analysis, self.t)
        self.signals = self.arrays.signals
        grid = analysis.tree.time
        self.scale, self.duration = _scales(analysis.tree), grid.end - grid.start
        repeated = float(np.max(self.arrays.closures["repeated"], initial=REPEATED))
        self.dependent = math.sqrt(repeated) if repeated > REPEATED else DEPENDENT
        prescribe(analysis, self.z, self.t)
        speeds, _, _ = parts(self.arrays, self.z)
        self.u = speeds.copy()
        jacobian = jacobian_of_gaps(analysis, self.z)
        self.free = self._independent(jacobian) if free is None else free
        self.L = self.functionals(self.z)
        self.Z, self.inverse = self._basis(jacobian, self.L)
        self.rate = self.rates(self.z, self.t)
        self.L_rate = self.rate_of_functionals(self.z)

    def _balls(self) -> list[Any]:
        return [frame for frame in self.arrays.frames[1:] if frame["ball"] >= 0]

    def functionals(self, state: np.ndarray) -> Any:
        """Return L (f, NS): three rotations of a hinge are along axes of the parent or of the body."""
        L, (_, _, attitudes) = np.eye(self.scale.size), parts(self.arrays, state)
        for frame in self._balls() if self.axes == OWN else ():
            own = slice(frame["first_rotation"], frame["first_rotation"] + 3)
            L[own, own] = rotation_matrix(attitudes[frame["ball"]]).T
        return L[self.free]

    def speeds_of(self, state: np.ndarray) -> np.ndarray:
        """Return the speeds (NS,) of a state."""
        return state[: self.scale.size]

    def along_motion(self, function: Any, state: np.ndarray) -> np.ndarray:
        """Return the rate of a function of the state; that of functionals along axes of parents is 0."""
        if self.axes == PARENT:
            return np.zeros_like(self.L)
        return super().along_motion(function, state)

    def _independent(self, jacobian: np.ndarray) -> np.ndarray:
        weights = np.where(self.arrays.elastic, PREFERENCE["mode"], PREFERENCE["displacement"])
        scaled = jacobian * self.scale * weights
        return np.flatnonzero(~dependent_columns(scaled, self._rank(jacobian)) & ~self.arrays.given)

    def _rank(self, jacobian: np.ndarray) -> int:
        values = np.linalg.svd(jacobian, compute_uv=False) if jacobian.size else np.zeros(0)
        return int(np.sum(values > self.dependent * np.max(values, initial=0.0)))

    def _basis(self, jacobian: np.ndarray, L: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Z (NS, f) with J Z = 0, L Z = 1, and the generalised inverse of J."""
        free = np.flatnonzero(~self.arrays.given)
        rank = self._rank(jacobian)
        if free.size - rank != len(L):
            raise AnalysisError(Fault("error", _singular(self.t), id="SOLVE-016"), self.t)
        motions = np.zeros((self.scale.size, len(L)))
        kernel = np.linalg.svd(jacobian[:, free])[2][rank:].T if rank else np.eye(free.size)
        motions[free] = kernel
        return motions @ np.linalg.inv(L @ motions), np.linalg.pinv(jacobian, self.dependent)

    def moved_on(self, state: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Return a state with the coordinates displaced by d."""
        return displaced(self.arrays, state, d)

    def rates(self, state: np.ndarray, t: float) -> np.ndarray:
        """Return u' (NS,) of a state; raises AnalysisError without inertia."""
        analysis, z, dz = self.analysis, state.copy(), np.zeros_like(state)
        fault = derivative(self.arrays, analysis.work, analysis.coordinates, t, z, dz)
        if fault != SOLVED:
            analysis.clock["fault"] = fault
            raise analysis.failure()
        return dz[: self.scale.size]

    def changed(self, d: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Return the state with the coordinates displaced by d and the speeds changed by w."""
        z = self.moved_on(self.z, d)
        z[: w.size] += w
        return z

    def companion(self, d: np.ndarray) -> np.ndarray:
        """Return the change w (NS,) of the speeds, L w = 0, that the displacement d causes."""
        if not self.arrays.closures.size:
            return np.zeros_like(d)
        gaps = self.variation(
            lambda d, w: gap_rates(self.analysis, self.moved_on(self.z, d), self.u + w), d, np.zeros_like(d)
        )
        return self.projected(-gaps)

    def turned(self, d: np.ndarray) -> np.ndarray:
        """Return k(d): - omega × the rotation of every hinge with three of them, in its parent's axes."""
        out = np.zeros_like(d)
        for frame in self._balls():
            own = slice(frame["first_rotation"], frame["first_rotation"] + 3)
            out[own] = -np.cross(self.u[own], d[own])
        return out

    def state_with(self, change: np.ndarray) -> np.ndarray:
        """Return the state where the states of signals are changed (s,)."""
        z, first = self.z.copy(), 2 * self.scale.size + 4 * self.arrays.balls
        z[first : first + change.size] += change
        return z

    def mass_times(self, x: np.ndarray) -> np.ndarray:
        """Return the mass matrix (NS, NS) times columns x (NS, k) of speeds, at the state."""
        analysis, mass = self.analysis, np.zeros((len(x), len(x)))
        set_mass(self.arrays, analysis.work, analysis.coordinates, self.z, mass)
        return (np.triu(mass) + np.triu(mass, 1).T) @ x

    def near(self, state: np.ndarray, t: float) -> "TreeLinearised":
        """Return the same coordinates near a state, where it closes the loops."""
        return TreeLinearised(self.analysis, self.axes, (self._closed(state, t), t), self.free)

    def _closed(self, z: np.ndarray, t: float) -> np.ndarray:
        """The state with loops closed and speeds that fit them, the independent coordinates kept."""
        prescribe(self.analysis, z, t)
        if not self.arrays.closures.size:
            return z
        size = np.max(self.scale)
        for _ in range(MOST_CORRECTIONS):
            gap, J = measured(self.analysis, z)["gap"].copy(), jacobian_of_gaps(self.analysis, z)
            # Overconstrained loops that close only nearly keep what no motion closes.
            gap = J @ (np.linalg.pinv(J, self.dependent) @ gap)
            if np.max(np.abs(gap)) <= CLOSED_SHARE * size:
                break
            z = self.moved_on(z, self._correction(z, gap))
        if not np.max(np.abs(gap)) <= STAYS_OPEN * size:
            raise AnalysisError(Fault("error", _singular(t), id="SOLVE-017"), t)
        z[: self.u.size] += self._correction(z, measured(self.analysis, z)["rate"].copy())
        return z

    def _correction(self, z: np.ndarray, gaps: np.ndarray) -> np.ndarray:
        L = self.functionals(z)
        Z, inverse = self._basis(jacobian_of_gaps(self.analysis, z), L)
        return without_motions(inverse @ -gaps, Z, L)

    def standing(self, y: np.ndarray) -> np.ndarray:
        """Return the state displaced by y (scaled), with the independent coordinates at rest."""
        z = self.moved_on(self.z, self.Z @ (self.units * y))
        z[: self.u.size] = 0.0
        return self._closed(z, self.t)

    def stand_at(self, y: np.ndarray) -> None:
        """Put the analysis to the position displaced by y (scaled), its independent coordinates at rest."""
        self.analysis.state[:] = self.standing(y)


def _singular(t: float) -> str:
    return f"at t = {t:.6g} s the loops are at a singular position, where the tree cannot be linearised"


def start_tree(analysis: TreeAnalysis, time: float) -> None:
    """Bring a TreeAnalysis from its start to `time`, s, by its own method of integration."""
    begin = analysis.tree.time.start
    if time <= begin:
        hold_functions_at(analysis, begin)
        assemble_tree(analysis)
        return
    for _ in analysis.rows():
        pass
    reached = float(analysis.clock["t"][0])
    if abs(reached - time) > 1e-9 * max(abs(time), 1.0):
        message = f"the integration ended at t = {reached:.6g} s instead of {time:.6g} s"
        raise AnalysisError(Fault("error", message, id="SOLVE-018"), reached)


def hold_functions_at(analysis: TreeAnalysis, t: float) -> None:
    """Hold functions of time behind t, at a breakpoint too, where they change next."""
    grid = analysis.tree.time
    after = breakpoints(analysis.tree, t, max(grid.end, t))
    hold_functions(analysis.arrays, after[0] if after else t + grid.step)


def _scales(tree: Tree) -> np.ndarray:
    """(NS,) 1 rad for rotations, the size of the largest body for lengths."""
    places = [hinge.point for hinge in tree.hinges] + [body.centre for body in tree.bodies]
    places += [place for body in tree.bodies if body.elastic for place in body.elastic.positions]
    size = float(max(np.linalg.norm(place) for place in places)) or 1.0
    return np.array([1.0 if c.motion == ROTATION else size for c in tree.coordinates])
