"""Masses and loads of a YOUNG deck: cards behind its last number, where the historic program stops reading.

A line that is exactly `DYNAMICS inverse` or `DYNAMICS forward` opens the cards; what stands between
dT and that line is prose, and a deck without it means what it always meant.  A card is a keyword and
its numbers, in any case of letters, on one line or several; `END` closes the cards, else the end of
the deck does.  `{...}` is a comment.
"""

import re
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import islice, takewhile

from ...deck import many_records, number
from ...deck.many_records import Block, ManyRecords, blocks_of
from ...deck.record import Deck, DeckText, Number, Record
from ...deck.words import UNCLOSED, Word, words, words_from
from ...errors import DeckError, Fault, FaultList, Place
from .dynamic_card_table import BY_KEYWORD, CARDS, Card
from .reader import read_young

MARKER = re.compile(r"\s*DYNAMICS\s+(INVERSE|FORWARD)\s*(\{[^}]*\}\s*)?", re.IGNORECASE)
NAME = re.compile("DYNAMICS", re.IGNORECASE)
# One word behind DYNAMICS, or none, is a slip rather than prose.
NEARLY = re.compile(r"\s*(DYNAMICS(\s+[^\s{]+)?)\s*(\{[^}]*\}\s*)?", re.IGNORECASE)
# Words that stand for no number, where one is wanted, and are no keyword.
NO_NUMBER = re.compile(r"nan|inf(inity)?", re.IGNORECASE)
# A card without comments: its keyword and its numbers.
_PLAIN_CARD = re.compile(r"[A-Za-z]+\s+([^\s{A-Za-z][^\s{]*(?:\s+[^\s{A-Za-z][^\s{]*)*)\s*({)?")
SECTION = "dynamics"
CLOSING = "END"
INVERSE, FORWARD = "inverse", "forward"


def read_young_deck(source: DeckText) -> Deck:
    """A YOUNG deck with the records of its dynamic cards, if it has any, behind those of kinematics.

    Raises DeckError with all faults of the cards.
    """
    deck = read_young(source)
    opening = _opening(deck)
    if opening is None:
        return replace(deck, warnings=(*deck.warnings, *_nearly_opening(deck)))
    cards = _Cards(source, opening)
    cards.read()
    if any(fault.severity == "error" for fault in cards.faults):
        raise DeckError((*deck.warnings, *cards.faults))
    return replace(deck, records=cards.behind(deck.records), warnings=(*deck.warnings, *cards.faults))


def analysis_of(deck: Deck) -> str | None:
    """ "inverse" or "forward" for a deck with dynamic cards, None without."""
    opened = deck.section(SECTION)
    return opened[0]["analysis"] if opened else None


def _opening(deck):
    """Number of the line that opens the cards, None without one."""
    return next((n for n, line in _lines_behind(deck) if MARKER.fullmatch(line)), None)


def _lines_behind(deck):
    """Number and text of every line behind that of dT that names the cards."""
    lines = deck.source.lines
    last = deck.one("time").at("step").place.line
    for found in NAME.finditer(lines.text, lines.start_of(last)):
        n, column = lines.place_of(found.start())
        line = lines[n - 1]
        # No other word stands before it, so it is found once a line.
        if not line[: column - 1].strip():
            yield n, line


def _nearly_opening(deck):
    """A warning for every line that looks like the opening one and is not."""
    message = (
        "this line is read as prose; DYNAMICS inverse or DYNAMICS forward opens cards with masses and loads"
    )
    for n, line in _lines_behind(deck):
        if found := NEARLY.fullmatch(line):
            yield Fault("warning", message, Place(n, found.start(1) + 1, len(found.group(1))), id="YOUNG-019")


@dataclass
class _Cards:
    """The cards of a deck as they are read, and the faults found on the way."""

    source: DeckText
    opening: int
    records: list[Record] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=FaultList)
    starts: dict[str, array] = field(default_factory=dict)  # of each section's cards, where in the text
    numbers: int = 0

    def behind(self, records: Sequence[Record]) -> Sequence[Record]:
        """Return the records of the cards behind those of kinematics; many ones are made when looked at."""
        if isinstance(records, tuple) and self.numbers <= many_records.MANY:
            return *records, *self.records
        blocks = [*blocks_of(records), *blocks_of(self.records[:1])]
        for section, starts in self.starts.items():
            blocks.append(Block(section, len(starts), partial(_again, self.source, section, starts)))
        return ManyRecords(blocks)

    def read(self):
        """Read all cards behind the opening line."""
        self.records.append(self._opening_record())
        card = []
        for word in words(self.source.lines, self.opening):
            if word.text == UNCLOSED:
                self.error(word.place, "", "a comment is opened here and never closed with }")
                break
            if _is_keyword(word):
                self._finish(card)
                card = [word]
                if word.text.upper() == CLOSING:
                    return
            elif card:
                card.append(word)
            else:
                self.error(word.place, "", f"a card begins with a keyword, one of {', '.join(BY_KEYWORD)}")
                card = [Word("", word.line, word.column)]
        self._finish(card)

    def error(self, place: Place, subject: str, message: str):
        self.faults.append(Fault("error", message, place, subject, id="YOUNG-020"))

    def _opening_record(self):
        line = self.source.lines[self.opening - 1]
        word = MARKER.fullmatch(line).group(1)
        place = Place(self.opening, MARKER.fullmatch(line).start(1) + 1, len(word))
        meaning = "inverse: forces of the driven motion; forward: motion under forces"
        return Record(SECTION, 0, SECTION, (Number("analysis", word.lower(), meaning, "", place, word),))

    def _finish(self, card):
        """Make a record of a keyword and the words behind it."""
        if not card or not card[0].text:
            return
        keyword, *found = card
        kind = BY_KEYWORD.get(keyword.text.upper())
        if kind is None:
            self.error(keyword.place, "", _unknown(keyword.text))
            return
        starts = self.starts.setdefault(kind.section, array("i"))
        starts.append(self.source.lines.starts[keyword.line - 1] + keyword.column - 1)
        subject = f"{kind.section} {len(starts)}"
        least, most = len(kind.columns) - kind.optional, len(kind.columns)
        if not least <= len(found) <= most:
            asked = f"{most}" if least == most else f"{least} to {most}"
            keys = " ".join(column.key for column in kind.columns)
            message = f"{kind.keyword} takes {asked} numbers ({keys}); read {len(found)}"
            self.error(keyword.place, subject, message)
            return
        record = self.record(kind, len(starts), keyword, found)
        self.numbers += most
        if self.numbers <= many_records.MANY:
            self.records.append(record)

    def record(self, kind: Card, number_of_card: int, keyword: Word, found: Sequence[Word]) -> Record:
        """The record of a card with as many words as it needs; faults of its numbers are noted."""
        subject = f"{kind.section} {number_of_card}"
        numbers = [self._number(subject, *pair) for pair in zip(kind.columns, found, strict=False)]
        left_out = kind.columns[len(found) :]
        numbers += [
            Number(c.key, 0 if c.is_integer else 0.0, c.meaning, c.unit, keyword.place, "0") for c in left_out
        ]
        return Record(kind.section, number_of_card, subject, tuple(numbers))

    def _number(self, subject, column, word):
        value = 0
        try:
            value, doubt = number.integer(word.text) if column.is_integer else number.real(word.text)
            if doubt:
                self.faults.append(
                    Fault("warning", f"{column.key}: {doubt}", word.place, subject, id="YOUNG-021")
                )
        except number.Misspelt as fault:
            self.error(word.place, subject, f"{column.key} {fault}")
        return Number(column.key, value, column.meaning, column.unit, word.place, word.text)


def _again(source, section, starts, index):
    """The record of a card that was read without error before."""
    kind = next(card for card in CARDS if card.section == section)
    return _ReadCard(source, kind, index + 1, starts[index])


class _ReadCard(Record):
    """A card of a large deck: what is more of its numbers than their values is made when it is looked at."""

    def __init__(self, source: DeckText, kind: Card, number_of_card: int, start: int):
        subject = f"{kind.section} {number_of_card}"
        vars(self).update(section=kind.section, number=number_of_card, subject=subject, made={})
        vars(self).update(positions=kind.positions, _source=source, _kind=kind, _start=start)

    @cached_property
    def values(self) -> tuple[float | int, ...]:
        """Values of the numbers."""
        found = self._plain
        if found is None:
            return tuple(item.value for item in self.numbers)
        texts = found[1].split()
        spellings = [number.integer if column.is_integer else number.real for column in self._kind.columns]
        read = [spelled(text)[0] for spelled, text in zip(spellings, texts, strict=False)]
        left_out = self._kind.columns[len(read) :]
        return *read, *(0 if column.is_integer else 0.0 for column in left_out)

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        """The numbers with their places."""
        words_of_card = words_from(self._source.lines, self._start)
        keyword, *behind = islice(words_of_card, 1 + len(self._kind.columns))
        found = list(takewhile(lambda word: not _is_keyword(word), behind))
        return _Cards(self._source, 0).record(self._kind, self.number, keyword, found).numbers

    @property
    def place(self) -> Place:
        """Place of the first number."""
        found = self._plain
        if found is None:
            return self.numbers[0].place
        line, column = self._source.lines.place_of(found.start(1))
        return Place(line, column, len(found[1].split(maxsplit=1)[0]))

    @cached_property
    def _plain(self):
        """The card in the text; None where a comment stands in it or behind it."""
        found = _PLAIN_CARD.match(self._source.text, self._start)
        return found if found and not found[2] else None


def _is_keyword(word):
    return word.text[0].isalpha() and not NO_NUMBER.fullmatch(word.text)


def _unknown(text):
    from difflib import get_close_matches

    near = get_close_matches(text.upper(), BY_KEYWORD, n=1)
    hint = f"; is {near[0]} meant?" if near else ""
    return f"there is no card {number.shown(text)}, only {', '.join(BY_KEYWORD)} and {CLOSING}{hint}"
