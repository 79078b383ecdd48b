"""The cards PLAC: a body is placed by one of its nodes at a point, and turned by two more nodes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...deck.number_table import outside
from ...deck.record import Record
from ...deck.records import DeckValues
from ...model.diagnostics import Findings, no_such
from ...model.fe_model import VsdfBody
from ...model.vectors import euler_parameters

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
    A = body.A if len(records) == 1 else _attitude(body, records, nodes, points, findings)
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


def _attitude(
    body: VsdfBody, records: Sequence[Record], nodes: np.ndarray, points: np.ndarray, findings: Findings
) -> np.ndarray | None:
    """Rotation matrix that takes the triad of the nodes to that of the points; None with a fault found."""
    own, wanted = _triad(nodes), _triad(points)
    for triad, what, record in ((own, "nodes", records[2]), (wanted, "points", records[2])):
        if triad is None:
            message = f"the three {what} that turn {body.name} lie on one line, or two of them coincide"
            findings.error(record.subject, message, record.place, id="VSDF-098")
    if own is None or wanted is None:
        return None
    distance, given = (np.linalg.norm(places[1] - places[0]) for places in (nodes, points))
    if abs(distance - given) > FAR_FROM_NODE * distance:
        message = (
            f"node {records[1]['node']} is {distance:.6g} m from node {records[0]['node']}, and its point "
            f"{given:.6g} m from the first one: the node lies {abs(distance - given):.3g} m beside its point"
        )
        findings.warn(records[1].subject, message, records[1].place, id="VSDF-099")
    found: np.ndarray | None = wanted @ own.T
    return found


def _triad(places: np.ndarray) -> np.ndarray | None:
    """Axes (3, 3) from the first place to the second, and across in their plane; None on one line."""
    along, beside = places[1] - places[0], places[2] - places[0]
    across = np.cross(along, beside)
    size = np.linalg.norm(along)
    if np.linalg.norm(across) <= SMALLEST_ANGLE * size * np.linalg.norm(beside):
        return None
    e1, e3 = along / size, across / np.linalg.norm(across)
    return np.column_stack([e1, np.cross(e3, e1), e3])
