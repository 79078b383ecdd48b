"""Blocks ELEMENTS of FMBD.DAT: elements at hinges, between points and between nodes."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...deck.record import Number
from ...model.diagnostics import Findings
from ...model.flexible_mechanism import NodePoint
from ...model.joint_elements import Coupling, JointDriver, JointElements, JointStart
from ...model.time_functions import MotionFunction
from ...model.tree import INERTIAL, ROTATION, TRANSLATION, Closure, Hinge, Tree
from ...model.tree_as_mechanism.frames import hinge_frames, shape_of
from ...model.tree_as_mechanism.poses import first_poses
from ..elements_block.build import BlockBuilder
from ..elements_block.functions import Functions
from ..elements_block.line import ElementLine
from ..elements_block.measures import Measures

COUPLED_RATE = 1e-6  # rate that speeds of Y(L), in ten columns, may leave of a coupling, of the largest


def with_elements(tree: Tree, lines: Sequence[Any], folder: Path, findings: Findings) -> Tree:
    """The tree with the elements of the blocks, its driven coordinates as their functions begin.

    Files of functions are relative to `folder`; faults go into `findings`.
    """
    functions = Functions(lines, folder, findings)
    elements = BlockBuilder(_Measures(tree, findings), functions, tree.time.start).elements(lines, {})
    functions.note_unused()
    _refuse_prescribed(tree, elements, findings)
    forces = (*tree.elements.forces, *elements.forces)
    started = replace(tree, **_start(tree, elements))
    closures = (
        *tree.closures,
        *_rolling(elements),
        *_held_ends(started, elements),
        *_closures(tree, elements, findings),
    )  # fmt: skip
    tree = replace(started, elements=replace(elements, forces=forces, starts=()), closures=closures)
    for item in elements.couplings:
        if not item.function:
            _check_speeds(tree, item, findings)
    return tree


def _held_ends(tree: Tree, elements: JointElements) -> Iterator[Closure]:
    """Yield the closures of general joints, whose axes coincide at the start of the tree."""
    if not elements.generals:
        return
    poses = first_poses(tree, hinge_frames(tree))
    for joint in elements.generals:
        of_i, of_j = (np.eye(3) if body == INERTIAL else poses[body].A for body in (joint.i, joint.j))
        yield Closure(
            joint.name,
            joint.j,
            joint.i,
            tuple(range(1, joint.rows + 1)),
            _node_of(tree, joint.P_j),
            _node_of(tree, joint.P_i),
            a_point=tuple(joint.P_j.r0),
            b_point=tuple(joint.P_i.r0),
            place=joint.place,
            general=joint,
            turned=of_j.T @ of_i,
        )


def _rolling(elements: JointElements) -> Iterator[Closure]:
    """Yield the closures of what rolls."""
    for roll in elements.rolls:
        yield Closure(
            roll.name,
            roll.j,
            roll.i,
            roll.directions,
            a_point=tuple(roll.P_j.r0),
            b_point=tuple(roll.P_i.r0),
            place=roll.place,
            roll=roll,
        )


def _closures(tree: Tree, elements: JointElements, findings: Findings) -> Iterator[Closure]:
    """Yield the closures of points on curves."""
    for curve in elements.curves:
        if _node_of(tree, curve.P_i) is not None:
            message = "nodes have no axes in which a curve could be given; fix it to a point, body(x,y,z)"
            findings.error(curve.name, message, curve.place, id="ELEMENTS-126")
            continue
        yield Closure(
            curve.name,
            curve.j,
            curve.i,
            (1, 2),
            _node_of(tree, curve.P_j),
            a_point=tuple(curve.P_j.r0),
            b_point=tuple(curve.P_i.r0),
            place=curve.place,
            curve=curve,
        )


def _node_of(tree: Tree, point: NodePoint) -> int | None:
    """Node of a flexible body at an end; None of a point."""
    if not point.shape.any():
        return None
    elastic = tree.bodies[point.body].elastic
    assert elastic is not None, "the body has nodes"
    return int(np.argmin(np.linalg.norm(elastic.positions - point.r0, axis=1)))


def _refuse_prescribed(tree: Tree, elements: JointElements, findings: Findings) -> None:
    """Refuse drivers and starts of coordinates that the card PRES drives, and starts of followers of cams."""
    driven = {(each.body, f"{each.motion} {each.axis}") for each in tree.prescribed}
    items: tuple[JointDriver | JointStart, ...] = (*elements.drivers, *elements.starts)
    for item in items:
        if (item.joint, item.coordinate) in driven:
            message = (
                f"PRES already drives {item.coordinate} of the hinge of body {item.joint + 1}; remove one"
            )
            findings.error(item.name, message, item.place, id="DAFMS-152")
    followers = {item.terms[0][:2]: item.name for item in elements.couplings if item.function}
    for start in elements.starts:
        if name := followers.get((start.joint, start.coordinate)):
            message = f"it follows the cam {name}, which says how it begins; give the start of the cam"
            findings.error(start.name, message, start.place, id="DAFMS-210")


class _Measures(Measures):
    """Hinges of the tree, numbered as their bodies, and ends at points and nodes of these."""

    def __init__(self, tree: Tree, findings: Findings):
        super().__init__(findings)
        self.bodies, self.hinges = tree.bodies, tree.hinges

    def named(self, line: ElementLine, number: Number, text: str) -> Any:
        """Body whose hinge is meant, and its coordinate."""
        count, _, name = text.partition(".")
        hinge = self._hinge(line, number, int(count))
        if hinge is None:
            return None
        if not re.fullmatch("[rt][1-3]", name):
            message = f"hinges have the coordinates r1 to r3 and t1 to t3; {_free(hinge, count)}"
            return self.error(line, number, message, id="DAFMS-195")
        motion, axis = ROTATION if name[0] == "r" else TRANSLATION, int(name[1])
        free = hinge.rotations if motion == ROTATION else hinge.translations
        if axis not in free:
            message = f"{motion} {axis} of this hinge is not free; {_free(hinge, count)}"
            return self.error(line, number, message, id="DAFMS-194")
        if motion == ROTATION and len(free) == 3:
            message = "the hinge has three free rotations: none of them is an angle"
            return self.error(line, number, message, id="DAFMS-079")
        return int(count) - 1, f"{motion} {axis}"

    def _hinge(self, line: ElementLine, number: Number, count: int) -> Any:
        if not 1 <= count <= len(self.hinges):
            message = f"there is no hinge of body {count}: there are bodies 1 to {len(self.hinges)}"
            return self.error(line, number, message, id="DAFMS-193")
        return self.hinges[count - 1]

    def sliding(self, line: ElementLine) -> Any:
        """Body whose hinge turns about, or slides along, one axis, and whether it turns."""
        number = line.at("joint")
        hinge = self._hinge(line, number, number.value)
        if hinge is None:
            return None
        free = hinge.rotations + hinge.translations
        if not free or len(set(free)) > 1:
            message = "friction needs a hinge that turns about, or slides along, one axis"
            return self.error(line, number, message, id="DAFMS-081")
        return number.value - 1, bool(hinge.rotations)

    def ends(self, line: ElementLine) -> tuple[int, int, Any, Any] | None:
        """Bodies (-1: inertial frame) and points or nodes."""
        bodies = [self.body(line, key, len(self.bodies)) for key in ("from", "to")]
        i, j = bodies
        if i is None or j is None or not self.two_bodies(line, i, j):
            return None
        P_i, P_j = self._end(line, "from", i, "end a"), self._end(line, "to", j, "end b")
        return None if P_i is None or P_j is None else (i, j, P_i, P_j)

    def is_rigid(self, line: ElementLine, body: int, key: str) -> bool:
        """Return whether an end keeps its place and attitude in a body: nodes do not."""
        return f"{key}.node" not in line

    def turns(self, line: ElementLine, body: int) -> bool:
        """Return whether the end `to` turns with its body: nodes have no attitude."""
        return self.is_rigid(line, body, "to")

    def _end(self, line: ElementLine, key: str, body: int, name: str) -> Any:
        elastic = self.bodies[body].elastic if body != INERTIAL else None
        if f"{key}.node" not in line:
            shape = shape_of(elastic, None) if elastic else np.zeros((3, 0))
            return NodePoint(name, body, np.array(line.vector(key)), shape)
        node, nodes = line.at(f"{key}.node"), len(elastic.masses) if elastic else 0
        if elastic is None or not 1 <= node.value <= nodes:
            what = f"body {body + 1}" if body != INERTIAL else "the inertial frame"
            message = f"{what} has {nodes or 'no'} nodes; read {node.value}; give the point, body(x,y,z)"
            return self.error(line, node, message, id="DAFMS-192")
        k = node.value - 1
        return NodePoint(name, body, elastic.positions[k], shape_of(elastic, k))


def _free(hinge: Hinge, count: str) -> str:
    """Return which coordinates a hinge has, in words."""
    free_axes = [
        *(f"{count}.r{axis}" for axis in hinge.rotations),
        *(f"{count}.t{a}" for a in hinge.translations),
    ]
    return f"free there: {', '.join(free_axes)}" if free_axes else "nothing is free there"


def _start(tree: Tree, elements: JointElements) -> Any:
    """Coordinates and speeds: driven ones begin as their functions do, others with the rates of START."""
    q, y = np.array(tree.q, float), np.array(tree.y, float)
    for start in elements.starts:
        m = _number(tree, start.joint, start.coordinate)
        q[m] = q[m] if start.value is None else start.value
        y[m] = y[m] if start.rate is None else start.rate
    for item in elements.drivers:
        m = _number(tree, item.joint, item.coordinate)
        q[m], y[m] = item.function.at(tree.time.start)[:2]
    for follower, cam, function in _cams(tree, elements):
        q[follower], slope, _ = function.at(q[cam])
        y[follower] = slope * y[cam]
    given = (_number(tree, *at) for at in elements.first_values)
    return {"q": q, "y": y, "started": tuple(given)}


def _cams(tree: Tree, elements: JointElements) -> Iterator[tuple[int, int, MotionFunction]]:
    """Yield the coordinates of follower and cam of couplings by functions, which begin where these are."""
    for item in elements.couplings:
        if item.function:
            follower, cam = (_number(tree, joint, name) for joint, name, _ in item.terms)
            yield follower, cam, item.function


def _number(tree: Tree, body: int, coordinate: str) -> int:
    coordinate_at = body, coordinate
    return next(
        m for m, c in enumerate(tree.coordinates) if (c.body, f"{c.motion} {c.axis}") == coordinate_at
    )


def _check_speeds(tree: Tree, item: Coupling, findings: Findings) -> None:
    """The speeds of Y(L) must fit a coupling."""
    rates = [factor * tree.y[_number(tree, body, name)] for body, name, factor in item.terms]
    if abs(sum(rates)) > COUPLED_RATE * max(map(abs, rates), default=0.0):
        message = f"the speeds of Y(L) give a constant sum the rate {sum(rates):.3g}; change one"
        findings.error(item.name, message, item.place, id="DAFMS-085")
