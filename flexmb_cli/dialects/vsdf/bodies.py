"""Bodies of a VSDF deck: masses, nodes, initial motion, the bodies that a card must not name."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...deck.many_records import DeckValues, outside
from ...deck.record import Record
from ...errors import MOST_LISTED_ERRORS
from ...model.diagnostics import Findings, no_such
from ...model.fe_model import RigidMass, VsdfBody
from ...model.mechanism import GROUND
from ...model.vectors import euler_parameters
from ..elements_block.line import mass_lines
from .cards import CARDS
from .cards.bodies import BODY_CARDS
from .flexible_bodies import flexible_body
from .many_bodies import ManyBodies
from .nodes import given_nodes, sets_of

_UNIT_LENGTH = 1e-6
_MOMENT_ROUND_OFF = 1e-9  # of the largest moment of inertia


def build_bodies(values: DeckValues, folder: Path, findings: Findings) -> Sequence[VsdfBody]:
    """The bodies in order; file names are relative to `folder`; faults go to `findings`."""
    count = len(values.section("body"))
    _check_body_numbers(values, count, findings)
    refuse_placements_outside(values, count, findings)
    given = (_body(values, k, folder, findings) for k in range(1, count + 1))
    bodies = (placed_body(values, k, body, findings) for k, body in enumerate(given, start=1))
    if not values.many:
        return tuple(bodies)
    return ManyBodies(bodies, lambda k: given_nodes(values, k, Findings()))


def build_ground(values: DeckValues, findings: Findings) -> VsdfBody:
    """The ground with its nodes."""
    nodes = given_nodes(values, 0, findings)
    return VsdfBody("ground", (0.0,) * 3, (1.0, 0.0, 0.0, 0.0), nodes=nodes)


def _check_body_numbers(values: DeckValues, count: int, findings: Findings) -> None:
    """Every card of a body must name one that exists."""
    for card in CARDS:
        if not (card.bodies or card in BODY_CARDS[1:]):
            continue  # their builders find what they name themselves
        lowest = card.least_body
        for record in outside(values.section(card.section), "body", lowest, count):
            number = record.at("body")
            message = no_such("body", number.value, count, lowest)
            findings.error(record.subject, message, number.place, id="VSDF-001")


def _body(values: Any, k: int, folder: Path, findings: Findings) -> VsdfBody:
    record = values.record("body", k)
    flexible = record["kind"] == "FLEX"
    r = values.record("position", k)
    velocity = values.record("velocity", k)
    pose = {
        "r": r.vector("r") if r else (0.0, 0.0, 0.0),
        "p": _attitude(values.record("attitude", k), findings),
        "velocity": velocity.vector("v") if velocity else (0.0, 0.0, 0.0),
        "omega": velocity.vector("w") if velocity else (0.0, 0.0, 0.0),
        "place": record.place,
        "velocity_place": velocity.place if velocity else None,
    }
    _refuse_cards_of_others(values, k, record["kind"], findings)
    build = flexible_body if flexible else _rigid
    return build(values, k, record, pose, folder, findings)


def _refuse_cards_of_others(values: DeckValues, k: int, kind: str, findings: Findings) -> None:
    """Faults for the cards of body k, of type FLEX or RIGD, that are for bodies of the other type."""
    for card in CARDS:
        if card.bodies in ("", kind):
            continue
        # Records one by one, and no more than are reported: there may be a million.
        for place in values.places_of_body(card.section, k)[: MOST_LISTED_ERRORS + 1]:
            given = values.section(card.section)[place]
            message = f"{card.word} is for {card.bodies} bodies; body {k} is {kind}"
            if kind == "RIGD":
                findings.error(given.subject, message, given.place, id="VSDF-004")
            else:
                findings.error(given.subject, message, given.place, id="VSDF-022")


def _attitude(record: Record | None, findings: Findings) -> Any:
    if record is None:
        return 1.0, 0.0, 0.0, 0.0
    p = tuple(float(record[f"e{i}"]) for i in range(4))
    length = math.hypot(*p)
    if not length:
        message = "the Euler parameters are all zero; write 1 0 0 0 for a body that is not turned"
        findings.error(record.subject, message, record.at("e0").place, id="VSDF-002")
        return 1.0, 0.0, 0.0, 0.0
    if abs(length - 1.0) > _UNIT_LENGTH:
        message = f"the Euler parameters have length {length:.7g} and are scaled to length 1"
        findings.warn(record.subject, message, record.at("e0").place, id="VSDF-003")
    return tuple(e / length for e in p)


def _rigid(
    values: DeckValues, k: int, record: Record, pose: dict[Any, Any], _folder: Path, findings: Findings
) -> VsdfBody:
    rigid = values.record("rigid", k)
    lines: Any = values.section("elements") if rigid is None else ()
    if rigid is None and not any(line["body"] == k for line in mass_lines(lines)):
        findings.error(
            record.subject,
            "a RIGD body needs a card RIGI with its mass and inertia, or a line MASS of a block",
            record.place,
            id="VSDF-005",
        )
    mass = _rigid_mass(rigid, findings) if rigid else None
    nodes = given_nodes(values, k, findings)
    return VsdfBody(record.subject, **pose, rigid=mass, nodes=nodes, sets=sets_of(values, k, nodes, findings))


def _rigid_mass(record: Record, findings: Findings) -> RigidMass:
    if not record["mass"] > 0:
        message = f"the mass must be above zero; read {record.at('mass').text}"
        findings.error(record.subject, message, record.at("mass").place, id="VSDF-006")
    xx, yy, zz, xy, yz, zx = (float(record[f"J{ij}"]) for ij in ("xx", "yy", "zz", "xy", "yz", "zx"))
    inertia = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    moments = np.linalg.eigvalsh(inertia)
    slack = _MOMENT_ROUND_OFF * np.abs(moments).max()
    if moments[0] < -slack:
        message = f"no principal moment of inertia may be negative; the least is {moments[0]:.6g} kg m^2"
        findings.error(record.subject, message, record.at("Jxx").place, id="VSDF-007")
    elif moments[2] > moments[0] + moments[1] + slack:
        message = (
            f"no body has the principal moments {moments[0]:.6g}, {moments[1]:.6g}, {moments[2]:.6g} kg m^2: "
            "the largest must not exceed the sum of the others (the moments are about the centre of mass)"
        )
        findings.error(record.subject, message, record.at("Jxx").place, id="VSDF-008")
    return RigidMass(float(record["mass"]), record.vector("c"), inertia)


def end_of_body(number: int) -> int:
    """The model's number of a deck's body: from 0, ground -1."""
    return GROUND if number == 0 else number - 1


# Of the distance between two nodes: a point farther beside the second one was meant for another node.
FAR_FROM_NODE = 1e-3
# Sine of the least angle between the directions to the second and the third node, and to their points.
SMALLEST_ANGLE = 1e-6


def refuse_placements_outside(values: DeckValues, count: int, findings: Findings) -> None:
    """Refuse cards PLAC of bodies that the deck, with `count` bodies, does not have."""
    for record in outside(values.section("placement"), "body", 1, count):
        number = record.at("body")
        message = no_such("body", number.value, count)
        findings.error(record.subject, message, number.place, id="VSDF-094")


def placed_body(values: DeckValues, k: int, body: VsdfBody, findings: Findings) -> VsdfBody:
    """Return body k where PLAC puts it; one without the card stays."""
    records = values.of_body("placement", k)
    return _placed(values, k, body, records, findings) if records else body


def _placed(
    values: DeckValues, k: int, body: VsdfBody, records: Sequence[Record], findings: Findings
) -> VsdfBody:
    if len(records) not in (1, 3):
        message = f"{len(records)} cards place {body.name}; one node places it, three place and turn it"
        findings.error(records[-1].subject, message, records[-1].place, id="VSDF-095")
        return body
    replaced = [("position", "POSI")] + [("attitude", "EULP")] * (len(records) == 3)
    for section, word in replaced:
        record = values.record(section, k)
        if record:
            findings.error(
                record.subject, f"{word} is not read beside PLAC of {body.name}", record.place, id="VSDF-096"
            )
    if len([record for record in records if _has_node(body, record, findings)]) < len(records):
        return body
    nodes = np.array([body.position(record["node"]) for record in records])
    points = np.array([record.vector("p") for record in records], float)
    A = body.A if len(records) == 1 else _placed_attitude(body, records, nodes, points, findings)
    if A is None:
        return body
    x, y, z = map(float, points[0] - A @ nodes[0])
    if len(records) == 1:
        return replace(body, r=(x, y, z))
    e0, e1, e2, e3 = map(float, euler_parameters(A))
    return replace(body, r=(x, y, z), p=(e0, e1, e2, e3))


def _has_node(body: VsdfBody, record: Record, findings: Findings) -> bool:
    number = record.at("node")
    if body.nodes and not body.members(number.value):
        findings.error(record.subject, f"{body.name} has no node {number.value}", number.place, id="VSDF-097")
    return bool(body.members(number.value))


def _placed_attitude(
    body: VsdfBody, records: Sequence[Record], nodes: np.ndarray, points: np.ndarray, findings: Findings
) -> np.ndarray | None:
    """Rotation matrix that takes the triad of the nodes to that of the points; None with a fault found."""
    own, target = _triad(nodes), _triad(points)
    for triad, what, record in ((own, "nodes", records[2]), (target, "points", records[2])):
        if triad is None:
            message = f"the three {what} that turn {body.name} lie on one line, or two of them coincide"
            findings.error(record.subject, message, record.place, id="VSDF-098")
    if own is None or target is None:
        return None
    distance, given = (np.linalg.norm(places[1] - places[0]) for places in (nodes, points))
    if abs(distance - given) > FAR_FROM_NODE * distance:
        message = (
            f"node {records[1]['node']} is {distance:.6g} m from node {records[0]['node']}, and its point "
            f"{given:.6g} m from the first one: the node lies {abs(distance - given):.3g} m beside its point"
        )
        findings.warn(records[1].subject, message, records[1].place, id="VSDF-099")
    return target @ own.T


def _triad(places: np.ndarray) -> np.ndarray | None:
    """Axes (3, 3) from the first place to the second, and across in their plane; None on one line."""
    along, beside = places[1] - places[0], places[2] - places[0]
    across = np.cross(along, beside)
    size = np.linalg.norm(along)
    if np.linalg.norm(across) <= SMALLEST_ANGLE * size * np.linalg.norm(beside):
        return None
    e1, e3 = along / size, across / np.linalg.norm(across)
    return np.column_stack([e1, np.cross(e3, e1), e3])
