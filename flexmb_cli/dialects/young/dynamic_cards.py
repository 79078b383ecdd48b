"""Masses and loads of a YOUNG deck: cards after its last number, where the historic program stops reading.

A line that is exactly `DYNAMICS inverse` or `DYNAMICS forward` opens the cards; what stands between
dT and that line is prose, and a deck without it means what it always meant.  A card is a keyword and
its numbers, in any case of letters, on one line or several; `END` closes the cards, else the end of
the deck does.  `{...}` is a comment.  Blocks ELEMENTS stand among the cards, or right after dT.
"""

import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

from ...deck import many_records, number
from ...deck.lazy import BySection
from ...deck.many_records import Block, ManyRecords, blocks_of
from ...deck.record import Deck, DeckText, Number, Record
from ...deck.words import UNCLOSED, Word, words
from ...errors import DeckError, Place
from ..elements_block.line import SECTION as ELEMENTS
from ..elements_block.text import (
    BLOCK,
    begins_block,
    mentions_block,
    refuse_after,
    stray_lines,
    without_braces,
)
from .blocks import cards_after_end, unread_lines
from .cards import BY_KEYWORD, SHAPE_CARDS
from .read_card import CardRecords, card_at, is_keyword, wants_text
from .reader import read_young

if TYPE_CHECKING:
    from ..elements_block.reader import BlockReader


MARKER = re.compile(
    r"\s*(?:DYNAMICS\s+(?P<analysis>INVERSE|FORWARD)|(?P<shapes>GEOMETRY))\s*(\{[^}]*\}\s*)?", re.IGNORECASE
)
NAME = re.compile("DYNAMICS|GEOM", re.IGNORECASE)
_COMMENT = re.compile(r"\{[^}]*\}?")
SECTION, GEOMETRY = "dynamics", "geometry"
LAST_CARD = "END"
INVERSE, FORWARD = "inverse", "forward"

# More would take more than twelve times the deck's size.
MOST_LOADS, BY_BODY = 200_000, ("mass", "velocity")


def read_young_deck(source: DeckText) -> Deck:
    """A YOUNG deck with the records of its dynamic cards, if it has any, after those of kinematics.

    Raises DeckError with all faults of the cards.
    """
    deck = _read_numbers(source)
    step = deck.one("time").at("step").place
    assert step is not None, "the step is read from the deck"
    blocks, last_read = _blocks_after(source, step.line)
    opening = _opening(deck, last_read)
    if opening is None:
        if blocks and any(fault.severity == "error" for fault in blocks.faults):
            raise DeckError((*deck.warnings, *blocks.faults))
        unread = unread_lines(source.lines, last_read, BY_KEYWORD)
        records = _with_lines(deck.records, blocks.records) if blocks else deck.records
        return replace(deck, records=records, warnings=(*deck.warnings, *unread))
    cards = _Cards(source, opening, blocks)
    cards.read()
    if any(fault.severity == "error" for fault in cards.made.faults):
        raise DeckError((*deck.warnings, *cards.made.faults))
    return replace(
        deck, records=cards.appended_to(deck.records), warnings=(*deck.warnings, *cards.made.faults)
    )


def analysis_of(deck: Deck) -> 'Literal["inverse", "forward"] | None':
    """ "inverse" or "forward" for a deck with dynamic cards, None without.

    Drivers and joints of a block in a kinematic deck move it as they do in inverse dynamics.
    """
    opened = deck.section(SECTION)
    if opened:
        return opened[0]["analysis"]
    return "inverse" if deck.section(ELEMENTS) else None


def takes_steps(deck: Deck) -> bool:
    """Return whether the motion is integrated; otherwise every row is solved for itself."""
    return analysis_of(deck) == FORWARD


def _read_numbers(source: DeckText) -> Deck:
    """Return the deck without its cards; raises DeckError.

    Where a line is lost, the counts ask for numbers beyond the line that opens the cards.  The deck is then
    judged as one that ends before it, so that the lost line is named and no word of a card is doubted.
    """
    try:
        return read_young(source)
    except DeckError as failed:
        places = (fault.place for fault in failed.faults if fault.place is not None)
        opening = next((place.line for place in places if MARKER.fullmatch(source.lines[place.line - 1])), 0)
        if opening:
            read_young(replace(source, text=source.text[: source.lines.start_of(opening - 1)]))
        raise


def _blocks_after(source: DeckText, last: int) -> "tuple[BlockReader | None, int]":
    """The reader of the deck's blocks, with those after line `last`, that of dT, and the last line read."""
    if not mentions_block(source.text, source.lines.start_of(last)):
        return None, last
    # Few decks have any.
    from .blocks import block_reader, read_blocks_after

    blocks = block_reader(source)
    return blocks, read_blocks_after(blocks, last, MARKER)


def _with_lines(records: Any, lines: Sequence[Record]) -> Any:
    """The records of a deck and of the lines of its blocks."""
    if isinstance(records, tuple) or not lines:
        return (*records, *lines) if lines else records
    return ManyRecords([*blocks_of(records), *blocks_of(lines)])


def _opening(deck: Deck, last_read: int) -> int | None:
    """Number of the line after another one that opens the cards, None without one."""
    return next((n for n, line in _lines_after(deck, last_read) if MARKER.fullmatch(line)), None)


def _lines_after(deck: Any, last: int) -> Iterator[tuple[int, str]]:
    """Number and text of every line after another one that names the cards."""
    lines = deck.source.lines
    for match in NAME.finditer(lines.text, lines.start_of(last)):
        n, column = lines.place_of(match.start())
        line = lines[n - 1]
        # No other word stands before it, so it is found once a line.
        if not line[: column - 1].strip():
            yield n, line


@dataclass
class _Cards:
    """The cards of a deck as they are read, and the faults found on the way."""

    source: DeckText
    opening: int
    blocks: "BlockReader | None"  # None: the deck has none
    records: list[Record] = field(default_factory=list)
    made: CardRecords = field(default_factory=CardRecords)
    starts: dict[str, "array[int]"] = field(default_factory=dict)  # of each section: where in the text
    numbers: int = 0
    loads: int = 0  # cards whose number that of the bodies does not bound
    old: dict[str, int] = field(default_factory=dict)  # cards of each word that the block replaces
    shapes_alone: bool = False
    stray: int = 0  # line of an element outside a block

    def appended_to(self, records: tuple[Record, ...] | BySection) -> tuple[Record, ...] | BySection:
        """Return the records of the cards after those of kinematics; many ones are made when looked at."""
        if isinstance(records, tuple) and self.numbers <= many_records.MANY_NUMBERS:
            return *records, *self.records, *self.lines
        blocks = [*blocks_of(records), *blocks_of([*self.records[:1], *self.lines])]
        for section, starts in self.starts.items():
            blocks.append(Block(section, len(starts), partial(card_at, self.source, section, starts)))
        return ManyRecords(blocks)

    @property
    def lines(self) -> Sequence[Record]:
        """Return the lines of the blocks."""
        return self.blocks.records if self.blocks else ()

    def read(self) -> None:
        """Read all cards and blocks after the opening line."""
        self.records.append(self._opening_record())
        last: int | None = self.opening
        while last is not None:
            last = self._read_cards(last)
        if self.blocks:
            self.made.faults += self.blocks.faults

    def _read_cards(self, last: int) -> int | None:
        """Read the cards after a line up to a block, and that; return the last line read, or None."""
        card: list[Any] = []
        for word in words(self.source.lines, last):
            if self.blocks and self._opens_block(word):
                self._finish(card)
                return self.blocks.read(word.line) - 1
            if self.blocks and self._is_stray(word):
                continue
            if word.text == UNCLOSED:
                self.made.error(
                    word.place, "", "a comment is opened here and never closed with }", id="YOUNG-169"
                )
                break
            if is_keyword(word) and not wants_text(BY_KEYWORD, card, word):
                self._finish(card)
                if self.loads > MOST_LOADS:
                    message = (
                        f"there are more than {MOST_LOADS} cards other than {', '.join(BY_BODY).upper()}"
                    )
                    self.made.error(
                        word.place, "", f"{message}: the deck is not read from here on", id="YOUNG-170"
                    )
                    return None
                card = [word]
                if word.text.upper() == LAST_CARD:
                    self.made.faults += cards_after_end(self.source.lines, word.line, BY_KEYWORD)
                    faults = refuse_after(self.source.lines, without_braces, word.line, LAST_CARD)
                    self.made.faults += faults
                    return None
            elif card:
                card.append(word)
            else:
                message = "a card begins with a keyword, such as MASS, FORCE or GRAVITY"
                self.made.error(word.place, "", message, id="YOUNG-171")
                card = [Word("", word.line, word.column)]
        self._finish(card)
        return None

    def _opens_block(self, word: Word) -> bool:
        """Return whether a word opens a block, alone on its line; a fault where only shapes may stand."""
        if word.column != 1 or word.text.upper() != BLOCK:
            return False
        opens = begins_block(_COMMENT.sub("", self.source.lines[word.line - 1]))
        if opens and self.shapes_alone:
            message = "a block stands right after dT, before GEOMETRY"
            self.made.error(word.place, "", message, id="YOUNG-179")
        return opens

    def _is_stray(self, word: Word) -> bool:
        """Return whether a word stands on a line of an element, outside a block, which is a fault."""
        if self.stray != word.line and "=" in self.source.lines[word.line - 1]:
            strays = list(stray_lines([(word.line, self.source.lines[word.line - 1])]))
            self.made.faults += strays
            self.stray = word.line if strays else self.stray
        return self.stray == word.line

    def _opening_record(self) -> Record:
        match = MARKER.fullmatch(self.source.lines[self.opening - 1])
        assert match is not None, "the line was found by this pattern"
        self.shapes_alone = match["shapes"] is not None
        key = "shapes" if self.shapes_alone else "analysis"
        place = Place(self.opening, match.start(key) + 1, len(match[key]))
        section, meaning = SECTION, "inverse: forces of the driven motion; forward: motion under forces"
        if self.shapes_alone:
            section, meaning = GEOMETRY, "shapes of bodies follow, for pictures"
        number = Number(key, match[key].lower(), meaning, "", place, match[key])
        return Record(section, 0, section, (number,))

    def _finish(self, card: list[Word]) -> None:
        """Make a record of a keyword and the words after it."""
        if not card or not card[0].text:
            return
        keyword, *words = card
        kind = BY_KEYWORD.get(keyword.text.upper())
        if kind is None:
            self._refuse(keyword, words)
            return
        if self.shapes_alone and kind not in SHAPE_CARDS:
            message = (
                f"{kind.keyword} is not a shape; DYNAMICS in place of GEOMETRY opens "
                "cards with masses and loads"
            )
            self.made.error(keyword.place, "", message, id="YOUNG-173")
            return
        starts = self.starts.setdefault(kind.section, array("i"))
        self.loads += kind.section not in BY_BODY
        starts.append(self.source.lines.starts[keyword.line - 1] + keyword.column - 1)
        if not kind.takes(len(words)):
            subject = f"{kind.section} {len(starts)}"
            message = f"{kind.keyword} takes {kind.numbers}; read {len(words)}"
            self.made.error(keyword.place, subject, message, id="YOUNG-174")
            return
        record = self.made.record(kind, len(starts), keyword, words)
        self.numbers += len(kind.columns)
        if self.numbers <= many_records.MANY_NUMBERS:
            self.records.append(record)

    def _refuse(self, keyword: Word, words: Sequence[Word]) -> None:
        """Refuse a word that is no card; what the block replaces with the line that says the same."""
        # Few decks have words that no card has.
        from ..elements_block.old_cards import LINES, refused

        word = keyword.text.upper()
        if word in LINES["young"]:
            cards = [(keyword.place, [each.text for each in words])]
            self.made.faults += refused("young", word, cards, self.old)
        else:
            message = f"there is no card {number.shown(keyword.text)}{_hint(keyword.text)}"
            self.made.error(keyword.place, "", message, id="YOUNG-172")


def _hint(text: str) -> str:
    from difflib import get_close_matches

    close = get_close_matches(text.upper(), BY_KEYWORD, n=1)
    if close:
        return f"; is {close[0]} meant?"
    return f", only {', '.join(BY_KEYWORD)} and {LAST_CARD}"
