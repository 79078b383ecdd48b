"""Masses and loads of a YOUNG deck: cards behind its last number, where the historic program stops reading.

A line that is exactly `DYNAMICS inverse` or `DYNAMICS forward` opens the cards; what stands between
dT and that line is prose, and a deck without it means what it always meant.  A card is a keyword and
its numbers, in any case of letters, on one line or several; `END` closes the cards, else the end of
the deck does.  `{...}` is a comment.
"""

import re

from ...deck import number
from ...deck.record import Deck, DeckText, Number, Record
from ...deck.words import UNCLOSED, Word, words
from ...errors import DeckError, Fault, Place
from ...quick_dataclass import dataclass, field, replace
from .reader import read_young
from .sections import Column

MARKER = re.compile(r"\s*DYNAMICS\s+(INVERSE|FORWARD)\s*(\{[^}]*\}\s*)?", re.IGNORECASE)
NAME = re.compile("DYNAMICS", re.IGNORECASE)
# One word behind DYNAMICS, or none, is a slip rather than prose.
NEARLY = re.compile(r"\s*(DYNAMICS(\s+[^\s{]+)?)\s*(\{[^}]*\}\s*)?", re.IGNORECASE)
# Words that stand for no number, where one is wanted, and are no keyword.
NO_NUMBER = re.compile(r"nan|inf(inity)?", re.IGNORECASE)
SECTION = "dynamics"
CLOSING = "END"
INVERSE, FORWARD = "inverse", "forward"


@dataclass(frozen=True)
class Card:
    """A card: its keyword, the section its records form, and its columns.

    The last `optional` columns may be left out and are then 0.
    """

    keyword: str
    section: str
    columns: tuple[Column, ...]
    optional: int = 0


def _whole(key, meaning):
    return Column(key, meaning, is_integer=True)


def _vector(key, meaning, unit):
    return tuple(Column(f"{key}.{axis}", f"{axis} of {meaning}", unit) for axis in "xyz")


_BODY = _whole("body", "number of the body")
_FOLLOWING = _whole("following", "0: global axes, 1: the axes of the body, turning with it")

CARDS = (
    Card(
        "MASS",
        "mass",
        (
            _BODY,
            Column("m", "mass", "kg"),
            *_vector("centre", "the centre of mass, body axes", "m"),
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
            *_vector("P", "the point of action, body axes", "m"),
            *_vector("F", "the force", "N"),
            _FOLLOWING,
        ),
        optional=1,
    ),
    Card("TORQUE", "torque", (_BODY, *_vector("T", "the torque", "N m"), _FOLLOWING), optional=1),
    Card(
        "SPRING",
        "spring",
        (
            _whole("I", "number of body I"),
            _whole("J", "number of body J"),
            *_vector("P_i", "the end on body I, body axes", "m"),
            *_vector("P_j", "the end on body J, body axes", "m"),
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
            _whole("I", "number of body I"),
            _whole("J", "number of body J"),
            *_vector("P_i", "the end on body I, body axes", "m"),
            *_vector("P_j", "the end on body J, body axes", "m"),
            Column("damping", "force per rate of length", "N s/m"),
        ),
    ),
    Card("GRAVITY", "gravity", _vector("g", "the acceleration of gravity, global axes", "m/s^2")),
    Card(
        "VELOCITY",
        "velocity",
        (
            _BODY,
            *_vector("v", "the velocity of the body's origin at the start, global axes", "m/s"),
            *_vector("w", "the angular velocity at the start, global axes", "rad/s"),
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
)
BY_KEYWORD = {card.keyword: card for card in CARDS}


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
    return replace(deck, records=(*deck.records, *cards.records), warnings=(*deck.warnings, *cards.faults))


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
    faults: list[Fault] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)

    def read(self):
        """Read all cards behind the opening line."""
        self.records.append(self._opening_record())
        card = []
        for word in words(self.source.lines, self.opening):
            if word.text == UNCLOSED:
                self.error(word.place, "", "a comment is opened here and never closed with }")
                break
            if word.text[0].isalpha() and not NO_NUMBER.fullmatch(word.text):
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
        self.counts[kind.section] = self.counts.get(kind.section, 0) + 1
        subject = f"{kind.section} {self.counts[kind.section]}"
        least, most = len(kind.columns) - kind.optional, len(kind.columns)
        if not least <= len(found) <= most:
            asked = f"{most}" if least == most else f"{least} to {most}"
            keys = " ".join(column.key for column in kind.columns)
            message = f"{kind.keyword} takes {asked} numbers ({keys}); read {len(found)}"
            self.error(keyword.place, subject, message)
            return
        numbers = [self._number(subject, *pair) for pair in zip(kind.columns, found, strict=False)]
        left_out = kind.columns[len(found) :]
        numbers += [
            Number(c.key, 0 if c.is_integer else 0.0, c.meaning, c.unit, keyword.place, "0") for c in left_out
        ]
        self.records.append(Record(kind.section, self.counts[kind.section], subject, tuple(numbers)))

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


def _unknown(text):
    from difflib import get_close_matches

    near = get_close_matches(text.upper(), BY_KEYWORD, n=1)
    hint = f"; is {near[0]} meant?" if near else ""
    return f"there is no card {number.shown(text)}, only {', '.join(BY_KEYWORD)} and {CLOSING}{hint}"
