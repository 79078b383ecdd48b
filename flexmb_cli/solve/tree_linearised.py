"""Small motions of a tree: accelerations of its coordinates about a state, loops not being closed."""

import numpy as np

from ..errors import AnalysisError, Fault, ModelError
from ..kernels.kane_tree import SOLVED
from ..kernels.tree_motion import derivative, normalise_attitudes, parts, turn_attitudes
from ..model.tree import ROTATION
from .linearised import SmallMotions
from .tree_assembly import assemble_tree
from .tree_dynamics import TreeAnalysis, breakpoints, set_laws


class TreeSmallMotions(SmallMotions):
    """Small motions about the state of a TreeAnalysis.

    Raises ModelError for a tree with closed loops.
    """

    def __init__(self, analysis: TreeAnalysis):
        _refuse_loops(analysis.tree)
        self.analysis, self.arrays = analysis, analysis.arrays
        self.t = float(analysis.clock["t"][0])
        set_laws_at(analysis, self.t)
        self.z = analysis.state.copy()
        self.scale = _scales(analysis.tree)
        self.free = np.flatnonzero(~self.arrays.given)
        self.motions = (np.eye(len(self.scale)) * self.scale)[:, self.free]

    def displaced(self, y, yd) -> np.ndarray:
        """The state with the free coordinates changed by y and their speeds by yd, scaled."""
        z = self.z.copy()
        speeds, q, attitudes = parts(self.arrays, z)
        step = self.motions @ y
        q += step
        rates = np.zeros_like(attitudes)
        turn_attitudes(self.arrays, step, attitudes, rates)
        attitudes += rates
        normalise_attitudes(self.arrays, z)
        speeds += self.motions @ yd
        return z

    def free_accelerations(self, y, yd) -> np.ndarray:
        """Scaled accelerations (f,) of the free coordinates; raises AnalysisError without inertia."""
        z, analysis = self.displaced(y, yd), self.analysis
        dz = np.zeros_like(z)
        fault = derivative(self.arrays, analysis.work, analysis.coordinates, self.t, z, dz)
        if fault != SOLVED:
            analysis.clock["fault"] = fault
            raise analysis.failure()
        return (dz[: self.scale.size] / self.scale)[self.free]

    def turning(self) -> np.ndarray:
        """T (f, f): turns s of a hinge with three rotations, parent's axes, have s' = v + omega x s."""
        turned = np.zeros_like(self.motions)
        for frame in self.arrays.frames[1:]:
            if frame["ball"] >= 0:
                own = slice(frame["first_rotation"], frame["first_rotation"] + 3)
                turned[own] = np.cross(self.z[own], self.motions[own].T).T
        return (turned / self.scale[:, None])[self.free]

    def stand_at(self, y) -> None:
        """Put the analysis to rest at the position changed by y."""
        z = self.displaced(y, np.zeros(self.freedoms))
        z[: self.scale.size] = 0.0
        self.analysis.state[:] = z


def start_tree(analysis: TreeAnalysis, time: float) -> None:
    """Bring a TreeAnalysis from its start to `time`, s, by its own method of integration."""
    _refuse_loops(analysis.tree)
    begin = analysis.tree.time.start
    if time <= begin:
        set_laws_at(analysis, begin)
        assemble_tree(analysis)
        return
    for _ in analysis.rows():
        pass
    reached = float(analysis.clock["t"][0])
    if abs(reached - time) > 1e-9 * max(abs(time), 1.0):
        message = f"the integration ended at t = {reached:.6g} s instead of {time:.6g} s"
        raise AnalysisError(Fault("error", message), reached)


def set_laws_at(analysis: TreeAnalysis, t: float) -> None:
    """Write the pieces of all tables on which t lies, those behind it at a breakpoint, into the arrays."""
    grid = analysis.tree.time
    after = breakpoints(analysis.tree, t, max(grid.end, t))
    set_laws(analysis.tree, analysis.arrays, t, after[0] if after else t + grid.step)


def _scales(tree) -> np.ndarray:
    """(NS,) 1 rad for rotations, the size of the largest body for lengths."""
    places = [hinge.point for hinge in tree.hinges] + [body.centre for body in tree.bodies]
    places += [place for body in tree.bodies if body.elastic for place in body.elastic.positions]
    size = float(max(np.linalg.norm(place) for place in places)) or 1.0
    return np.array([1.0 if c.motion == ROTATION else size for c in tree.coordinates])


def _refuse_loops(tree):
    if tree.closures:
        closure = tree.closures[0]
        message = (
            "small motions of trees with closed loops are not known; cut the loop, or write a YOUNG deck"
        )
        raise ModelError([Fault("error", message, closure.place, closure.name)])
