"""Matrix files of a body, read; what is wrong with them is noted at the cards that name them."""

from collections.abc import Callable
from typing import Any

from ..model.diagnostics import Findings
from ..model.flexible_body import FEFile, FlexibleInput
from .elements.assembled_matrices import element_matrix
from .elements.body_elements import element_table
from .formats.formats import OF_ELEMENTS, read_matrix
from .formats.matrix_file import FEFileFault, MatrixFile


def matrix_file(given: Any, file: FEFile, letter: str, findings: Findings) -> MatrixFile | None:
    """The matrix of a file, or of the elements in its place; None with a fault noted."""
    mapping = given.mapping
    try:
        if file.form == OF_ELEMENTS:
            table = element_table(given, given.material.file, given.positions, findings)
            return element_matrix(given, table, letter) if table else None
        path, form = (mapping.path, mapping.form) if mapping else (None, "")
        return read_matrix(file.path, file.form, letter, path, form, file.matrix)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None


def arranged(
    given: FlexibleInput, file: FEFile, found: MatrixFile, arrange: Callable[..., Any], findings: Findings
) -> Any:
    """Return what `arrange` makes of name, matrix and numbers of nodes; None with a fault noted."""
    try:
        return arrange(file.path.name, found, given.numbers)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None
