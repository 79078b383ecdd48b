"""The records of a large VSDF deck without errors: the line of each is known, and read again when needed."""

from array import array
from functools import partial
from typing import Any, cast

from ....deck.many_records import Block, ManyRecords
from ....deck.number_table import NumberTable
from ....deck.record import DeckText, Number, Record
from .. import fields
from ..card import Card
from ..cards import BY_WORD
from . import plain
from .one_card import CardReader

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
    numbers = plain.numbers(card, line, at) if plain.is_plain(card) else None
    if numbers is None:
        reader = CardReader(source)
        reader.at = at
        read = reader.read_card(card, line, card.columns, card.more)
        if card.second:
            read += reader.read_second(card)
        numbers = fields.with_own_keys(read)
    number = number_of(card, numbers[0], index + 1)
    return Record(card.section, number, card.subject.format(number), numbers)


def number_of(card: Card, head: Number, count: int) -> Any:
    """Return the number of a record, of its type the `count`-th, whose first number is `head`."""
    return {"single": 0, "list": count}.get(card.counted, head.value)
