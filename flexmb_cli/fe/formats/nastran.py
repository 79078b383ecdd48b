"""Nastran matrices as DMIG cards, by grid point and component.

MSC Nastran Quick Reference Guide, DMIG.  pyNastran reads them too, but cannot stand beside numpy 2.
"""

from pathlib import Path
from typing import Any

import numpy as np

from .bulk_data import BulkCard, bulk_cards, integer_field, real_field
from .file_text import line_fault
from .matrix_file import FEFileFault, MatrixFile, labelled

_SYMMETRIC, _SQUARE = 6, (1, 2)
_REAL = (1, 2)


def read_dmig(path: Path, letter: str) -> MatrixFile:
    """The DMIG matrix at `path`; of several the one whose name begins with `letter` (M or K)."""
    matrices: dict[str, list[Any]] = {}
    for card in bulk_cards(path, ("DMIG",)):
        name = card.fields[0].upper()
        matrices.setdefault(name, []).append(card)
    if not matrices:
        raise FEFileFault(f"{path.name} holds no DMIG card", id="FE-042")
    name = chosen(path, list(matrices), letter)
    header, *columns = matrices[name]
    symmetric = _check_header(path, name, header)
    entries: list[tuple[int, int, int, int]] = []
    values: list[float] = []
    for card in columns:
        _read_column(path, card, entries, values)
    where = np.array(entries, dtype=np.int64).reshape(-1, 4)
    return labelled(where, np.array(values), True if symmetric else None)


def chosen(path: Path, names: list[str], letter: str) -> str:
    """The only name, or the only one that begins with `letter`."""
    fitting = [name for name in names if name.startswith(letter)]
    if len(names) == 1:
        return names[0]
    if len(fitting) != 1:
        raise FEFileFault(
            f"{path.name} holds the matrices {', '.join(names)}; exactly one must begin with {letter}",
            id="FE-043",
        )
    return fitting[0]


def _check_header(path: Path, name: str, header: BulkCard) -> bool:
    if integer_field(path, header, 1, "the 0 of a header", -1) != 0:
        raise line_fault(path.name, header.line, f"DMIG {name} begins without its header card", id="FE-119")
    form = integer_field(path, header, 2, "the form of the matrix")
    if form != _SYMMETRIC and form not in _SQUARE:
        message = f"DMIG {name} has form {form}; 6 (symmetric) or 1 (square) wanted"
        raise line_fault(path.name, header.line, message, id="FE-120")
    if integer_field(path, header, 3, "the type of the matrix") not in _REAL:
        raise line_fault(path.name, header.line, f"DMIG {name} is complex; real wanted", id="FE-121")
    return form == _SYMMETRIC


def _read_column(
    path: Path, card: BulkCard, entries: list[tuple[int, int, int, int]], values: list[float]
) -> None:
    """One column: fields of four, the first with the column's point and component."""
    node = integer_field(path, card, 1, "a grid point")
    component = integer_field(path, card, 2, "a component")
    for first in range(4, len(card.fields), 4):
        if not card.fields[first]:
            continue
        row = integer_field(path, card, first, "a grid point")
        row_component = integer_field(path, card, first + 1, "a component")
        value = real_field(path, card, first + 2, "a value")
        if value and not {component, row_component} <= {1, 2, 3}:
            _refuse(path, card, row, row_component, node, component)
        if component in (1, 2, 3) and row_component in (1, 2, 3):
            entries.append((row, row_component, node, component))
            values.append(value)


def _refuse(path: Any, card: BulkCard, row: int, row_component: int, node: int, component: int) -> None:
    point, wrong = (node, component) if component not in (1, 2, 3) else (row, row_component)
    if wrong == 0:
        message = f"scalar point {point} is a coordinate of a condensed model; full matrices are wanted"
    else:
        message = f"grid point {point} has rotations (component {wrong}); mesh with solid elements"
    raise line_fault(path.name, card.line, message, id="FE-122")
