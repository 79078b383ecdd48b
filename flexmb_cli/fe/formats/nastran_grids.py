"""Grid points of Nastran bulk data: GRID with the defaults of GRDSET, in the systems of CORD1x and CORD2x.

MSC Nastran Quick Reference Guide, GRID, GRDSET, CORD1C ... CORD2S.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .bulk_data import BulkCard, bulk_cards, integer_field, real_field
from .coordinate_systems import BASIC, CoordinateSystem, spanned
from .included_files import Line
from .node_table import Node

_CORDS = tuple(f"CORD{points}{type}" for points in "12" for type in "RCS")
# Fields of GRID behind its number and those that GRDSET gives where they are empty.
_CP, _X, _CD, _PS, _SEID = 1, 2, 5, 6, 7
_DEFAULTS = (_CP, _CD, _PS, _SEID)
# So many systems may be defined in one another.
DEEPEST_SYSTEM = 50


def grids(path: Path) -> Iterator[Node]:
    """Yield number, position and line of every grid point.  Raises FEFileFault."""
    cards = list(bulk_cards(path, ("GRID", "GRDSET", *_CORDS)))
    points = [card for card in cards if card.name == "GRID"]
    for card in cards:
        card.fields.extend([""] * 8)
    defaults = next((card.fields for card in cards if card.name == "GRDSET"), [""] * 8)
    for card in points:
        for i in _DEFAULTS:
            card.fields[i] = card.fields[i] or defaults[i]
    systems = _Systems(path, points, [card for card in cards if card.name in _CORDS])
    for card in points:
        node = integer_field(path, card, 0, "the number of the point")
        _check(node, card, systems.of(card, _CD, ()))
        yield node, systems.position(card, ()), Line(card.file, card.line, "")


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

    def __init__(self, path: Path, points: list[BulkCard], cards: list[BulkCard]) -> None:
        self.path, self.known = path, {0: BASIC}
        self.points = {card.fields[0]: card for card in points}
        firsts = [
            (card, i) for card in cards for i in (0, 4)[: 1 + (card.name[4] == "1" and card.fields[4] > "")]
        ]
        self.cards = {
            integer_field(path, card, i, "the number of the system"): (card, i) for card, i in firsts
        }

    def position(self, card: BulkCard, above: tuple[int, ...]) -> Any:
        """Return the position of a point, in basic coordinates."""
        system = self.of(card, _CP, above)
        values = [real_field(self.path, card, _X + i, "a coordinate") for i in range(3)]
        return values if system is BASIC else system.basic(values)

    def of(self, user: BulkCard, field: int, above: tuple[int, ...]) -> CoordinateSystem:
        """Return the system that a field of a card names; `above`: the systems that wait for it."""
        number = integer_field(self.path, user, field, "a coordinate system", 0)
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
                yield system.basic([real_field(self.path, card, i + k, "a coordinate") for k in range(3)])
            return
        for point in card.fields[first + 1 : first + 4]:
            if point not in self.points:
                raise card.card_fault(f"there is no GRID '{point}'", id="FE-175")
            yield self.position(self.points[point], above)
