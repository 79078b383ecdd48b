"""A tree moved as a constrained mechanism: every body has coordinates of its own, hinges are equations.

The other formulation of the same model: floating frames with nodal displacements as modal coordinates,
Euler parameters and Lagrange multipliers.  Nothing of the recursion along the tree is used.
"""

from typing import Any

import numpy as np

from ...fe.lumped_body import floating_body, massless_body
from ...kernels.constrained.report import Report
from ...model.arrays.constraint_table import PrimitiveTable
from ...model.arrays.element_table import ElementTable
from ...model.arrays.flexible import flexible_arrays, length_scale
from ...model.arrays.records import LOAD
from ...model.arrays.system import SystemArrays
from ...model.fe_model import Integrator
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.tree import Tree
from ...model.tree_as_mechanism.elements import HingeJoints
from ...model.tree_as_mechanism.frames import Frames, hinge_frames
from ...model.tree_as_mechanism.hinges import add_closures, add_hinges, add_prescribed
from ...model.tree_as_mechanism.limits import refuse_foreign
from ...model.tree_as_mechanism.loads import tree_loads
from ...model.tree_as_mechanism.loop_assembly import closed_tree
from ...model.tree_as_mechanism.poses import elastic_start, first_poses
from ...quick_dataclass import replace
from ..tree.rows import TreeRows
from .analysis import ConstrainedMotion
from .integrators import RadauSteps
from .tree_element_rows import with_elements
from .tree_rows import absolute_rows

IMPLICIT = ("radau", "sdirk4")


class AbsoluteTree(ConstrainedMotion):
    """One run of a tree over its report times in absolute coordinates; the rows are those of a tree.

    Raises ModelError for what is not carried over, AnalysisError for loops that do not close.
    """

    turns_in_body_axes = True

    def __init__(self, tree: Tree):
        refuse_foreign(tree)
        self.frames = hinge_frames(tree)
        self.tree = tree = closed_tree(tree, self.frames)
        poses = first_poses(tree, self.frames)
        bodies = [floating_body(tree, k, poses[k]) for k in range(len(tree.bodies))]
        bodies += [
            massless_body(node_frame, pose)
            for node_frame, pose in zip(self.frames.node_frames, poses[len(bodies) :], strict=True)
        ]
        arrays = absolute_arrays(tree, self.frames, tuple(bodies))
        stiff = tree.elements and tree.integration.method in IMPLICIT
        super().__init__(arrays, tree.time, tree.integration.rtol, RadauSteps() if stiff else None)
        self.clock["atol"] = tree.integration.atol
        self._speeds = np.concatenate([np.concatenate([body.velocity, body.omega]) for body in bodies])
        self._elastic = [elastic_start(tree, k) for k in range(len(tree.bodies))]
        self._last = None

    def assembled(self, t: float) -> np.ndarray:
        """Coordinates at the start: those of the tree, which meet the equations of its hinges."""
        rigid = 7 * self.arrays.bodies
        return np.concatenate([self.arrays.q[:rigid], *(eta for eta, _ in self._elastic)])

    def given_speeds(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All speeds are given, by the tree's."""
        wanted = np.concatenate([self._speeds, *(rate for _, rate in self._elastic)])
        return np.ones(wanted.size, bool), wanted

    def block(self, report: Report) -> TreeRows:
        """The rows of a report in the terms of the tree."""
        rows = absolute_rows(self.tree, self.frames, self.arrays, report, self._last)
        self._last = rows  # type: ignore[assignment]
        return with_elements(self.tree, rows, report) if self.tree.elements else rows


def absolute_arrays(tree: Tree, frames: Frames, bodies: tuple[Any, ...]) -> SystemArrays:
    """The equations of a tree between bodies with coordinates of their own."""
    integrator = Integrator("RK45", 0.0, tree.integration.rtol)
    free = FlexibleMechanism(bodies, tree.time, integrator, tree.gravity)
    table = PrimitiveTable(bodies, length_scale(free))
    add_hinges(table, tree, frames)
    add_prescribed(table, tree, frames)
    elements = ElementTable(table, HingeJoints(table, tree, frames), tree.elements, ())
    elements.add_couplings()
    elements.add_drivers(tree.time.start)
    add_closures(table, tree)
    loads = np.array([*tree_loads(table, tree, frames), *elements.loads()], dtype=LOAD).reshape(-1)
    return replace(flexible_arrays(free), loads=loads, **table.arrays())
