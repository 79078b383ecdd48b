"""Reader of YOUNG's OUT tables: ours and the historic ones.

Historic fields run together when full (`-7.3304-1074.6427  0.0000245.3407`), so that blanks alone do
not part them; the number of decimals of each column does.  The spacing of the titles and the line ends
do not matter.  Lines that are no part of the layout are passed over.
"""

import re
from dataclasses import dataclass, field

import numpy as np

from ...deck.fortran_words import unit_of
from ...deck.listing import LARGEST_INDEX, EchoLine, Listing, ListingForm, Rows, Section, TableError
from ...deck.number import hint
from ...deck.table_columns import HEADINGS, SECTIONS, Columns
from ...errors import Fault, Place
from .errata import young_errors
from .listing_rows import echo_numbers, is_row_of, repeated_items, row_fault, split_index, split_row

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
            # Column titles begin a section; behind an unknown heading nothing continues.
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
            message = f"a time is expected behind TIME=, {read}"
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
