"""Mass and stiffness of a body from its elements and material, where no program has written them.

Masses are consistent, integrated exactly in elements with straight edges, or lumped by the sums of rows
(Hughes, The Finite Element Method (1987), section 7.3).  Tetrahedra are integrated as collapsed cubes
(Stroud, Approximate Calculation of Multiple Integrals (1971), section 2.5).
"""

from typing import Any

import numpy as np

from ...model.diagnostics import Findings
from ...model.flexible_body import FlexibleInput
from ..formats.formats import OF_ELEMENTS
from ..formats.matrix_file import FEFileFault, MatrixFile
from ..linear_algebra import in_three_directions
from . import tetrahedra
from .body_elements import BodyTable
from .element_stiffness import assembled, element_stiffness, parts
from .solid_elements import (
    CUBE,
    FORMULATIONS,
    Formulation,
    elasticity,
    gauss_points,
    shape_slopes,
    solid_elements,
)

# Elements of Abaqus and CalculiX go by their types; those of other formats have none and go by their nodes.
_OF_TYPE = {
    "C3D4": "one point",
    "C3D8": "full integration",
    "C3D8I": "incompatible modes of CalculiX",
    "C3D10": "four points",
    "C3D20": "full integration",
    "C3D20R": "reduced integration",
}
# Nobody has published the 13 incompatible modes of C3D8I of Abaqus.
_OF_PROGRAM = {"CCX": {}, "ABQ": {"C3D8": "mean dilatation", "C3D8I": ""}}
_OF_NODES = {4: "one point", 8: "incompatible modes", 10: "four points", 20: "full integration"}
# Points a direction: products of two quadratic shape functions and a Jacobian of straight edges.
_MASS_POINTS = {4: 3, 8: 2, 10: 4, 20: 3}


def element_matrix(given: FlexibleInput, table: BodyTable, letter: str) -> MatrixFile:
    """Return M or K (`letter`) of the elements, rows x y z node by node.  Raises FEFileFault."""
    matrix = _mass(given, table) if letter == "M" else _stiffness(given, table)
    if isinstance(matrix, np.ndarray):
        rows, columns = np.nonzero(matrix)
        return MatrixFile(len(matrix), rows, columns, matrix[rows, columns], False)
    entries = matrix.tocoo()
    return MatrixFile(matrix.shape[0], entries.row, entries.col, entries.data, False)


def _stiffness(given: Any, table: Any) -> Any:
    material = given.material
    formulation = formulation_of(table.kind, table.rows.shape[1], material.program)
    elements = solid_elements(given.positions, table.rows, formulation)
    stiffness, _ = element_stiffness(elements, elasticity(material.young, material.poisson))
    return assembled(stiffness, table.rows, len(given.positions), 3)


def formulation_of(name: str, nodes: int, program: str = "") -> Formulation:
    """Return the formulation of the elements that a file calls `name`, "" where it has no such names.

    `program`: whose names these are, CCX, ABQ or "".  Raises FEFileFault for types of unknown matrices.
    """
    types = _OF_TYPE | _OF_PROGRAM[program or "CCX"]
    if name == "C3D8R":
        message = "C3D8R needs forces against hourglasses, which no file contains; use C3D8"
        raise FEFileFault(message, id="FE-070")
    if name and not types.get(name):
        known = ", ".join(one for one, formulation in types.items() if formulation)
        whose = " of Abaqus" if name in types else ""
        message = f"matrices cannot be assembled from elements of type {name}{whose}; known are {known}"
        raise FEFileFault(message, id="FE-083")
    name_of_formulation = types[name] if name else _OF_NODES[nodes]
    return next(one for one in FORMULATIONS[nodes] if one.name == name_of_formulation)


def _mass(given: Any, table: BodyTable) -> Any:
    rows, nodes = table.rows, table.rows.shape[1]
    points, weights = _mass_rule(nodes)
    shapes, slopes = shape_values(points, nodes), shape_slopes(points, nodes)
    elements = np.empty((len(rows), nodes, nodes))
    for part in parts(len(rows)):
        volumes = np.linalg.det(np.einsum("mki,gkj->mgij", given.positions[rows[part]], slopes)) * weights
        elements[part] = np.einsum("ga,gb,mg->mab", shapes, shapes, volumes, optimize=True)
    if given.material.lumped:
        elements = _lumped(elements)
    scalar = assembled(given.material.density * elements, rows, len(given.positions), 1)
    return in_three_directions(scalar)


def _lumped(elements: np.ndarray) -> np.ndarray:
    """Return element masses (m, k, k) with the sum of each row on the diagonal.  Raises FEFileFault."""
    nodes = elements.shape[1]
    if nodes not in (4, 8):
        raise FEFileFault(
            f"the mass of elements of {nodes} nodes is not lumped, nor is it in Abaqus: corners would get a "
            "negative mass; take CONS",
            id="FE-160",
        )
    return elements.sum(axis=2)[:, :, None] * np.eye(nodes)


def assembled_text(given: FlexibleInput, table: BodyTable) -> str:
    """Return what the matrices of `given` are made of, "" where files have them."""
    material = given.material
    if given.mass.form != OF_ELEMENTS or material is None:
        return ""
    program = "Abaqus" if material.program == "ABQ" else "CalculiX"
    types = f"{table.kind} of {program}, " if table.kind else ""
    return f"{types}{'lumped' if material.lumped else 'consistent'} mass"


def warn_of_types(given: FlexibleInput, table: BodyTable, findings: Findings) -> None:
    """Warn of matrices made of a type that programs understand differently, where the deck names none."""
    material = given.material
    if given.mass.form == OF_ELEMENTS and material and not material.program and table.kind == "C3D8":
        message = (
            "C3D8 is taken as in CalculiX, fully integrated; Abaqus averages its volumetric strain: write "
            "CCX or ABQ on a card ELMT to say which is meant"
        )
        findings.warn(given.name, message, material.place, id="FE-161")


def _mass_rule(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    points, weights = gauss_points(_MASS_POINTS[nodes])
    if nodes not in tetrahedra.COUNTS:
        return points, weights
    a, b, c = ((1 + points) / 2).T
    places = np.column_stack([a, b * (1 - a), c * (1 - a) * (1 - b)])
    return places, weights / 8 * (1 - a) ** 2 * (1 - b)


def shape_values(points: np.ndarray, nodes: int) -> np.ndarray:
    """Shape functions at natural coordinates, (points, nodes)."""
    if nodes in tetrahedra.COUNTS:
        return tetrahedra.shape_values(points, nodes)
    corners = np.prod(1 + points[:, None] * CUBE[:8], axis=-1) / 8
    if nodes == 8:
        return corners
    values = np.empty((len(points), 20))
    values[:, :8] = corners * ((points[:, None] * CUBE[:8]).sum(axis=-1) - 2)
    for a in range(8, 20):
        factors = np.where(CUBE[a] == 0, 1 - points**2, 1 + points * CUBE[a])
        values[:, a] = np.prod(factors, axis=-1) / 4
    return values
