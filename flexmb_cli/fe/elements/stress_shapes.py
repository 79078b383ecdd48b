"""Stresses of a body's modes: at points of integration, and extrapolated to nodes and averaged there.

Barlow, Int. J. Num. Meth. Eng. 10 (1976), 243-251: the points of reduced integration are those where
stresses of quadratic elements are best.  Inside an element a polynomial is fitted to its points (trilinear in
hexahedra, linear in tetrahedra of four points, constant for one point) and evaluated at its nodes; a node has
the mean of its elements.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...errors import Fault, ModelError
from ...model.diagnostics import Findings
from ...model.fe_model import StressSelection, VsdfModel
from ...model.flexible_body import BodyStress, FlexibleBody, FlexibleInput
from ...model.flexible_mechanism import FloatingBody, StressOutput
from ..linear_algebra import Matrix
from ..reference_frame import Frame
from . import tetrahedra
from .assembled_matrices import assembled_text, warn_of_types
from .body_elements import (
    FOREIGN,
    BodyTable,
    element_table,
    foreign_stiffness,
    warn_of_distortion,
    warn_of_same_nodes,
)
from .element_stiffness import (
    BodyElements,
    element_stiffness,
    matching_elements,
    parts,
    stresses,
    uniform_strain_deviation,
)
from .solid_elements import (
    FORMULATIONS,
    Formulation,
    elasticity,
    integration_points,
    node_coordinates,
    solid_elements,
)

# A mass that differs by more of itself is that of another density; meshes and digits make less.
DIFFERENT_MASS = 1e-3
_OF_CENTRE = "; those of a brick's centre miss its bending"


def body_stress(
    given: FlexibleInput, K: Matrix, mass: float, frame: Frame, Phi: np.ndarray, findings: Findings
) -> BodyStress | None:
    """Return the elements of `given` and their nodal stresses per mode; None with a fault found.

    `K` (3 n, 3 n), body axes; `mass`, kg, that of the mass matrix; `Phi` (3 n, N).
    """
    material = given.material
    assert material is not None, "stresses need a material"
    table = element_table(given, material.file, frame.r0, findings)
    if table is None:
        return None
    warn_of_same_nodes(given, table, findings)
    warn_of_distortion(given, table, frame.r0, findings)
    warn_of_types(given, table, findings)
    body = matching_elements(frame.r0, table.rows, (material.young, material.poisson), K)
    if body.deviation > FOREIGN:
        body = _at_best_points(given, frame.r0, table, body, K, findings)
    _check_density(given, mass, body, findings)
    return BodyStress(
        table.numbers,
        table.rows,
        body.elements.formulation.name,
        material.young,
        material.poisson,
        body.deviation,
        nodal_stresses(body, Phi),
        assembled_text(given, table),
    )


def _at_best_points(
    given: Any, positions: np.ndarray, table: BodyTable, nearest: BodyElements, K: Matrix, findings: Findings
) -> BodyElements:
    """Return elements at their points of reduced integration, for a stiffness of an unknown formulation.

    A stiffness that answers uniform strains as the elements do is of their mesh and material; else E or nu
    is wrong, which is an error.  Such stresses are refused unless the deck asks for them, or the elements
    are C3D8R: what K has besides the strain of the centre, forces against hourglasses, has no stress.
    """
    material = given.material
    reduced = FORMULATIONS[table.rows.shape[1]]
    names = [formulation.name for formulation in reduced]
    formulation = reduced[names.index("reduced integration") if "reduced integration" in names else 0]
    elements = solid_elements(positions, table.rows, formulation)
    D = elasticity(material.young, material.poisson)
    stiffness, internal = element_stiffness(elements, D)
    body = BodyElements(elements, D, internal, nearest.deviation)
    nodal_forces = (elements, stiffness), (nearest.elements, element_stiffness(nearest.elements, D)[0])
    if min(uniform_strain_deviation(*one, positions, K) for one in nodal_forces) > FOREIGN:
        remedy = "leave MATL out"
        findings.error(given.name, foreign_stiffness(nearest, material, remedy), material.place, id="FE-072")
        return body
    what = (
        f"the stiffness matrix is that of no known formulation of its elements (the nearest, "
        f"{nearest.elements.formulation.name}, differs by {nearest.deviation:.1e} of the largest entry)"
    )
    if material.any_stiffness or table.kind == "C3D8R":
        message = (
            f"{what}; stresses are taken at the points of reduced integration, and element energies do not "
            f"add up to the body's{_OF_CENTRE * (elements.nodes == 8)}"
        )
        findings.warn(given.name, message, material.place, id="FE-073")
    else:
        message = (
            f"{what}, so their stresses are not known; leave MATL out, or write REDU on a card ELMT for "
            f"stresses at the points of reduced integration{_OF_CENTRE * (elements.nodes == 8)}"
        )
        findings.error(given.name, message, material.place, id="FE-162")
    return body


def _check_density(given: Any, mass: float, body: BodyElements, findings: Findings) -> None:
    material, volume = given.material, body.elements.volumes.sum()
    if abs(material.density * volume - mass) > DIFFERENT_MASS * mass:
        message = (
            f"the mass matrix has {mass:.6g} kg, and {volume:.6g} m^3 of elements at "
            f"{material.density:g} kg/m^3 have {material.density * volume:.6g} kg; check the density, or the "
            "units of the files"
        )
        findings.warn(given.name, message, material.place, id="FE-074")


def nodal_stresses(body: BodyElements, Phi: np.ndarray) -> np.ndarray:
    """Stresses (n, 6, N), Pa, at the nodes for displacements `Phi` (3 n, N): means over the elements."""
    elements = body.elements
    fitted = extrapolation(elements.nodes, elements.formulation)
    n = len(Phi) // 3
    sums, counts = np.zeros((n, 6, Phi.shape[1])), np.bincount(elements.rows.ravel(), minlength=n)
    for part in parts(len(elements.rows)):
        at_nodes = np.einsum("kg,mgac->mkac", fitted, stresses(body, Phi, part))
        np.add.at(sums, elements.rows[part], at_nodes)
    return sums / np.maximum(counts, 1)[:, None, None]


def extrapolation(nodes: int, formulation: Formulation) -> np.ndarray:
    """Matrix (k, g) from values at the points of integration to those at the nodes of an element."""
    points, _ = integration_points(nodes, formulation)
    terms = _terms_of(nodes, len(points))
    return terms(node_coordinates(nodes)) @ np.linalg.pinv(terms(points))


def _terms_of(nodes: int, count: int) -> Callable[..., Any]:
    """The polynomial that so many points determine."""
    if count == 1:
        return lambda x: np.ones((len(x), 1))
    if nodes in tetrahedra.COUNTS:
        return lambda x: np.column_stack([np.ones(len(x)), x])
    powers = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return lambda x: np.column_stack([np.prod(x**power, axis=1) for power in powers])


def elements_of(body: FlexibleBody, chosen: np.ndarray) -> BodyElements:
    """Return the elements at the places `chosen` of the body's table, with their strains."""
    stress = body.stress
    assert stress is not None, "elements are those of a body of known material"
    formulations = FORMULATIONS[stress.rows.shape[1]]
    formulation = next(one for one in formulations if one.name == stress.formulation)
    elements = solid_elements(body.r0, stress.rows[chosen], formulation)
    D = elasticity(stress.young, stress.poisson)
    return BodyElements(elements, D, element_stiffness(elements, D)[1], stress.deviation)


def point_stresses(body: FlexibleBody, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Stresses (e, g, 6, N), Pa, per mode at the points of chosen elements, and their volumes (e, g), m³."""
    recovered = elements_of(body, chosen)
    points = np.empty((*recovered.elements.volumes.shape, 6, body.modes))
    for part in parts(len(chosen)):
        points[part] = stresses(recovered, body.Phi, part)
    return points, recovered.elements.volumes


def stress_outputs(model: VsdfModel, bodies: Sequence[FloatingBody]) -> tuple[StressOutput, ...]:
    """Return what the model reports of its bodies.  Raises ModelError for an element that a body lacks."""
    return tuple(_output(selection, bodies[selection.body].flexible) for selection in model.stresses)


def _output(selection: StressSelection, body: FlexibleBody | None) -> StressOutput:
    assert body is not None and body.stress is not None, "a selection is of a flexible body with a material"
    nodes = np.array(selection.nodes, dtype=np.int64)
    order = np.argsort(body.numbers)
    rows = order[np.searchsorted(body.numbers[order], nodes)]
    numbers = body.stress.numbers
    order = np.argsort(numbers)
    named = order[np.searchsorted(numbers[order], _named_elements(selection, body.name, numbers))]
    chosen = np.arange(len(numbers)) if selection.every_element else named
    elements = numbers[chosen]
    points, volumes = point_stresses(body, chosen)
    return StressOutput(
        selection.body, nodes, body.stress.nodal[rows], elements, points, volumes, selection.largest
    )


def _named_elements(selection: StressSelection, name: str, numbers: np.ndarray) -> np.ndarray:
    """Return the numbers of the elements that the deck names.  Raises ModelError where the body lacks one."""
    elements = np.array(selection.elements, dtype=np.int64)
    faults = [
        Fault(
            "error",
            f"{name} has no element {elements[k]}; its elements are {numbers.min()} to {numbers.max()}",
            selection.places[k],
            "OUTS",
            id="FE-071",
        )
        for k in np.flatnonzero(~np.isin(elements, numbers))
    ]
    if faults:
        raise ModelError(faults)
    return elements
