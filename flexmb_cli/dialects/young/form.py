"""What `flexmb new young` asks for, in the order of YOUNG's own dialogue, and the deck it gives.

Liang Yong, YOUNG dissertation (1996), listing of the program, procedures IN_BODY to IN_GROUN.  Records,
names, meanings and units are those of the reader's table.
"""

from collections.abc import Sequence

from ...deck import number
from ...deck.questions import INTEGER, MOST_ASKED, REAL, TITLE_ENTRY, Cell, Entry
from ...deck.record import Record
from ...errors import Fault
from .build import faults_of_last
from .equation_count import imbalance
from .sections import COUNTS, YOUNG_SECTIONS, Column, Section

"""Largest count that is asked for one by one; a deck beyond it is a program's work."""

# Where an empty answer is sensible: joint points and frames at the origin, at rest and not turned.
_ZERO = {"x", "y", "z", "e1", "e2", "e3", "C", "A", "value", "alpha", "beta", "gamma", "start"}
_ZERO |= {f"P_{side}.{axis}" for side in "ij" for axis in "xyz"}
_DEFAULTS = {**dict.fromkeys(_ZERO, "0"), "e0": "1"}


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
        return entries

    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]:
        """Faults and doubts that the last record brings in."""
        last = records[-1]
        if last.section == "title":
            return _faults_of_title(last)
        if last.section == "counts":
            return _faults_of_counts(last, complete)
        return faults_of_last(records[2:], records[1]["NBODY"], complete)

    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]:
        """One record a line, as in Appendix B; comments name the numbers."""
        title = records[0]["text"]
        lines = [(f"{{ {title} }}", records[0].prefix)] if title else []
        lines.append(("{ Lengths in m, angles in rad, times in s; points in the axes of their body. }", ""))
        section = ""
        for record in records[1:]:
            if record.section != section:
                section = record.section
                kind = record.subject.removesuffix(f" {record.number}")
                lines.append((f"{{ {kind}: {' '.join(n.key for n in record.numbers)} }}", ""))
            lines.append((" ".join(n.text for n in record.numbers), record.prefix))
        return lines


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


def _faults_of_counts(record: Record, complete: bool) -> list[Fault]:
    faults = []
    for count in record.numbers:
        least = 1 if count.key == "NBODY" else 0
        if not least <= count.value <= MOST_ASKED:
            message = f"{count.key} must be within {least}..{MOST_ASKED}; read {count.text}"
            faults.append(Fault("error", message, count.place, "counts", id="YOUNG-028"))
    if complete and not faults:
        wrong = imbalance({n.key: n.value for n in record.numbers})
        faults = [Fault("error", wrong, record.place, "counts", id="YOUNG-029")] if wrong else []
    return faults
