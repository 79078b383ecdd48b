"""Functions of time, and elements at hinges and between bodies, of FMBD.DAT."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ....deck.record import Record
from ....deck.records import DeckValues
from ....model.diagnostics import Findings
from ....model.flexible_mechanism import NodePoint
from ....model.joint_elements import Coupling
from ....model.laws import FRICTION, MOTOR, Joint
from ....model.tree import INERTIAL, ROTATION, TRANSLATION, Body, Hinge, Tree
from ....model.tree_as_mechanism.frames import shape_of
from ...elements_block.build import joined
from ...elements_block.function_lines import given_functions
from ...joint_elements.build import (
    Cards,
    coupling,
    force,
    force_sections,
    joint_driver,
    sections_of,
)
from ...joint_elements.build import build_elements as elements_of
from ...joint_elements.functions import Functions, GivenFunction
from ...joint_elements.maker import ElementMaker
from ..block_elements import COUPLED_RATE, with_block
from .cards import FUNCTION_KINDS

if TYPE_CHECKING:
    from ....model.joint_elements import JointElements


_CARDS: Cards = {
    "drivers": [("function_drive", joint_driver(None))],
    "forces": [
        *force_sections({"hinge_": None}),
        ("friction", force(FRICTION, Joint)),
        ("function_motor", force(MOTOR)),
    ],
    "couplings": [("coupling", coupling)],
}


def with_elements(tree: Tree, values: DeckValues, folder: Path, findings: Findings) -> Tree:
    """The tree with the elements of the deck, its driven coordinates as their functions begin."""
    lines: Any = values.section("elements")
    given = [*_given(values, findings), *given_functions(lines, folder, findings)]
    functions = Functions(given, findings)
    if lines:
        tree = with_block(tree, lines, functions, findings)
    maker = _Maker(tree.bodies, tree.hinges, functions, findings, tree.time.start)
    elements = elements_of(maker, sections_of(values), _CARDS)
    functions.note_unused()
    if not elements:
        return tree
    _refuse_prescribed(tree, elements, findings)
    tree = replace(tree, elements=joined(tree.elements, elements), **_start(tree, elements))
    for item in elements.couplings:
        _check_speeds(tree, item, findings)
    return tree


def _refuse_prescribed(tree: Tree, elements: "JointElements", findings: Findings) -> None:
    """Refuse drivers by functions of coordinates that the card PRES drives."""
    driven = {(each.body, f"{each.motion} {each.axis}") for each in tree.prescribed}
    for item in elements.drivers:
        if (item.joint, item.coordinate) in driven:
            message = (
                f"PRES already drives {item.coordinate} of the hinge of body {item.joint + 1}; remove one"
            )
            findings.error(item.name, message, item.place, id="DAFMS-152")


def _given(values: DeckValues, findings: Findings) -> Iterator[GivenFunction]:
    for record in values.section("function"):
        kind = record.at("kind")
        if kind.value not in FUNCTION_KINDS:
            message = f"kind is 1 to {len(FUNCTION_KINDS)}; read {kind.value}"
            findings.error(record.subject, message, kind.place, id="DAFMS-086")
            continue
        found, place = list(record.values[3:]), _places(record)
        yield GivenFunction(record, record.at("number"), FUNCTION_KINDS[kind.value], found, place)


def _places(record: Record) -> Any:
    return lambda k: record.numbers[3 + k].place


class _Maker(ElementMaker):
    """Makes elements of records; None where a fault was found."""

    def __init__(
        self,
        bodies: Sequence[Body],
        hinges: Sequence[Hinge],
        functions: Any,
        findings: Findings,
        start: float,
    ) -> None:
        super().__init__(functions, findings, start)
        self.bodies, self.hinges = bodies, hinges

    def where(self, record: Record, coordinate: Any, suffix: str = "") -> Any:
        """Body and hinge coordinate, by K and A."""
        hinge, freedom = self._hinge(record, f"K{suffix}"), record.at(f"A{suffix}")
        if hinge is None:
            return None
        if not 1 <= freedom.value <= 6:
            message = f"A = {freedom.value}: 1-3 are rotations, 4-6 translations of a hinge"
            self.findings.error(record.subject, message, freedom.place, id="DAFMS-077")
            return None
        motion, axis = (ROTATION, freedom.value) if freedom.value <= 3 else (TRANSLATION, freedom.value - 3)
        free = hinge.rotations if motion == ROTATION else hinge.translations
        if axis not in free:
            message = f"A = {freedom.value}: {motion} {axis} of this hinge is not free; {_freed(hinge)}"
            self.findings.error(record.subject, message, freedom.place, id="DAFMS-078")
            return None
        if motion == ROTATION and len(free) == 3:
            message = "the hinge has three free rotations: none of them is an angle"
            self.findings.error(record.subject, message, freedom.place, id="DAFMS-079")
            return None
        return record[f"K{suffix}"] - 1, f"{motion} {axis}"

    def _hinge(self, record: Record, key: str) -> Any:
        body = record.at(key)
        if not 1 <= body.value <= len(self.hinges):
            message = f"K = {body.value}: there are bodies 1 to {len(self.hinges)}"
            self.findings.error(record.subject, message, body.place, id="DAFMS-080")
            return None
        return self.hinges[body.value - 1]

    def sliding(self, record: Record) -> Any:
        """Body whose hinge turns about, or slides along, one axis, and whether it turns."""
        hinge = self._hinge(record, "K")
        if hinge is None:
            return None
        free = hinge.rotations + hinge.translations
        if not free or len(set(free)) > 1:
            message = "friction wants a hinge that turns about, or slides along, one axis"
            self.findings.error(record.subject, message, record.at("K").place, id="DAFMS-081")
            return None
        return record["K"] - 1, bool(hinge.rotations)

    def ends(self, record: Record) -> Any:
        """Bodies and points of an element between two bodies."""
        ends = [self._end(record, letter) for letter in "ab"]
        if None in ends:
            return None
        (i, P_i), (j, P_j) = ends
        if i == j:
            message = f"KA = KB = {record['KA']}: two bodies are needed"
            self.findings.error(record.subject, message, record.at("KB").place, id="DAFMS-082")
            return None
        return {"i": i, "j": j, "P_i": P_i, "P_j": P_j}

    def _end(self, record: Record, letter: Any) -> Any:
        body, node = record.at(f"K{letter.upper()}"), record.at(f"N{letter.upper()}")
        if not 0 <= body.value <= len(self.bodies):
            message = f"{body.key} = {body.value}: there are bodies 0 to {len(self.bodies)}"
            self.findings.error(record.subject, message, body.place, id="DAFMS-083")
            return None
        elastic = self.bodies[body.value - 1].elastic if body.value else None
        nodes = len(elastic.masses) if elastic else 0
        if not 0 <= node.value <= nodes:
            message = (
                f"{node.key} = {node.value}, but body {body.value} has {nodes} nodes; 0 takes the vector"
            )
            self.findings.error(record.subject, message, node.place, id="DAFMS-084")
            return None
        place = np.array([record[f"{letter}{axis}"] for axis in (1, 2, 3)], float)
        if elastic and node.value:
            place = elastic.positions[node.value - 1]
        shape = shape_of(elastic, node.value - 1 if node.value else None) if elastic else np.zeros((3, 0))
        owner = body.value - 1 if body.value else INERTIAL
        return owner, NodePoint(f"end {letter}", owner, place, shape)


def _freed(hinge: Hinge) -> str:
    """Return which values of A a hinge has, in words."""
    found = [*hinge.rotations, *(axis + 3 for axis in hinge.translations)]
    return f"free there: A = {', '.join(map(str, found))}" if found else "nothing is free there"


def _start(tree: Tree, elements: "JointElements") -> Any:
    """Coordinates and speeds whose driven ones begin as their functions do."""
    q, y = np.array(tree.q, float), np.array(tree.y, float)
    for item in elements.drivers:
        m = _number(tree, item.joint, item.coordinate)
        q[m], y[m] = item.function.at(tree.time.start)[:2]
    return {"q": q, "y": y}


def _number(tree: Tree, body: Any, coordinate: Any) -> Any:
    wanted = body, coordinate
    return next(m for m, c in enumerate(tree.coordinates) if (c.body, f"{c.motion} {c.axis}") == wanted)


def _check_speeds(tree: Tree, item: Coupling, findings: Findings) -> None:
    """The speeds of Y(L) must fit a coupling."""
    rates = [factor * tree.y[_number(tree, body, name)] for body, name, factor in item.terms]
    if abs(sum(rates)) > COUPLED_RATE * max(map(abs, rates), default=0.0):
        message = f"the speeds of Y(L) leave the rate {sum(rates):.3g} of a sum that must stay; change one"
        findings.error(item.name, message, item.place, id="DAFMS-085")
