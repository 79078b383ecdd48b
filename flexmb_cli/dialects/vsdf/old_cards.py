"""Cards of elements that VSDF decks had before the block ELEMENTS: they are cut to print the lines for it."""

from collections.abc import Iterator, Sequence

from ...errors import Fault, Place
from ..elements_block.old_cards import VSDF_FIELDS, refused
from .card import Column
from .fields import fields


def refused_cards(word: str, lines: Sequence[tuple[Place, str]], counts: dict[str, int]) -> Iterator[Fault]:
    """Refuse data cards of a word; `counts`: how many of each word the deck had before."""
    return refused("vsdf", word, [(place, fields_of(word, line)) for place, line in lines], counts)


def fields_of(word: str, line: str) -> list[str]:
    """Return the fields of a data card."""
    columns = tuple(Column("", "", letter=letter, skip=letter == "A") for letter in VSDF_FIELDS[word])
    return [field.text for field in fields(line, columns, Column("", "") if word == "FUNC" else None)]
