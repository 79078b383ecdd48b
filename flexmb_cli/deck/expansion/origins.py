"""Origins of the lines of an expanded deck, and of what stands in them for variables."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from ...errors import Fault, Place
from .expressions import Formula


class Origin(NamedTuple):
    """A line as it was read."""

    file: str  # path of the included file, "" for the deck itself
    line: int  # from 1
    text: str  # without its end
    code: str  # the same, comments being blank


class Piece(NamedTuple):
    """A number in the place of a variable or formula of the text."""

    line: int  # of the expanded text, from 1
    column: int  # of its first character there, from 1
    text: str  # the number
    origin: int  # column of the variable in its line as it was read
    width: int  # of the variable there
    formula: Formula  # that gives it
    aligned: bool  # whether the line's columns have stayed


@dataclass(frozen=True)
class Expansion:
    """The origin of an expanded text.

    `origins`: of each line, and of the lines SET and INCLUDE after them, which the text does not have;
    `definitions`: formulas of the variables; `places`: of their lines, from 1 among `origins`; `values`,
    `pieces`: of the variables, and what stands for them, once the text has them.
    """

    origins: tuple[Origin, ...]
    definitions: Mapping[str, Formula] = field(default_factory=dict[str, Formula], compare=False)
    places: Mapping[str, Place] = field(default_factory=dict[str, Place], compare=False)
    faults: tuple[Fault, ...] = ()  # of the statements
    values: Mapping[str, float] = field(default_factory=dict[str, float], compare=False)
    pieces: tuple[Piece, ...] = field(default=(), compare=False)

    def located(self, place: Place) -> tuple[str, Place, str]:
        """Return file, place and line, as they were read, of a place in the text."""
        if not 1 <= place.line <= len(self.origins):
            return "", place, ""
        origin, shift = self.origins[place.line - 1], 0
        for piece in self.pieces:
            if piece.line == place.line and place.column >= piece.column:
                if place.column < piece.column + len(piece.text):
                    return origin.file, Place(origin.line, piece.origin, piece.width), origin.text
                shift = piece.origin + piece.width - piece.column - len(piece.text)
        return origin.file, place._replace(line=origin.line, column=place.column + shift), origin.text
