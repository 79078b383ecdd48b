"""Questions of `flexmb new dafms`: the records of the reader's table of cards, body by body.

A flexible body is typed number by number or made from a uniform beam (`beam.py`).  The deck
itself is written by `deck_writer.py`.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...deck.questions import INTEGER, MOST_ASKED, TITLE_ENTRY, WORD, Cell, Entry
from ...deck.record import Record
from ...errors import Fault
from ..elements_block.form import COUNT as LINE_COUNT
from ..elements_block.form import line_entries
from .card import Card
from .cards import CARDS
from .deck_writer import ADDED, OF_EVERY_BODY, OPTIONAL, deck_lines
from .form_blocks import Answers, block_entries, counted
from .form_cards import body_entry, counted_entries
from .form_faults import faults_of

if TYPE_CHECKING:
    from collections.abc import Iterator


_KINDS = ("RIGID", "BEAM", "TYPED")
_TIME = Entry(
    "time",
    0,
    "time",
    (Cell("IT", "number of output intervals", letter=INTEGER), Cell("H", "length of an interval", "s")),
)


def _count_cell(card: Card) -> Cell:
    if card.layout == "entries":
        meaning = f"number of entries, {card.section.replace('_', ' ')}"
    else:
        meaning = f"1: with the card, {card.section.replace('_', ' ')}"
    if card.word == "GRAV":
        meaning += "; without it 9.8 m/s^2 along +axis 2"
    return Cell(card.word, meaning, letter=INTEGER, default="0")


_COUNTS = Entry(
    "counts",
    0,
    "counts",
    (
        Cell("N", "number of bodies", letter=INTEGER),
        Cell("NDM", "dimension, 2 or 3", letter=INTEGER, default="3"),
        *(_count_cell(CARDS[word]) for word in OPTIONAL),
    ),
)
# Last and optional: answers piped from a file that was written for the cards of FMBD.DAT give a deck still.
_ELEMENTS = Entry("elements", 0, "shapes and elements", (_count_cell(CARDS[ADDED]), LINE_COUNT), True)


class DafmsForm:
    """The questions of a DAFMS deck."""

    dialect = "dafms"

    def entries(self, values: dict[str, str]) -> list[Entry]:
        """Title, counts, time, hinges, elastic blocks, the cards of each body, the start, other cards."""
        answers = Answers(values)
        entries = [TITLE_ENTRY, _COUNTS]
        if not all(0 <= answers.integer(f"counts.{c.key}", -1) <= MOST_ASKED for c in _COUNTS.cells):
            return entries
        bodies = range(1, answers.integer("counts.N") + 1)
        entries += [_TIME, *(_body_entry(k) for k in bodies)]
        for k in bodies:
            entries += block_entries(answers, k)
        for k in bodies:
            entries += [body_entry(word, answers, k) for word in OF_EVERY_BODY]
        entries += [_state_entry(m, what) for m, what in enumerate(_coordinates(answers, bodies), 1)]
        for word in OPTIONAL:
            entries += counted_entries(word, answers, bodies)
        entries.append(_ELEMENTS)
        shapes, lines = (answers.integer(f"elements.{cell.key}", -1) for cell in _ELEMENTS.cells)
        if 0 <= shapes <= MOST_ASKED and 0 <= lines <= MOST_ASKED:
            entries += [*counted_entries(ADDED, answers, bodies, "elements"), *line_entries(lines)]
        return entries

    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]:
        """Return faults of ranges, columns and beams; `flexmb check` finds all others."""
        return faults_of(records, complete)

    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]:
        """The cards in the columns of their FORMATs."""
        return deck_lines(records)


def _flags(letter: str, motion: str) -> list[Cell]:
    return [
        Cell(f"{letter}.{a}", f"{motion} free, axis {a}; a flag", letter=INTEGER, default="0")
        for a in (1, 2, 3)
    ]


def _body_entry(k: int) -> Entry:
    cells = (
        Cell("L", "number of the parent; 0: inertial frame", letter=INTEGER, default=str(k - 1)),
        *_flags("NT", "translation of the hinge"),
        *_flags("NR", "rotation of the hinge"),
        Cell("kind", "RIGID, a uniform BEAM, or nodes and stiffness TYPED", "", WORD, "RIGID", _KINDS),
    )
    return Entry("body", k, f"body {k}", cells)


def _coordinates(answers: Answers, bodies: range) -> "Iterator[Any]":
    """Return what each coordinate is, in the order of card Y(L)."""
    for letter, motion in (("NR", "rotation about"), ("NT", "translation along")):
        for k in bodies:
            for a in (1, 2, 3):
                if answers.integer(f"body.{k}.{letter}.{a}") == 1:
                    yield f"{motion} axis {a}, hinge of body {k}"
    for k in bodies:
        axes, nodes = answers.axes(k)
        yield from (
            f"displacement along axis {a}, node {i} of body {k}" for i in counted(nodes) for a in axes
        )


def _state_entry(m: int, what: str) -> Entry:
    unit = "rad" if what.startswith("rotation") else "m"
    cells = (
        Cell("q", "coordinate at the start", unit, default="0"),
        Cell("u", "speed at the start", f"{unit}/s", default="0"),
    )
    return Entry("state", m, f"coordinate {m}: {what}", cells)
