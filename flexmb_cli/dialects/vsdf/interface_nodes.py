"""Interface nodes of flexible bodies of a VSDF deck: cards RBE2 and RBE3."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...deck.many_records import DeckValues
from ...deck.record import Record
from ...fe.formats.matrix_file import FEFileFault
from ...model.diagnostics import Findings
from ...model.fe_model import Arm
from ...model.flexible_body import FEFile, FlexibleInput, InterfaceNode
from .nodes import members_of

Nodes = Mapping[int, Any]
_RIGID = {"rigid_interface": True, "mean_interface": False}


def interface_nodes(
    values: DeckValues, k: int, nodes: Nodes, sets: Nodes, file: FEFile, findings: Findings
) -> tuple[InterfaceNode, ...]:
    """Return the interface nodes of body k with `nodes` and node `sets`; `file`: that of the node table."""
    interfaces: list[InterfaceNode] = []
    for section, rigid in _RIGID.items():
        for record in values.of_body(section, k):
            coupling = _coupling(record, rigid, nodes, sets, file, findings)
            if coupling is None:
                continue
            members, node = coupling[0], record["interface"]
            position = nodes[node] if node in nodes else np.mean([nodes[one] for one in members], axis=0)
            interfaces.append(InterfaceNode(node, position, rigid, *coupling, record.place))
    _check(k, interfaces, sets, findings)
    return tuple(interfaces)


def _coupling(
    record: Record, rigid: bool, nodes: Nodes, sets: Nodes, file: FEFile, findings: Findings
) -> tuple[tuple[int, ...], tuple[float, ...], bool] | None:
    """Return the nodes that a card or the file couples, their weights, and whether rotations are, too."""
    if [number.value for number in record.numbers if number.key.startswith("node")] != [0]:
        known = {**{node: (node,) for node in nodes}, **sets}
        named = members_of(record, known, record["body"], findings)
        members = tuple(node for one in named for node in known[one])
        return (members, (1.0,) * len(members), True) if members else None
    from ...fe.formats.couplings import read_coupling  # few decks have any

    number = record.at("interface")
    try:
        coupling = read_coupling(file.path, file.form, number.value, rigid)
    except FEFileFault as fault:
        findings.error(record.subject, str(fault), number.place, id=fault.id)
        return None
    missing = [node for node in coupling.members if node not in nodes]
    if missing or not coupling.members:
        message = (
            f"{file.path.name} couples node {number.value} to {missing[:1] or 'none'}, which has no place"
        )
        findings.error(record.subject, message, number.place, id="VSDF-250")
        return None
    return coupling.members, coupling.weights, coupling.turns


def carrying_arms(interfaces: tuple[InterfaceNode, ...], nodes: Nodes) -> dict[int, Arm]:
    """Return the arms from rigid interface nodes to the nodes that they carry, by the numbers of these."""
    rigid = [(one, member) for one in interfaces if one.rigid for member in one.members]
    return {member: Arm(one.node, nodes[member] - one.position, one.place) for one, member in rigid}


def check_uses(k: int, given: FlexibleInput, sets: Nodes, findings: Findings) -> None:
    """Refuse frames, bases, sets and means of nodes that have no rows of their own."""
    owner = {member: one.node for one in given.interfaces if one.rigid for member in one.members}
    owner |= {one.node: one.node for one in given.interfaces if not one.rigid}
    used = [*given.reference, *given.clamped, *given.attachment, *given.interface]
    used += [node for members in sets.values() for node in members]
    used += [node for one in given.interfaces if not one.rigid for node in one.members]
    for node in [node for node in used if node in owner][:1]:
        message = (
            f"node {node} has no rows of its own, since interface node {owner[node]} carries it, or is it: "
            "no frame, static shape, set or mean can take it"
        )
        findings.error(f"body {k}", message, given.place, id="VSDF-254")


def _check(k: int, interfaces: list[InterfaceNode], sets: Mapping[int, Any], findings: Findings) -> None:
    """Each node is carried once, by a node that no other carries, whose number is its own."""
    carried: dict[int, int] = {}
    for one in interfaces:
        name = f"interface node {one.node}"
        if one.node in sets or one.node < 1:
            message = f"{one.node} is a node set of body {k}, or no number of a node; take another"
            findings.error(name, message, one.place, id="VSDF-251")
        for member in one.members:
            other = carried.setdefault(member, one.node) if one.rigid else one.node
            if other != one.node or member == one.node or len(set(one.members)) < len(one.members):
                message = f"node {member} of body {k} is coupled twice, or to itself"
                findings.error(name, message, one.place, id="VSDF-252")
                break
    for one in interfaces:
        if one.node in carried or sum(other.node == one.node for other in interfaces) > 1:
            message = f"node {one.node} of body {k} is carried by another, or coupled by two cards"
            findings.error(f"interface node {one.node}", message, one.place, id="VSDF-253")
