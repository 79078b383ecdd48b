"""Decks of YOUNG's earlier version: 11 counts, no distance constraints, body estimates of three numbers.

IN1-4-3 of Appendix B (Liang Yong, YOUNG dissertation, 1996) is printed so.  Its echo says of the bodies
"ENTER INITIAL ESTIMATES OF X, Y, Z (E0=1,E1,E2,E3=0)".
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain, zip_longest
from typing import Any

from ...deck.many_records import ManyRecords
from ...deck.number import Misspelt, integer
from ...deck.record import Deck, Number, Record
from ...deck.words import Word
from ...errors import Fault
from .sections import BODIES, COUNTS, DISTANCES, YOUNG_SECTIONS, Section

POSITIONS = 3  # numbers of a body estimate
UNTURNED = (1.0, 0.0, 0.0, 0.0)
NOTE = (
    "the deck has 11 counts, as decks of YOUNG's earlier version: NSIMP2 is 0, and body estimates are x y z "
    "with Euler parameters 1 0 0 0"
)


def _earlier(section: Section) -> Section:
    if section is COUNTS:
        return replace(section, columns=tuple(c for c in section.columns if c.key != DISTANCES.count))
    return replace(section, columns=section.columns[:POSITIONS]) if section is BODIES else section


EARLIER_SECTIONS = tuple(_earlier(section) for section in YOUNG_SECTIONS if section is not DISTANCES)


def are_eleven_counts(texts: Sequence[str]) -> bool:
    """Return whether the words of a deck's first line are the counts of the earlier version."""
    if len(texts) != len(COUNTS.columns) - 1:
        return False
    try:
        for text in texts:
            integer(text)
    except Misspelt:
        return False
    return True


def lines_begin_records(words: Iterable[Word], sizes: Iterable[int], next_word: Word | None) -> bool:
    """Return whether every line begins with a record and the last number ends its line.

    A deck of 12 counts that has lost one does not look so: its body estimates have seven numbers.
    """
    line = 0
    for before, word in zip_longest(_within(sizes), words):
        if before is None or word is None or (before and word.line != line):
            return False
        line = word.line
    return next_word is None or next_word.line != line


def _within(sizes: Any) -> Iterator[Any]:
    """For every number of records in their order how many of its record stand before it."""
    return chain.from_iterable(range(size) for size in sizes)


def completed(deck: Deck) -> Deck:
    """Return the deck with the numbers that the final version reads, and a note."""
    records: Sequence[Record]
    if not isinstance(deck.records, ManyRecords):
        records = tuple(_completed(record) for record in deck.records)
    else:
        blocks = (replace(block, made=partial(_made, block.made)) for block in deck.records.blocks)
        records = ManyRecords(tuple(blocks))
    note = Fault("note", NOTE, deck.one("counts").place, "counts", id="YOUNG-022")
    return replace(deck, records=records, warnings=(*deck.warnings, note))


def _made(record_of: Any, index: int) -> Any:
    return _completed(record_of(index))


def _completed(record: Record) -> Record:
    return _COMPLETED[record.section](record) if record.section in _COMPLETED else record


def _with_distances(record: Record) -> Record:
    numbers = list(record.numbers)
    where = COUNTS.positions[DISTANCES.count]
    numbers.insert(where, _missing(COUNTS, where, 0, record))
    return Record(record.section, record.number, record.subject, tuple(numbers))


def _with_attitude(record: Record) -> Record:
    more = [_missing(BODIES, POSITIONS + k, e, record) for k, e in enumerate(UNTURNED)]
    return Record(record.section, record.number, record.subject, (*record.numbers, *more))


def _missing(section: Section, where: int, value: float, record: Record) -> Number:
    column = section.columns[where]
    return Number(column.key, value, column.meaning, column.unit, record.place, f"{value:g}")


_COMPLETED = {"counts": _with_distances, "body": _with_attitude}
