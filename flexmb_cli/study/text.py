"""The table of a study: a row a case, as text; and its numbers, parameters and results of solved cases."""

import fnmatch
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

import h5py
import numpy as np

from ..deck.record import DeckText
from ..deck.toml_table import TomlError, toml_table
from ..deck.units import Wishes, converted
from ..errors import Fault, visible
from ..results.hdf5.stored_result import Damaged, attribute, check_shapes, check_structure, understood
from ..results.quantities.quantities import NOTHING, SHOWS_ALL, ResultError
from ..results.quantities.quantity_names import folded
from ..results.quantities.table import grouped, table_lines, widths_of
from .table import NUMBERS_WRITTEN

CASE, EXIT_CODE, MESSAGE = "case", "exit_code", "message"
GROUPS = ("parameter", "result")


@dataclass(frozen=True)
class StudyColumn:
    """A column of the table: its dataset, unit, meaning, and how many numbers a case has (0: just one)."""

    path: str
    unit: str
    long_name: str
    length: int
    factor: float = 1.0  # of its numbers in the table

    def in_units(self, wishes: Wishes) -> "StudyColumn":
        """Return the column in the units that are wanted."""
        unit, factor = converted(self.unit, wishes)
        return replace(self, unit=unit, factor=factor * self.factor)

    @property
    def name(self) -> str:
        """The name, as the column of a Parquet table: `parameter.driver.1.B`, `result.top`."""
        return self.path.replace("/", ".", 1)

    @property
    def label(self) -> str:
        """The name without its group, with the unit, as pictures have it."""
        return f"{self.path.partition('/')[2]} [{self.unit}]"

    @property
    def heads(self) -> list[str]:
        """Heads of the columns of text, with units."""
        unit = f" [{self.unit}]" if "/" in self.path else ""
        if not self.length:
            return [f"{self.name}{unit}"]
        return [f"{self.name}.{row}{unit}" for row in range(1, self.length + 1)]

    def is_called(self, pattern: str) -> bool:
        """Return whether `pattern`, with `*` and `?`, means this column; its group may be left out."""
        names = {folded(self.name), folded(self.path.rpartition("/")[2] or self.name)}
        return any(name == folded(pattern) or fnmatch.fnmatchcase(name, folded(pattern)) for name in names)


@contextmanager
def open_study(path: str) -> Iterator[h5py.File]:
    """The table at `path`, open for reading.  Raises ResultError when it shows to be damaged."""
    try:
        with h5py.File(path, "r") as file, understood():
            check_structure(file)
            yield file
    except Damaged as fault:
        raise ResultError(path, f"a damaged table: {fault}", id="STUDY-021") from fault


def study_columns(table: h5py.File) -> list[StudyColumn]:
    """Every column: the case, parameters, results, each by the alphabet, exit code, rows, message."""
    paths = [f"{group}/{name}" for group in GROUPS for name in table.get(group, ())]
    return [_column(table, path) for path in (CASE, *paths, EXIT_CODE, "rows", MESSAGE)]


def _column(table: h5py.File, path: str) -> StudyColumn:
    axes = "cr" if getattr(table[path], "ndim", 1) > 1 else "c"
    check_shapes(table, {CASE: "c", path: axes}, {})
    dataset = table[path]
    unit, long_name = attribute(dataset, "units"), attribute(dataset, "long_name")
    if len(dataset) != len(table[CASE]):
        counts = f"{len(dataset)} rows and /case {len(table[CASE])}"
        raise ResultError(table.filename, f"a damaged table: /{path} has {counts}", id="STUDY-022")
    return StudyColumn(path, unit, long_name, dataset.shape[1] if dataset.ndim > 1 else 0)


def chosen_columns(
    columns: Sequence[StudyColumn], patterns: Iterable[str], file: str = ""
) -> list[StudyColumn]:
    """The columns that `patterns` name, the case first; without any, all but series, rows and messages.

    Raises ResultError for a pattern that names none, with `file`, the name of the table.
    """
    patterns = list(patterns)
    if not patterns:
        return [column for column in columns if column.path not in ("rows", MESSAGE) and not column.length]
    names = {columns[0]: None}
    for pattern in patterns:
        named = [column for column in columns if column.is_called(pattern)]
        if not named:
            raise ResultError(file, _unknown(columns, pattern), id="STUDY-023")
        names.update(dict.fromkeys(named))
    return list(names)


def _unknown(columns: Sequence[StudyColumn], pattern: str) -> str:
    known = {column.path.rpartition("/")[2]: column.name for column in columns}
    close = [known[word] for word in get_close_matches(pattern, known, cutoff=0.4)]
    hint = f"; near it are {', '.join(close)}" if close else ""
    return f"{pattern or NOTHING}: the study has no such parameter or result{hint}{SHOWS_ALL}"


def study_text(
    table: h5py.File,
    columns: Sequence[StudyColumn],
    every: int = 1,
    style: str = "csv",
    shown: Sequence[int] | None = None,
) -> Iterator[str]:
    """Pieces of the text of every `every`-th case, block by block; `style` is one of `table.FORMATS`.

    `shown`: the places of the heads that appear; without it all do.
    """
    heads = _heads(columns)
    shown = range(len(heads)) if shown is None else shown
    heads = [heads[k] for k in shown]
    if style != "jsonl":
        yield table_lines(heads, [heads], style)
    count = len(table[CASE])
    cases = range(0, count, min(every, max(count, 1)))  # HDF5 counts strides in 64 bits
    length = max(1, NUMBERS_WRITTEN // sum(max(column.length, 1) for column in columns))
    for first in range(0, len(cases), length):
        block = cases[first : first + length]
        rows = _rows(table, columns, slice(block.start, block.stop, block.step))
        yield table_lines(heads, [[row[k] for k in shown] for row in rows], style)


def fitting_heads(columns: Sequence[StudyColumn], width: int) -> list[list[int]]:
    """Return the places of the heads in groups whose aligned columns take `width` characters.

    Each group begins with the case.  Messages, which are prose of any length, have a group of their own.
    """
    heads = _heads(columns)
    widths = widths_of(heads)
    room = width - widths[0]
    needed = [room if head == MESSAGE else size for head, size in zip(heads, widths, strict=True)]
    return [[0, *group] for group in grouped(range(1, len(heads)), needed[1:], room)] or [[0]]


def _heads(columns: Sequence[StudyColumn]) -> list[str]:
    return [head for column in columns for head in column.heads]


def _rows(table: h5py.File, columns: Sequence[StudyColumn], cases: slice) -> list[Any]:
    """Cells of the cases, row by row: whole numbers, numbers and text."""
    cells = []
    for column in columns:
        dataset = table[column.path]
        if column.path == MESSAGE:
            values = [visible(text) for text in dataset.asstr(errors="replace")[cases].tolist()]
        else:
            values = dataset[cases] if column.factor == 1.0 else dataset[cases] * column.factor
        cells += np.reshape(values, (len(values), -1)).T.tolist()
    return list(zip(*cells, strict=True))


def study_notes(table: h5py.File, columns: Sequence[StudyColumn], named: bool) -> list[Fault]:
    """Return notes on what the text leaves out: series that were not named, and cases that failed."""
    series = [column.name for column in study_columns(table) if column.length]
    message = f"name a series to see it: {', '.join(series)}"
    notes = [] if named or not series else [Fault("note", message, id="STUDY-055")]
    return notes if any(column.path == MESSAGE for column in columns) else [*notes, *failed_notes(table)]


def failed_notes(table: h5py.File) -> list[Fault]:
    """Return a note on the cases that failed, none where none did."""
    failed = int(np.count_nonzero(table[EXIT_CODE][:]))
    message = (
        f"{failed} of {len(table[CASE])} cases failed and have nan for results; the column message says why"
    )
    return [Fault("note", message, id="STUDY-056")] if failed else []


@dataclass(frozen=True)
class CasesTable:
    """Solved cases by columns, which are arrays (cases,): `parameters` and `results` by their headings."""

    deck_name: str
    parameters: dict[str, np.ndarray]
    results: dict[str, np.ndarray]
    failed: int

    @property
    def varied(self) -> dict[str, np.ndarray]:
        """The parameters with more than one value."""
        return {name: values for name, values in self.parameters.items() if np.unique(values).size > 1}

    @property
    def is_grid(self) -> bool:
        """Return whether two parameters vary and every pair of their values was solved once."""
        axes = list(self.varied.values())
        if len(axes) != 2:
            return False
        pairs = np.unique(np.column_stack(axes), axis=0)
        sizes = [np.unique(axis).size for axis in axes]
        return len(pairs) == len(axes[0]) == sizes[0] * sizes[1]


def cases_table(
    table: h5py.File, patterns: Iterable[str], file: str, with_results: bool = True
) -> CasesTable:
    """Return the solved cases of an open study; `patterns` choose results, without any all single numbers.

    Raises ResultError for a pattern that names none, a series, and a study without a solved case.
    """
    columns = study_columns(table)
    columns_shown = [column for column in chosen_columns(columns, patterns, file) if _is(column, "result")]
    series = [column.name for column in columns_shown if column.length]
    if with_results and (series or not columns_shown):
        message = (
            f"{series[0]} is a series of each case: draw it alone"
            if series
            else "no result with one number is named"
        )
        raise ResultError(file, f"{message}; name results that are one number a case", id="STUDY-004")
    solved = table[EXIT_CODE][:] == 0
    if not solved.any():
        raise ResultError(file, "nothing to draw: no case was solved", id="STUDY-019")
    parameters = sorted((column for column in columns if _is(column, "parameter")), key=_as_listed(table))
    return CasesTable(
        table.attrs["deck_name"],
        {column.label: table[column.path][:][solved] for column in parameters},
        {column.label: table[column.path][:][solved] for column in columns_shown if with_results},
        int((~solved).sum()),
    )


def _as_listed(table: h5py.File) -> Callable[[StudyColumn], int]:
    """Return the place of a parameter in the text of the study; a text that is none says nothing."""
    try:
        listed = toml_table(DeckText("study", table["study"].asstr()[()], "")).get("parameters", {})
    except (TomlError, KeyError):
        listed = {}
    places = {f"parameter/{name}": number for number, name in enumerate(listed)}
    return lambda column: places.get(column.path, len(places))


def _is(column: StudyColumn, group: str) -> bool:
    return column.path.startswith(f"{group}/")
