"""Matrix files of a body, read; what is wrong with them is noted at the cards that name them."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FEFile, FlexibleInput
from .elements.assembled_matrices import element_matrix
from .elements.body_elements import element_table
from .elements.structures import matrix_of_structures
from .formats.formats import OF_ELEMENTS, OF_STRUCTURES, read_matrix
from .formats.matrix_file import TRANSLATIONS, FEFileFault, MatrixFile
from .interface_nodes import labels_of, tied

MODAL_ROWS = 1000  # beside those of nodes that matrices of damping and geometric stiffness may leave empty


def matrix_file(given: Any, file: FEFile, letter: str, findings: Findings) -> MatrixFile | None:
    """The matrix of a file, or of the elements in its place; None with a fault noted."""
    whole = given.whole or given
    try:
        matrix = _matrix(whole, file, letter, findings)
        if matrix and letter == "K":
            matrix = replace(matrix, values=matrix.values * given.stiffness_factor)
        if matrix and letter == "M" and given.nodal_masses:
            matrix = _with_nodal_masses(matrix, whole)
        return matrix and tied(matrix, whole)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None


def _matrix(given: Any, file: FEFile, letter: str, findings: Findings) -> MatrixFile | None:
    """The matrix of all nodes that the files have; None with a fault noted.  Raises FEFileFault."""
    if file.form == OF_STRUCTURES:
        return matrix_of_structures(given.material, letter)
    if file.form == OF_ELEMENTS:
        table = element_table(given, given.material.file, given.positions, findings)
        return element_matrix(given, table, letter) if table else None
    path, form = (given.mapping.path, given.mapping.form) if given.mapping else (None, "")
    # A few dampers leave most rows empty, an axial force all others.
    empty = 6 * len(given.numbers) + MODAL_ROWS if letter in "BG" else 0
    return read_matrix(file.path, file.form, letter, path, form, file.matrix, empty)


def _with_nodal_masses(matrix: MatrixFile, given: FlexibleInput) -> MatrixFile:
    """Return the mass matrix with what the deck adds to nodes.  Raises FEFileFault."""
    row_of = {label: row for row, label in enumerate(labels_of(matrix, given))}
    places, values = [], []
    for node, mass in given.nodal_masses:
        rows = [row_of.get((node, component)) for component in TRANSLATIONS]
        if None in rows:
            message = f"node {node} has no three displacements in the mass matrix, and cannot have a mass"
            raise FEFileFault(message, id="FE-335")
        places += rows
        values += [mass] * len(rows)
    return replace(
        matrix,
        rows=np.append(matrix.rows, np.array(places, np.int64)),
        columns=np.append(matrix.columns, np.array(places, np.int64)),
        values=np.append(matrix.values, values),
    )


def arranged(
    given: FlexibleInput, file: FEFile, matrix: MatrixFile, arrange: Callable[..., Any], findings: Findings
) -> Any:
    """Return what `arrange` makes of name, matrix and numbers of nodes; None with a fault noted."""
    try:
        return arrange(file.path.name, matrix, given.numbers)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None
