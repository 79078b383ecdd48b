"""Records of a deck by section and number, with the zeros of the cards that were not given."""

from array import array
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from ..errors import Place
from .lazy import Made
from .number_table import column, places_by
from .record import Deck, Number, Record

if TYPE_CHECKING:
    import numpy as np

    from .many_records import Block


class DeckValues:
    """Look-up of a deck's records; a card that is not given leaves its defaults."""

    def __init__(self, deck: Deck):
        self.deck = deck
        self.many = not isinstance(deck.records, tuple)
        self._records: dict[str, dict[int, Record]] = {}
        for record in () if self.many else deck.records:
            self._records.setdefault(record.section, {})[record.number] = record
        self._of_bodies: dict[str, Mapping[int, array[int]]] = {}
        self._columns: dict[tuple[str, str], np.ndarray] = {}

    def section(self, name: str) -> Sequence[Record]:
        """All records of a section in the deck's order; empty when its card is not given."""
        if self.many:
            return self.deck.section(name)
        return list(self._records.get(name, {}).values())

    def record(self, section: str, number: int = 0) -> Record | None:
        """One record, None when its card is not given."""
        if self.many:
            found = self.deck.section(section)
            return cast("Block", found).numbered(number) if found else None
        return self._records.get(section, {}).get(number)

    def of_body(self, section: str, body: int) -> Sequence[Record]:
        """Return the records of a section whose first number is that of a body."""
        places = self.places_of_body(section, body)
        records = self.section(section) if len(places) else ()
        return Made(places, records.__getitem__) if self.many else [records[k] for k in places]

    def places_of_body(self, section: str, body: int) -> Sequence[int]:
        """Return where among the records of a section those of a body stand."""
        if section not in self._of_bodies:
            self._of_bodies[section] = places_by(self.section(section), "body")
        return self._of_bodies[section].get(body, ())

    def column(self, section: str, key: str) -> "np.ndarray":
        """Return the numbers (record,) that the records of a section have under a key."""
        if (section, key) not in self._columns:
            self._columns[section, key] = column(self.section(section), key)
        return self._columns[section, key]

    def number(self, section: str, number: int, key: str) -> Number:
        """One number of a card that must be there."""
        record = self.record(section, number)
        assert record is not None, f"{section} {number} must be there"
        return record.at(key)

    def values(self, section: str, number: int, default: tuple[Any, ...]) -> tuple[Any, ...]:
        """All values of a record, or `default`."""
        record = self.record(section, number)
        return default if record is None else tuple(record.values)

    def place(self, section: str, number: int = 0) -> Place | None:
        """Return where a record stands, None when it does not."""
        record = self.record(section, number)
        return record.place if record else None
