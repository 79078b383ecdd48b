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
# Fields of GRID behind its number: CP, three coordinates, CD, PS, SEID.
_CP, _X, _CD, _PS, _SEID = 1, 2, 5, 6, 7
# So many systems may be defined in one another.
DEEPEST_SYSTEM = 50


def grids(path: Path) -> Iterator[Node]:
    """Yield number, position and line of every grid point.  Raises FEFileFault."""
    found = _Grids(path)
    for card in found.cards:
        node = integer_field(path, card, 0, "the number of the point")
        found.check(node, card)
        yield node, found.position(card, ()), Line(card.file, card.line, "")


class _Grids:
    """The GRID cards of a file, and the coordinate systems by their numbers."""

    def __init__(self, path: Path) -> None:
        cards = list(bulk_cards(path, ("GRID", "GRDSET", *_CORDS)))
        defaults = next((card for card in cards if card.name == "GRDSET"), None)
        self.path = path
        self.cards = [_completed(card, defaults) for card in cards if card.name == "GRID"]
        self.points = {card.field(0): card for card in self.cards}
        self.definitions: dict[int, tuple[BulkCard, int]] = {}  # and the first field
        self.systems = {0: BASIC}
        for card in cards:
            if card.name in _CORDS:
                for first in (0, 4) if card.name[4] == "1" and card.field(4) else (0,):
                    number = integer_field(path, card, first, "the number of the system")
                    self.definitions[number] = card, first

    def check(self, node: int, card: BulkCard) -> None:
        """Refuse what turns, holds or removes a point's rows in matrices."""
        system = self.system(integer_field(self.path, card, _CD, "a coordinate system", 0), card, ())
        if system.type != "R" or not np.allclose(system.axes, np.eye(3)):
            message = f"{node}: the displacement must be in basic axes (CD); write cards and matrices so"
            raise card.fault(message, id="FE-132")
        if set(card.field(_PS)) & set("123"):
            message = f"{node} is held by PS = {card.field(_PS)}; export the body free"
            raise card.fault(message, id="FE-170")
        if card.field(_SEID).strip("0"):
            raise card.fault(f"{node} is of superelement {card.field(_SEID)}; write one body", id="FE-171")

    def position(self, card: BulkCard, above: tuple[int, ...]) -> Any:
        """Return the position of a point, in basic coordinates."""
        system = self.system(integer_field(self.path, card, _CP, "a coordinate system", 0), card, above)
        values = [real_field(self.path, card, _X + i, "a coordinate") for i in range(3)]
        return values if system is BASIC else system.basic(values)

    def system(self, number: int, user: BulkCard, above: tuple[int, ...]) -> CoordinateSystem:
        """Return a system that the card `user` names; `above`: the systems that wait for it."""
        if number in self.systems:
            return self.systems[number]
        if number not in self.definitions:
            message = f"coordinate system {number} is on no card CORD1R ... CORD2S; add it"
            raise user.fault(message, id="FE-172")
        card, first = self.definitions[number]
        if number in above or len(above) > DEEPEST_SYSTEM:
            message = f"coordinate system {number} depends on itself, or on more than {DEEPEST_SYSTEM} others"
            raise card.fault(message, id="FE-173")
        a, b, c = map(np.array, self._span(card, first, (*above, number)))
        axes = spanned(b - a, c - a)
        if axes is None:
            raise card.fault(f"the points of system {number} lie on one line", id="FE-174")
        self.systems[number] = CoordinateSystem(card.name[5], a, axes[:, [1, 2, 0]])
        return self.systems[number]

    def _span(self, card: BulkCard, first: int, above: tuple[int, ...]) -> Iterator[Any]:
        """Yield origin, a point on the z axis and one in the plane of x and z, in basic coordinates."""
        if card.name[4] == "1":
            for i in range(first + 1, first + 4):
                if card.field(i) not in self.points:
                    raise card.fault(f"there is no GRID '{card.field(i)}'", id="FE-175")
                yield self.position(self.points[card.field(i)], above)
            return
        system = self.system(integer_field(self.path, card, 1, "a coordinate system", 0), card, above)
        for i in (2, 5, 8):
            yield system.basic([real_field(self.path, card, i + k, "a coordinate") for k in range(3)])


def _completed(card: BulkCard, defaults: BulkCard | None) -> BulkCard:
    """Return a GRID whose empty fields have what GRDSET gives; 0 there is no empty field."""
    if defaults is None:
        return card
    fields = [card.field(i) or defaults.field(i) * (i in (_CP, _CD, _PS, _SEID)) for i in range(8)]
    return card._replace(fields=fields)
