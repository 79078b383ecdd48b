"""The matrix formats by their names in the deck."""

from pathlib import Path

from .abaqus import read_abaqus
from .calculix import read_calculix, read_dofs
from .harwell_boeing import read_harwell_boeing, read_mapping
from .matrix_file import FEFileFault, MatrixFile
from .matrix_market import read_matrix_market
from .nastran import read_dmig
from .nastran_op4 import read_op4

# The mapping that a format needs beside the matrix itself.
NEEDS_MAPPING = {"HB": "ANS", "CCX": "CCX"}
_MAPPINGS = {"ANS": read_mapping, "CCX": read_dofs}


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


def _read(path: Path, form: str, letter: str, mapping: Path | None, mapping_form: str) -> MatrixFile:
    if form in NEEDS_MAPPING:
        if mapping is None or mapping_form != NEEDS_MAPPING[form]:
            raise FEFileFault(
                f"format {form} needs the equation mapping: add a card FEMP of format {NEEDS_MAPPING[form]}",
                id="FE-031",
            )
        reader = read_harwell_boeing if form == "HB" else read_calculix
        return reader(path, _MAPPINGS[mapping_form](mapping))
    if form in ("DMIG", "OP4"):
        return (read_dmig if form == "DMIG" else read_op4)(path, letter)
    return (read_matrix_market if form == "MM" else read_abaqus)(path)
