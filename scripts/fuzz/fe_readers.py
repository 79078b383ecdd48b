"""The readers of finite-element files by name, and what they may say in answer."""

import struct
import warnings
from collections.abc import Callable
from pathlib import Path

from flexmb_cli.fe.formats.calculix import read_calculix, read_dofs
from flexmb_cli.fe.formats.connectivity import read_elements
from flexmb_cli.fe.formats.couplings import read_coupling
from flexmb_cli.fe.formats.formats import read_matrix
from flexmb_cli.fe.formats.harwell_boeing import read_harwell_boeing, read_mapping
from flexmb_cli.fe.formats.matrix_file import FEFileFault
from flexmb_cli.fe.formats.nastran import row_order
from flexmb_cli.fe.formats.node_table import read_node_table


def read_couplings(path: Path, form: str) -> None:
    """Read what the file couples to node 1, rigidly, and in the mean."""
    for rigid in (True, False):
        read_coupling(path, form, 1, rigid)


READERS: dict[str, Callable[[Path], object]] = {
    **{
        f"matrix {form}": lambda p, form=form: read_matrix(p, form, "K")
        for form in ("MM", "ABQ", "DMIG", "OP4", "FEM")
    },
    "matrix HB": read_harwell_boeing,
    "matrix CCX": read_calculix,
    "mapping ANS": read_mapping,
    "mapping CCX": read_dofs,
    "mapping BDF": row_order,
    **{f"couplings {form}": lambda p, form=form: read_couplings(p, form) for form in ("INP", "BDF")},
    **{
        f"nodes {form}": lambda p, form=form: read_node_table(p, form)
        for form in ("TXT", "CDB", "INP", "BDF", "FEM")
    },
    **{f"bricks {form}": lambda p, form=form: read_elements(p, form) for form in ("CDB", "INP", "BDF")},
}


def read_file(reader: str, path: Path) -> str:
    """What the reader says of the file at `path`, "" when it is content; any other exception is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            READERS[reader](path)
        except FEFileFault as refused:
            return str(refused)
    return ""


def op4_record(integers, payload: bytes = b"", order: str = "<", reported: int | None = None) -> bytes:
    """A FORTRAN record between its lengths, which are `told` when they shall lie."""
    body = struct.pack(f"{order}{len(integers)}i", *integers) + payload
    length = struct.pack(f"{order}i", len(body) if reported is None else reported)
    return length + body + length
