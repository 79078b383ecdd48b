"""Masses and loads of a YOUNG deck: cards behind its last number, where the historic program stops reading.

A line that is exactly `DYNAMICS inverse` or `DYNAMICS forward` opens the cards; what stands between
dT and that line is prose, and a deck without it means what it always meant.  A card is a keyword and
its numbers, in any case of letters, on one line or several; `END` closes the cards, else the end of
the deck does.  `{...}` is a comment.
"""

import re
from array import array
from collections.abc import Sequence
from functools import cached_property, partial
from itertools import takewhile
from typing import TYPE_CHECKING, Any

from ...deck import many_records, number
from ...deck.many_records import Block, ManyRecords, blocks_of
from ...deck.record import Deck, DeckText, Number, Record
from ...deck.words import UNCLOSED, Word, words, words_from
from ...errors import DeckError, Fault, FaultList, Place
from ...quick_dataclass import dataclass, field, replace
from .card import Card, vector, whole
from .element_cards import FUNCTION_CARDS, JOINT_CARDS
from .reader import read_young
from .sections import Column
from .shape_cards import SHAPE_CARDS
from .unread_lines import cards_behind_end, unread_lines

if TYPE_CHECKING:
    from collections.abc import Iterator


MARKER = re.compile(
    r"\s*(?:DYNAMICS\s+(?P<analysis>INVERSE|FORWARD)|(?P<shapes>GEOMETRY))\s*(\{[^}]*\}\s*)?", re.IGNORECASE
)
NAME = re.compile("DYNAMICS|GEOM", re.IGNORECASE)
# Words that stand for no number, where one is wanted, and are no keyword.
NO_NUMBER = re.compile(r"nan|inf(inity)?", re.IGNORECASE)
# A card without comments: its keyword and its numbers.
_PLAIN_CARD = re.compile(r"[A-Za-z]\w*\s+([^\s{A-Za-z][^\s{]*(?:\s+[^\s{A-Za-z][^\s{]*)*)\s*({)?")
SECTION, GEOMETRY = "dynamics", "geometry"
LAST_CARD = "END"
INVERSE, FORWARD = "inverse", "forward"


_BODY = whole("body", "number of the body")
_FOLLOWING = whole("following", "0: global axes, 1: the axes of the body, turning with it")
_FACTOR = whole("factor", "number of the function that multiplies it, 0: none")

CARDS = (
    Card(
        "MASS",
        "mass",
        (
            _BODY,
            Column("m", "mass", "kg"),
            *vector("centre", "the centre of mass, body axes", "m"),
            *(
                Column(
                    f"I{a}",
                    f"element {a} of the inertia tensor about the centre of mass, body axes",
                    "kg m^2",
                )
                for a in ("xx", "yy", "zz", "xy", "yz", "zx")
            ),
        ),
        optional=3,
    ),
    Card(
        "FORCE",
        "force",
        (
            _BODY,
            *vector("P", "the point of action, body axes", "m"),
            *vector("F", "the force", "N"),
            _FOLLOWING,
            _FACTOR,
        ),
        optional=2,
    ),
    Card("TORQUE", "torque", (_BODY, *vector("T", "the torque", "N m"), _FOLLOWING, _FACTOR), optional=2),
    Card(
        "SPRING",
        "spring",
        (
            whole("I", "number of body I, 0: the ground"),
            whole("J", "number of body J, 0: the ground"),
            *vector("P_i", "the end on body I, body axes", "m"),
            *vector("P_j", "the end on body J, body axes", "m"),
            Column("stiffness", "stiffness", "N/m"),
            Column("free_length", "length without force", "m"),
            Column("damping", "force of the damper in line per rate of length", "N s/m"),
        ),
        optional=1,
    ),
    Card(
        "DAMPER",
        "damper",
        (
            whole("I", "number of body I, 0: the ground"),
            whole("J", "number of body J, 0: the ground"),
            *vector("P_i", "the end on body I, body axes", "m"),
            *vector("P_j", "the end on body J, body axes", "m"),
            Column("damping", "force per rate of length", "N s/m"),
        ),
    ),
    Card("GRAVITY", "gravity", vector("g", "the acceleration of gravity, global axes", "m/s^2")),
    Card(
        "VELOCITY",
        "velocity",
        (
            _BODY,
            *vector("v", "the velocity of the body's origin at the start, global axes", "m/s"),
            *vector("w", "the angular velocity at the start, global axes", "rad/s"),
        ),
        optional=3,
    ),
    Card("TOLERANCE", "tolerance", (Column("relative", "error tolerance of the integration"),)),
    Card(
        "GALF",
        "generalised-alpha",
        (
            Column("step", "length of the steps of the generalised-alpha method, 0: by the tolerance", "s"),
            Column("radius", "spectral radius at infinity, 1: no numerical damping, 0: the most"),
        ),
    ),
    Card(
        "RAD5",
        "radau",
        (Column("tolerance", "error tolerance of Radau's method of order 5, 0: that of TOLERANCE"),),
        optional=1,
    ),
    *FUNCTION_CARDS,
    *JOINT_CARDS,
    *SHAPE_CARDS,
)
BY_KEYWORD = {card.keyword: card for card in CARDS}


def read_young_deck(source: DeckText) -> Deck:
    """A YOUNG deck with the records of its dynamic cards, if it has any, behind those of kinematics.

    Raises DeckError with all faults of the cards.
    """
    deck = read_young(source)
    opening = _opening(deck)
    if opening is None:
        last = deck.one("time").at("step").place.line  # type: ignore[union-attr]
        return replace(deck, warnings=(*deck.warnings, *unread_lines(source.lines, last, BY_KEYWORD)))
    cards = _Cards(source, opening)
    cards.read()
    if any(fault.severity == "error" for fault in cards.faults):
        raise DeckError((*deck.warnings, *cards.faults))
    return replace(deck, records=cards.behind(deck.records), warnings=(*deck.warnings, *cards.faults))


def analysis_of(deck: Deck) -> str | None:
    """ "inverse" or "forward" for a deck with dynamic cards, None without."""
    opened = deck.section(SECTION)
    return opened[0]["analysis"] if opened else None


def takes_steps(deck: Deck) -> bool:
    """Return whether the motion is integrated; otherwise every row is solved for itself."""
    return analysis_of(deck) == FORWARD


def has_elements(deck: Deck) -> bool:
    """Return whether there are cards of elements at joints or of what drives them."""
    return analysis_of(deck) is not None and any(deck.section(card.section) for card in JOINT_CARDS)


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
    faults: list[Fault] = field(default_factory=FaultList)
    starts: dict[str, array] = field(default_factory=dict)  # of each section's cards, where in the text
    numbers: int = 0
    shapes_alone: bool = False

    def behind(self, records: Sequence[Record]) -> Sequence[Record]:
        """Return the records of the cards behind those of kinematics; many ones are made when looked at."""
        if isinstance(records, tuple) and self.numbers <= many_records.MANY_NUMBERS:
            return *records, *self.records
        blocks = [*blocks_of(records), *blocks_of(self.records[:1])]
        for section, starts in self.starts.items():
            blocks.append(Block(section, len(starts), partial(_again, self.source, section, starts)))
        return ManyRecords(blocks)

    def read(self) -> None:
        """Read all cards behind the opening line."""
        self.records.append(self._opening_record())
        card: list[Any] = []
        for word in words(self.source.lines, self.opening):
            if word.text == UNCLOSED:
                self.error(word.place, "", "a comment is opened here and never closed with }")
                break
            if _is_keyword(word) and not _wants_text(card):
                self._finish(card)
                card = [word]
                if word.text.upper() == LAST_CARD:
                    self.faults += cards_behind_end(self.source.lines, word.line, BY_KEYWORD)
                    return
            elif card:
                card.append(word)
            else:
                self.error(word.place, "", "a card begins with a keyword, such as MASS, FORCE or GRAVITY")
                card = [Word("", word.line, word.column)]
        self._finish(card)

    def error(self, place: Place, subject: str, message: str) -> Any:
        self.faults.append(Fault("error", message, place, subject, id="YOUNG-020"))

    def _opening_record(self) -> Record:
        found = MARKER.fullmatch(self.source.lines[self.opening - 1])
        self.shapes_alone = found["shapes"] is not None  # type: ignore[index]
        key = "shapes" if self.shapes_alone else "analysis"
        place = Place(self.opening, found.start(key) + 1, len(found[key]))  # type: ignore[index, union-attr]
        section, meaning = SECTION, "inverse: forces of the driven motion; forward: motion under forces"
        if self.shapes_alone:
            section, meaning = GEOMETRY, "shapes of bodies follow, for pictures"
        number = Number(key, found[key].lower(), meaning, "", place, found[key])  # type: ignore[index]
        return Record(section, 0, section, (number,))

    def _finish(self, card: list[Word]) -> None:
        """Make a record of a keyword and the words behind it."""
        if not card or not card[0].text:
            return
        keyword, *found = card
        kind = BY_KEYWORD.get(keyword.text.upper())
        if kind is None:
            self.error(keyword.place, "", _unknown(keyword.text))
            return
        if self.shapes_alone and kind not in SHAPE_CARDS:
            message = (
                f"{kind.keyword} is no shape; DYNAMICS in place of GEOMETRY opens cards with masses and loads"
            )
            self.error(keyword.place, "", message)
            return
        starts = self.starts.setdefault(kind.section, array("i"))
        starts.append(self.source.lines.starts[keyword.line - 1] + keyword.column - 1)
        columns = kind.columns_of(len(found))
        if columns is None:
            subject = f"{kind.section} {len(starts)}"
            self.error(keyword.place, subject, f"{kind.keyword} takes {kind.numbers}; read {len(found)}")
            return
        record = self.record(kind, columns, len(starts), keyword, found)
        self.numbers += len(columns)
        if self.numbers <= many_records.MANY_NUMBERS:
            self.records.append(record)

    def record(
        self,
        kind: Card,
        columns: tuple[Column, ...],
        number_of_card: int,
        keyword: Word,
        found: Sequence[Word],
    ) -> Record:
        """The record of a card with as many words as it needs; faults of its numbers are noted."""
        subject = f"{kind.section} {number_of_card}"
        numbers = [self._number(subject, *pair) for pair in zip(columns, found, strict=False)]
        left_out = columns[len(found) :]
        numbers += [
            Number(c.key, 0 if c.is_integer else 0.0, c.meaning, c.unit, keyword.place, "0") for c in left_out
        ]
        return Record(kind.section, number_of_card, subject, tuple(numbers))

    def _number(self, subject: str, column: Column, word: Word) -> Number:
        if column.is_text:
            return Number(column.key, word.text, column.meaning, column.unit, word.place, word.text)
        value = 0
        try:
            value, doubt = number.integer(word.text) if column.is_integer else number.real(word.text)  # type: ignore[assignment]
            if doubt:
                self.faults.append(
                    Fault("warning", f"{column.key}: {doubt}", word.place, subject, id="YOUNG-021")
                )
        except number.Misspelt as fault:
            self.error(word.place, subject, f"{column.key} {fault}")
        return Number(column.key, value, column.meaning, column.unit, word.place, word.text)


def _again(source: DeckText, section: str, starts: Any, index: int) -> "_ReadCard":
    kind = next(card for card in CARDS if card.section == section)
    return _ReadCard(source, kind, index + 1, starts[index])


class _ReadCard(Record):
    """A card of a large deck: places of its numbers are made when they are looked at."""

    def __init__(self, source: DeckText, kind: Card, number_of_card: int, start: int):
        names = {"section": kind.section, "number": number_of_card, "made": {}}
        names["subject"] = f"{kind.section} {number_of_card}"
        vars(self).update(names, _source=source, _kind=kind, _start=start)

    @cached_property
    def values(self) -> tuple[float | int, ...]:
        """Values of the numbers."""
        if not self._plain:
            return tuple(item.value for item in self.numbers)
        texts = self._plain[1].split()
        columns = self._kind.columns_of(len(texts))  # type: ignore[attr-defined]
        spellings = [number.integer if column.is_integer else number.real for column in columns]
        read = [spelled(text)[0] for spelled, text in zip(spellings, texts, strict=False)]
        return *read, *(0 if column.is_integer else 0.0 for column in columns[len(read) :])

    @cached_property
    def positions(self) -> dict[str, int]:
        """Return where among the numbers each key stands."""
        count = len(self._plain[1].split()) if self._plain else len(self.numbers)
        return {column.key: k for k, column in enumerate(self._kind.columns_of(count))}  # type: ignore[attr-defined]

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        """The numbers with their places."""
        behind = words_from(self._source.lines, self._start)  # type: ignore[attr-defined]
        keyword = next(behind)
        found = [next(behind)] if self._kind.begins_with_text else []  # type: ignore[attr-defined]
        found += takewhile(lambda word: not _is_keyword(word), behind)
        columns = self._kind.columns_of(len(found))  # type: ignore[attr-defined]
        return _Cards(self._source, 0).record(self._kind, columns, self.number, keyword, found).numbers  # type: ignore[attr-defined]

    @property
    def place(self) -> Place:
        """Place of the first number."""
        if self._plain is None:
            return self.numbers[0].place  # type: ignore[return-value]
        first = self._plain[1].split(maxsplit=1)[0]
        return Place(*self._source.lines.place_of(self._plain.start(1)), len(first))  # type: ignore[attr-defined, call-arg]

    @cached_property
    def _plain(self) -> Any:
        """The card in the text; None where a comment stands in it or behind it."""
        if self._kind.begins_with_text:  # type: ignore[attr-defined]
            return None
        found = _PLAIN_CARD.match(self._source.text, self._start)  # type: ignore[attr-defined]
        return found if found and not found[2] else None


def _is_keyword(word: Word) -> bool:
    return word.text[0].isalpha() and not NO_NUMBER.fullmatch(word.text)


def _wants_text(card: Any) -> Any:
    """Return whether a keyword alone has been read, behind which a word is no keyword."""
    kind = BY_KEYWORD.get(card[0].text.upper()) if len(card) == 1 else None
    return kind is not None and kind.begins_with_text


def _unknown(text: str) -> str:
    from difflib import get_close_matches

    close = get_close_matches(text.upper(), BY_KEYWORD, n=1)
    if close:
        return f"there is no card {number.shown(text)}; is {close[0]} meant?"
    return f"there is no card {number.shown(text)}, only {', '.join(BY_KEYWORD)} and {LAST_CARD}"
