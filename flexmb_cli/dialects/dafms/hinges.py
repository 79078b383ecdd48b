"""Hinges of FMBD.DAT: parents, hinge points and nodes, attitudes, free axes.

DAFMS thesis (Zhao, 1992), section 2.2 and appendix C, TSYSIN.  The listing looks up the node of a
hinge with the parent (NP(L(k))); its card, and any branched tree, mean the node stored with body k.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...deck.many_records import DeckValues
from ...deck.record import Record
from ...model.diagnostics import Findings
from ...model.tree import INERTIAL, UNTURNED, Body, Hinge

# Euler parameters typed with five decimals miss their length by less than this.
_LENGTH = 1e-3


def build_hinges(values: DeckValues, bodies: tuple[Body, ...], findings: Findings) -> tuple[Hinge, ...]:
    """The hinge of every body, in order; faults go to `findings`."""
    if len(bodies) > 1 and not values.section("parent"):
        message = "card 'CONN' is missing: every body hangs on the inertial frame"
        findings.warn("", message, values.place("counts"), id="DAFMS-032")
    parents = [_parent(values, k, findings) for k in range(1, len(bodies) + 1)]
    return tuple(_hinge(values, bodies, parents, k, findings) for k in range(1, len(bodies) + 1))


def _parent(values: Any, k: int, findings: Findings) -> int:
    number = values.record("parent", k)
    if number is None:
        return INERTIAL
    number = number.at("L")
    if not 0 <= number.value < k:
        allowed = "0, the inertial frame" if k == 1 else f"0 (inertial frame) to {k - 1}"
        message = f"L = {number.value}: parents are numbered below their children, here {allowed}"
        findings.error(f"body {k}", message, number.place, id="DAFMS-033")
        return INERTIAL
    return int(number.value - 1)


def _hinge(
    values: DeckValues, bodies: tuple[Body, ...], parents: list[int], k: int, findings: Findings
) -> Hinge:
    parent = parents[k - 1]
    point = values.values("hinge_point", k, (0.0, 0.0, 0.0))
    node = _node(values, bodies, parent, k, point, findings)
    return Hinge(
        parent,
        point,
        node,
        _attitude(values, "hinge_attitude", "EULL", k, findings),
        _attitude(values, "attitude", "EULT", k, findings),
        _free_axes(values, k, "NR"),
        _free_axes(values, k, "NT"),
        None if node is None else _elastic_rotation(values, parent, node, bodies),
        values.place("hinge_point", k) or values.place("counts", k),
    )


def _free_axes(values: DeckValues, k: int, name: str) -> tuple[int, ...]:
    return tuple(axis for axis in (1, 2, 3) if values.number("counts", k, f"{name}{axis}").value)


def _node(
    values: DeckValues,
    bodies: Sequence[Body],
    parent: Any,
    k: int,
    point: tuple[float, float, float],
    findings: Findings,
) -> int | None:
    """Node of the flexible parent at P_k, from 0; None when P_k does not follow one."""
    own = values.record("hinge_node", k)
    if parent == INERTIAL or bodies[parent].elastic is None:
        _note_unused_node(own, parent, k, findings)
        return None
    stated = own.at("NP").value if own else 0
    place = own.place if own else None
    positions = bodies[parent].elastic.positions
    if stated == 0:
        stated = _node_of_parents_record(values, parent, positions, point, k, findings)
    if stated == 0:
        _warn_of_rigid_attachment(values, bodies, parent, k, point, findings)
        return None
    if not 1 <= stated <= len(positions):
        message = f"NP = {stated} is not a node of body {parent + 1}, which has {len(positions)}"
        findings.error(f"hinge of body {k}", message, place, id="DAFMS-034")
        return None
    if not _same_point(positions[stated - 1], point):
        _report_other_point(values, positions[stated - 1], stated, parent, k, point, findings)
    return stated - 1


def _note_unused_node(own: Record | None, parent: int, k: int, findings: Findings) -> None:
    """The listing does not look at NP of a parent without nodes; flexmb neither."""
    if own and own.at("NP").value > 0 and parent != INERTIAL:
        message = (
            f"NP = {own.at('NP').value} is not used: body {parent + 1} is rigid, and Q(k) says where P_k is"
        )
        findings.note(f"hinge of body {k}", message, own.at("NP").place, id="DAFMS-035")


def _same_point(node: np.ndarray, point: tuple[float, float, float]) -> bool:
    """Equal to the digits that two F10.5 fields hold for certain."""
    return bool(np.all(np.abs(node - point) <= 1.1e-5 + 1e-6 * np.abs(node)))


def _node_of_parents_record(
    values: DeckValues,
    parent: int,
    positions: np.ndarray,
    point: tuple[float, float, float],
    k: int,
    findings: Findings,
) -> int:
    """The node a deck meant for the listing gives with the parent, when it lies where Q(k) says."""
    record = values.record("hinge_node", parent + 1)
    stated = record.at("NP").value if record else 0
    if not 1 <= stated <= len(positions) or not _same_point(positions[stated - 1], point):
        return 0
    message = (
        f"NP is 0; node {stated} of body {parent + 1} is read from record {parent + 1} of NOFP, where the "
        f"1992 listing looks: write {stated} in record {k} too"
    )
    findings.warn(f"hinge of body {k}", message, values.place("hinge_node", k), id="DAFMS-036")
    return stated


def _warn_of_rigid_attachment(
    values: DeckValues,
    bodies: Sequence[Body],
    parent: int,
    k: int,
    point: tuple[float, float, float],
    findings: Findings,
) -> None:
    if any(point):
        message = (
            f"Q(k) is a point of flexible body {parent + 1} but NP names no node: "
            "the hinge does not follow the body's elastic motion"
        )
        findings.warn(
            f"hinge of body {k}",
            message,
            values.place("hinge_node", k) or bodies[k - 1].place,
            id="DAFMS-037",
        )


def _report_other_point(
    values: DeckValues,
    node: np.ndarray,
    stated: int,
    parent: int,
    k: int,
    point: tuple[float, float, float],
    findings: Findings,
) -> None:
    place = values.place("hinge_point", k) or values.place("hinge_node", k)
    message = (
        f"Q(k) = {_triple(point)} is not where node {stated} of body {parent + 1} lies, {_triple(node)}; "
        f"NP of record {k} is the node of the parent at which this hinge sits"
    )
    findings.error(f"hinge of body {k}", message, place, id="DAFMS-038")


def _triple(vector: np.ndarray | tuple[float, float, float]) -> str:
    return "(" + ", ".join(f"{x:g}" for x in vector) + ")"


def _attitude(values: DeckValues, section: str, card: str, k: int, findings: Findings) -> Any:
    """Euler parameters, scalar first and normalised, from a card that gives the scalar last."""
    record = values.record(section, k)
    if record is None:
        return UNTURNED
    e1, e2, e3, e4 = (number.value for number in record.numbers)
    length = math.hypot(e1, e2, e3, e4)
    if length == 0:
        message = "four zeros are not an attitude; write 0.0 0.0 0.0 1.0 for no turn, the scalar last"
        findings.error(f"{card} of body {k}", message, record.place, id="DAFMS-039")
        return UNTURNED
    if abs(length - 1) > _LENGTH:
        message = f"the Euler parameters have length {length:.6g}, not 1; they are normalised"
        findings.warn(f"{card} of body {k}", message, record.place, id="DAFMS-040")
    elif (abs(e1), e2, e3, e4) == (1.0, 0.0, 0.0, 0.0):
        message = "1.0 0.0 0.0 0.0 is half a turn about axis 1: the scalar e4 stands last"
        findings.note(f"{card} of body {k}", message, record.place, id="DAFMS-041")
    return tuple(float(e) / length for e in (e4, e1, e2, e3))


def _elastic_rotation(
    values: DeckValues, parent: Any, node: int, bodies: Sequence[Body]
) -> np.ndarray | None:
    """Matrix (3, NM) of card NROT for the node the hinge sits on; None when it is not given."""
    for record in values.section("nodal_rotation"):
        rows = np.array([number.value for number in record.numbers[2:]], float)
        fits = rows.size == 3 * bodies[parent].elastic.coordinates
        if fits and (record["K"], record["I"]) == (parent + 1, node + 1):
            return rows.reshape(3, -1)
    return None
