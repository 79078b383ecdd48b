"""Reader of VSDF decks: keyword cards of four columns, data cards below them."""

import math
from array import array
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ...deck import many_records
from ...deck.many_records import ManyRecords, blocks_of
from ...deck.record import Deck, DeckText, Number, Record
from ...errors import DeckError, Fault, Place
from ..elements_block.old_cards import VSDF_FIELDS, refused
from ..elements_block.text import (
    BLOCK,
    begins_block,
    is_like_block,
    refuse_after,
    stray_lines,
    without_starred,
)
from . import data_cards
from .card import WIDTHS, Card, Column
from .cards import BY_WORD, DATA_WORDS, END, FINAL, KNOWN_WORDS, STAR, STOP
from .data_cards import DATA, NUMBERS, CardReader
from .fields import fields, with_own_keys

if TYPE_CHECKING:
    from ..elements_block.reader import BlockReader


def refused_cards(word: str, lines: Sequence[tuple[Place, str]], counts: dict[str, int]) -> Iterator[Fault]:
    """Refuse data cards of a word; `counts`: how many of each word the deck had before."""
    return refused("vsdf", word, [(place, fields_of(word, line)) for place, line in lines], counts)


def fields_of(word: str, line: str) -> list[str]:
    """Return the fields of a data card."""
    columns = tuple(Column("", "", letter=letter, skip=letter == "A") for letter in VSDF_FIELDS[word])
    return [field.text for field in fields(line, columns, Column("", "") if word == "FUNC" else None)]


_TITLE_WIDTH = 75
# Nobody reads more, and each costs a search for near words.
_MOST_FAULTS = 1000
# More would take more than twelve times the deck's size.
_MOST_LISTED = 2_000_000  # fields of cards with lists, together
_MOST_CARDS = 100_000  # of a type whose records become objects
_UNBOUNDED = ("node", "table")


def read_vsdf(source: DeckText) -> Deck:
    """The deck of `source`; `DeckError` with every fault found when it cannot be read."""
    reader = _Reader(source)
    reader.read()
    if any(fault.severity == "error" for fault in reader.faults):
        raise DeckError(reader.faults)
    lines = reader.blocks.records if reader.blocks else []
    records = (*reader.records, *lines) if reader.kept else _many(source, reader, lines)
    return Deck("vsdf", source, records, tuple(reader.faults))


def _many(source: DeckText, reader: "_Reader", lines: Sequence[Record]) -> ManyRecords:
    title = _Reader(source)
    title._read_title()
    records = data_cards.many_records(source, title.records[0], reader.starts, reader.rows)
    return ManyRecords([*records.blocks, *blocks_of(lines)])


class _Reader(CardReader):
    """The deck's lines, the card whose data is being read, and what was read so far."""

    def __init__(self, source: DeckText):
        super().__init__(source)
        self.records: list[Record] = []
        self.numbers = self.listed = 0
        self.kept = True
        self.starts: dict[str, array[int]] = {}  # of each section's records, their lines
        self.rows: dict[str, array[float]] = {}  # of sections of numbers only, their numbers, nan if empty
        self.seen: dict[tuple[str, int], int] = {}  # lines of numbers that are not their records' places
        self.strange: set[tuple[str, int]] = set()  # those places
        self.counts: dict[str, int] = {}
        self.blocks: BlockReader | None = None  # None: the deck has none so far
        self.old: dict[str, int] = {}  # cards of each word that the block replaces
        self.begun = self.unknown = False
        self.bare: Place | None = None  # of a keyword without data so far

    def read(self) -> None:
        """Title, keyword blocks, END, STAR and STOP."""
        self._read_title()
        card: Card | None = None
        ended: dict[str, Any] = {}
        while (line := self.next()) is not None:
            if too_much := self._too_much(card):
                self.error(
                    "", f"{too_much}: the deck is not read from here on", Place(self.at, 1), id="VSDF-153"
                )
                return
            if begins_block(line):
                self._check_filled(card, BLOCK[:4])
                self._read_block(ended)
                card = None
            elif not DATA.match(line):
                word = line[:4].strip().upper()
                self._check_filled(card, word)
                card = self._open(word, line, ended)
                if word == STOP:
                    self.faults += refuse_after(self.lines, without_starred, self.at, STOP)
                    break
            elif self._refuse_stray(line):
                continue
            elif card is not None:
                self.bare = None
                self._read_record(card, line)
            elif not self.unknown:
                preceding = (
                    "after END, where nothing is read" if ended else "after a block, which ends before it"
                )
                where = preceding if ended or self.blocks else "before any keyword"
                self.error("", f"a data card stands {where}", Place(self.at, 1), id="VSDF-154")
        self._check_end(ended)

    def _read_block(self, ended: dict[str, Any]) -> None:
        """Read a block ELEMENTS, which the line read last opens; no card is open after it."""
        # Few decks have any.
        from ..elements_block.reader import BlockReader

        if ended:
            message = f"{BLOCK} stands after END, where nothing is read; put the block before END"
            self.error("", message, Place(self.at, 1, len(BLOCK)), id="VSDF-218")
        if self.blocks is None:
            sections = [card.section for card in BY_WORD.values()]
            self.blocks = BlockReader(self.lines, without_starred, [*sections, "title"])
        n_faults = len(self.blocks.faults)
        self.at = min(self.blocks.read(self.at) - 1, len(self.lines))
        self.faults += self.blocks.faults[n_faults:]
        self.bare, self.unknown = None, False

    def _refuse_stray(self, line: str) -> bool:
        """Refuse a line of an element outside a block."""
        strays = list(stray_lines([(self.at, line)])) if "=" in line or "FUNCTION" in line else []
        self.faults += strays
        return bool(strays)

    def _too_much(self, card: Card | None) -> str:
        """Return what the deck, read up to the data of `card`, has too much of; "" for nothing."""
        if len(self.faults) > _MOST_FAULTS:
            return f"more than {_MOST_FAULTS} faults"
        if self.listed > _MOST_LISTED:
            return f"cards with lists have more than {_MOST_LISTED} fields together"
        if card and card.section not in _UNBOUNDED and self.counts.get(card.section, 0) > _MOST_CARDS:
            return f"there are more than {_MOST_CARDS} cards {card.word}"
        return ""

    def _read_title(self) -> None:
        line = self.next() or ""
        if line[:4].upper() != "VSDF":
            place = Place(max(self.at, 1), 1, 4)
            self.error("", f"the first card must begin with VSDF; read '{line[:4]}'", place, id="VSDF-155")
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
            if self._refuse_old(word, place):
                return None
            hint = f"; is {BLOCK} meant?" if is_like_block(line) else _hint(word)
            self.error("", f"there is no card '{line[:4].rstrip()}'{hint}", place, id="VSDF-156")
            return None
        reported = self._check_alone(word, line)
        if END in ended:
            self.error("", f"card '{word}' stands after END, where nothing is read", place, id="VSDF-157")
            self.unknown = True
            return None
        if word != "BODY" and not self.begun:
            self.error("", f"card '{word}' stands before BODY, which must come first", place, id="VSDF-158")
        self.begun, self.bare = True, None if reported else place
        return BY_WORD[word]

    def _refuse_old(self, word: str, place: Place) -> bool:
        """Refuse cards that the block replaces, with their data; False for other words."""
        # Few decks have words that no card has.
        from ..elements_block.old_cards import VSDF_FIELDS

        if word not in VSDF_FIELDS:
            return False
        last, lines = self.at, []
        while (line := self.next()) is not None and DATA.match(line):
            lines.append((Place(self.at, 1, len(line)), line))
            last = self.at
        self.at = last
        self.faults += refused_cards(word, lines or [(place, "")], self.old)
        return True

    def _check_filled(self, card: Card | None, following: str) -> None:
        """A keyword alone says nothing; what was meant may stand in its comment."""
        if card is not None and self.bare is not None and following in KNOWN_WORDS:
            self.warn(
                card.word, "no data card follows the keyword, so it has no effect", self.bare, id="VSDF-159"
            )
        self.bare = None

    def _check_alone(self, word: str, line: str) -> bool:
        """Words after a keyword are a comment; numbers there were meant to be read, and are a fault."""
        extra = line[4:].strip()
        if not NUMBERS.match(extra):
            return False
        message = (
            f"'{extra}' stands after the keyword and is not read; data cards follow on lines of their own"
        )
        self.error(word, message, Place(self.at, line.index(extra, 4) + 1, len(extra)), id="VSDF-160")
        return True

    def _check_end(self, ended: dict[str, Place]) -> None:
        if END not in ended:
            last = len(self.lines)
            while last > 1 and not self.lines[last - 1].strip():
                last -= 1
            place = Place(last, len(self.lines[last - 1].rstrip()) + 1)
            self.error("", "unexpected end of the deck, expected the card END", place, id="VSDF-161")
        elif STAR not in ended:
            self.warn("", "no STAR card after END: the deck asks for no run", ended[END], id="VSDF-162")

    def _read_record(self, card: Card, line: str) -> None:
        before = len(self.faults)
        if card.more:
            self.listed += line.count(",") or len(line) // WIDTHS["I"]
        self.starts.setdefault(card.section, array("i")).append(self.at)
        if not self.kept and self._take_plain(card, line):
            return
        numbers = self.read_card(card, line, card.columns, card.more)
        head = numbers[0] if numbers else None
        if card.second:
            numbers += self.read_second(card)
        if head is None or any(fault.severity == "error" for fault in self.faults[before:]):
            self.counts[card.section] = self.counts.get(card.section, 0) + 1
            self.strange.add((card.section, self.counts[card.section]))
            return
        self._keep(card, head, numbers)

    def _take_plain(self, card: Card, line: str) -> bool:
        """Take a card of plain numbers whose record needs no number; False for others."""
        texts = data_cards.matched(card, line) if card.section in self.rows else None
        if texts is None or card.counted != "list":
            return False
        self.rows[card.section].extend(data_cards.values(texts))
        self.counts[card.section] += 1
        return True

    def _keep(self, card: Card, head: Number, numbers: list[Number]) -> None:
        count = self.counts[card.section] = self.counts.get(card.section, 0) + 1
        number = data_cards.number_of(card, head, count)
        subject = card.subject.format(number)
        if card.counted != "list":
            earlier = self._given(card.section, number, count)
            if earlier:
                self.error(subject, f"it is given on line {earlier} already", head.place, id="VSDF-163")
                return
        if card.counted == "own" and number != count:
            message = f"it is number {count} of its type; records are numbered 1, 2, ... in their order"
            self.error(subject, message, head.place, id="VSDF-164")
        if data_cards.is_plain(card):
            head_numbers = numbers[: len(card.columns)]
            # A name of a function is read again where it is looked at.
            values = (number.value if number.text else math.nan for number in head_numbers)
            given = (math.nan if isinstance(value, str) else float(value) for value in values)
            self.rows.setdefault(card.section, array("d")).extend(given)
        self.numbers += len(numbers)
        if self.numbers > many_records.MANY_NUMBERS:
            self.kept, self.records = False, []
        if self.kept:
            self.records.append(Record(card.section, number, subject, with_own_keys(numbers)))

    def _given(self, section: str, number: int, count: int) -> int:
        """The line where a record of this number stands already, 0 without one."""
        earlier = self.seen.get((section, number), 0)
        if not earlier and 0 < number < count and (section, number) not in self.strange:
            earlier = self.starts[section][number - 1]
        if number != count:
            self.seen.setdefault((section, number), self.at)
            self.strange.add((section, count))
        return earlier


def _hint(word: str) -> str:
    """Return what may have been meant by a word that no card has."""
    if word in DATA_WORDS:
        return f"; '{word}' stands on a data card, after a blank"
    from difflib import get_close_matches

    close = get_close_matches(word, KNOWN_WORDS, n=1, cutoff=0.5)
    return f"; is '{close[0]}' meant?" if close else ""
