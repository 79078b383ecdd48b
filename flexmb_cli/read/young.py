"""YOUNG decks: free-format numbers in the order of `young_sections`, exactly as many as are needed.

Liang Yong, YOUNG dissertation (1996), chapters 4 and 5, Appendix B.  What follows the last number is
never looked at, as in the historic program.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import islice

from ..errors import DeckError, Fault
from . import number
from .card import UNCLOSED, Word, end_of, words
from .deck import Deck, DeckText, Number, Record
from .line_custom import slips, with_slip_named
from .young_sections import BODIES, COUNTS, YOUNG_SECTIONS, Section

DIALECT = "young"
MOST_ERRORS = 1000
LONGEST_RECORD = max(len(section.columns) for section in YOUNG_SECTIONS)


def read_young(source: DeckText) -> Deck:
    """The deck's records with every number named and placed.

    Raises DeckError with all misspelt numbers, or for a deck that ends too early.
    """
    reading = _Reading(source)
    counts = _read_counts(reading)
    records = [counts, *_read_sections(reading, counts)]
    slipped = _slips_of(reading, counts)
    faults = _in_order([*reading.faults, *slipped])
    if reading.errors:
        raise DeckError(with_slip_named(faults, slipped))
    return Deck(DIALECT, source, tuple(records), tuple(faults), slipped)


@dataclass
class _Reading:
    """The words of a deck as they are taken, and the faults found on the way."""

    source: DeckText
    taken: list[Word] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    errors: int = 0

    def __post_init__(self):
        self.words = words(self.source.lines)

    def take(self, wanted: int) -> list[Word]:
        """The next `wanted` words, fewer at the end of the deck."""
        found = list(islice(self.words, min(wanted, sys.maxsize)))
        if found and found[-1].text == UNCLOSED:
            self.error(found.pop(), "", "a comment is opened here and never closed with }")
        self.taken += found
        return found

    def error(self, word: Word, subject: str, message: str):
        self.errors += 1
        self.faults.append(Fault("error", message, word.place, subject))

    def warn(self, word: Word, subject: str, message: str):
        self.faults.append(Fault("warning", message, word.place, subject))

    def early_end(self, subject: str, message: str):
        # An unclosed comment swallows the rest of the deck: its own fault says enough.
        if any("never closed" in fault.message for fault in self.faults):
            return
        self.errors += 1
        self.faults.append(Fault("error", message, end_of(self.source.lines), subject))


def _read_counts(reading):
    found = reading.take(len(COUNTS.columns))
    record = _record(reading, COUNTS, 0, found)
    if len(found) < len(COUNTS.columns):
        subject = "counts" if found else ""
        reading.early_end(subject, _too_few_counts(len(found)))
    for word, count in zip(found, record.numbers, strict=True):
        least = 1 if count.key == "NBODY" else 0
        if count.value is not None and count.value < least:
            reading.error(word, "counts", f"{count.key} must be at least {least}; read {count.value}")
    if reading.errors:
        raise DeckError(with_slip_named(reading.faults, _slip_of_counts(reading, record)))
    return record


def _too_few_counts(found):
    if not found:
        return "the deck is empty; a YOUNG deck begins with 12 integers"
    return f"the deck ends after {found} of the 12 counts"


def _read_sections(reading, counts):
    wanted = sum(size for _, size in _blocks(counts))
    found = reading.take(wanted)
    records, position = [], 0
    for section, number_of_record in _expected(counts):
        size = len(section.columns)
        chunk = found[position : position + size]
        position += size
        if reading.errors > MOST_ERRORS:
            break  # no deck at all, such as a text that begins with twelve integers
        if chunk:
            records.append(_record(reading, section, number_of_record, chunk))
        if len(chunk) < size:
            where = f"after {len(chunk)} of its {size} numbers" if chunk else "before it"
            message = (
                f"the deck ends {where}; by its counts the deck needs "
                f"{wanted + len(COUNTS.columns)} numbers, it has {len(reading.taken)}"
            )
            reading.early_end(_subject(section, number_of_record), message)
            break
    return records


def _expected(counts) -> Iterator[tuple[Section, int]]:
    """Every record that the counts announce, lazily: a small file may announce a trillion."""
    for section in YOUNG_SECTIONS[1:]:
        if section.count:
            for number_of_record in range(1, counts[section.count] + 1):
                yield section, number_of_record
        else:
            yield section, 0


def _blocks(counts):
    """Pairs (section, numbers in the whole section)."""
    for section in YOUNG_SECTIONS[1:]:
        yield section, len(section.columns) * (counts[section.count] if section.count else 1)


def labelled(record: Record) -> Record:
    """`record` with the meanings and units that its present direction gives the values behind it."""
    section = next((section for section in YOUNG_SECTIONS if section.name == record.section), None)
    if section is None:
        return record
    turning = any(n.key == "direction" and n.value in (4, 5, 6) for n in record.numbers)
    numbers = tuple(
        replace(number, meaning=column.label(turning)[0], unit=column.label(turning)[1])
        for column, number in zip(section.columns, record.numbers, strict=True)
    )
    return replace(record, numbers=numbers)


def _record(reading, section, number_of_record, found):
    subject = _subject(section, number_of_record)
    pairs = list(zip(section.columns, found, strict=False))
    values = [_value(reading, subject, column, word) for column, word in pairs]
    turning = _turns(section, values)
    numbers = tuple(
        Number(column.key, value, *column.label(turning), word.place, word.text)
        for (column, word), value in zip(pairs, values, strict=True)
    )
    return Record(section.name, number_of_record, subject, numbers)


def _value(reading, subject, column, word):
    try:
        value, doubt = number.integer(word.text) if column.is_integer else number.real(word.text)
    except number.Misspelt as fault:
        reading.error(word, subject, f"{column.key} {fault}")
        return None
    if doubt:
        reading.warn(
            word, subject, f"{column.key} {doubt}" if column.is_integer else f"{column.key}: {doubt}"
        )
    return value


def _turns(section, values):
    """Whether the record's direction is a rotation, so that its values are angles."""
    where = section.direction
    return where is not None and where < len(values) and values[where] in (4, 5, 6)


def _subject(section, number_of_record):
    return f"{section.subject} {number_of_record}" if number_of_record else section.subject


def _slips_of(reading, counts):
    """Slips, looked for only where the numbers needed do not end with a line: no other deck has any."""
    wanted = sum(size for _, size in _blocks(counts)) + len(COUNTS.columns)
    behind = _words_behind(reading)
    if len(reading.taken) == wanted and not behind:
        return ()
    # No record is empty, so the words taken bound the number of records worth listing.
    expected = islice(_expected(counts), len(reading.taken))
    sizes = [(_subject(section, k), len(section.columns)) for section, k in expected]
    return slips([*reading.taken, *behind], [(COUNTS.subject, len(COUNTS.columns)), *sizes])


def _words_behind(reading):
    """The rest of the last number's line and the next line; nothing when the number ends its line."""
    behind = list(islice(reading.words, 2 * LONGEST_RECORD))
    last = reading.taken[-1].line
    if not behind or behind[0].line != last:
        return []
    next_line = next((word.line for word in behind if word.line != last), last)
    return [word for word in behind if word.line in (last, next_line)]


def _slip_of_counts(reading, record):
    """The counts' own slip: judged by the body estimates that follow, which are 7 numbers a line."""
    reading.take(2 * len(BODIES.columns))
    bodies = [(f"body {k}", len(BODIES.columns)) for k in (1, 2)]
    first_lines = sorted({word.line for word in reading.taken})[:2]
    near = [word for word in reading.taken if word.line in first_lines]
    return slips(near, [(COUNTS.subject, len(COUNTS.columns)), *bodies], kept_per_slip=1)


def _in_order(faults):
    return sorted(faults, key=lambda fault: fault.place)
