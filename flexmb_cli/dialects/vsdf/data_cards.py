"""Data cards of plain numbers, each read by one regular expression: the millions of a large deck are such.

A card with a word, a tab, a comment, a doubtful spelling or an empty field that must be filled is left to
`fields`, which also finds the faults.
"""

import functools
import math
import re
from array import array
from collections.abc import Iterator
from functools import partial
from typing import Any, cast

from ...deck.many_records import Block, ManyRecords, NumberTable
from ...deck.record import DeckText, Number, Record
from ...errors import Fault, Place
from . import fields
from .card import WIDTHS, Card, Column
from .cards import BY_WORD

# Never too long, too large or too small for a double.
_SPELT = {"I": "[+-]?[0-9]{1,15}", "F": r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,2})?"}
_LONGEST, _LONGEST_LIST = 250, 100_000  # characters
_WORD = re.compile("[^ ,]+")


def is_plain(card: Card) -> bool:
    """Return whether the data cards of a card may be plain: one line of numbers each."""
    return not card.second and all(column.letter in "IF" for column in card.columns)


def matched(card: Card, line: str) -> re.Match[str] | None:
    """Return the fields of a plain data card; None for one that is not plain."""
    free, fixed, width = _patterns(card.columns, card.more)
    if "," in line:
        return free.fullmatch(line) if len(line) <= (_LONGEST_LIST if card.more else _LONGEST) else None
    return None if card.more else fixed.fullmatch(line.ljust(width))


def values(match: re.Match[str]) -> list[float]:
    """Return the numbers of a data card that all cards of its type have, nan for empty fields."""
    return [float(text) if text else math.nan for text in match.groups()]


def numbers(card: Card, line: str, at: int) -> tuple[Number, ...] | None:
    """Return the numbers of the plain data card on line `at`, as `fields` finds them; None for others."""
    texts = matched(card, line)
    commas = line.count(",")
    if texts is None or (commas and None in texts.groups()[: commas + 1]):
        return None
    read = tuple(_numbers(card, texts, commas, Place(at, len(line) + 1)))
    return read + _further(card.more, texts, len(card.columns), at) if card.more else read


def _numbers(card: Card, match: re.Match[str], commas: int, end: Place) -> Iterator[Number]:
    for index, (column, text) in enumerate(zip(card.columns, match.groups(), strict=True), 1):
        if text is None:
            place = end if commas else Place(end.line, _first(card.columns, index))
            yield Number(column.key, column.default, column.meaning, column.unit, place, "")
        else:
            value = int(text) if column.letter == "I" else float(text)
            place = Place(end.line, match.start(index) + 1, len(text))
            yield Number(column.key, value, column.meaning, column.unit, place, text)


def _further(more: Column, match: re.Match[str], head: int, at: int) -> tuple[Number, ...]:
    """Return the numbers of a list, after the `head` ones; more than one get numbers after their key."""
    texts = list(_WORD.finditer(match.string, match.end(head)))
    keys = [f"{more.key}{k}" for k in range(1, len(texts) + 1)] if len(texts) > 1 else [more.key]
    read = int if more.letter == "I" else float
    return tuple(
        Number(
            key, read(text[0]), more.meaning, more.unit, Place(at, text.start() + 1, len(text[0])), text[0]
        )
        for key, text in zip(keys, texts, strict=True)
    )


def _first(columns: tuple[Column, ...], index: int) -> int:
    """Return the first character of a field of fixed form; both count from 1."""
    return 1 + sum(WIDTHS[column.letter] for column in columns[: index - 1])


@functools.cache
def _patterns(
    columns: tuple[Column, ...], more: Column | None
) -> tuple[re.Pattern[str], re.Pattern[str], int]:
    """Return the expressions of a data card with commas and in fixed form, and the width of the latter."""
    by_commas, by_columns, width = "", "", 0
    required = max((k for k, column in enumerate(columns) if column.default is None), default=0)
    for k, column in reversed(tuple(enumerate(columns))):
        further = f"(?:,{by_commas})" + ("?" if k >= required else "") if by_commas else ""
        by_commas = _field(column) + further
    if more:
        by_commas = f"{','.join(map(_field, columns))}(?:, *(?:{_SPELT[more.letter]}) *)+"
    for column in columns:
        width += WIDTHS[column.letter]
        by_columns += f"{_field(column)}(?<=^.{{{width}}})"
    return re.compile(by_commas), re.compile(by_columns), width


def _field(column: Column) -> str:
    return f" *({_SPELT[column.letter]}){'' if column.default is None else '?'} *"


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
                return line
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
        texts = fields.fields(line, columns, more)
        own_columns = [*columns, *([more] * (len(texts) - len(columns)))]
        numbers = [self._number(card, line, columns, *pair) for pair in zip(texts, own_columns, strict=True)]
        if more is None:
            self._check_rest(card, line, columns)
        elif len(texts) == len(columns) and more.default is None:
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
        """Words after the last field are a comment; numbers there were meant to be read."""
        extra = fields.rest(line, columns)
        text = extra.text
        if not text:
            return
        place = Place(self.at, extra.column, len(text))
        if NUMBERS.match(text):
            message = f"'{text}' stands after the last field and is not read"
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


_BY_SECTION = {card.section: card for card in BY_WORD.values()}


def many_records(
    source: DeckText, title: Record, starts: "dict[str, array[int]]", rows: "dict[str, array[float]]"
) -> ManyRecords:
    """Return that of the title and those whose lines and numbers `starts` and `rows` give by sections."""
    blocks = [Block("title", 1, [title].__getitem__)]
    for section, lines in starts.items():
        card = _BY_SECTION[section]
        # Cards of many records have columns of numbers alone.
        defaults = cast("dict[str, float]", {column.key: column.default for column in card.columns})
        table = NumberTable(defaults, rows[section]) if section in rows else None
        blocks.append(Block(section, len(lines), partial(_again, source, card, lines), table=table))
    return ManyRecords(blocks)


def _again(source: DeckText, card: Card, lines: Any, index: int) -> Record:
    """Return a record that was read without error before."""
    at = lines[index]
    line = source.lines[at - 1].rstrip()
    plain = numbers(card, line, at) if is_plain(card) else None
    if plain is None:
        reader = CardReader(source)
        reader.at = at
        read = reader.read_card(card, line, card.columns, card.more)
        if card.second:
            read += reader.read_second(card)
        plain = fields.with_own_keys(read)
    number = number_of(card, plain[0], index + 1)
    return Record(card.section, number, card.subject.format(number), plain)


def number_of(card: Card, head: Number, count: int) -> Any:
    """Return the number of a record, of its type the `count`-th, whose first number is `head`."""
    return {"single": 0, "list": count}.get(card.counted, head.value)
