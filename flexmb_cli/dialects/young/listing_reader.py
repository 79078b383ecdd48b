"""Reader of YOUNG's OUT tables: ours and the historic ones.

Historic fields run together when full (`-7.3304-1074.6427  0.0000245.3407`), so that blanks alone do
not part them; the number of decimals of each column does.  The spacing of the titles and the line ends
do not matter.  Lines that are no part of the layout are passed over.
"""

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from ...deck.edit import fixed
from ...deck.fortran_words import UNREADABLE, unit_of, value_of
from ...deck.listing import LARGEST_INDEX, EchoLine, Listing, ListingForm, Rows, Section, TableError
from ...deck.number import hint
from ...deck.table_columns import HEADINGS, OLD_DECIMALS, SECTIONS, Columns
from ...errors import Fault, Place
from ...solvers.as_printed.errors import OVERRUN, SCREW, TRANSPOSED, WRONG_INDEX

EARLIER = "listing of an earlier program: dde without the term of (4.64)"
DOUBLE_ROOT = "listing of an earlier program: e0 from the normalisation near its double root e0 = 0"
LOOSE_STOP = "listing of an earlier program: the iteration ended a digit short"


@dataclass(frozen=True)
class KnownError:
    """Cells of one body's or point's lines in every report row, or in the rows `steps` only, and the cause.

    Columns count from 1 after the number of the body or point.
    """

    deck: str
    section: str
    index: int
    columns: tuple[int, ...]
    cause: str
    steps: tuple[int, ...] | None = None

    def holds(
        self, index: int | np.ndarray, column: int | np.ndarray, step: int | np.ndarray
    ) -> bool | np.ndarray:
        """Return whether it covers the cells; the arguments are numbers or arrays that broadcast."""
        here = np.equal(index, self.index) & np.isin(column, self.columns)
        return here if self.steps is None else here & np.isin(step, self.steps)


ALL_TEN = tuple(range(1, 11))

YOUNG_ERRORS = (
    # Angular velocity and Euler parameter rates of the coupler.
    KnownError("IN4-BAR", "velocity", 2, (4, 5, 6, 7, 8, 9, 10), OVERRUN),
    # The driven body turns about x only: its y and z parts must be zero.
    KnownError("IN4-BAR", "acceleration", 1, (6, 7, 9, 10), TRANSPOSED),
    KnownError("IN4-BAR", "acceleration", 2, ALL_TEN, f"{TRANSPOSED}; {OVERRUN}"),
    KnownError("IN4-BAR", "acceleration", 3, ALL_TEN, f"{TRANSPOSED}; {OVERRUN}"),
    KnownError("IN4-BAR", "point", 1, (7,), TRANSPOSED),
    KnownError("IN5BODY", "acceleration", 1, (6, 7, 9, 10), TRANSPOSED),
    KnownError("IN5BODY", "acceleration", 2, ALL_TEN, f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN5BODY", "acceleration", 3, ALL_TEN, f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN5BODY", "acceleration", 4, (1, 2, 3, 5, 6, 7, 8, 9, 10), f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN5BODY", "point", 1, (7, 8, 9), f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN2-6-1", "position", 2, (2,), SCREW, (2,)),
    KnownError("IN2-6-1", "velocity", 2, (2,), SCREW, (1, 2, 3)),
    KnownError("IN2-6-1", "acceleration", 2, (2,), SCREW),
    KnownError("IN2-6-1", "point", 1, (2,), SCREW, (2, 3)),
    KnownError("IN2-6-1", "point", 1, (5,), SCREW, (1, 2, 3)),
    KnownError("IN2-6-1", "point", 1, (8,), SCREW),
    KnownError("IN1-4-3", "acceleration", 1, (4,), EARLIER, (0, 1, 2)),
    KnownError("IN1-4-3", "acceleration", 1, (6,), EARLIER, (1, 2, 3)),
    KnownError("IN1-4-3", "position", 1, (4,), DOUBLE_ROOT, (3,)),
    KnownError("IN1-4-3", "velocity", 1, (6,), DOUBLE_ROOT, (3,)),
    KnownError("IN1-4-3", "point", 1, (1, 3, 4, 6, 7, 9), DOUBLE_ROOT, (3,)),
    KnownError("IN1-4-3", "position", 1, (6,), LOOSE_STOP, (2,)),
    KnownError("IN1-4-3", "point", 1, (3,), LOOSE_STOP, (1, 2)),
    KnownError("IN1-4-3", "point", 1, (6, 7), LOOSE_STOP, (2,)),
)


def young_errors(*listings: str) -> tuple[KnownError, ...]:
    """The errors of the published listing that one of the files is named after: OUT4-BAR.* for IN4-BAR."""
    stems = {os.path.basename(name).split(".")[0].upper() for name in listings}
    decks = {f"IN{stem[3:]}" for stem in stems if stem.startswith("OUT")}
    return tuple(error for error in YOUNG_ERRORS if error.deck in decks)


INDEX = re.compile(r"\s*\d+(?=\s|$)")
NUMBER = re.compile(
    rf"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?|[-+]?(nan|inf)|\*+|{UNREADABLE}", re.IGNORECASE | re.ASCII
)
# A number of the echo; its widths are those of the answers, its stars show the width themselves.
_ECHO_LINE = re.compile(r"[-+.\d?*\s]*[\d?][-+.\d?*\s]*")
_ECHO_DECIMALS = 2
MOST_REPEATED_ITEMS = 20  # faults
INDEX_WIDTH = 3  # columns of the number of a body or point


def split_index(text: str) -> tuple[int, str, int]:
    """Number of the body or point (three columns wide), the rest of the line, and where that begins."""
    head = INDEX.match(text)
    end = head.end() if head else 3
    digits = text[:end].strip()
    is_number = digits.isdecimal() and digits.isascii() and len(digits) <= 9
    return (int(digits) if is_number else 0), text[end:], end


def split_row(rest: str, columns: Columns) -> Sequence[Any] | None:
    """Spellings of the numbers of a line, separated by blanks or else by the decimals of their columns."""
    words = rest.split()
    if len(words) == len(columns.names) and all(NUMBER.fullmatch(word) for word in words):
        return words
    for decimals in (columns.decimals, len(columns.decimals) * (OLD_DECIMALS,)):
        match = _pattern(decimals, columns.width).fullmatch(rest)
        if match:
            return match.groups()
    return None


def is_row_of(columns: Columns, line: str) -> Any:
    """Return whether a line reads as a body or point and its numbers."""
    index, rest, _ = split_index(line)
    return index > 0 and split_row(rest, columns) is not None


@lru_cache(maxsize=64)
def _pattern(decimals: tuple[int, ...], width: int) -> re.Pattern[str]:
    # Stars of one field are as many as it is wide; "?++" takes all question marks and gives none back.
    number = r"\s*([-+]?[\d?]*\.[\d?]{%d}|[-+]?nan|[-+]?inf|\*{%d}|\?++)"
    return re.compile("".join(number % (count, width) for count in decimals) + r"\s*")


def row_fault(key: str, index: int, rest: str, number: int, offset: int, columns: Columns) -> Fault:
    """Fault of a line that does not have the numbers of its columns; `rest` of it begins at `offset`."""
    words = list(re.finditer(r"\S+", rest))
    bad = next((word for word in words if not NUMBER.fullmatch(word[0])), None)
    shown = bad or (words[0] if words else None)
    place = Place(number, offset + (shown.start() if shown else 0) + 1, len(shown[0]) if shown else 1)
    expected = f"{len(columns.names)} numbers are expected ({columns.names[0]} … {columns.names[-1]})"
    there = f"{len(words)} are there{_other_block(len(words), columns)}"
    read = f"{bad[0]!r} is not a number of this table{hint(bad[0])}" if bad else there
    return Fault("error", f"{expected}, {read}", place, f"{key} of {columns.item} {index}", id="YOUNG-031")


def _other_block(words: int, columns: Columns) -> str:
    """Return which blocks have lines of so many numbers: the heading of one may be missing."""
    names = [key for key, one in SECTIONS.items() if one.item == columns.item and len(one.names) == words]
    return f", as many as of {' or '.join(names)}: is a heading missing above?" if names else ""


def repeated_items(key: str, section: Section) -> list[Fault]:
    """Return the faults of bodies or points that stand twice in the block of one report row."""
    _, first = np.unique(np.stack([section.step, section.index]), axis=1, return_index=True)
    faults = []
    for row in np.setdiff1d(np.arange(len(section.index)), first)[:MOST_REPEATED_ITEMS].tolist():
        message = f"{section.name_of(row)} stands twice in this block: is it another one?"
        place = Place(int(section.line[row]), 1, INDEX_WIDTH)
        faults.append(Fault("error", message, place, key, id="YOUNG-083"))
    return faults


def echo_numbers(number: int, title: str, line: str) -> EchoLine | None:
    """The line `number` of numbers below `title`; None when the line is text.  Echoes print two decimals."""
    if not _ECHO_LINE.fullmatch(line):
        return None
    words = re.findall(r"[-+]?\d*\.\d\d|[-+]?\d+(?![.\d])", line)
    if "".join(words) != "".join(line.split()):
        words = line.split()
    if not all(NUMBER.fullmatch(word) for word in words):
        return None
    edits = tuple(fixed(len(word), _ECHO_DECIMALS) for word in words) if "*" in line else ()
    values, units = tuple(map(value_of, words)), tuple(map(unit_of, words))
    return EchoLine(number, title, values, units, edits=edits)


_TIME = re.compile(r"\s*TIME\s*=\s*([-+]?\d*\.?\d+)\s*", re.IGNORECASE)


@dataclass
class _Gathered:
    """The lines of one section while the file is read."""

    columns: Columns
    text: list[str] = field(default_factory=list)
    step: list[int] = field(default_factory=list)
    line: list[int] = field(default_factory=list)


FORM = ListingForm(
    "YOUNG OUT table",
    "CONVERGENCE FAILED or RUN STOPPED",
    fewer_decimals=True,
    emulated=True,
    known_errors=young_errors,
)


def parse_listing(name: str, text: str) -> Listing | None:
    """The OUT table in `text`; None when it has no block and no echo of a YOUNG table.

    Raises `TableError` with the place of every line that cannot be read.
    """
    lines = text.split("\n")
    scan = _Scan()
    for number, line in enumerate(lines, 1):
        scan.take(number, line)
    if not scan.time and not scan.is_young:
        return None
    faults: list[Fault] = []
    sections = {key: _section(key, gathered, faults) for key, gathered in scan.sections.items()}
    faults += scan.faults
    if not faults:  # which may be why a block seems to go on
        faults = [fault for key, section in sections.items() for fault in repeated_items(key, section)]
    if faults:
        raise TableError(
            name, sorted(faults, key=lambda fault: fault.place.line if fault.place else 0), lines
        )
    time, words = np.array(scan.time), tuple(scan.words)
    return Listing(name, tuple(scan.echo), time, scan.time_unit, sections, scan.failed, FORM, words)


class _Scan:
    """Sorts the lines of a file into echo, times and sections."""

    def __init__(self) -> None:
        self.echo: list[EchoLine] = []
        self.time: list[float] = []
        self.time_unit = 0.001
        self.sections: dict[str, _Gathered] = {}
        self.faults: list[Fault] = []
        self.failed = False
        self.is_young = False
        self.words: list[tuple[int, str]] = []
        self._titles: set[str] = set()
        self._open: _Gathered | None = None
        # What a line of words closed: a page heading may stand within a section.
        self._interrupted: _Gathered | None = None
        self._title = ""

    def take(self, number: int, line: str) -> None:
        """Sort one line."""
        head = line.lstrip()[:1]
        if not head:
            return
        if self._open is not None and head.isdigit():
            self._take_row(self._open, number, line)
        elif self._interrupted is not None and is_row_of(self._interrupted.columns, line):
            self._open = self._interrupted
            self._take_row(self._open, number, line)
        elif (
            not self.time and head in "0123456789.+-?*" and (echo := echo_numbers(number, self._title, line))
        ):
            self.echo.append(echo)
        else:
            self._take_words(number, line)

    def _take_row(self, section: _Gathered, number: int, line: str) -> None:
        section.text.append(line)
        section.step.append(len(self.time) - 1)
        section.line.append(number)

    def _take_words(self, number: int, line: str) -> None:
        words = line.split()
        if words[0].startswith("TIME") or _TIME.fullmatch(line):
            self._open_block(number, line)
            return
        if "CONVERGENCE FAILED" in line or "RUN STOPPED" in line:
            self.failed = True
            return
        self._keep_words(number, " ".join(words))
        if words[0].upper() in HEADINGS and self.time:
            self._open_section(HEADINGS[words[0].upper()])
        elif words[0].upper() in ("BODY", "NO"):
            # Column titles begin a section; after an unknown heading nothing continues.
            self._interrupted = None
            if self._open is not None:
                self._take_title(self._open, words[1:])
        else:
            self._interrupted, self._open = self._open or self._interrupted, None
            self._title = " ".join(words)
            self.is_young = self.is_young or self._title in ("ENTER NUMBER OF", "-- KINEMATIC ANALYSIS --")

    def _keep_words(self, number: int, text: str) -> None:
        """Keep a line of text; a title that the blocks repeat is kept once."""
        if not any(character.isalpha() for character in text) or text in self._titles:
            return
        if self.time:
            self._titles.add(text)
        self.words.append((number, text))

    def _open_block(self, number: int, line: str) -> None:
        self._open = self._interrupted = None
        match = _TIME.fullmatch(line)
        if match is None:
            place = Place(number, line.index("TIME") + 1, len(line.strip()))
            read = f"read {line.strip()!r}{hint(line.partition('=')[2].strip())}"
            message = f"a time is expected after TIME=, {read}"
            self.faults.append(Fault("error", message, place, id="YOUNG-030"))
            return
        self.time.append(float(match[1]))
        self.time_unit = unit_of(match[1])

    def _open_section(self, key: str) -> None:
        self._interrupted, self._open = None, self.sections.setdefault(key, _Gathered(SECTIONS[key]))

    def _take_title(self, section: _Gathered, words: list[str]) -> None:
        """A title with fewer columns than the layout names those that are there."""
        standard = section.columns
        known = {name.lower(): k for k, name in enumerate(standard.names)}
        chosen = [known[word.lower()] for word in words if word.lower() in known]
        if len(words) == len(standard.names) or not words or len(chosen) < len(words):
            return
        section.columns = Columns(
            standard.item,
            tuple(standard.names[k] for k in chosen),
            tuple(standard.kinds[k] for k in chosen),
            tuple(standard.decimals[k] for k in chosen),
            standard.width,
        )


def _section(key: str, gathered: _Gathered, faults: list[Fault]) -> Section:
    columns, rows = gathered.columns, Rows()
    for text, step, number in zip(gathered.text, gathered.step, gathered.line, strict=True):
        index, rest, offset = split_index(text)
        words = split_row(rest, columns)
        if not 1 <= index <= LARGEST_INDEX:
            sentence = f"a number of a {columns.item} is expected first, read {text[:offset].strip()!r}"
            faults.append(Fault("error", sentence, Place(number, 1, offset), key, id="YOUNG-059"))
        elif words is None:
            faults.append(row_fault(key, index, rest, number, offset, columns))
        else:
            rows.add(number, step, words, index)
    groups = tuple(zip(columns.kinds, columns.names, strict=True))
    return rows.section(groups, columns.edits, columns.item)
