"""Questions of `flexmb new young`, in the order of YOUNG's own dialogue, and the deck it gives.

Liang Yong, YOUNG dissertation (1996), listing of the program, procedures IN_BODY to IN_GROUN.  Records,
names, meanings and units are those of the reader's table.
"""

from collections.abc import Iterator, Sequence

from ....deck import number
from ....deck.questions import INTEGER, MOST_ASKED, REAL, TITLE_ENTRY, Cell, Entry
from ....deck.record import Number, Record
from ....errors import Fault
from ...elements_block.form import LINES, faults_of_line
from ..build import faults_of_last
from ..equation_count import imbalance
from ..sections import COUNTS, YOUNG_SECTIONS, Column, Section
from ..shape_cards import SHAPE_CARDS
from ..shapes import faults_of_shape
from .form_cards import OPENING, OPENING_ENTRY, card_entries, card_lines, faults_of_card, is_card

GEOM = SHAPE_CARDS[0]
SHAPES_ENTRY = Entry(
    "shapes",
    0,
    "shapes for pictures",
    (Cell("GEOM", "number of shapes, 0: lines between joints", letter=INTEGER, default="0"),),
    optional=True,
)


def shape_entries(values: dict[str, str]) -> Iterator[Entry]:
    """Yield the question for the number of shapes, and those for each of them."""
    yield SHAPES_ENTRY
    for k in range(1, _number_of_shapes(values) + 1):
        yield _shape_entry(k)


def _number_of_shapes(values: dict[str, str]) -> int:
    """Return how many shapes are to be asked for: none before the number is known and sensible."""
    try:
        count = number.integer(values["shapes.GEOM"])[0]
    except (KeyError, number.Misspelt):
        return 0
    return count if count <= MOST_ASKED else 0


def _shape_entry(k: int) -> Entry:
    given = len(GEOM.columns) - GEOM.optional
    cells = (
        Cell(column.key, column.meaning, column.unit, INTEGER if column.is_integer else REAL,
             None if at < given else "0")
        for at, column in enumerate(GEOM.columns)
    )  # fmt: skip
    return Entry(GEOM.section, k, f"shape {k}", tuple(cells))


def shape_lines(records: Sequence[Record]) -> list[tuple[str, str]]:
    """Return the lines of the shapes, with the prefix of each line's record."""
    shapes = [record for record in records if record.section == GEOM.section]
    cards = [
        (" ".join([GEOM.keyword, *(n.text for n in record.numbers)]), record.prefix) for record in shapes
    ]
    return [("GEOMETRY", ""), *cards, ("END", "")] if shapes else []


# Where an empty answer is sensible: joint points and frames at the origin, at rest and not turned.
_ZERO = {"x", "y", "z", "e1", "e2", "e3", "C", "A", "value", "alpha", "beta", "gamma", "start"}
_ZERO |= {f"P_{side}.{axis}" for side in "ij" for axis in "xyz"}
_DEFAULTS = {**dict.fromkeys(_ZERO, "0"), "e0": "1"}


class YoungForm:
    """The questions of a YOUNG deck of kinematics; with those of cards where a draft has answers to them."""

    dialect = "young"
    asks_cards = False

    def entries(self, values: dict[str, str]) -> list[Entry]:
        """Title, analysis where cards are requested, counts, the records that these announce, cards."""
        with_cards = self.asks_cards or f"{OPENING}.analysis" in values
        entries = [TITLE_ENTRY, *([OPENING_ENTRY] if with_cards else []), _entry(COUNTS, 0, values)]
        counts = _counts(values)
        for section in YOUNG_SECTIONS[1:] if counts else ():
            numbers = range(1, counts[section.count] + 1) if section.count else [0]
            entries += [_entry(section, k, values) for k in numbers]
        if counts:
            entries += card_entries(values) if with_cards else shape_entries(values)
        return entries

    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]:
        """Errors and warnings that the last record brings in."""
        last = records[-1]
        if last.section == "title":
            return _faults_of_title(last)
        if last.section == "counts":
            # Forward runs may leave degrees of freedom open, and repeat equations.
            return _faults_of_counts(last, complete and len(records) == 2)
        if last.section == OPENING:
            return []
        if last.section == LINES:
            return faults_of_line(records)
        if last.section == SHAPES_ENTRY.section:
            return _outside(last.numbers[0], 0, "shapes")
        first = next(k for k, record in enumerate(records) if record.section == "counts")
        bodies = records[first]["NBODY"]
        if last.section == GEOM.section and first == 1:
            return faults_of_shape(last, bodies) if complete else []
        if is_card(last):
            return faults_of_card(last, bodies)
        return faults_of_last(records[first + 1 :], bodies, complete)

    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]:
        """One record a line, as in Appendix B; comments name the numbers.  Cards follow."""
        title = records[0]["text"]
        lines = [(f"{{ {title} }}", records[0].prefix)] if title else []
        lines.append(("{ Lengths in m, angles in rad, times in s; points in the axes of their body. }", ""))
        section = ""
        for record in records[1:]:
            if is_card(record) or record.section == SHAPES_ENTRY.section:
                continue
            if record.section != section:
                section = record.section
                kind = record.subject.removesuffix(f" {record.number}")
                lines.append((f"{{ {kind}: {' '.join(n.key for n in record.numbers)} }}", ""))
            lines.append((" ".join(n.text for n in record.numbers), record.prefix))
        return [*lines, *(card_lines(records) if records[1].section == OPENING else shape_lines(records))]


class YoungFormWithCards(YoungForm):
    """The same with the analysis and its cards."""

    asks_cards = True


def _counts(values: dict[str, str]) -> dict[str, int]:
    """The counts by name, none before all are known and sensible: a slip must not announce a billion."""
    try:
        counts = {c.key: number.integer(values[f"counts.{c.key}"])[0] for c in COUNTS.columns}
    except (KeyError, number.Misspelt):
        return {}
    return counts if max(counts.values()) <= MOST_ASKED else {}


def _entry(section: Section, k: int, values: dict[str, str]) -> Entry:
    subject = f"{section.subject} {k}" if k else section.subject
    prefix = f"{section.name}.{k}" if k else section.name
    turning = values.get(f"{prefix}.direction") in ("4", "5", "6")
    return Entry(section.name, k, subject, tuple(_cell(section, c, turning) for c in section.columns))


def _cell(section: Section, column: Column, turning: bool) -> Cell:
    default = _DEFAULTS.get(column.key)
    if section is COUNTS and column.key != "NBODY":
        default = "0"
    letter = INTEGER if column.is_integer else REAL
    return Cell(column.key, *column.label(turning), letter, default)


def _faults_of_title(record: Record) -> list[Fault]:
    brace = next((brace for brace in "{}" if brace in record["text"]), "")
    message = f"the title becomes a comment, which cannot hold {brace}"
    return [Fault("error", message, record.place, "title", id="YOUNG-027")] if brace else []


def _outside(count: Number, least: int, subject: str) -> list[Fault]:
    if least <= count.value <= MOST_ASKED:
        return []
    message = f"{count.key} must be within {least}..{MOST_ASKED}; read {count.text}"
    return [Fault("error", message, count.place, subject, id="YOUNG-028")]


def _faults_of_counts(record: Record, complete: bool) -> list[Fault]:
    faults: list[Fault] = []
    for count in record.numbers:
        faults += _outside(count, 1 if count.key == "NBODY" else 0, "counts")
    if complete and not faults:
        wrong = imbalance({n.key: n.value for n in record.numbers})
        faults = [Fault("error", wrong, record.place, "counts", id="YOUNG-029")] if wrong else []
    return faults
