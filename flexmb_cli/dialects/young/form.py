"""What `flexmb new young` asks for, in the order of YOUNG's own dialogue, and the deck it gives.

Liang Yong, YOUNG dissertation (1996), listing of the program, procedures IN_BODY to IN_GROUN.  Records,
names, meanings and units are those of the reader's table.
"""

from collections.abc import Sequence

from ...deck import number
from ...deck.questions import INTEGER, MOST_ASKED, REAL, TITLE_ENTRY, Cell, Entry
from ...deck.record import Number, Record
from ...errors import Fault
from .build import faults_of_last
from .equation_count import imbalance
from .sections import COUNTS, YOUNG_SECTIONS, Column, Section
from .shape_cards import SHAPE_CARDS
from .shapes import faults_of_shape

# Where an empty answer is sensible: joint points and frames at the origin, at rest and not turned.
_ZERO = {"x", "y", "z", "e1", "e2", "e3", "C", "A", "value", "alpha", "beta", "gamma", "start"}
_ZERO |= {f"P_{side}.{axis}" for side in "ij" for axis in "xyz"}
_DEFAULTS = {**dict.fromkeys(_ZERO, "0"), "e0": "1"}
_GEOM = SHAPE_CARDS[0]
_SHAPES = Entry(
    "shapes",
    0,
    "shapes for pictures",
    (Cell("GEOM", "number of shapes, 0: lines between joints", letter=INTEGER, default="0"),),
    optional=True,
)


class YoungForm:
    """The questions of a YOUNG deck of kinematics."""

    dialect = "young"

    def entries(self, values: dict[str, str]) -> list[Entry]:
        """Title and counts, then the records that the counts announce."""
        entries = [TITLE_ENTRY, _entry(COUNTS, 0, values)]
        counts = _counts(values)
        for section in YOUNG_SECTIONS[1:] if counts else ():
            numbers = range(1, counts[section.count] + 1) if section.count else [0]
            entries += [_entry(section, k, values) for k in numbers]
        if counts:
            entries += [_SHAPES, *(_shape_entry(k) for k in range(1, _number_of_shapes(values) + 1))]
        return entries

    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]:
        """Faults and doubts that the last record brings in."""
        last = records[-1]
        if last.section == "title":
            return _faults_of_title(last)
        if last.section == "counts":
            return _faults_of_counts(last, complete)
        if last.section == "shapes":
            return _outside(last.numbers[0], 0, "shapes")
        if last.section == _GEOM.section:
            return faults_of_shape(last, records[1]["NBODY"]) if complete else []
        return faults_of_last(records[2:], records[1]["NBODY"], complete)

    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]:
        """One record a line, as in Appendix B; comments name the numbers."""
        title = records[0]["text"]
        lines = [(f"{{ {title} }}", records[0].prefix)] if title else []
        lines.append(("{ Lengths in m, angles in rad, times in s; points in the axes of their body. }", ""))
        section = ""
        shapes = [record for record in records if record.section == _GEOM.section]
        for record in records[1:]:
            if record.section in (_SHAPES.section, _GEOM.section):
                continue
            if record.section != section:
                section = record.section
                kind = record.subject.removesuffix(f" {record.number}")
                lines.append((f"{{ {kind}: {' '.join(n.key for n in record.numbers)} }}", ""))
            lines.append((" ".join(n.text for n in record.numbers), record.prefix))
        cards = [(" ".join([_GEOM.keyword, *(n.text for n in r.numbers)]), r.prefix) for r in shapes]
        return [*lines, ("GEOMETRY", ""), *cards, ("END", "")] if shapes else lines


def _counts(values: dict[str, str]) -> dict[str, int]:
    """The counts by name, none before all are known and sensible: a slip must not announce a billion."""
    try:
        counts = {c.key: number.integer(values[f"counts.{c.key}"])[0] for c in COUNTS.columns}
    except (KeyError, number.Misspelt):
        return {}
    return counts if max(counts.values()) <= MOST_ASKED else {}


def _number_of_shapes(values: dict[str, str]) -> int:
    """Return how many shapes are to be asked for: none before the number is known and sensible."""
    try:
        count = number.integer(values["shapes.GEOM"])[0]
    except (KeyError, number.Misspelt):
        return 0
    return count if count <= MOST_ASKED else 0


def _shape_entry(k: int) -> Entry:
    given = len(_GEOM.columns) - _GEOM.optional
    cells = (
        Cell(column.key, column.meaning, column.unit, INTEGER if column.is_integer else REAL,
             None if at < given else "0")
        for at, column in enumerate(_GEOM.columns)
    )  # fmt: skip
    return Entry(_GEOM.section, k, f"shape {k}", tuple(cells))


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
