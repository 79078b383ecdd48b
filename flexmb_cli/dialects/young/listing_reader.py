"""Reader of YOUNG's OUT tables: ours and the historic ones.

Historic fields run together when full (`-7.3304-1074.6427  0.0000245.3407`), so that blanks alone do
not part them; the number of decimals of each column does.  The spacing of the titles and the line ends
do not matter.  Lines that are no part of the layout are passed over.
"""

import re
import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.fortran_words import value_of
from ...deck.listing import LARGEST_INDEX, EchoLine, Listing, ListingForm, Section, TableError
from ...deck.number import hint
from ...deck.table_columns import HEADINGS, SECTIONS, Columns
from ...errors import Fault, Place
from .errata import young_errors
from .listing_rows import (
    echo_numbers,
    is_row_of,
    repeated_items,
    row_fault,
    split_index,
    split_row,
    unit_of,
    units_of_rows,
)

if TYPE_CHECKING:
    pass


FAST_LINES = 4096
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
    sections = {key: _section(key, lines, gathered, faults) for key, gathered in scan.sections.items()}
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


def _section(key: str, lines: list[str], gathered: _Gathered, faults: Any) -> Section:
    columns = gathered.columns
    width = len(columns.names)
    table = np.empty((len(gathered.text), width + 1))
    for start in range(0, len(gathered.text), FAST_LINES):
        texts = gathered.text[start : start + FAST_LINES]
        block = _read_together(texts, width)
        if block is None:
            block = _read_one_by_one(key, texts, gathered.line[start : start + FAST_LINES], columns, faults)
        table[start : start + FAST_LINES] = block
    return Section(
        columns.names,
        columns.kinds,
        np.array(gathered.step, dtype=np.int64),
        table[:, 0].astype(np.int64),
        np.array(gathered.line, dtype=np.int64),
        table[:, 1:],
        units_of_rows(gathered.text, columns),
        columns.item,
        columns.edits,
    )


def _read_together(texts: list[str], width: int) -> np.ndarray | None:
    """All numbers of the lines at once, shape (lines, 1 + width); None when fields may run together."""
    joined = "\n".join(texts) + "\n"
    decimals = [len(word.partition(".")[2]) for word in texts[0].split()[1:]]
    if len(decimals) != width or not _decimals_agree(joined, np.array(decimals), len(texts)):
        return None
    with warnings.catch_warnings():
        # numpy reports text that is no number by a warning.
        warnings.simplefilter("error")
        try:
            numbers = np.fromstring(joined, sep=" ")
        except (ValueError, DeprecationWarning):
            return None
    if numbers.size != len(texts) * (width + 1):
        return None
    table = numbers.reshape(-1, width + 1)
    index = table[:, 0]
    return table if ((index >= 1) & (index <= LARGEST_INDEX) & (index == np.floor(index))).all() else None


def _decimals_agree(joined: str, decimals: np.ndarray, lines: int) -> bool:
    """Return whether every point of the text is followed by just its column's digits.

    Without this `0.0000245.3407` would be read as 0.0000245 and 0.3407.
    """
    characters = np.frombuffer((joined + "\n" * 20).encode("utf-8"), dtype=np.uint8)
    points = np.flatnonzero(characters == ord("."))
    if points.size != lines * decimals.size or decimals.max(initial=0) > 17:
        return False
    last = points.reshape(lines, -1) + decimals
    digit = (characters >= ord("0")) & (characters <= ord("9"))
    return bool(digit[last].all() and not digit[last + 1].any())


def _read_one_by_one(
    key: str, texts: list[str], numbers: list[int], columns: Columns, faults: Any
) -> np.ndarray:
    block = np.full((len(texts), len(columns.names) + 1), np.nan)
    block[:, 0] = 0
    for row, (text, number) in enumerate(zip(texts, numbers, strict=True)):
        index, rest, offset = split_index(text)
        words = split_row(rest, columns)
        if not 1 <= index <= LARGEST_INDEX:
            sentence = f"a number of a {columns.item} is expected first, read {text[:offset].strip()!r}"
            faults.append(Fault("error", sentence, Place(number, 1, offset), key, id="YOUNG-059"))
        elif words is None:
            faults.append(row_fault(key, index, rest, number, offset, columns))
        else:
            block[row] = [index, *map(value_of, words)]
    return block
