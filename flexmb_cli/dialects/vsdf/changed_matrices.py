"""Changes of a flexible body's matrices by its deck: masses added to nodes, a factor of the stiffness."""

from collections.abc import Collection
from typing import Any

from ...deck.many_records import DeckValues
from ...model.diagnostics import Findings


def changes_of_matrices(
    values: DeckValues, k: int, nodes: Collection[int], findings: Findings
) -> dict[str, Any]:
    """Return the fields of `FlexibleInput` that change the matrices of body k, whose table has `nodes`."""
    return {
        "nodal_masses": _nodal_masses(values, k, nodes, findings),
        "stiffness_factor": _stiffness_factor(values, k, findings),
    }


def _nodal_masses(
    values: DeckValues, k: int, nodes: Collection[int], findings: Findings
) -> tuple[tuple[int, float], ...]:
    """Return nodes of body k and the masses, kg, that the cards NODM add to them."""
    added = []
    for record in values.of_body("nodal_mass", k):
        node, mass = record.at("node"), record.at("mass")
        if node.value not in nodes:
            message = f"the files of body {k} have no node {node.value}"
            findings.error(record.subject, message, node.place, id="VSDF-255")
        elif not mass.value > 0:
            message = f"an added mass must be above zero; read {mass.text}"
            findings.error(record.subject, message, mass.place, id="VSDF-256")
        else:
            added.append((int(node.value), float(mass.value)))
    loads = values.of_body("unit_load", k)
    if added and loads:
        message = "the matrices of FEMG are those of loads without the added masses; take E and nu of GEOS"
        findings.error(loads[0].subject, message, loads[0].place, id="VSDF-257")
    return tuple(added)


def _stiffness_factor(values: DeckValues, k: int, findings: Findings) -> float:
    """Return the factor of the card SCAL of body k, 1 without one."""
    record = values.record("stiffness_factor", k)
    if record is None:
        return 1.0
    factor = record.at("factor")
    if not factor.value > 0:
        message = f"a factor of the stiffness must be above zero; read {factor.text}"
        findings.error(record.subject, message, factor.place, id="VSDF-258")
        return 1.0
    return float(factor.value)
