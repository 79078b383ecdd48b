"""The matrix formats by their names in the deck."""

import importlib
from pathlib import Path

from .matrix_file import FEFileFault, MatrixFile

# The mapping that a format needs beside the matrix itself.
NEEDS_MAPPING = {"HB": "ANS", "CCX": "CCX"}
# The form of a "file" that stands for the elements themselves.
OF_ELEMENTS = "MESH"
# Module and function that reads a format; a run imports those of its files.
_MATRICES = {
    "HB": ("harwell_boeing", "read_harwell_boeing"),
    "CCX": ("calculix", "read_calculix"),
    "DMIG": ("nastran", "read_dmig"),
    "OP4": ("nastran_op4", "read_op4"),
    "MM": ("matrix_market", "read_matrix_market"),
    "ABQ": ("abaqus", "read_abaqus"),
}
_MAPPINGS = {"ANS": ("harwell_boeing", "read_mapping"), "CCX": ("calculix", "read_freedoms")}


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
    return found


def _read(path, form, letter, mapping, mapping_form) -> MatrixFile:
    if form in NEEDS_MAPPING:
        if mapping is None or mapping_form != NEEDS_MAPPING[form]:
            raise FEFileFault(
                f"format {form} needs the equation mapping: add a card FEMP of format {NEEDS_MAPPING[form]}",
                id="FE-031",
            )
        return _reader(*_MATRICES[form])(path, _reader(*_MAPPINGS[mapping_form])(mapping))
    letters = (letter,) if form in ("DMIG", "OP4") else ()
    return _reader(*_MATRICES[form])(path, *letters)


def _reader(module: str, function: str):
    return getattr(importlib.import_module(f".{module}", __package__), function)
