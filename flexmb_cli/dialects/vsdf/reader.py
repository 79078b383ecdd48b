"""Reader of VSDF decks: keyword cards of four columns, data cards below them."""

import re
from array import array
from functools import partial
from typing import Any

from ...deck import many_records
from ...deck.many_records import Block, ManyRecords
from ...deck.record import Deck, DeckText, Number, Record
from ...errors import DeckError, Fault, Place
from . import fields
from .card import WIDTHS, Card, Column
from .cards import BY_WORD, DATA_WORDS, END, FINAL, KNOWN_WORDS, STAR, STOP

_TITLE_WIDTH = 75
# Nobody reads more, and each costs a search for near words.
_MOST_FAULTS = 1000
_MOST_FIELDS = 100_000  # each takes some hundred bytes while its card is read
_COMMENT = "*"
_BY_SECTION = {card.section: card for card in BY_WORD.values()}
# A data card begins with a blank or a number, so that no keyword can be mistaken for one.
_DATA = re.compile(r"[\s0-9+\-.,]")
_NUMBERS = re.compile(r"[.,+\-]*[0-9][0-9.,+\-EeDd]*(?=\s|$)")


def read_vsdf(source: DeckText) -> Deck:
    """The deck of `source`; `DeckError` with every fault found when it cannot be read."""
    reader = _Reader(source)
    reader.read()
    if any(fault.severity == "error" for fault in reader.faults):
        raise DeckError(reader.faults)
    records = tuple(reader.records) if reader.kept else _many(source, reader.starts)
    return Deck("vsdf", source, records, tuple(reader.faults))


def _many(source: DeckText, starts: "dict[str, Any]") -> ManyRecords:
    """The records of a large deck without errors: the first line of each is known."""
    title = _Reader(source)
    title._read_title()
    blocks = [Block("title", 1, title.records.__getitem__)]
    for section, lines in starts.items():
        blocks.append(Block(section, len(lines), partial(_again, source, _BY_SECTION[section], lines)))
    return ManyRecords(blocks)


def _again(source: DeckText, card: Card, lines: Any, index: int) -> Record:
    """A record that was read without error before."""
    reader = _Reader(source)
    reader.at = lines[index]
    line = reader.lines[reader.at - 1].rstrip()
    numbers = reader._read_card(card, line, card.columns, card.more)
    if card.second:
        numbers += reader._read_second(card)
    number = _number_of(card, numbers[0], index + 1)
    return Record(card.section, number, card.subject.format(number), fields.with_own_keys(numbers))


def _number_of(card: Card, head: Number, count: int) -> Any:
    """The number of a record, of its kind the `count`-th, whose first number is `head`."""
    return {"single": 0, "list": count}.get(card.counted, head.value)


class _Reader:
    """The deck's lines, the card whose data is being read, and what was read so far."""

    def __init__(self, source: DeckText):
        self.lines = source.lines
        self.at = 0
        self.faults: list[Fault] = []
        self.records: list[Record] = []
        self.numbers = 0
        self.kept = True
        self.starts: dict[str, array[int]] = {}  # of each section's records, their lines
        self.seen: dict[tuple[str, int], int] = {}  # lines of numbers that are not their records' places
        self.strange: set[tuple[str, int]] = set()  # those places
        self.counts: dict[str, int] = {}
        self.begun = self.unknown = False
        self.bare: Place | None = None  # of a keyword without data so far

    def read(self) -> None:
        """Title, keyword blocks, END, STAR and STOP."""
        self._read_title()
        card: Card | None = None
        ended: dict[str, Any] = {}
        while (line := self._next()) is not None:
            if len(self.faults) > _MOST_FAULTS:
                place = Place(self.at, 1)
                self._error("", f"more than {_MOST_FAULTS} faults: the deck is not read from here on", place)
                return
            if not _DATA.match(line):
                word = line[:4].strip().upper()
                self._check_filled(card, word)
                card = self._open(word, line, ended)
                if word == STOP:
                    break
            elif card is not None:
                self.bare = None
                self._read_record(card, line)
            elif not self.unknown:
                where = "behind END, where nothing is read" if ended else "before any keyword"
                self._error("", f"a data card stands {where}", Place(self.at, 1))
        self._check_end(ended)

    def _next(self) -> str | None:
        """The next line that is neither blank nor a comment; None at the end of the deck."""
        while self.at < len(self.lines):
            self.at += 1
            line = self.lines[self.at - 1].rstrip()
            if line and not line.startswith(_COMMENT):
                found: str | None = line
                return found
        return None

    def _read_title(self) -> None:
        line = self._next() or ""
        if line[:4].upper() != "VSDF":
            place = Place(max(self.at, 1), 1, 4)
            self._error("", f"the first card must begin with VSDF; read '{line[:4]}'", place)
        title = line[5 : 5 + _TITLE_WIDTH]
        place = Place(max(self.at, 1), 1, 4)
        self.records.append(Record("title", 0, "title", (Number("title", title, "title", "", place, title),)))

    def _open(self, word: str, line: str, ended: dict[str, Any]) -> Card | None:
        """The card that `word` names; None for END, STAR, STOP and for words that no card has."""
        place = Place(self.at, 1, max(1, len(line[:4].rstrip())))
        self.unknown = False
        if word in FINAL:
            ended.setdefault(word, place)
            return None
        if word not in BY_WORD:
            self.unknown = True
            self._error("", f"there is no card '{line[:4].rstrip()}'{_hint(word)}", place)
            return None
        reported = self._check_alone(word, line)
        if END in ended:
            self._error("", f"card '{word}' stands behind END, where nothing is read", place)
            self.unknown = True
            return None
        if word != "BODY" and not self.begun:
            self._error("", f"card '{word}' stands before BODY, which must come first", place)
        self.begun, self.bare = True, None if reported else place
        return BY_WORD[word]

    def _check_filled(self, card: Card | None, following: str) -> None:
        """A keyword alone says nothing; what was meant may stand in its comment."""
        if card is not None and self.bare is not None and following in KNOWN_WORDS:
            self._warn(card.word, "no data card stands below the keyword, so it says nothing", self.bare)
        self.bare = None

    def _check_alone(self, word: str, line: str) -> bool:
        """Words behind a keyword are a comment; numbers there were meant to be read, and are a fault."""
        extra = line[4:].strip()
        if not _NUMBERS.match(extra):
            return False
        message = (
            f"'{extra}' stands behind the keyword and is not read; data cards follow on lines of their own"
        )
        self._error(word, message, Place(self.at, line.index(extra, 4) + 1, len(extra)))
        return True

    def _check_end(self, ended: dict[str, Place]) -> None:
        if END not in ended:
            last = len(self.lines)
            while last > 1 and not self.lines[last - 1].strip():
                last -= 1
            place = Place(last, len(self.lines[last - 1].rstrip()) + 1)
            self._error("", "unexpected end of the deck, expected the card END", place)
        elif STAR not in ended:
            self._warn("", "no STAR card behind END: the deck asks for no run", ended[END])

    def _read_record(self, card: Card, line: str) -> None:
        before = len(self.faults)
        self.starts.setdefault(card.section, array("i")).append(self.at)
        numbers = self._read_card(card, line, card.columns, card.more)
        head = numbers[0] if numbers else None
        if card.second:
            numbers += self._read_second(card)
        if head is None or any(fault.severity == "error" for fault in self.faults[before:]):
            self.counts[card.section] = self.counts.get(card.section, 0) + 1
            self.strange.add((card.section, self.counts[card.section]))
            return
        self._keep(card, head, numbers)

    def _read_second(self, card: Card) -> list[Number]:
        """The second card of a record; it must be a data card."""
        here = self.at
        line = self._next()
        if line is None or not _DATA.match(line):
            self.at = here
            keys = f"{card.second[0].key} ... {card.second[-1].key}"
            place = Place(here, len(self.lines[here - 1].rstrip()) + 1)
            self._error(card.word, f"its second card, with {keys}, is missing", place)
            return []
        return self._read_card(card, line, card.second, None)

    def _read_card(self, card: Card, line: str, columns: Any, more: Column | None) -> list[Number]:
        count = line.count(",") or len(line) // WIDTHS["I"]
        if more is not None and count > _MOST_FIELDS:
            message = f"a card has at most {_MOST_FIELDS} fields; go on on a further one"
            self._error(card.word, message, Place(self.at, 1))
            return []
        found = fields.fields(line, columns, more)
        wanted = [*columns, *([more] * (len(found) - len(columns)))]
        numbers = [self._number(card, line, columns, *pair) for pair in zip(found, wanted, strict=True)]
        if more is None:
            self._check_rest(card, line, columns)
        elif len(found) == len(columns) and more.default is None:
            place = Place(self.at, len(line) + 1)
            self._error(card.word, f"the card names no {more.meaning}", place)
        return [number for number in numbers if number is not None]

    def _number(
        self, card: Card, line: str, columns: tuple[Column, ...], field: Any, column: Column
    ) -> Number | None:
        place = Place(self.at, field.column, max(1, len(field.text)))
        try:
            value, doubt = fields.value(field, column)
        except fields.Unfit as fault:
            self._error(card.word, str(fault), place, fields.guide(line, columns))
            return None
        if doubt:
            self._warn(card.word, doubt, place)
        return Number(column.key, value, column.meaning, column.unit, place, field.text)

    def _check_rest(self, card: Card, line: str, columns: tuple[Column, ...]) -> None:
        """Words behind the last field are a comment; numbers there were meant to be read."""
        extra = fields.rest(line, columns)
        text = extra.text
        if not text:
            return
        place = Place(self.at, extra.column, len(text))
        if _NUMBERS.match(text):
            message = f"'{text}' stands behind the last field and is not read"
            self._error(card.word, message, place, fields.guide(line, columns))
        elif fields.runs_over(line, columns, extra):
            message = (
                f"'{text}' touches the last field, which ends in column {extra.column - 1}: a comment needs "
                "a blank before it, a longer number the form with commas"
            )
            self._error(card.word, message, place, fields.guide(line, columns))

    def _keep(self, card: Card, head: Number, numbers: list[Number]) -> None:
        count = self.counts[card.section] = self.counts.get(card.section, 0) + 1
        number = _number_of(card, head, count)
        subject = card.subject.format(number)
        if card.counted != "list":
            earlier = self._given(card.section, number, count)
            if earlier:
                self._error(subject, f"it is given on line {earlier} already", head.place)
                return
        if card.counted == "own" and number != count:
            message = f"it is number {count} of its kind; records are numbered 1, 2, ... in their order"
            self._error(subject, message, head.place)
        self.numbers += len(numbers)
        if self.numbers > many_records.MANY_NUMBERS:
            self.kept, self.records = False, []
        if self.kept:
            self.records.append(Record(card.section, number, subject, fields.with_own_keys(numbers)))

    def _given(self, section: str, number: int, count: int) -> int:
        """The line where a record of this number stands already, 0 without one."""
        earlier = self.seen.get((section, number), 0)
        if not earlier and 0 < number < count and (section, number) not in self.strange:
            earlier = self.starts[section][number - 1]
        if number != count:
            self.seen.setdefault((section, number), self.at)
            self.strange.add((section, count))
        return earlier

    def _error(self, subject: str, message: str, place: Any, guide: tuple[str, ...] = ()) -> None:
        self.faults.append(Fault("error", message, place, subject, tuple(guide), id="VSDF-081"))

    def _warn(self, subject: str, message: str, place: Place) -> None:
        self.faults.append(Fault("warning", message, place, subject, id="VSDF-082"))


def _hint(word: str) -> str:
    """Return what may have been meant by a word that no card has."""
    if word in DATA_WORDS:
        return f"; '{word}' stands on a data card, behind a blank"
    from difflib import get_close_matches

    close = get_close_matches(word, KNOWN_WORDS, n=1, cutoff=0.5)
    return f"; is '{close[0]}' meant?" if close else ""
