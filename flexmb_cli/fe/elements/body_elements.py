"""The elements of a body: rows of their nodes in its node table, and faults of mesh and material."""

from dataclasses import dataclass

import numpy as np

from ...model.diagnostics import Findings
from ...model.flexible_body import BodyMesh, ElementMaterial, FEFile, FlexibleInput
from ..formats.connectivity import ElementTable, read_elements
from ..formats.matrix_file import FEFileFault
from .element_stiffness import BodyElements
from .solid_elements import FORMULATIONS, integration_points, jacobians, node_coordinates

# The stiffness need only differ by this share of its largest entry for stresses to be off by several times.
FOREIGN = 1e-4
# Of det J at a node, relative to its mean at the points of integration. Elements whose nodes are interchanged
# have less than FOLDED; elements with middles at a quarter of their edges, for cracks, have 0.
FOLDED, DISTORTED = -0.5, -1e-6


@dataclass(frozen=True)
class BodyTable:
    """Numbers (m,) of the elements and the rows (m, k) of their nodes in the node table.

    `kind` is the type of all of them in an INP file, such as C3D20R; "" in other formats.
    """

    numbers: np.ndarray
    rows: np.ndarray
    kind: str = ""


def element_table(
    given: FlexibleInput, file: FEFile, positions: np.ndarray, findings: Findings
) -> BodyTable | None:
    """Return the elements in `file`; None with a fault found when they cannot be used.

    `positions` (n, 3), m, are those of the body's nodes.
    """
    try:
        read = read_elements(file.path, file.form)
        rows = _rows(given, read)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None
    if read.left_out:
        message = (
            f"{file.path.name} holds other elements, too ({read.left_out}); they have no part in the body, "
            "neither mass nor stiffness"
        )
        if all(fault.message != message for fault in findings.faults):
            findings.warn(given.name, message, file.place, id="FE-182")
    number = _folded(read.numbers, rows, positions)
    if number is not None:
        message = (
            f"{file.path.name}: element {number} is turned inside out or folded; check the order and places "
            "of its nodes"
        )
        findings.error(given.name, message, file.place, id="FE-010")
        return None
    return BodyTable(read.numbers, rows, read.kind)


def _folded(numbers: np.ndarray, rows: np.ndarray, positions: np.ndarray) -> int | None:
    """Return the number of the first element that is turned inside out or folded."""
    sound = np.flatnonzero((_determinants(rows, positions) > 0).all(axis=1))
    folded = (_relative_determinants(rows[sound], positions) < FOLDED).any(axis=1)
    folded_rows = np.setdiff1d(np.arange(len(rows)), sound[~folded])
    return int(numbers[folded_rows[0]]) if folded_rows.size else None


def _determinants(rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return det J (m, g) at the points of integration of elements."""
    points, _ = integration_points(rows.shape[1], FORMULATIONS[rows.shape[1]][0])
    return np.linalg.det(jacobians(positions[rows], points))


def _relative_determinants(rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return det J (m, k) at the nodes of elements, relative to its mean at the points of integration."""
    at_nodes = np.linalg.det(jacobians(positions[rows], node_coordinates(rows.shape[1])))
    return at_nodes / _determinants(rows, positions).mean(axis=1)[:, None]


def warn_of_distortion(
    given: FlexibleInput, table: BodyTable, positions: np.ndarray, findings: Findings
) -> None:
    """Warn of the element whose Jacobian determinant is the most negative at a node."""
    determinants = _relative_determinants(table.rows, positions)
    element, node = np.unravel_index(int(determinants.argmin()), determinants.shape)
    if determinants[element, node] >= DISTORTED:
        return
    count = int((determinants < DISTORTED).any(axis=1).sum())
    more = f"; {count} elements have such nodes" if count > 1 else ""
    material = given.material
    assert material is not None, "stresses need a material"
    at = given.numbers[table.rows[element, node]]
    message = (
        f"{material.file.path.name}: element {table.numbers[element]} is distorted: its Jacobian determinant "
        f"at node {at} is {determinants[element, node]:.2g} of its mean{more}; "
        "stresses there are doubtful"
    )
    findings.warn(given.name, message, material.place, id="FE-086")


def element_mesh(given: FlexibleInput) -> BodyMesh | None:
    """Return the elements of a body of no known material, for pictures; None where they cannot be read.

    They have no part in its motion, so that other types of elements are no fault.
    """
    if given.mesh is None:
        return None
    try:
        read = read_elements(given.mesh.path, given.mesh.form)
        return BodyMesh(read.numbers, _rows(given, read))
    except FEFileFault:
        return None


def _rows(given: FlexibleInput, table: ElementTable) -> np.ndarray:
    order = np.argsort(given.numbers)
    places = np.searchsorted(given.numbers[order], table.nodes)
    rows = order[np.minimum(places, len(order) - 1)]
    missing = given.numbers[rows] != table.nodes
    if missing.any():
        element, node = np.argwhere(missing)[0]
        raise FEFileFault(
            f"element {table.numbers[element]} has node {table.nodes[element, node]}, which no line of the "
            "node table defines",
            id="FE-011",
        )
    return rows


def warn_of_same_nodes(given: FlexibleInput, table: BodyTable, findings: Findings) -> None:
    """Warn of the first elements whose nodes are the same: files joined twice have them."""
    keys = np.sort(table.rows, axis=1)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[inverse.ravel()] != np.arange(len(keys)))
    if not len(again):
        return
    one, other = table.numbers[first[inverse.ravel()[again[0]]]], table.numbers[again[0]]
    more = f"; so do {len(again) - 1} more" if len(again) > 1 else ""
    assert given.material is not None, "the body has a table of elements"
    message = (
        f"{given.material.file.path.name}: element {other} has the same nodes as element {one}{more}; "
        "each counts, with its mass and stiffness if these are assembled from the elements"
    )
    findings.warn(given.name, message, given.material.place, id="FE-085")


def foreign_stiffness(body: BodyElements, material: ElementMaterial, remedy: str) -> str:
    """Return the message on a stiffness matrix that the elements do not assemble to."""
    values = f"E = {material.young:g} Pa, nu = {material.poisson:g}"
    return (
        f"the stiffness matrix differs by {body.deviation:.1e} of its largest entry from that of its "
        f"{len(body.elements.rows)} elements with {values}, the nearest being "
        f"{body.elements.formulation.name}: check E and nu, or, if the program's elements are others, "
        f"{remedy}"
    )
