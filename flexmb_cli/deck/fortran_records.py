"""The records of a fixed-format deck in sequence: READ statements with located, collected faults."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from ..errors import Fault, FaultList, Place
from .fortran_card import Field, Format, cut, fortran_format, hint
from .number_list import LONG, NumberList
from .record import DeckText, Lines, Number


class Unreadable(Exception):
    """Reading cannot go on: the fault that stopped it is already noted."""


class MissingRecord(Exception):
    """A card stands where a data record is expected; it has not been consumed."""


@dataclass(frozen=True)
class Item:
    """One entry of an input list: the deck's name for it, what it means, its SI unit."""

    key: str
    meaning: str
    unit: str = ""


class Records:
    """The lines of `source` as a FORTRAN unit reads them, and the faults found on the way.

    `words` are the cards known by their first four columns: none of them can be a data record.
    """

    def __init__(self, source: DeckText, words: Iterable[str]):
        self.lines = _lines_before_end(source)
        self._count = len(self.lines)
        self._card = ""
        self.words = frozenset(words)
        self.line = 0
        self.faults: list[Fault] = FaultList()
        self.errors = 0

    @property
    def exhausted(self) -> bool:
        """Return whether all lines have been read."""
        return self.line == self._count

    def next_card(self) -> str:
        """The next line, whatever it holds."""
        if self.exhausted:
            raise EOFError
        self._card = self.lines[self.line]
        self.line += 1
        return self._card

    def word(self) -> str:
        """First four columns of the current card, padded with blanks."""
        return self._card[:4].ljust(4)

    def report(
        self,
        severity: str,
        subject: str,
        message: str,
        place: Place | None = None,
        guide: tuple[str, ...] = (),
        *,
        id: str,
    ) -> None:
        """Note a fault; without a place it stands at the current line's first column."""
        self.errors += severity == "error"
        self.faults.append(
            Fault(severity, message, place or Place(self.line, 1), subject, tuple(guide), id=id)
        )

    def stop(self, subject: str, message: str, place: Place | None = None, *, id: str) -> None:
        """Note an error that nothing can be read after."""
        self.report("error", subject, message, place, id=id)
        raise Unreadable

    def read(self, form: str, items: list[Item], subject: str) -> tuple[Number, ...]:
        """One READ: `items` in as many records as the FORMAT `form` needs, each from its own columns."""
        fmt = fortran_format(form)
        numbers: list[Number] = []
        while len(numbers) < len(items):
            batch = items[len(numbers) : len(numbers) + len(fmt.edits)]
            numbers += self._read_record(fmt, batch, subject)
        return tuple(numbers)

    def read_list(
        self, form: str, count: int, labelled: Callable[[int], tuple[str, str, str]], subject: str
    ) -> Sequence[Number]:
        """One READ of `count` numbers, whose key, meaning and unit `labelled` gives, counted from 0."""
        if count <= LONG:
            return self.read(form, [Item(*labelled(k)) for k in range(count)], subject)
        fmt = fortran_format(form)
        numbers = NumberList(self.lines, fmt, self.line + 1, labelled)
        while len(numbers) < count:
            reached = range(len(numbers), min(len(numbers) + len(fmt.edits), count))
            batch = [Item(*labelled(k)) for k in reached]
            numbers.values.extend(number.value for number in self._read_record(fmt, batch, subject))
        return numbers

    def check_index(self, index: Number, position: int, subject: str, rule: str) -> None:
        """The number that heads a record must be its position: DAFMS reads it and never looks at it."""
        if index.value == position:
            return
        if not index.text:
            message = f"the record's number is blank, taken as {position}"
            self.report("warning", subject, message, index.place, id="DECK-044")
            return
        message = f"the record is numbered {index.value}, expected {position}: {rule}"
        self.report("error", subject, message, index.place, id="DECK-045")

    def end_of_deck(self, subject: str, expected: str) -> Any:
        """Note that the deck ends where `expected` should stand, just after its last character."""
        last = len(self.lines)
        while last > 1 and not self.lines[last - 1]:
            last -= 1
        column = len(self.lines[last - 1]) + 1 if self.lines else 1
        self.stop(
            subject,
            f"unexpected end of the deck, expected {expected}",
            Place(max(last, 1), column),
            id="DECK-046",
        )

    def _read_record(self, fmt: Format, items: list[Item], subject: str) -> list[Number]:
        if self.exhausted:
            self.end_of_deck(subject, f"{_named(items)}; FORMAT({fmt.text})")
        line = self.next_card()
        if self.word() in self.words:
            message = f"card '{self.word()}' stands where {_named(items)} must stand; FORMAT({fmt.text})"
            self.report("error", subject, message, id="DECK-047")
            self.line -= 1
            raise MissingRecord
        card = _Card(self, fmt, line, len(items), subject)
        numbers = [card.number(field, item) for field, item in zip(card.fields, items, strict=True)]
        card.check_edges()
        card.check_rest()
        return numbers


class _Card:
    """One record being read: its fields, and the faults that are shown with its FORMAT and ruler."""

    def __init__(self, records: Records, fmt: Format, line: str, used: int, subject: str):
        self.records = records
        self.format = fmt
        self.line = line
        self.fields = [cut(line, edit) for edit in fmt.edits[:used]]
        self.subject = subject

    def number(self, field: Field, item: Item) -> Number:
        """The field's number; 0 with an error noted when it holds none."""
        value = field.value()
        place = Place(self.records.line, field.column, len(field.spelled) or 1)
        if value is None:
            self._report_bad(field, item, place)
            value = 0 if field.edit.letter == "I" else 0.0
        elif " " in field.spelled or field.implied_point:
            self._report_odd(field, item, place, value)
        return Number(item.key, value, item.meaning, item.unit, place, field.spelled)

    def _report(self, severity: str, message: str, place: Place, id: str) -> None:
        message = f"{message}; FORMAT({self.format.text})"
        guide = self.format.guide(len(self.fields))
        self.records.report(severity, self.subject, message, place, guide, id=id)

    def _report_bad(self, field: Field, item: Item, place: Place) -> None:
        kind = "an integer" if field.edit.letter == "I" else "a real number"
        reason = hint(field, self.line)
        reason = f" ({reason})" if reason else ""
        message = f"{item.key} in {field.span} must be {kind}, read '{field.spelled}'{reason}"
        self._report("error", message, place, id="DECK-005")

    def _report_odd(self, field: Field, item: Item, place: Place, value: float) -> None:
        why = "blanks inside a number are ignored" if " " in field.spelled else "no decimal point is typed"
        if field.implied_point:
            why += f", so {field.edit.descriptor} takes {field.edit.decimals} decimals"
        message = f"{item.key} in {field.span}: '{field.spelled}' is read as {value!r}: {why}"
        self._report("warning", message, place, id="DECK-048")

    def check_edges(self) -> None:
        """Warn of a number cut in two: it begins in one field and leaves blanks in the next.

        Fields that touch because the right one is full are usual in these decks.
        """
        for left, right in pairwise(self.fields):
            if left.raw[-1] == " " or right.raw[0] == " " or right.raw[-1] != " ":
                continue
            if left.value() is not None and right.value() is not None:
                message = (
                    f"'{left.spelled}' and '{right.spelled.split()[0]}' touch at column {right.edit.column}: "
                    "two numbers are read, one is typed?"
                )
                self._report("warning", message, Place(self.records.line, left.column), id="DECK-049")

    def check_rest(self) -> None:
        """Warn of numbers after the last column read; words there are the old decks' comments."""
        last = self.fields[-1].edit.last
        rest = self.line[last:].rstrip()
        if rest and not rest.strip(" 0123456789.+-EeDd"):
            column = last + 1 + len(rest) - len(rest.lstrip())
            message = f"'{rest.strip()}' stands after column {last} and is not read"
            place = Place(self.records.line, column, len(rest.strip()))
            self._report("warning", message, place, id="DECK-050")


def _named(items: list[Item]) -> str:
    """The keys of a list in words, a long one by its ends."""
    keys = [item.key for item in items]
    return ", ".join(keys) if len(keys) < 5 else f"{keys[0]} ... {keys[-1]}"


def _lines_before_end(source: DeckText) -> Sequence[str]:
    """The deck's lines up to the end of the file or to the Ctrl-Z that DOS editors put there."""
    text = source.text.partition("\x1a")[0]
    if text.endswith(("\n", "\r")):
        text = text[: -2 if text.endswith("\r\n") else -1]
        return Lines(text)
    return Lines(text) if text else []
