"""The formats of matrix files by their words in decks, and what reads them."""

import re
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from .file_text import bytes_of, printed_digits
from .matrix_file import FEFileFault, MatrixFile, size_hint


class MatrixFormat(NamedTuple):
    """A format of matrices."""

    reader: str  # "module:function" of this folder: (path) or (path, letter, name)
    mapping: str = ""  # format of the equation mapping that it needs beside the matrix, "" for none
    by_name: bool = False  # whether a file may hold several matrices with names


# The form of files of modes in place of matrices.
OF_MODES = "FEM"
MATRIX_FORMATS = {
    "MM": MatrixFormat("matrix_market:read_matrix_market"),
    "HB": MatrixFormat("harwell_boeing:read_harwell_boeing", mapping="ANS"),
    "CCX": MatrixFormat("calculix:read_calculix", mapping="CCX"),
    "ABQ": MatrixFormat("abaqus:read_abaqus", by_name=True),
    "DMIG": MatrixFormat("nastran:read_dmig", by_name=True),
    "OP4": MatrixFormat("nastran_op4:read_op4", by_name=True),
    OF_MODES: MatrixFormat("mbdyn_fem:read_modal_matrix", by_name=True),
}
# Readers of equation mappings: (path).
MAPPING_FORMATS = {
    "ANS": "harwell_boeing:read_mapping",
    "CCX": "calculix:read_dofs",
    "BDF": "nastran:row_order",
}
# Formats that a mapping may or must stand beside; rows of DMIG always have nodes and directions.
TAKES_MAPPING = tuple(form for form in MATRIX_FORMATS if form not in ("DMIG", OF_MODES))
# The forms of a "file" that stands for the elements themselves: solid ones, or beams and shells.
OF_ELEMENTS, OF_STRUCTURES = "MESH", "SHELL"
# Node tables that may hold elements, too.
FORMS_WITH_ELEMENTS = ("INP", "CDB", "BDF")
# What reads the lines of files that may include others: (path).
INCLUDING = {"INP": "abaqus_input:lines", "BDF": "bulk_data:lines", "DMIG": "bulk_data:lines"}


def read_matrix(
    path: Path,
    form: str,
    letter: str,
    mapping: Path | None = None,
    mapping_form: str = "",
    name: str = "",
    empty: int = 0,
) -> MatrixFile:
    """Return the matrix at `path` in format `form`; `mapping` gives the nodes and directions of its rows.

    `name`, or without one `letter` (M, K, G for a geometric stiffness, B for viscous damping), selects a
    matrix where a file holds several.  Raises FEFileFault, also for a declared size that no free body with
    these entries can have, unless it is at most `empty`: the size determines how much memory is taken.
    """
    matrix = _read(path, form, (letter, name), mapping, mapping_form)
    if matrix.size > max(len(matrix.values), empty):
        message = f"{matrix.size} rows and {len(matrix.values)} entries: a body has no rows without entries"
        raise FEFileFault(f"{path.name} has {message}", id="FE-030")
    return replace(matrix, digits=matrix.digits or printed_digits(path))


def content_of(path: Path, form: str) -> bytes:
    """Return what a file and those that it includes hold.  Raises FEFileFault."""
    raw = bytes_of(path)
    if form not in INCLUDING or not re.search(rb"\bIN(CLUDE|PUT)\b", raw, re.IGNORECASE):
        return raw
    return "\n".join(line.text for line in _reader(INCLUDING[form])(path)).encode()


def _read(
    path: Path, form: str, which: tuple[str, str], mapping: Path | None, mapping_form: str
) -> MatrixFile:
    known, name = MATRIX_FORMATS[form], which[1]
    if known.mapping and (mapping is None or mapping_form != known.mapping):
        message = f"format {form} needs the equation mapping: add a card FEMP of format {known.mapping}"
        raise FEFileFault(message, id="FE-031")
    if name and not known.by_name:
        message = f"matrices of format {form} have no names; remove {name} from card FEMX"
        raise FEFileFault(message, id="FE-197")
    is_mapped = mapping_form and form in TAKES_MAPPING
    equations = _reader(MAPPING_FORMATS[mapping_form])(mapping) if is_mapped else None
    matrix: MatrixFile = _reader(known.reader)(path, *which[: 2 * known.by_name])
    if mapping is None or equations is None or matrix.equations is not None:
        return matrix
    if matrix.size != len(equations):
        message = f"{path.name} has {matrix.size} rows and the mapping {mapping.name} {len(equations)}"
        raise FEFileFault(message + size_hint(matrix.size, len(equations) / 3), id="FE-199")
    return replace(matrix, equations=equations)


def _reader(reference: str) -> Callable[..., Any]:
    """Return what reads a format; a run imports the readers of its files only."""
    module, _, name = reference.partition(":")
    return getattr(import_module(f"{__package__}.{module}"), name)
