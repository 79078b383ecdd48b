"""A tree moved as a constrained mechanism: every body has coordinates of its own, hinges are equations.

The other formulation of the same model: floating frames with nodal displacements as modal coordinates,
Euler parameters and Lagrange multipliers.  Nothing of the recursion along the tree is used.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...fe.lumped_body import floating_body, massless_body
from ...kernels.constrained.report import Report
from ...kernels.laws import COORDINATE
from ...kernels.tree.motion import parts
from ...model.arrays.constraint_table import PrimitiveTable
from ...model.arrays.element_table import ElementTable, JointCoordinateName
from ...model.arrays.flexible import flexible_arrays, length_scale
from ...model.arrays.system import SystemArrays
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.integrators import IMPLICIT_TREE_METHODS, Integrator
from ...model.joint_elements import JointElements
from ...model.laws import FRICTION
from ...model.tree import ROTATION, Tree
from ...model.tree_as_mechanism.frames import Frames, hinge_frames
from ...model.tree_as_mechanism.hinges import (
    HingeJoints,
    add_closures,
    add_hinges,
    add_prescribed,
    tree_loads,
)
from ...model.tree_as_mechanism.limits import refuse_foreign
from ...model.tree_as_mechanism.poses import elastic_start, first_poses, repeated_in_planar_tree
from ..checkpoint import taken
from ..projection import RESIDUAL_MET, largest
from ..tree.analysis import TreeAnalysis, hold_functions
from ..tree.assembly import assemble_tree
from ..tree.rows import TreeRows, unturned
from .analysis import ConstrainedMotion
from .element_rows import with_elements
from .position import PositionGaps
from .tree_rows import rows_of_bodies


class AbsoluteTree(ConstrainedMotion):
    """One run of a tree over its report times in absolute coordinates; the rows are those of a tree.

    Raises ModelError for what is not carried over, AnalysisError for loops that do not close.
    """

    omega_in_body_axes = True
    usual_words = "planar tree", "one a loop"

    def __init__(self, tree: Tree):
        refuse_foreign(tree)
        self.frames = hinge_frames(tree)
        self.tree = tree = closed_tree(tree)
        poses = first_poses(tree, self.frames)
        bodies = [floating_body(tree, k, poses[k]) for k in range(len(tree.bodies))]
        bodies += [
            massless_body(node_frame, pose)
            for node_frame, pose in zip(self.frames.node_frames, poses[len(bodies) :], strict=True)
        ]
        self._bodies = tuple(bodies)
        arrays = absolute_arrays(tree, self.frames, self._bodies)
        stiff = tree.elements and tree.integration.method in IMPLICIT_TREE_METHODS
        integrator = Integrator("RAD5" if stiff else "RK45", tolerance=tree.integration.rtol)
        super().__init__(arrays, tree.time, integrator, tree.elements)
        self.clock["atol"] = tree.integration.atol
        self._speeds = np.concatenate([np.concatenate([body.velocity, body.omega]) for body in bodies])
        self._elastic = [elastic_start(tree, k) for k in range(len(tree.bodies))]
        behind = len(tree.elements.of(FRICTION))
        self._probes = len(arrays.loads) - behind - len(turning_coordinates(tree)), len(arrays.loads) - behind
        self._attitude = unturned(len(tree.bodies))

    @property
    def checkpoint(self) -> dict[str, np.ndarray]:
        """Return where to go on, with attitudes of the last row, which the next ones continue."""
        return {**super().checkpoint, "attitude": self._attitude}

    def restore(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Go on behind the rows that were yielded up to a checkpoint."""
        super().restore(checkpoint)
        self._attitude = taken(checkpoint, "attitude", self._attitude.shape)

    def assembled(self, t: float) -> np.ndarray:
        """Coordinates at the start: those of the tree, which meet the equations of its hinges.

        Loops that close only nearly are closed by all bodies, as the tolerance allows.
        """
        rigid = 7 * self.arrays.bodies
        q = np.concatenate([self.arrays.q[:rigid], *(eta for eta, _ in self._elastic)])
        gaps = PositionGaps(self.arrays, self.system, self.work)
        if largest(gaps.residual(q, t, self.arrays.angles)) <= RESIDUAL_MET:
            return q
        return self.first_position(t, self.tree.loop_tolerance, q)[1]

    def given_speeds(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All speeds are given, by the tree's."""
        wanted = np.concatenate([self._speeds, *(rate for _, rate in self._elastic)])
        return np.ones(wanted.size, bool), wanted

    def usual_repetitions(self, q: np.ndarray) -> int | None:
        """Closed directions across the plane of a planar tree; None of any other."""
        return repeated_in_planar_tree(self.tree)

    def block(self, report: Report) -> TreeRows:
        """The rows of a report in the terms of the tree."""
        angles = report.responses[:, slice(*self._probes), COORDINATE]
        rows = rows_of_bodies(self.tree, self.frames, self.arrays, report, angles, self._attitude)
        self._attitude = rows.euler_parameters[-1].copy()
        if not self.tree.elements:
            return rows
        return with_elements(self.tree, self.arrays, rows, report, len(turning_coordinates(self.tree)))


def closed_tree(tree: Tree) -> Tree:
    """The tree with initial coordinates and speeds that its closures allow, as Kane's equations find them.

    Gaps of loops that nearly close are left.
    """
    if not tree.closures:
        return tree
    drivers = JointElements(drivers=tree.elements.drivers)
    analysis = TreeAnalysis(replace(tree, elements=drivers))
    hold_functions(analysis.arrays, tree.time.end)
    assemble_tree(analysis)
    y, q, attitudes = (part.copy() for part in parts(analysis.arrays, analysis.state))
    turned = iter(attitudes.tolist())
    hinges = [replace(h, attitude=tuple(next(turned))) if len(h.rotations) == 3 else h for h in tree.hinges]
    return replace(tree, q=q, y=y, hinges=tuple(hinges))


def turning_coordinates(tree: Tree) -> list[JointCoordinateName]:
    """Return the rotations that are angles, whose turns the steps of the integration count."""
    return [
        JointCoordinateName(c.body, f"{c.motion} {c.axis}")
        for c in tree.coordinates
        if c.motion == ROTATION and len(tree.hinges[c.body].rotations) < 3
    ]


def absolute_arrays(tree: Tree, frames: Frames, bodies: tuple[Any, ...]) -> SystemArrays:
    """The equations of a tree between bodies with coordinates of their own."""
    free = FlexibleMechanism(bodies, tree.time, Integrator(), tree.gravity)
    table = PrimitiveTable(bodies, length_scale(free))
    add_hinges(table, tree, frames)
    add_prescribed(table, tree, frames)
    elements = ElementTable(table, HingeJoints(table, tree, frames), tree.elements, turning_coordinates(tree))
    elements.add_couplings()
    elements.add_drivers(tree.time.start)
    add_closures(table, tree)
    loads = elements.loads(tree_loads(table, tree))
    return replace(flexible_arrays(free), loads=loads, **table.arrays())
