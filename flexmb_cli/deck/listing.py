"""A printed listing as numbers: what the readers of the dialects yield and `diff` compares."""

import sys
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from ..errors import DeckError, Fault
from .edit import Edit
from .fortran_words import unit_of, value_of
from .text import first_bytes, size_of

# Bytes.  The numbers of two listings take seven times their size in memory.
LARGEST_LISTING = 2**29
# No deck has more bodies; a larger number at the start of a line is another slip.
LARGEST_INDEX = 99999


class ListingForm(NamedTuple):
    """A type of listing, as `diff` compares it."""

    name: str  # in words
    mark_of_failure: str  # what ends the listing of a failed run, in words
    has_rows: bool = True  # of times: one without any is empty
    by_titles: bool = (
        False  # numbers of its echo belong to their titles, over however many lines they are spread
    )
    fewer_decimals: bool = False  # in the echoes of older programs
    emulated: bool = False  # whether its program's errors can be computed from a deck (`diff --deck`)
    # Known errors of historic programs for `--explain`.  Of the rows: function of the names of two files, of
    # items with section, deck, index, cause and holds(index, column, step).
    known_errors: Callable[..., Sequence[Any]] = lambda *names: ()
    # Of the echo: cause, and function of two arrays and the unit of their last digits: the cells it explains.
    echo_error: tuple[str, Callable[..., Any]] | None = None


NO_FORM = ListingForm("listing", "a mark of failure")


@dataclass(frozen=True)
class Section:
    """All lines of one section: line r is body or point `index[r]` of report row `step[r]`."""

    columns: tuple[str, ...]
    kinds: tuple[str, ...]
    step: np.ndarray  # (lines,) from 0
    index: np.ndarray  # (lines,) from 1
    line: np.ndarray  # (lines,) in the file, from 1
    values: np.ndarray  # (lines, columns)
    units: np.ndarray  # (lines, columns) one unit of the last printed digit; nan: unreadable
    item: str  # what the lines are of: body, point; empty when there is one line a row
    edits: tuple[Edit, ...] = ()  # of the columns, where an overfull field prints stars
    labels: dict[int, str] = field(default_factory=dict)  # names of what `index` counts, if not `item` n

    def name_of(self, line: int) -> str:
        """Name of what a line is of; empty when there is one line a row."""
        number = int(self.index[line])
        return self.labels.get(number, f"{self.item} {number}" if self.item else "")


class Rows:
    """The lines of one section while a file is read."""

    def __init__(self) -> None:
        self.steps, self.index, self.lines = array("q"), array("q"), array("q")
        self.values, self.units = array("d"), array("d")

    def add(self, line: int, step: int, words: Sequence[str], index: int = 1) -> None:
        """Add the numbers of a line, as they are spelled, of item `index` of report row `step`."""
        for numbers, number in ((self.lines, line), (self.steps, step), (self.index, index)):
            numbers.append(number)
        self.values.extend(map(value_of, words))
        self.units.extend(map(unit_of, words))

    def section(
        self,
        groups: Sequence[tuple[str, str]],
        edits: tuple[Edit, ...],
        item: str = "",
        labels: dict[int, str] | None = None,
    ) -> Section:
        """Return the section; `groups`: types of columns, and the names of those of each."""
        columns = [(name, kind) for kind, names in groups for name in names.split(",")]
        shape = len(self.lines), len(columns)
        step, index, line = (np.array(numbers, np.int64) for numbers in (self.steps, self.index, self.lines))
        values, units = (np.array(numbers).reshape(shape) for numbers in (self.values, self.units))
        names, kinds = (tuple(column[k] for column in columns) for k in (0, 1))
        return Section(names, kinds, step, index, line, values, units, item, edits, labels or {})


@dataclass(frozen=True)
class EchoLine:
    """A line of numbers in the echo of the input, and the text above it."""

    line: int
    title: str
    values: tuple[float, ...]
    units: tuple[float, ...]
    columns: tuple[str, ...] = ()
    kind: str = "echo"
    edits: tuple[Edit, ...] = ()

    def where(self, place: int) -> tuple[str, str, str]:
        """Section, item and column of one of its numbers, for a reader."""
        if not self.edits or self.kind == "echo":
            return self.kind, self.title, ""
        column = self.columns[place] if self.columns else f"number {place + 1}"
        return self.title, f"line {self.line}", column


@dataclass(frozen=True)
class Listing:
    """A listing as read; `form` says whose, `failed`: it ends with the mark of a failed run.

    Stars, which FORTRAN prints for a number that does not fit, are infinite.  A number that a typist could
    not read (`?`) is nan, and so is the unit of its last digit.  `words` are the lines of
    text, each with its place in the file and single blanks; what every report row repeats is there once.
    """

    name: str
    echo: tuple[EchoLine, ...]
    time: np.ndarray  # (rows,)
    time_unit: float
    sections: dict[str, Section]
    failed: bool = False
    form: ListingForm = NO_FORM
    words: tuple[tuple[int, str], ...] = ()


class TableError(DeckError):
    """A file to compare cannot be read (exit 2); `name` and `lines` are its own."""

    def __init__(self, name: str, faults: list[Fault], lines: Sequence[Any] = ()):
        super().__init__(faults)
        self.name = self.file = name
        self.lines = lines


def read_bytes(path: Path | str) -> bytes:
    """Content of a file; "-" is standard input.  Raises `TableError`."""
    try:
        if str(path) == "-":
            return _bounded(path, sys.stdin.buffer)
        with open(path, "rb") as file:
            return _bounded(path, file)
    except FileNotFoundError:
        fault = Fault("error", "no such file", id="DECK-006")
    except IsADirectoryError:
        fault = Fault("error", "it is a folder", id="DECK-055")
    except OSError as error:
        fault = Fault("error", f"cannot be read: {error.strerror}", id="DECK-056")
    raise TableError(str(path), [fault])


def _bounded(path: Path | str, file: BinaryIO) -> bytes:
    # A device or a pipe has no size, and may never end.
    content = b"" if size_of(file) > LARGEST_LISTING else first_bytes(file, LARGEST_LISTING + 1)
    if max(size_of(file), len(content)) > LARGEST_LISTING:
        reason = (
            f"is larger than {LARGEST_LISTING >> 20} MB: compare the HDF5 results, which are read in parts"
        )
        raise TableError(str(path), [Fault("error", reason, id="DECK-007")])
    return content


def plain_text(content: bytes) -> str:
    """Text of a listing with LF line ends; what is no UTF-8 is replaced."""
    return content.decode("utf-8", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
