"""Cards of elements that FMBD.DAT had before the block ELEMENTS: they are read to print the lines for it."""

from collections.abc import Iterator, Sequence

from ...deck.fortran_card import fortran_format
from ...deck.fortran_records import Item
from ...deck.record import Number, Record
from ...errors import Fault
from ..elements_block.old_cards import DAFMS_FORMATS, refused
from .card import Card


def old_card(word: str) -> Card | None:
    """Return the card of a word, its fields without names; None for other words."""
    if word not in DAFMS_FORMATS:
        return None
    head, tail, further = DAFMS_FORMATS[word]
    count = len(fortran_format(head).edits)
    items = tuple(Item(f"field {k}", "") for k in range(1, count + further + 1))
    return Card(word, word.lower(), "entries", head, items, tail, head=count if further else 0)


def refused_card(card: Card, entries: Sequence[Record], counts: dict[str, int]) -> Iterator[Fault]:
    """Refuse the entries of a card; `counts`: how many of each word the deck had before."""
    cards = [(record.numbers[0].place, [*_fields(card, record.numbers)]) for record in entries]
    return refused("dafms", card.word, cards, counts)


def _fields(card: Card, numbers: Sequence[Number]) -> Iterator[str]:
    """Spellings of numbers, with the point where a FORMAT implies it; not the count of a function's."""
    for k, number in enumerate(numbers):
        text = number.text.replace(" ", "") or "0"
        if not (card.word == "FUNC" and k == 2):
            yield text if isinstance(number.value, int) or "." in text else repr(number.value)
