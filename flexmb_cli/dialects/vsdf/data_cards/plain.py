"""Data cards of plain numbers, each read by one regular expression: the millions of a large deck are such.

A card with a word, a tab, a comment, a doubtful spelling or an empty field that must be filled is left to
`fields`, which also finds the faults.
"""

import functools
import math
import re
from collections.abc import Iterator

from ....deck.record import Number
from ....errors import Place
from ..card import WIDTHS, Card, Column

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


def values(found: re.Match[str]) -> list[float]:
    """Return the numbers of a data card that all cards of its type have, nan for empty fields."""
    return [float(text) if text else math.nan for text in found.groups()]


def numbers(card: Card, line: str, at: int) -> tuple[Number, ...] | None:
    """Return the numbers of the plain data card on line `at`, as `fields` finds them; None for others."""
    found = matched(card, line)
    commas = line.count(",")
    if found is None or (commas and None in found.groups()[: commas + 1]):
        return None
    read = tuple(_numbers(card, found, commas, Place(at, len(line) + 1)))
    return read + _further(card.more, found, len(card.columns), at) if card.more else read


def _numbers(card: Card, found: re.Match[str], commas: int, end: Place) -> Iterator[Number]:
    for index, (column, text) in enumerate(zip(card.columns, found.groups(), strict=True), 1):
        if text is None:
            place = end if commas else Place(end.line, _first(card.columns, index))
            yield Number(column.key, column.default, column.meaning, column.unit, place, "")
        else:
            value = int(text) if column.letter == "I" else float(text)
            place = Place(end.line, found.start(index) + 1, len(text))
            yield Number(column.key, value, column.meaning, column.unit, place, text)


def _further(more: Column, found: re.Match[str], head: int, at: int) -> tuple[Number, ...]:
    """Return the numbers of a list, behind the `head` ones; more than one get numbers behind their key."""
    texts = list(_WORD.finditer(found.string, found.end(head)))
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
