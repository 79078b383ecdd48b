"""YOUNG decks: free-format numbers in the order of `young_sections`, exactly as many as are needed.

Liang Yong, YOUNG dissertation (1996), chapters 4 and 5, Appendix B.  What follows the last number is
never looked at, as in the historic program.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import islice
from typing import Any

from ...deck import many_records, number
from ...deck.many_records import Block, ManyRecords
from ...deck.record import Deck, DeckText, Number, Record
from ...deck.shifted_lines import slips, with_slip_named
from ...deck.words import UNCLOSED, Word, Words, end_of
from ...errors import DeckError, Fault, FaultList, Place
from .eleven_counts import EARLIER_SECTIONS, are_eleven_counts, completed, lines_begin_records
from .sections import BODIES, COUNTS, YOUNG_SECTIONS, Section


def relabelled(record: Record, key: str) -> Record:
    """Return `record` after a change of the number `key`: a direction gives the values after it units."""
    return labelled(record) if key == "direction" else record


def labelled(record: Record) -> Record:
    """`record` with the meanings and units that its present direction gives the values after it."""
    section = next((section for section in YOUNG_SECTIONS if section.name == record.section), None)
    if section is None:
        return record
    turning = any(n.key == "direction" and n.value in (4, 5, 6) for n in record.numbers)
    return record.with_numbers(
        replace(number, meaning=column.label(turning)[0], unit=column.label(turning)[1])
        for column, number in zip(section.columns, record.numbers, strict=True)
    )


class ReadRecord(Record):
    """A record of a deck; what is more of its numbers than their values is made when it is looked at."""

    _section: Section
    _words: Words
    _first: int  # word

    def __init__(self, section: Section, number: int, values: tuple[Any, ...], words: Words, first: int):
        vars(self).update(
            section=section.name, number=number, subject=subject_of(section, number), made={}, values=values,
            positions=section.positions, _section=section, _words=words, _first=first,
        )  # fmt: skip

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        """The numbers with their places."""
        return tuple(map(self._number, range(len(self.values))))

    @property
    def place(self) -> Place | None:
        """Place of the first number."""
        return self._words[self._first].place

    def at(self, key: str) -> Number:
        """The number called `key`."""
        return self._number(self.positions[key])

    def _number(self, k: int) -> Number:
        word, column = self._words[self._first + k], self._section.columns[k]
        meaning, unit = column.label(is_rotation(self._section, self.values))
        return Number(column.key, self.values[k], meaning, unit, word.place, word.text)


def is_rotation(section: Section, values: Sequence[float]) -> bool:
    """Return whether the record's direction is a rotation, so that its values are angles."""
    where = section.direction
    return where is not None and where < len(values) and values[where] in (4, 5, 6)


def subject_of(section: Section, number_of_record: int) -> str:
    """Name of a record in messages: "body 1"."""
    return f"{section.subject} {number_of_record}" if number_of_record else section.subject


DIALECT = "young"
MOST_ERRORS = 1000
LONGEST_RECORD = max(len(section.columns) for section in YOUNG_SECTIONS)


def read_young(source: DeckText) -> Deck:
    """The deck's records with every number named and placed.

    Raises DeckError with all misspelt numbers, or for a deck that ends too early.
    """
    reading = _Reading(source, YOUNG_SECTIONS)
    if are_eleven_counts(_words_of_first_line(reading.words)):
        with suppress(DeckError):
            return _read_earlier(source)
    return _read(reading)


def _words_of_first_line(words: Words) -> list[str]:
    """The words of the first line that has any, no more than a few of them."""
    words.reach(len(COUNTS.columns))
    few = list(words.upto(len(COUNTS.columns)))
    return [word.text for word in few if word.line == few[0].line and word.text != UNCLOSED]


def _read_earlier(source: DeckText) -> Deck:
    """The deck as one of the earlier version; raises DeckError when it is none."""
    reading = _Reading(source, EARLIER_SECTIONS)
    deck = _read(reading)
    reading.words.reach(reading.taken + 1)
    next_word = reading.words[reading.taken] if len(reading.words) > reading.taken else None
    sizes = (len(record.values) for record in deck.records)
    if not lines_begin_records(reading.words.upto(reading.taken), sizes, next_word):
        raise DeckError(
            [Fault("error", "its lines do not begin with records of the earlier version", id="YOUNG-055")]
        )
    return completed(deck)


def _read(reading: "_Reading") -> Deck:
    counts = _read_counts(reading)
    records = _read_sections(reading, counts)
    slipped = _slips_of(reading, counts)
    faults = _in_order([*reading.faults, *slipped, *([] if slipped else _numbers_left_over(reading))])
    if reading.errors:
        raise DeckError(with_slip_named(faults, slipped))
    return Deck(DIALECT, reading.source, records, tuple(faults), slipped)


@dataclass
class _Reading:
    """The words of a deck as they are taken, and the faults found on the way."""

    source: DeckText
    sections: tuple[Section, ...]
    taken: int = 0
    faults: list[Fault] = field(default_factory=FaultList)
    errors: int = 0

    def __post_init__(self) -> None:
        self.words = Words(self.source.lines)

    def take(self, count: int) -> range:
        """Places of the next `count` words, fewer at the end of the deck."""
        first = self.taken
        self.words.reach(first + count)
        self.taken = min(first + count, len(self.words))
        if self.taken > first and self.words[self.taken - 1].text == UNCLOSED:
            self.taken -= 1
            self.error(
                self.words[self.taken], "", "a comment is opened here and never closed with }", id="YOUNG-169"
            )
            self.words.drop_last()
        return range(first, self.taken)

    def error(self, word: Word, subject: str, message: str, *, id: str) -> Any:
        self.errors += 1
        self.faults.append(Fault("error", message, word.place, subject, id=id))

    def warn(self, word: Word, subject: str, message: str, *, id: str) -> None:
        self.faults.append(Fault("warning", message, word.place, subject, id=id))

    def early_end(self, subject: str, message: str, *, id: str) -> None:
        # An unclosed comment swallows the rest of the deck: its own fault says enough.
        if any("never closed" in fault.message for fault in self.faults):
            return
        self.errors += 1
        self.faults.append(Fault("error", message, end_of(self.source.lines), subject, id=id))


def _read_counts(reading: _Reading) -> ReadRecord:
    section = reading.sections[0]
    words = reading.take(len(section.columns))
    record = _record(reading, section, 0, words)
    if len(words) < len(section.columns):
        _report_few_counts(reading, len(words))
    for place, count in zip(words, record.numbers, strict=True):
        least = 1 if count.key == "NBODY" else 0
        if count.value is not None and count.value < least:
            message = f"{count.key} must be at least {least}; read {count.value}"
            reading.error(reading.words[place], "counts", message, id="YOUNG-175")
    if reading.errors:
        raise DeckError(with_slip_named(reading.faults, _slip_of_counts(reading, record)))
    return record


def _report_few_counts(reading: _Reading, count: int) -> None:
    if count:
        reading.early_end("counts", f"the deck ends after {count} of the 12 counts", id="YOUNG-176")
    else:
        reading.early_end("", "the deck is empty; a YOUNG deck begins with 12 integers", id="YOUNG-177")


def _read_sections(reading: _Reading, counts: ReadRecord) -> ManyRecords | tuple[ReadRecord, ...]:
    size_of_all = sum(size for _, size in _blocks(reading, counts))
    words = reading.take(size_of_all)
    records, position = [counts], 0
    for section, number_of_record in _expected(reading, counts):
        size = len(section.columns)
        chunk = words[position : position + size]
        position += size
        if reading.errors > MOST_ERRORS:
            break  # no deck at all, such as a text that begins with twelve integers
        record = _record(reading, section, number_of_record, chunk) if chunk else None
        if record and size_of_all <= many_records.MANY_NUMBERS:
            records.append(record)
        if len(chunk) < size:
            where = f"after {len(chunk)} of its {size} numbers" if chunk else "before it"
            message = (
                f"the deck ends {where}; by its counts the deck needs "
                f"{size_of_all + len(counts.values)} numbers, it has {reading.taken}"
            )
            reading.early_end(subject_of(section, number_of_record), message, id="YOUNG-058")
            break
    return tuple(records) if size_of_all <= many_records.MANY_NUMBERS else _many(reading, counts)


def _many(reading: _Reading, counts: ReadRecord) -> ManyRecords:
    """The records of a large deck without errors."""
    blocks = [Block(COUNTS.name, 1, [counts].__getitem__)]
    first = len(counts.values)
    for section, numbers in _blocks(reading, counts):
        size = len(section.columns)
        record_at = partial(_again, section, reading.words, first)
        blocks.append(Block(section.name, numbers // size, record_at))
        first += numbers
    return ManyRecords(blocks)


def _again(section: Section, words: Words, first: int, index: int) -> ReadRecord:
    """A record that was read without error before."""
    start = first + index * len(section.columns)
    texts = words.texts(start, start + len(section.columns))
    values = tuple(spelled(text)[0] for spelled, text in zip(section.spellings, texts, strict=True))
    return ReadRecord(section, index + 1 if section.count else 0, values, words, start)


def _expected(reading: _Reading, counts: ReadRecord) -> Iterator[tuple[Section, int]]:
    """Every record that the counts announce, lazily: a small file may announce a trillion."""
    for section in reading.sections[1:]:
        if section.count:
            for number_of_record in range(1, counts[section.count] + 1):
                yield section, number_of_record
        else:
            yield section, 0


def _blocks(reading: _Reading, counts: ReadRecord) -> Iterator[tuple[Section, int]]:
    """Pairs (section, numbers in the whole section)."""
    for section in reading.sections[1:]:
        yield section, len(section.columns) * (counts[section.count] if section.count else 1)


def _record(reading: _Reading, section: Section, number_of_record: int, places: range) -> ReadRecord:
    texts = reading.words.texts(places.start, places.stop)
    try:
        read = [spelled(text) for spelled, text in zip(section.spellings, texts, strict=False)]
        values, warnings = zip(*read, strict=True) if read else ((), ())
    except number.Misspelt:
        values, warnings = (), (True,)
    if any(warnings):
        values = tuple(_values(reading, section, number_of_record, places))
    return ReadRecord(section, number_of_record, values, reading.words, places.start)


def _values(
    reading: _Reading, section: Section, number_of_record: int, places: range
) -> Iterator[float | None]:
    """The values of a record, None for a word that is no number; each of its faults is reported."""
    subject = subject_of(section, number_of_record)
    for column, spelled, place in zip(section.columns, section.spellings, places, strict=False):
        word = reading.words[place]
        try:
            value, warning = spelled(word.text)
        except number.Misspelt as fault:
            reading.error(word, subject, f"{column.key} {fault}", id="YOUNG-056")
            value, warning = None, ""
        if warning:
            colon = "" if column.is_integer else ":"
            reading.warn(word, subject, f"{column.key}{colon} {warning}", id="YOUNG-057")
        yield value


def _slips_of(reading: _Reading, counts: ReadRecord) -> tuple[Fault, ...]:
    """Slips, looked for only where the numbers needed do not end with a line: no other deck has any."""
    needed = sum(size for _, size in _blocks(reading, counts)) + len(counts.values)
    rest = _words_after(reading)
    if reading.taken == needed and not rest:
        return ()
    # No record is empty, so the words taken bound the number of records worth listing.
    expected = islice(_expected(reading, counts), reading.taken)
    sizes = [(subject_of(section, k), len(section.columns)) for section, k in expected]
    taken = reading.words.upto(reading.taken)
    return slips([*taken, *rest], [(COUNTS.subject, len(counts.values)), *sizes])


def _words_after(reading: _Reading) -> list[Word]:
    """The rest of the last number's line and the next line; nothing when the number ends its line."""
    rest, following = _lines_after(reading, reading.words[reading.taken - 1].line)
    return [*rest, *following] if rest else []


def _lines_after(reading: _Reading, last: int) -> tuple[Any, Any]:
    """The words after the last number on its line `last`, and those of the next line that has any."""
    end = reading.taken
    reading.words.reach(end + 2 * LONGEST_RECORD)
    known = min(end + 2 * LONGEST_RECORD, len(reading.words))
    unread = [reading.words[place] for place in range(end, known)]
    rest = [word for word in unread if word.line == last]
    following = [word for word in unread if word.line != last]
    return rest, [word for word in following if word.line == following[0].line]


def _is_number(word: Word) -> bool:
    try:
        number.real(word.text)
    except number.Misspelt:
        return False
    return True


def _numbers_left_over(reading: _Reading) -> Iterator[Any]:
    """A warning of numbers after dT: on its line, or alone on the next one.

    Prose may stand there.  Numbers only are rather one too many in a record before.
    """
    if reading.errors:
        return
    last = reading.words[reading.taken - 1]
    rest, following = _lines_after(reading, last.line)
    if rest and all(map(_is_number, rest)):
        message = f"one more number follows Ti, Te and dT = {last.text}; is one before it too many?"
        yield Fault("warning", message, rest[0].place, "time", id="YOUNG-060")
    elif following and all(map(_is_number, following)):
        message = "the deck is complete before this line; its numbers are ignored"
        yield Fault("warning", message, following[0].place, "", id="YOUNG-061")


def _slip_of_counts(reading: _Reading, record: ReadRecord) -> tuple[Fault, ...]:
    """The counts' own slip: judged by the body estimates that follow, which are 7 numbers a line."""
    reading.take(2 * len(BODIES.columns))
    bodies = [(f"body {k}", len(BODIES.columns)) for k in (1, 2)]
    taken = [*reading.words.upto(reading.taken)]
    first_lines = sorted({word.line for word in taken})[:2]
    close = [word for word in taken if word.line in first_lines]
    return slips(close, [(COUNTS.subject, len(COUNTS.columns)), *bodies], kept_per_slip=1)


def _in_order(faults: Sequence[Fault]) -> list[Any]:
    return sorted(faults, key=lambda fault: fault.place)
