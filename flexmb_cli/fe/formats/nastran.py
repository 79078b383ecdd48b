"""Nastran matrices as DMIG cards, by grid point and component, grid points, and the order of rows.

MSC Nastran Quick Reference Guide, DMIG.  pyNastran reads them too, but cannot stand beside numpy 2.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from .bulk_data import BulkCard, bulk_cards
from .file_text import digits_in
from .matrix_file import MODAL, FEFileFault, MatrixFile, NamedMatrix, check_labels, chosen, labelled, mirrored
from .node_table import BASIC, CoordinateSystem, Node, spanned

_SYMMETRIC, _SQUARE = 6, (1, 2)
_REAL = (1, 2)
# So many values show how many digits all have.
_MANY_VALUES = 50_000


def read_dmig(path: Path, letter: str, title: str = "") -> MatrixFile:
    """The DMIG matrix `title` at `path`, or the one that `letter` (M K G) means.  Raises FEFileFault."""
    cards: dict[str, list[BulkCard]] = {}
    scalars: list[range] = []
    for card in bulk_cards(path, ("DMIG", "SPOINT")):
        if card.name == "SPOINT":
            scalars += _scalar_points(card)
        else:
            cards.setdefault(card.fields[0].upper(), []).append(card)
    if not cards:
        raise FEFileFault(f"{path.name} holds no DMIG card", id="FE-042")
    matrices = [
        NamedMatrix(name, _is_usable(columns[0]), partial(_matrix, path, name, columns, scalars))
        for name, columns in cards.items()
    ]
    return chosen(path.name, matrices, letter, title)


def _is_usable(header: BulkCard) -> bool:
    return header.fields[2] in map(str, (_SYMMETRIC, *_SQUARE)) and header.fields[3] in map(str, _REAL)


def _scalar_points(card: BulkCard) -> list[range]:
    """Return the scalar points that a card SPOINT names, one by one or from the first to the last."""
    fields = [field for field in card.fields if field]
    if len(fields) == 3 and fields[1].upper() == "THRU":
        first, last = (card.integer(i, "a scalar point") for i in (0, 2))
        return [range(first, last + 1)]
    numbers = [card.integer(i, "a scalar point") for i, field in enumerate(card.fields) if field]
    return [range(number, number + 1) for number in numbers]


def _matrix(path: Path, name: str, cards: list[BulkCard], scalars: list[range]) -> MatrixFile:
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
    for points in scalars:  # the component of a scalar point is 0, or 1 as well
        where[:, 1::2][(where[:, ::2] >= points.start) & (where[:, ::2] < points.stop)] = MODAL
    matrix = labelled(where, np.array(values), True if symmetric else None)
    entry, counts = np.unique(where, axis=0, return_counts=True)
    if (counts > 1).any():
        row, row_direction, column, direction = entry[counts.argmax()]
        raise FEFileFault(
            f"{path.name}: DMIG {name} repeats entries, such as that of {row}, {row_direction} with "
            f"{column}, {direction}; give each once",
            id="FE-195",
        )
    both = mirrored(matrix.rows, matrix.columns, matrix.size)
    if symmetric and len(both):
        row, row_direction, column, direction = where[both[0]]
        raise FEFileFault(
            f"{path.name}: DMIG {name} is of form 6 and has both triangles, such as the entry of {row}, "
            f"{row_direction} with {column}, {direction} and its mirror image; give one triangle, or form 1",
            id="FE-205",
        )
    # Fields of fixed width may touch the ones before, which have integers.
    fields = islice((text for card in columns for text in card.fields[6::4]), _MANY_VALUES)
    return replace(matrix, digits=digits_in("\n".join(fields).encode()))


def _check_header(name: str, header: BulkCard) -> bool:
    if header.integer(1, "the 0 of a header", -1) != 0:
        raise header.line.fault(f"DMIG {name} begins without its header card", id="FE-119")
    form = header.integer(2, "the form of the matrix")
    if form != _SYMMETRIC and form not in _SQUARE:
        message = f"DMIG {name} has form {form}; expected 6 (symmetric) or 1 (square)"
        raise header.line.fault(message, id="FE-120")
    if header.integer(3, "the type of the matrix") not in _REAL:
        raise header.line.fault(f"DMIG {name} is complex; it must be real", id="FE-121")
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
        values.append(card.real(first + 2, "a value"))
        entries.append((row, row_component, node, component))
        for point, number in ((node, component), (row, row_component)):
            if not 0 <= number <= 6:
                message = f"component {number} of point {point}: expected 1 to 6, or 0 at a scalar point"
                raise card.line.fault(message, id="FE-122")


def row_order(path: Path) -> np.ndarray:
    """Node and component of every row of an external superelement, (size, 2), in the order of card EXTRN.

    MSC Nastran Quick Reference Guide, EXTRN: pairs of a point and its components, 0 of a scalar point.
    Matrices that EXTSEOUT writes to OP4 files have their rows so.
    """
    rows = [
        (card.integer(i, "a grid point"), int(digit))
        for card in bulk_cards(path, ("EXTRN",))
        for i in range(0, len(card.fields), 2)
        if card.fields[i]
        for digit in _components(card, i + 1)
    ]
    if not rows:
        message = "holds no card EXTRN, which gives the order of the rows; name the .pch or .asm of EXTSEOUT"
        raise FEFileFault(f"{path.name} {message}", id="FE-250")
    equations = np.array(rows, dtype=np.int64)
    check_labels(path.name, equations, "; EXTRN names each row once")
    return equations


def _components(card: BulkCard, field: int) -> str:
    """Return the digits of the components in a field of the card."""
    text = card.field(field) or "0"
    if text != "0" and (set(text) - set("123456") or len(set(text)) < len(text)):
        raise card.card_fault(f"expected components such as 123456, or 0; read '{text}'", id="FE-251")
    return text


_CORDS = tuple(f"CORD{points}{type}" for points in "12" for type in "RCS")
# Fields of GRID after its number and those that GRDSET gives where they are empty.
_CP, _X, _CD, _PS, _SEID = 1, 2, 5, 6, 7
_DEFAULTS = (_CP, _CD, _PS, _SEID)
# So many systems may be defined in one another.
DEEPEST_SYSTEM = 50


def grids(path: Path) -> Iterator[Node]:
    """Yield number, position, line, and turned displacement axes of every grid point.  Raises FEFileFault."""
    points, systems = [], _Systems()
    for card in bulk_cards(path, ("GRID", "GRDSET", *_CORDS)):
        card.fields.extend([""] * 8)
        if card.name == "GRID":
            points.append(card)
            systems.points[card.fields[0]] = card
        else:
            systems.define(card)
    defaults = systems.cards.pop("GRDSET", (None, 0))[0]
    for card in points if defaults else ():
        for i in _DEFAULTS:
            card.fields[i] = card.fields[i] or defaults.fields[i]
    for card in points:
        node = card.integer(0, "the number of the point")
        _check(node, card)
        position, system = systems.position(card, ()), systems.of(card, _CD, ())
        axes = None if system is BASIC else system.axes_at(np.array(position))
        turned = axes is not None and not np.allclose(axes, np.eye(3))
        yield (node, position, card.line, axes) if turned else (node, position, card.line)


def _check(node: int, card: BulkCard) -> None:
    """Refuse what takes a point's rows out of matrices."""
    if set(card.fields[_PS]) & set("123"):
        raise card.card_fault(f"{node} is held by PS = {card.fields[_PS]}; export the body free", id="FE-170")
    if card.fields[_SEID].strip("0"):
        raise card.card_fault(f"{node} is of superelement {card.fields[_SEID]}; write one body", id="FE-171")


class _Systems:
    """Coordinate systems by their numbers, and what defines the others: points and cards."""

    def __init__(self) -> None:
        self.known = {0: BASIC}
        self.points: dict[str, BulkCard] = {}
        self.cards: dict[Any, tuple[Any, int]] = {}  # with the first field of the system

    def define(self, card: BulkCard) -> None:
        """Keep a card, which may define two systems.  Raises FEFileFault for another one of that number."""
        for i in (0, 4)[: 1 + (card.name[:5] == "CORD1" and card.fields[4] > "")]:
            number = "GRDSET" if card.name == "GRDSET" else card.integer(i, "the number of the system")
            other = self.cards.setdefault(number, (card, i))[0]
            if other.fields != card.fields:
                message = f"it differs from the one on line {other.line.number}; keep one of the two"
                raise card.card_fault(message, id="FE-196")

    def position(self, card: BulkCard, above: tuple[int, ...]) -> Any:
        """Return the position of a point, in basic coordinates."""
        system = self.of(card, _CP, above)
        values = [card.real(_X + i, "a coordinate") for i in range(3)]
        return values if system is BASIC else system.basic(values)

    def of(self, user: BulkCard, field: int, above: tuple[int, ...]) -> CoordinateSystem:
        """Return the system that a field of a card names; `above`: the systems that wait for it."""
        number = user.integer(field, "a coordinate system", 0)
        if number not in self.known:
            if number not in self.cards:
                message = f"coordinate system {number} is on no card CORD1R ... CORD2S; add it"
                raise user.card_fault(message, id="FE-172")
            card, first = self.cards[number]
            if number in above or len(above) > DEEPEST_SYSTEM:
                message = (
                    f"coordinate system {number} depends on itself, or on more than {DEEPEST_SYSTEM} others"
                )
                raise card.card_fault(message, id="FE-173")
            a, b, c = map(np.array, self.span(card, first, (*above, number)))
            axes = spanned(b - a, c - a)
            if axes is None:
                raise card.card_fault(f"the points of system {number} lie on one line", id="FE-174")
            self.known[number] = CoordinateSystem(card.name[5], a, axes[:, [1, 2, 0]])
        return self.known[number]

    def span(self, card: BulkCard, first: int, above: tuple[int, ...]) -> Iterator[Any]:
        """Yield origin, a point on the z axis and one in the plane of x and z, in basic coordinates."""
        if card.name[4] == "2":
            system = self.of(card, 1, above)
            for i in (2, 5, 8):
                yield system.basic([card.real(i + k, "a coordinate") for k in range(3)])
            return
        for point in card.fields[first + 1 : first + 4]:
            if point not in self.points:
                raise card.card_fault(f"there is no GRID '{point}'", id="FE-175")
            yield self.position(self.points[point], above)
