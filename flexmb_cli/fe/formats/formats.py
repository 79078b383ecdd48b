"""The matrix formats by their names in the deck."""

from pathlib import Path
from typing import Any

from ...quick_dataclass import replace
from .file_text import printed_digits
from .matrix_file import FEFileFault, MatrixFile

# The mapping that a format needs beside the matrix itself.
NEEDS_MAPPING = {"HB": "ANS", "CCX": "CCX"}
# The form of a "file" that stands for the elements themselves.
OF_ELEMENTS = "MESH"
# Node tables that may hold elements, too.
FORMS_WITH_ELEMENTS = ("INP", "CDB", "BDF")


def read_matrix(
    path: Path, form: str, letter: str, mapping: Path | None = None, mapping_form: str = ""
) -> MatrixFile:
    """The matrix at `path` in format `form`; `letter` (M or K) tells which, where a file holds several.

    Raises FEFileFault, also where a size is declared that no free body with these entries has: memory is
    taken by the size.
    """
    found = _read(path, form, letter, mapping, mapping_form)
    if found.size > len(found.values):
        message = f"{found.size} rows and {len(found.values)} entries: rows without any are no body's"
        raise FEFileFault(f"{path.name} has {message}", id="FE-030")
    return replace(found, digits=printed_digits(path))


def _read(path: Path, form: str, letter: str, mapping: Path | None, mapping_form: str) -> MatrixFile:
    if form in NEEDS_MAPPING:
        if mapping is None or mapping_form != NEEDS_MAPPING[form]:
            raise FEFileFault(
                f"format {form} needs the equation mapping: add a card FEMP of format {NEEDS_MAPPING[form]}",
                id="FE-031",
            )
        return _matrix_reader(form)(path, _mapping_reader(mapping_form)(mapping))
    letters = (letter,) if form in ("DMIG", "OP4") else ()
    return _matrix_reader(form)(path, *letters)


def _matrix_reader(form: Any) -> Any:
    """Return what reads a format; a run imports the readers of its files only."""
    if form == "HB":
        from .harwell_boeing import read_harwell_boeing

        return read_harwell_boeing
    if form == "CCX":
        from .calculix import read_calculix

        return read_calculix
    if form == "DMIG":
        from .nastran import read_dmig

        return read_dmig
    if form == "OP4":
        from .nastran_op4 import read_op4

        return read_op4
    if form == "MM":
        from .matrix_market import read_matrix_market

        return read_matrix_market
    from .abaqus import read_abaqus

    return read_abaqus


def _mapping_reader(form: Any) -> Any:
    """Return what reads the mapping of a format."""
    if form == "ANS":
        from .harwell_boeing import read_mapping

        return read_mapping
    from .calculix import read_dofs

    return read_dofs
