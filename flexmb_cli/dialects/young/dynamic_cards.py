"""Masses and loads of a YOUNG deck: cards behind its last number, where the historic program stops reading.

A line that is exactly `DYNAMICS inverse` or `DYNAMICS forward` opens the cards; what stands between
dT and that line is prose, and a deck without it means what it always meant.  A card is a keyword and
its numbers, in any case of letters, on one line or several; `END` closes the cards, else the end of
the deck does.  `{...}` is a comment.

Lines of a YOUNG deck that are not read but look as if they should be: slips of DYNAMICS, and cards.

What stands behind the last number, or behind END, is prose.  A misspelt opening line there would turn a
dynamic analysis into a kinematic one, and a card there would be lost.
"""

import re
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

from ...deck import many_records, number
from ...deck.lines import Lines
from ...deck.many_records import Block, ManyRecords, blocks_of
from ...deck.number import shown
from ...deck.record import Deck, DeckText, Number, Record
from ...deck.words import UNCLOSED, Word, words
from ...errors import DeckError, Fault, Place
from .card import MOST_NUMBERS
from .cards import BY_KEYWORD
from .elements.cards import JOINT_CARDS
from .read_card import CardRecords, card_at, is_keyword
from .reader import read_young
from .shape_cards import SHAPE_CARDS

_COMMENT = re.compile(r"\{[^}]*\}")
_OPENING = "DYNAMICS"
# One word, one more behind it, or anything where that is the name of an analysis.
_LIKE_OPENING = re.compile(
    r"^[ \t]*(([A-Z]{6,10})(?:[^\w\n]{1,9}(?:INVERSE|FORWARD)\b[^\n]*|[^\w\n]*|[^\w\n]{1,9}[A-Z]+[^\w\n]*))$",
    re.IGNORECASE | re.MULTILINE,
)
_LEAST_LIKENESS = 0.75  # of DYNAMICS: two letters changed
_NUMBER = r"[-+]?\.?\d[-+.\deEdD]*"


def unread_lines(lines: Lines, behind: int, keywords: Iterable[str]) -> Iterator[Fault]:
    """Warn of the lines behind line `behind` of a deck without dynamic cards that look like such cards."""
    slips = list(_like_openings(lines, behind))
    message = (
        "is read as prose: a card needs the line DYNAMICS inverse, DYNAMICS forward or GEOMETRY before it"
    )
    # Cards behind a misspelt opening line have that one cause.
    return iter(slips) if slips else _cards(lines, behind, keywords, message, id="YOUNG-156")


def _like_openings(lines: Lines, behind: int) -> "Iterator[Any]":
    text, start = _without_comments(lines, behind)
    for found in _LIKE_OPENING.finditer(text):
        if _is_like_opening(found[2]):
            message = (
                f"{shown(found[1].strip())} is read as prose; DYNAMICS inverse or DYNAMICS forward, alone on "
                "its line, opens cards with masses and loads"
            )
            place = Place(*lines.place_of(start + found.start(1)), len(found[1].rstrip()))
            yield Fault("warning", message, place, id="YOUNG-019")


def cards_behind_end(lines: Lines, behind: int, keywords: Iterable[str]) -> Iterator[Fault]:
    """Warn of cards behind line `behind`, which holds END."""
    message = "stands behind END and is not read: put it before END"
    yield from _cards(lines, behind, keywords, message, id="YOUNG-178")


def _cards(lines: Lines, behind: int, keywords: Iterable[str], message: str, *, id: str) -> "Iterator[Any]":
    text, start = _without_comments(lines, behind)
    card = rf"^[ \t]*({'|'.join(keywords)})[ \t]+{_NUMBER}(?:[ \t]+{_NUMBER})*[ \t]*$"
    for found in re.finditer(card, text, re.IGNORECASE | re.MULTILINE):
        place = Place(*lines.place_of(start + found.start(1)), len(found[1]))
        yield Fault("warning", f"{found[1].upper()} {message}", place, id=id)


def _without_comments(lines: Lines, behind: int) -> tuple[Any, Any]:
    """The text behind a line with blanks for comments and one type of line end, and where it starts."""
    start = lines.start_of(behind)
    text = lines.text[start:].replace("\r", "\n")
    # A crowd of braces that nothing closes would be searched to the end of the text, each of them.
    closed = text.rfind("}") + 1
    return _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), text[:closed]) + text[
        closed:
    ], start


def _is_like_opening(word: str) -> bool:
    from difflib import SequenceMatcher

    return SequenceMatcher(None, word.upper(), _OPENING).ratio() >= _LEAST_LIKENESS


MARKER = re.compile(
    r"\s*(?:DYNAMICS\s+(?P<analysis>INVERSE|FORWARD)|(?P<shapes>GEOMETRY))\s*(\{[^}]*\}\s*)?", re.IGNORECASE
)
NAME = re.compile("DYNAMICS|GEOM", re.IGNORECASE)
SECTION, GEOMETRY = "dynamics", "geometry"
LAST_CARD = "END"
INVERSE, FORWARD = "inverse", "forward"

# More would take more than twelve times the deck's size.
MOST_LOADS, BY_BODY = 200_000, ("mass", "velocity")


def read_young_deck(source: DeckText) -> Deck:
    """A YOUNG deck with the records of its dynamic cards, if it has any, behind those of kinematics.

    Raises DeckError with all faults of the cards.
    """
    deck = _read_numbers(source)
    opening = _opening(deck)
    if opening is None:
        step = deck.one("time").at("step").place
        assert step is not None, "the step is read from the deck"
        last = step.line
        return replace(deck, warnings=(*deck.warnings, *unread_lines(source.lines, last, BY_KEYWORD)))
    cards = _Cards(source, opening)
    cards.read()
    if any(fault.severity == "error" for fault in cards.made.faults):
        raise DeckError((*deck.warnings, *cards.made.faults))
    return replace(deck, records=cards.behind(deck.records), warnings=(*deck.warnings, *cards.made.faults))


def analysis_of(deck: Deck) -> 'Literal["inverse", "forward"] | None':
    """ "inverse" or "forward" for a deck with dynamic cards, None without."""
    opened = deck.section(SECTION)
    return opened[0]["analysis"] if opened else None


def takes_steps(deck: Deck) -> bool:
    """Return whether the motion is integrated; otherwise every row is solved for itself."""
    return analysis_of(deck) == FORWARD


def has_elements(deck: Deck) -> bool:
    """Return whether there are cards of elements at joints or of what drives them."""
    return analysis_of(deck) is not None and any(deck.section(card.section) for card in JOINT_CARDS)


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


def _opening(deck: Deck) -> int | None:
    """Number of the line that opens the cards, None without one."""
    return next((n for n, line in _lines_behind(deck) if MARKER.fullmatch(line)), None)


def _lines_behind(deck: Any) -> "Iterator[tuple[int, str]]":
    """Number and text of every line behind that of dT that names the cards."""
    lines = deck.source.lines
    last = deck.one("time").at("step").place.line
    for found in NAME.finditer(lines.text, lines.start_of(last)):
        n, column = lines.place_of(found.start())
        line = lines[n - 1]
        # No other word stands before it, so it is found once a line.
        if not line[: column - 1].strip():
            yield n, line


@dataclass
class _Cards:
    """The cards of a deck as they are read, and the faults found on the way."""

    source: DeckText
    opening: int
    records: list[Record] = field(default_factory=list)
    made: CardRecords = field(default_factory=CardRecords)
    starts: dict[str, "array[int]"] = field(default_factory=dict)  # of each section: where in the text
    numbers: int = 0
    loads: int = 0  # cards whose number that of the bodies does not bound
    shapes_alone: bool = False

    def behind(self, records: "tuple[Record, ...] | ManyRecords") -> "tuple[Record, ...] | ManyRecords":
        """Return the records of the cards behind those of kinematics; many ones are made when looked at."""
        if isinstance(records, tuple) and self.numbers <= many_records.MANY_NUMBERS:
            return *records, *self.records
        blocks = [*blocks_of(records), *blocks_of(self.records[:1])]
        for section, starts in self.starts.items():
            blocks.append(Block(section, len(starts), partial(card_at, self.source, section, starts)))
        return ManyRecords(blocks)

    def read(self) -> None:
        """Read all cards behind the opening line."""
        self.records.append(self._opening_record())
        card: list[Any] = []
        for word in words(self.source.lines, self.opening):
            if word.text == UNCLOSED:
                self.made.error(
                    word.place, "", "a comment is opened here and never closed with }", id="YOUNG-169"
                )
                break
            if is_keyword(word) and not _wants_text(card):
                self._finish(card)
                if self.loads > MOST_LOADS:
                    message = (
                        f"there are more than {MOST_LOADS} cards other than {', '.join(BY_BODY).upper()}"
                    )
                    self.made.error(
                        word.place, "", f"{message}: the deck is not read from here on", id="YOUNG-170"
                    )
                    return
                card = [word]
                if word.text.upper() == LAST_CARD:
                    self.made.faults += cards_behind_end(self.source.lines, word.line, BY_KEYWORD)
                    return
            elif card:
                card.append(word)
            else:
                message = "a card begins with a keyword, such as MASS, FORCE or GRAVITY"
                self.made.error(word.place, "", message, id="YOUNG-171")
                card = [Word("", word.line, word.column)]
        self._finish(card)

    def _opening_record(self) -> Record:
        found = MARKER.fullmatch(self.source.lines[self.opening - 1])
        assert found is not None, "the line was found by this pattern"
        self.shapes_alone = found["shapes"] is not None
        key = "shapes" if self.shapes_alone else "analysis"
        place = Place(self.opening, found.start(key) + 1, len(found[key]))
        section, meaning = SECTION, "inverse: forces of the driven motion; forward: motion under forces"
        if self.shapes_alone:
            section, meaning = GEOMETRY, "shapes of bodies follow, for pictures"
        number = Number(key, found[key].lower(), meaning, "", place, found[key])
        return Record(section, 0, section, (number,))

    def _finish(self, card: list[Word]) -> None:
        """Make a record of a keyword and the words behind it."""
        if not card or not card[0].text:
            return
        keyword, *found = card
        kind = BY_KEYWORD.get(keyword.text.upper())
        if kind is None:
            message = f"there is no card {number.shown(keyword.text)}{_hint(keyword.text)}"
            self.made.error(keyword.place, "", message, id="YOUNG-172")
            return
        if self.shapes_alone and kind not in SHAPE_CARDS:
            message = (
                f"{kind.keyword} is no shape; DYNAMICS in place of GEOMETRY opens cards with masses and loads"
            )
            self.made.error(keyword.place, "", message, id="YOUNG-173")
            return
        starts = self.starts.setdefault(kind.section, array("i"))
        self.loads += kind.section not in BY_BODY
        starts.append(self.source.lines.starts[keyword.line - 1] + keyword.column - 1)
        columns = kind.columns_of(len(found))
        if columns is None:
            subject = f"{kind.section} {len(starts)}"
            taken = f"at most {MOST_NUMBERS} numbers" if len(found) > MOST_NUMBERS else kind.numbers
            self.made.error(
                keyword.place, subject, f"{kind.keyword} takes {taken}; read {len(found)}", id="YOUNG-174"
            )
            return
        record = self.made.record(kind, columns, len(starts), keyword, found)
        self.numbers += len(columns)
        if self.numbers <= many_records.MANY_NUMBERS:
            self.records.append(record)


def _wants_text(card: Sequence[Word]) -> Any:
    """Return whether a keyword alone has been read, behind which a word is no keyword."""
    kind = BY_KEYWORD.get(card[0].text.upper()) if len(card) == 1 else None
    return kind is not None and kind.begins_with_text


def _hint(text: str) -> str:
    from difflib import get_close_matches

    close = get_close_matches(text.upper(), BY_KEYWORD, n=1)
    if close:
        return f"; is {close[0]} meant?"
    return f", only {', '.join(BY_KEYWORD)} and {LAST_CARD}"
