"""Nastran matrices as DMIG cards, by grid point and component.

MSC Nastran Quick Reference Guide, DMIG.  pyNastran reads them too, but cannot stand beside numpy 2.
"""

from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np

from .bulk_data import BulkCard, bulk_cards
from .file_text import digits_in
from .matrix_file import FEFileFault, MatrixFile, NamedMatrix, chosen, labelled, mirrored

_SYMMETRIC, _SQUARE = 6, (1, 2)
_REAL = (1, 2)
# So many values show how many digits all have.
_MANY_VALUES = 50_000


def read_dmig(path: Path, letter: str, wanted: str = "") -> MatrixFile:
    """The DMIG matrix `wanted` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    cards: dict[str, list[BulkCard]] = {}
    for card in bulk_cards(path, ("DMIG",)):
        cards.setdefault(card.fields[0].upper(), []).append(card)
    if not cards:
        raise FEFileFault(f"{path.name} holds no DMIG card", id="FE-042")
    matrices = [
        NamedMatrix(name, _is_usable(found[0]), partial(_matrix, path, name, found))
        for name, found in cards.items()
    ]
    return chosen(path.name, matrices, letter, wanted)


def _is_usable(header: BulkCard) -> bool:
    return header.fields[2] in map(str, (_SYMMETRIC, *_SQUARE)) and header.fields[3] in map(str, _REAL)


def _matrix(path: Path, name: str, cards: list[BulkCard]) -> MatrixFile:
    header, *columns = cards
    symmetric = _check_header(name, header)
    entries: list[tuple[int, int, int, int]] = []
    values: list[float] = []
    for card in columns:
        if card.fields[1] == "0":
            message = f"DMIG {name} begins again, after line {header.line.number}; keep one of the two"
            raise card.line.fault(message, id="FE-204")
        _read_column(card, entries, values)
    where = np.array(entries, dtype=np.int64).reshape(-1, 4)
    found = labelled(where, np.array(values), True if symmetric else None)
    entry, counts = np.unique(where, axis=0, return_counts=True)
    if (counts > 1).any():
        row, row_direction, column, direction = entry[counts.argmax()]
        raise FEFileFault(
            f"{path.name}: DMIG {name} repeats entries, such as that of {row}, {row_direction} with "
            f"{column}, {direction}; give each once",
            id="FE-195",
        )
    both = mirrored(found.rows, found.columns, found.size)
    if symmetric and len(both):
        row, row_direction, column, direction = where[both[0]]
        raise FEFileFault(
            f"{path.name}: DMIG {name} is of form 6 and has both triangles, such as the entry of {row}, "
            f"{row_direction} with {column}, {direction} and its mirror image; give one triangle, or form 1",
            id="FE-205",
        )
    # Fields of fixed width may touch the ones before, which have integers.
    fields = islice((text for card in columns for text in card.fields[6::4]), _MANY_VALUES)
    return replace(found, digits=digits_in("\n".join(fields).encode()))


def _check_header(name: str, header: BulkCard) -> bool:
    if header.integer(1, "the 0 of a header", -1) != 0:
        raise header.line.fault(f"DMIG {name} begins without its header card", id="FE-119")
    form = header.integer(2, "the form of the matrix")
    if form != _SYMMETRIC and form not in _SQUARE:
        message = f"DMIG {name} has form {form}; 6 (symmetric) or 1 (square) wanted"
        raise header.line.fault(message, id="FE-120")
    if header.integer(3, "the type of the matrix") not in _REAL:
        raise header.line.fault(f"DMIG {name} is complex; real wanted", id="FE-121")
    return form == _SYMMETRIC


def _read_column(card: BulkCard, entries: list[tuple[int, int, int, int]], values: list[float]) -> None:
    """One column: fields of four, the first with the column's point and component."""
    node = card.integer(1, "a grid point")
    component = card.integer(2, "a component")
    for first in range(4, len(card.fields), 4):
        if not card.fields[first]:
            continue
        row = card.integer(first, "a grid point")
        row_component = card.integer(first + 1, "a component")
        value = card.real(first + 2, "a value")
        if value and not {component, row_component} <= {1, 2, 3}:
            _refuse(card, row, row_component, node, component)
        if component in (1, 2, 3) and row_component in (1, 2, 3):
            entries.append((row, row_component, node, component))
            values.append(value)


def _refuse(card: BulkCard, row: int, row_component: int, node: int, component: int) -> None:
    point, wrong = (node, component) if component not in (1, 2, 3) else (row, row_component)
    if wrong == 0:
        message = f"scalar point {point} is a coordinate of a condensed model; full matrices are wanted"
    else:
        message = f"grid point {point} has rotations (component {wrong}); mesh with solid elements"
    raise card.line.fault(message, id="FE-122")
