"""Card of FMBD.DAT: its fields, formats and meanings."""

from dataclasses import dataclass

from ...deck.fortran_records import Item


@dataclass(frozen=True)
class Card:
    """A card: its word (four columns), the section of its records, FORMAT and list of one record.

    `layout` is how many records follow: "bodies" N, each headed by the body's number; "list" one
    list over all bodies; "coordinates", "state" a list over the coordinates; "single" one record;
    "switch" none; "entries" a count, then so many entries.  Of those the first `head` items
    stand in `format`, the others in `tail`; without a head all do, and `tail` is that of a list.
    """

    word: str
    section: str
    layout: str
    format: str = ""
    items: tuple[Item, ...] = ()
    tail: str = ""
    head: int = 0
