"""Grid points of Nastran bulk data: GRID with the defaults of GRDSET, in the systems of CORD1x and CORD2x.

MSC Nastran Quick Reference Guide, GRID, GRDSET, CORD1C ... CORD2S.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .bulk_data import BulkCard, bulk_cards
from .node_table import BASIC, CoordinateSystem, Node, spanned

_CORDS = tuple(f"CORD{points}{type}" for points in "12" for type in "RCS")
# Fields of GRID behind its number and those that GRDSET gives where they are empty.
_CP, _X, _CD, _PS, _SEID = 1, 2, 5, 6, 7
_DEFAULTS = (_CP, _CD, _PS, _SEID)
# So many systems may be defined in one another.
DEEPEST_SYSTEM = 50


def grids(path: Path) -> Iterator[Node]:
    """Yield number, position and line of every grid point.  Raises FEFileFault."""
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
        _check(node, card, systems.of(card, _CD, ()))
        yield node, systems.position(card, ()), card.line


def _check(node: int, card: BulkCard, system: CoordinateSystem) -> None:
    """Refuse what turns a point's rows in matrices, or takes them out."""
    if system is not BASIC and (system.type != "R" or not np.allclose(system.axes, np.eye(3))):
        raise card.card_fault(f"{node}: the displacement must be in basic axes (CD)", id="FE-132")
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
