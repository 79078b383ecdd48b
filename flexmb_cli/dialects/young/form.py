"""Questions of `flexmb new young`, in the order of YOUNG's own dialogue, and the deck it gives.

Liang Yong, YOUNG dissertation (1996), listing of the program, procedures IN_BODY to IN_GROUN.  Records,
names, meanings and units are those of the reader's tables.
"""

import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from ...deck.dialogue import Entries, Form, Line, named, titled
from ...deck.questions import COUNT, INTEGER, MOST_ASKED, REAL, TEXT, WORD, Cell, Entry
from ...deck.record import DeckText, Record
from ...errors import DeckError, Fault
from ..elements_block.old_cards import LINES
from ..elements_block.questions import SECTION as ELEMENT_LINE
from ..elements_block.questions import block_lines, element_entries
from .build import build_young
from .build_model import build_model
from .cards import CARDS, SHAPE_CARDS, Card
from .dynamic_cards import FORWARD, INVERSE, LAST_CARD, analysis_of, read_young_deck
from .equation_count import imbalance
from .sections import COUNTS, YOUNG_SECTIONS, Column, drawing

_SHAPES = "GEOMETRY"
_ANALYSES = (FORWARD.upper(), INVERSE.upper(), _SHAPES)
_CARDS = {card.keyword: card for card in CARDS if card.keyword not in LINES["young"]}
_GEOM = SHAPE_CARDS[0]
# Where an empty answer is sensible: points and frames at the origin, at rest and not turned.
_ZERO = {"x", "y", "z", "e1", "e2", "e3", "C", "A", "value", "alpha", "beta", "gamma", "start"}
_ZERO |= {f"{point}.{axis}" for point in ("P", "P_i", "P_j", "centre") for axis in "xyz"}
_MEANING = f"FORWARD or INVERSE dynamics, or {_SHAPES}: shapes alone"
_ANALYSIS = Cell("analysis", _MEANING, "", WORD, _ANALYSES[0], _ANALYSES)
_OPENING = Entry("opening", 0, "cards after dT", (_ANALYSIS,))
_N_SHAPES = Cell("GEOM", "number of shapes, 0: lines between joints", "", INTEGER, "0", within=COUNT)


class YoungForm(Form):
    """The questions of a YOUNG deck of kinematics; with those of cards where a draft has answers to them."""

    dialect = "young"
    has_cards = True
    early = frozenset(("body", "I", "J", "direction"))
    of_whole = frozenset(("YOUNG-025", "YOUNG-026", "YOUNG-082"))  # on numbers of equations

    def entries(self, values: Mapping[str, str]) -> Entries:
        """Title, analysis where cards are requested, counts, the records that these announce, cards."""
        yield titled(refused="{}")
        self.cards = self.cards or f"{_OPENING.section}.analysis" in values
        opening = (yield _OPENING) if self.cards else None
        counts = yield Entry("counts", 0, "counts", tuple(map(_count, COUNTS.columns)))
        # Forward runs may leave degrees of freedom open, and repeat equations.
        wrong = "" if opening else imbalance({n.key: n.value for n in counts.numbers})
        if wrong:
            raise DeckError([Fault("error", wrong, id="YOUNG-029")])
        for section in YOUNG_SECTIONS[1:]:
            for k in range(1, counts[section.count] + 1) if section.count else [0]:
                subject = f"{section.subject} {k}" if k else section.subject
                entry = Entry(section.name, k, subject, ())
                turning = values.get(f"{entry.prefix}.direction") in ("4", "5", "6")
                cells = tuple(_cell(column, turning) for column in section.columns)
                text = drawing(section)
                topics = partial(_drawn, text) if text else None
                yield Entry(section.name, k, subject, cells, topics=topics)
        if opening:
            yield from _card_entries(counts["NBODY"], opening["analysis"] == _SHAPES)
            yield from element_entries()
        else:
            shapes = yield Entry("shapes", 0, "shapes for pictures", (_N_SHAPES,), optional=True)
            for k in range(1, shapes["GEOM"] + 1):
                yield _card_entry(_GEOM, k, counts["NBODY"])

    def lines(self, records: Sequence[Record]) -> list[Line]:
        """One record a line, as in Appendix B; comments name the numbers.  Block and cards follow."""
        of = {section.name: [r for r in records if r.section == section.name] for section in YOUNG_SECTIONS}
        lines: list[Line] = [[("{ ", ""), *named(records[0]), (" }", "")]] if records[0]["text"] else []
        lines.append([("{ Lengths in m, angles in rad, times in s; points in the axes of their body. }", "")])
        for section in YOUNG_SECTIONS:
            rows = [named(record) for record in of[section.name]]
            if section is COUNTS:
                # Those of the records so far.
                counts = {each.count: len(of[each.name]) for each in YOUNG_SECTIONS}
                rows = [[(" ".join(str(counts[column.key]) for column in COUNTS.columns), "")]]
            elif not section.count and not rows:
                rows = [[("0 0 1", "")]]  # before the time is known
            keys = " ".join(column.key for column in section.columns)
            lines += [[(f"{{ {section.subject}: {keys} }}", "")], *rows] if rows else []
        lines += block_lines(records)
        return [*lines, *_card_lines(records)]

    def read(self, source: DeckText, last: Record) -> Sequence[Fault]:
        """Build what needs no masses, and the whole where all others are there."""
        deck = read_young_deck(source)
        whole = last.section == ELEMENT_LINE or analysis_of(deck) is None
        model = build_model(deck, self.folder) if whole else build_young(deck)
        return [*deck.warnings, *model[1]]


def _count(column: Column) -> Cell:
    bodies = column.key == "NBODY"
    default, least = (None, 1) if bodies else ("0", 0)
    return Cell(column.key, column.meaning, "", INTEGER, default, within=(least, MOST_ASKED))


def _cell(column: Column, turning: bool = False, optional: bool = False, bodies: int = 0) -> Cell:
    """The question for a column; `bodies`: the most that the number of a body may be, 0 for any."""
    letter = TEXT if column.is_text else INTEGER if column.is_integer else REAL
    default = "0" if optional or column.key in _ZERO else "1" if column.key == "e0" else None
    within = (int("0: " not in column.meaning), bodies) if bodies and column.key in YoungForm.early else None
    meaning, unit = column.label(turning)
    return Cell(column.key, meaning, unit, letter, default, within=within, names=column.is_function)


def _drawn(text: str, topic: str) -> str:
    """Return the drawing of a joint, whatever topic is wanted."""
    return text


def _card_entry(card: Card, k: int, bodies: int) -> Entry:
    required = len(card.columns) - card.optional
    cells = (_cell(c, optional=at >= required, bodies=bodies) for at, c in enumerate(card.columns))
    return Entry(card.section, k, f"{card.section} {k}", tuple(cells))


def _card_entries(bodies: int, shapes: bool) -> Entries:
    """Yield the questions for the keywords of cards and for their numbers, until END."""
    words = (*((card.keyword for card in SHAPE_CARDS) if shapes else _CARDS), LAST_CARD)
    cell = Cell(
        "keyword", f"keyword of the next card, {LAST_CARD} after the last", "", WORD, LAST_CARD, words
    )
    counted: Counter[str] = Counter()
    for k in itertools.count(1):
        word = (yield Entry("card", k, f"card {k}", (cell,)))["keyword"]
        if word == LAST_CARD:
            return
        counted[word] += 1
        yield _card_entry(_CARDS[word], counted[word], bodies)


def _card_lines(records: Sequence[Record]) -> Iterator[Line]:
    """Yield the cards of shapes, or those of dynamics, with the line that opens them."""
    cards = {card.section: card for card in _CARDS.values()}
    cards_there = [record for record in records if record.section in cards]
    opened = next((record["analysis"] for record in records if record.section == "opening"), "")
    if not (opened or cards_there):
        return
    yield [(_SHAPES if opened in ("", _SHAPES) else f"DYNAMICS {opened.lower()}", "")]
    section = ""
    for record in cards_there:
        if opened and record.section != section:
            section = record.section
            yield [(f"{{ {' '.join(value.key for value in record.numbers)} }}", "")]
        yield [(f"{cards[record.section].keyword} ", ""), *named(record)]
    yield [(LAST_CARD, "")]
