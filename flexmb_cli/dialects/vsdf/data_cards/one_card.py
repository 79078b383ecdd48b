"""One data card of a VSDF deck, and the card that completes it: their numbers and their faults."""

import re
from typing import Any

from ....deck.record import DeckText, Number
from ....errors import Fault, Place
from .. import fields
from ..card import WIDTHS, Card, Column

_MOST_FIELDS = 100_000  # each takes some hundred bytes while its card is read
_COMMENT = "*"
# A data card begins with a blank or a number, so that no keyword can be mistaken for one.
DATA = re.compile(r"[\s0-9+\-.,]")
NUMBERS = re.compile(r"[.,+\-]*[0-9][0-9.,+\-EeDd]*(?=\s|$)")


class CardReader:
    """The deck's lines, the one that is being read (`at`, from 1), and the faults so far."""

    def __init__(self, source: DeckText):
        self.lines = source.lines
        self.at = 0
        self.faults: list[Fault] = []

    def next(self) -> str | None:
        """Return the next line that is neither blank nor a comment; None at the end of the deck."""
        while self.at < len(self.lines):
            self.at += 1
            line = self.lines[self.at - 1].rstrip()
            if line and not line.startswith(_COMMENT):
                found: str | None = line
                return found
        return None

    def read_second(self, card: Card) -> list[Number]:
        """Return the numbers of the second card of a record, which must be a data card."""
        here = self.at
        line = self.next()
        if line is None or not DATA.match(line):
            self.at = here
            keys = f"{card.second[0].key} ... {card.second[-1].key}"
            place = Place(here, len(self.lines[here - 1].rstrip()) + 1)
            self.error(card.word, f"its second card, with {keys}, is missing", place, id="VSDF-165")
            return []
        return self.read_card(card, line, card.second, None)

    def read_card(self, card: Card, line: str, columns: Any, more: Column | None) -> list[Number]:
        """Return the numbers of a data card, without those that are faulty."""
        count = line.count(",") or len(line) // WIDTHS["I"]
        if more is not None and count > _MOST_FIELDS:
            message = f"a card has at most {_MOST_FIELDS} fields; continue on a further one"
            self.error(card.word, message, Place(self.at, 1), id="VSDF-166")
            return []
        found = fields.fields(line, columns, more)
        wanted = [*columns, *([more] * (len(found) - len(columns)))]
        numbers = [self._number(card, line, columns, *pair) for pair in zip(found, wanted, strict=True)]
        if more is None:
            self._check_rest(card, line, columns)
        elif len(found) == len(columns) and more.default is None:
            place = Place(self.at, len(line) + 1)
            self.error(card.word, f"the card names no {more.meaning}", place, id="VSDF-167")
        return [number for number in numbers if number is not None]

    def _number(
        self, card: Card, line: str, columns: tuple[Column, ...], field: Any, column: Column
    ) -> Number | None:
        place = Place(self.at, field.column, max(1, len(field.text)))
        try:
            value, warning = fields.value(field, column)
        except fields.Unfit as fault:
            self.error(card.word, str(fault), place, fields.guide(line, columns), id=fault.id)
            return None
        if warning:
            self.warn(card.word, warning, place, id="VSDF-082")
        return Number(column.key, value, column.meaning, column.unit, place, field.text)

    def _check_rest(self, card: Card, line: str, columns: tuple[Column, ...]) -> None:
        """Words behind the last field are a comment; numbers there were meant to be read."""
        extra = fields.rest(line, columns)
        text = extra.text
        if not text:
            return
        place = Place(self.at, extra.column, len(text))
        if NUMBERS.match(text):
            message = f"'{text}' stands behind the last field and is not read"
            self.error(card.word, message, place, fields.guide(line, columns), id="VSDF-168")
        elif fields.runs_over(line, columns, extra):
            message = (
                f"'{text}' touches the last field, which ends in column {extra.column - 1}: a comment needs "
                "a blank before it, a longer number the form with commas"
            )
            self.error(card.word, message, place, fields.guide(line, columns), id="VSDF-169")

    def error(
        self, subject: str, message: str, place: Place | None, guide: tuple[str, ...] = (), *, id: str
    ) -> None:
        """Note an error."""
        self.faults.append(Fault("error", message, place, subject, tuple(guide), id=id))

    def warn(self, subject: str, message: str, place: Place, *, id: str) -> None:
        """Note a warning."""
        self.faults.append(Fault("warning", message, place, subject, id=id))
