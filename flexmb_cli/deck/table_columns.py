"""The sections of a YOUNG OUT table and their columns, as its reader and `diff` name them."""

from dataclasses import dataclass
from typing import Any

from .edit import Edit, fixed


@dataclass(frozen=True)
class Columns:
    """The columns of a section: names as in the title, types as `diff` names them, decimals printed.

    `width`: characters of a field.
    """

    item: str
    names: tuple[str, ...]
    kinds: tuple[str, ...]
    decimals: tuple[int, ...]
    width: int

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The fields of the columns."""
        return tuple(fixed(self.width, number) for number in self.decimals)


def _columns(item: str, width: int, *groups: Any) -> Columns:
    """Groups (type, names, decimals) side by side."""
    names = tuple(name for _, words, _ in groups for name in words.split())
    kinds = tuple(kind for kind, words, _ in groups for _ in words.split())
    decimals = tuple(number for _, _, numbers in groups for number in numbers)
    return Columns(item, names, kinds, decimals, width)


# Decimals of Appendix B of the YOUNG dissertation: w-x and w-y have two, the points four.
SECTIONS = {
    "position": _columns(
        "body", 10, ("position", "X Y Z", (3, 3, 3)), ("euler", "e0 e1 e2 e3", (3, 3, 3, 3))
    ),
    "velocity": _columns(
        "body",
        7,
        ("velocity", "dX dY dZ", (3, 3, 3)),
        ("euler_rate", "de0 de1 de2 de3", (3, 3, 3, 3)),
        ("omega", "w-x w-y w-z", (2, 2, 3)),
    ),
    "acceleration": _columns(
        "body",
        7,
        ("acceleration", "ddX ddY ddZ", (3, 3, 3)),
        ("euler_acceleration", "dde0 dde1 dde2 dde3", (3, 3, 3, 3)),
        ("alpha", "dw-x dw-y dw-z", (3, 3, 3)),
    ),
    "point": _columns(
        "point",
        8,
        ("point_position", "X Y Z", (4, 4, 4)),
        ("point_velocity", "dX dY dZ", (4, 4, 4)),
        ("point_acceleration", "ddX ddY ddZ", (4, 4, 4)),
    ),
}
HEADINGS = {"POSITION": "position", "VELOCITY": "velocity", "ACCELERATION": "acceleration", "POINTS": "point"}
# The oldest listings (OUT1-4-3) print two decimals everywhere.
OLD_DECIMALS = 2
