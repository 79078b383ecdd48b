"""The fields of one data card: cut by columns, or by commas where the card has one."""

import functools
import re
from collections import Counter
from typing import NamedTuple

from ...deck import number
from ...deck.record import Number
from .card import WIDTHS, Column

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")  # of a function
_NAMES = {"I": "an integer", "F": "a number", "A": "a word", "T": "a file name"}


class Field(NamedTuple):
    """Content of a field, and the field's place."""

    text: str  # without the blanks around it
    column: int  # of the first character of the text, from 1
    first: int = 0  # first column of a field of fixed form
    last: int = 0  # its last column, 0 where text continues
    number: int = 0  # of a field by commas, from 1

    @property
    def span(self) -> str:
        """The field's place in words."""
        if self.number:
            return f"field {self.number}"
        return f"columns {self.first}-{self.last}" if self.last else f"column {self.first} on"


class Unfit(ValueError):
    """The field's text is not what the card wants there; `id` is the fault's."""

    def __init__(self, message: str, id: str):
        super().__init__(message)
        self.id = id


def is_free(line: str, columns: tuple[Column, ...]) -> bool:
    """Return whether a card is in free form: it has a comma before any file name."""
    text = any(column.letter == "T" for column in columns)
    head = line[: _edges(columns)[-1][0] - 1] if text else line
    return "," in head


def fields(line: str, columns: tuple[Column, ...], more: Column | None = None) -> list[Field]:
    """The fields of `line`, as many as there are columns, and as many more as `more` finds filled."""
    if is_free(line, columns):
        texts = _cut_by_commas(line, columns)
    else:
        texts = [_cut(line, first, last) for first, last in _edges(columns)]
        if more:
            texts += _cut_on(line, _edges(columns)[-1][1], WIDTHS[more.letter])
    if more is None:
        return texts[: len(columns)]
    while len(texts) > len(columns) and not texts[-1].text:
        texts.pop()
    return texts


def rest(line: str, columns: tuple[Column, ...]) -> Field:
    """Return what stands after the last field of a card."""
    if is_free(line, columns):
        if line.count(",") < len(columns):
            return Field("", len(line) + 1)
        extra = _cut_by_commas(line, columns)[len(columns) :]
        return next((field for field in extra if field.text), Field("", len(line) + 1))
    last = _edges(columns)[-1][1]
    return _cut(line, last + 1, len(line)) if 0 < last < len(line) else Field("", len(line) + 1)


def runs_over(line: str, columns: tuple[Column, ...], extra: Field) -> bool:
    """Return whether what stands after the last field of a card in fixed form continues without a blank."""
    return not is_free(line, columns) and extra.column > 1 and not line[extra.column - 2].isspace()


def value(field: Field, column: Column) -> tuple[float | int | str, str]:
    """The field's value and a warning, "" for none.  Raises Unfit."""
    if not field.text:
        if column.default is None:
            message = f"{column.key} in {field.span} must be {_NAMES[column.letter]}; the field is empty"
            raise Unfit(message, id="VSDF-182")
        return column.default, ""
    if column.names and NAME.fullmatch(field.text):
        return field.text, ""
    if column.letter in "IF":
        return _numeral(field, column)
    if column.letter == "A":
        return _word(field, column)
    return field.text, ""


def _numeral(field: Field, column: Column) -> tuple[float, str]:
    read = number.integer if column.letter == "I" else number.real
    if " " in field.text:
        raise Unfit(
            f"{column.key} in {field.span} must be {_NAMES[column.letter]}; read '{field.text}': "
            "two numbers in one field? fields are cut by column, or by commas",
            id="VSDF-183",
        )
    if "\t" in field.text:
        message = f"{column.key} in {field.span}: a tab counts as one column; use blanks or commas"
        raise Unfit(message, id="VSDF-184")
    try:
        value, warning = read(field.text)
    except number.Misspelt as fault:
        raise Unfit(f"{column.key} in {field.span} {fault}", id="VSDF-081") from None
    return value, f"{column.key}: {warning}" if warning else ""


def _word(field: Field, column: Column) -> tuple[str, str]:
    word = field.text.upper()
    if word not in column.words:
        raise Unfit(
            f"{column.key} in {field.span} must be one of {', '.join(column.words)}; "
            f"read {number.shown(field.text)}",
            id="VSDF-185",
        )
    return word, ""


def guide(line: str, columns: tuple[Column, ...]) -> tuple[str, ...]:
    """Two lines to set above a card in fixed form: its fields and a ruler of their columns."""
    if is_free(line, columns):
        return ()
    picture = ""
    for column, (first, _) in zip(columns, _edges(columns), strict=True):
        name = f"{column.letter}{WIDTHS[column.letter] or ''}"
        width = max(WIDTHS[column.letter], len(name) + 2)
        picture = picture.ljust(first - 1) + "[" + name.ljust(width - 2, "-") + "]"
    ruler = "".join(f"----+----{tens}" for tens in range(1, len(picture) // 10 + 2))
    return picture, ruler[: len(picture)]


@functools.cache
def _edges(columns: tuple[Column, ...]) -> tuple[tuple[int, int], ...]:
    """First and last column of each field; text continues to the end of the line, marked by 0."""
    edges, first = [], 1
    for column in columns:
        first += column.skip
        width = WIDTHS[column.letter]
        edges.append((first, first + width - 1 if width else 0))
        first += width
    return tuple(edges)


def _cut(line: str, first: int, last: int) -> Field:
    raw = line[first - 1 : last] if last else line[first - 1 :]
    text = raw.strip()
    column = first + (len(raw) - len(raw.lstrip()) if text else 0)
    return Field(text, column, first, last)


def _cut_on(line: str, last: int, width: int) -> list[Field]:
    """Fields of equal width from column `last` + 1 to the end of the line."""
    count = -(-max(0, len(line.rstrip()) - last) // width)
    return [_cut(line, last + 1 + i * width, last + (i + 1) * width) for i in range(count)]


def _cut_by_commas(line: str, columns: tuple[Column, ...]) -> list[Field]:
    pieces, first = [], 1
    limit = len(columns) - 1 if columns[-1].letter == "T" else -1
    for index, raw in enumerate(line.split(",", limit), start=1):
        text = raw.strip()
        column = first + (len(raw) - len(raw.lstrip()) if text else 0)
        pieces.append(Field(text, column, number=index))
        first += len(raw) + 1
    missing = range(len(pieces) + 1, len(columns) + 1)
    return pieces + [Field("", len(line) + 1, number=index) for index in missing]


def with_own_keys(numbers: list[Number]) -> tuple[Number, ...]:
    """Fields that repeat get a number after their key, so that every number has its own name."""
    keys = [number.key for number in numbers]
    if len(set(keys)) == len(keys):
        return tuple(numbers)
    named: list[Number] = []
    counts: dict[str, int] = {}
    repeated = Counter(keys)
    for own in numbers:
        if repeated[own.key] > 1:
            counts[own.key] = counts.get(own.key, 0) + 1
            key = f"{own.key}{counts[own.key]}"
            own = Number(key, own.value, own.meaning, own.unit, own.place, own.text)
        named.append(own)
    return tuple(named)
