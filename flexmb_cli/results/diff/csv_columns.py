"""Compare CSV and TSV tables of quantities with each other and with HDF5 results, column by column."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...deck.listing import TableError, plain_text, read_bytes
from ...errors import Fault
from ..quantities.quantities import names, read
from .hdf5 import kind_of, open_sound
from .report import Found, Report, are, counted
from .tolerances import CSV, Tolerances

TIME_HEAD = "time [s]"
# Rows belong together when their times agree to this part of the longest time.
SAME_TIME = 1e-9
SHOWN_HEADS = 5  # of columns that a table lacks
KIND_OF_NAME = (
    (r"body\..*\.e\d", "euler"), (r"body\..*\.de\d", "euler_rate"),
    (r"body\..*\.dde\d", "euler_acceleration"),
    (r"body\..*\.velocity\.\w", "velocity"), (r"body\..*\.omega\.\w", "omega"),
    (r"body\..*\.acceleration\.\w", "acceleration"), (r"body\..*\.alpha\.\w", "alpha"),
    (r"body\..*\.[xyz]", "position"), (r"point\..*\.velocity\.\w", "point_velocity"),
    (r"point\..*\.acceleration\.\w", "point_acceleration"), (r"point\..*", "point_position"),
    (r"coordinate\..*\.u", "speed"), (r"coordinate\..*", "coordinate"),
    (r"(reaction|held)\..*\.force\.\w", "force"), (r"(reaction|held)\..*\.torque\.\w", "torque"),
    (r"driver\..*\.effort", "effort"), (r"(energy|audit|elastic|modal)\..*", r"\1"),
)  # fmt: skip


@dataclass(frozen=True)
class Columns:
    """Columns by their heads, the time first; `whole`: there are no others in the result."""

    name: str
    heads: tuple[str, ...]
    kinds: dict[str, str]
    values: np.ndarray  # (rows, columns)
    whole: bool = False

    @property
    def time(self) -> np.ndarray:
        """Times of the rows, s."""
        return self.values[:, 0]


def compare_csv(report: Report, forms: Sequence[str], tolerances: Tolerances) -> None:
    """Compare two tables, or a table with an HDF5 result, of which the table may hold a selection."""
    a, b = (
        read_csv(path) if form == CSV else _read_result(path)
        for path, form in zip((report.a, report.b), forms, strict=True)
    )
    rows = _common_rows(report, a, b)
    for head in a.heads:
        if head in b.heads:
            _compare_column(report, head, (a, b), rows, tolerances)
    _report_missing(report, a, b, tolerances)
    _report_missing(report, b, a, tolerances)


def read_csv(path: str) -> Columns:
    """Return the columns of a CSV or TSV table.  Raises TableError with the line that cannot be read."""
    text = plain_text(read_bytes(path)).removeprefix("\ufeff")
    first = text.partition("\n")[0]
    separator = "\t" if first.startswith(f"{TIME_HEAD}\t") else ","
    rows = csv.reader(io.StringIO(text), delimiter=separator)
    try:
        heads = tuple(next(rows))
        if len(set(heads)) < len(heads):
            raise TableError(path, [Fault("error", "two columns have the same heading", id="DIFF-014")])
        values = [_numbers(path, rows.line_num, row, len(heads)) for row in rows if row]
    except csv.Error as error:
        raise TableError(
            path, [Fault("error", f"line {rows.line_num} is not a row of a CSV: {error}", id="DIFF-031")]
        ) from error
    kinds = {head: kind_of_name(head.partition(" [")[0]) for head in heads}
    return Columns(path, heads, kinds, np.array(values, dtype=float).reshape(-1, len(heads)))


def kind_of_name(name: str) -> str:
    """Return the type of a quantity, as tolerances name it, from the name in a heading."""
    if name == "time":
        return "time"
    for pattern, kind in KIND_OF_NAME:
        match = re.fullmatch(pattern, name)
        if match:
            return match.expand(kind)
    return "other"


def _numbers(path: str, line: int, row: list[str], count: int) -> list[float]:
    if len(row) != count:
        raise TableError(
            path, [Fault("error", f"line {line} has {len(row)} columns, the heading {count}", id="DIFF-015")]
        )
    try:
        return [float(cell) for cell in row]
    except ValueError as error:
        raise TableError(path, [Fault("error", f"line {line}: {error}", id="DIFF-016")]) from error


def _read_result(path: str) -> Columns:
    with open_sound(path) as file:
        if "time" not in file:
            message = "it has no times: a CSV table is compared with the result of a run"
            raise TableError(path, [Fault("error", message, id="DIFF-017")])
        quantities = names(file)
        kinds = {quantity.header: kind_of(quantity.dataset) for quantity in quantities}
        return Columns(path, tuple(kinds), kinds, read(file, quantities), whole=True)


def _common_rows(report: Report, a: Columns, b: Columns) -> tuple[np.ndarray, np.ndarray]:
    """Row numbers of both tables that belong together: by time, unless there are as many in both."""
    if len(a.time) == len(b.time):
        same = np.arange(len(a.time))
        return same, same
    rows = _rows_of_one_time(a, b)
    for one, other, rows_of_both in ((a, b, rows[0]), (b, a, rows[1])):
        alone = np.setdiff1d(np.arange(len(one.time)), rows_of_both)
        if alone.size:
            first = f"the first at t = {one.time[alone[0]]:.10g}"
            count = counted(alone.size, "row")
            report.missing.append(f"{count} of {one.name} {are(alone.size)} not in {other.name}, {first}")
    return rows


def _rows_of_one_time(a: Columns, b: Columns) -> tuple[np.ndarray, np.ndarray]:
    """Return numbers of rows of `a` and of `b` in pairs of one time, without a table of all pairs."""
    longest = max((abs(float(x.time[-1])) for x in (a, b) if len(x.time)), default=0.0)
    tolerance = SAME_TIME * longest if np.isfinite(longest) else 0.0
    order = np.argsort(b.time, kind="stable")
    first = np.searchsorted(b.time[order], a.time - tolerance, "left")
    last = np.searchsorted(b.time[order], a.time + tolerance, "right")
    counts = np.where(np.isfinite(a.time), last - first, 0)
    if counts.sum() > len(a.time) + len(b.time):
        message = "its rows do not fit those of the other table: one time stands in many of them"
        raise TableError(b.name, [Fault("error", message, id="DIFF-032")])
    rows = np.repeat(np.arange(len(a.time)), counts)
    within = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    return rows, order[first[rows] + within]


def _compare_column(
    report: Report,
    head: str,
    tables: tuple[Columns, Columns],
    rows: tuple[np.ndarray, np.ndarray],
    tolerances: Tolerances,
) -> Any:
    name = head.partition(" [")[0]
    kind = tables[1 if tables[1].whole else 0].kinds[head]
    a, b = (table.values[chosen, table.heads.index(head)] for table, chosen in zip(tables, rows, strict=True))
    time = tables[0].time[rows[0]]

    def describe(position: tuple[int], distance: float) -> Found:
        row = position[0]
        return Found(head, "", "", float(time[row]), float(a[row]), float(b[row]), distance)

    report.compare(kind, a, b, tolerances.named(name) or tolerances.of(kind), describe)


def _report_missing(report: Report, having: Columns, lacking: Columns, tolerances: Tolerances) -> None:
    """Report the columns of one table that the other lacks; those of a result in one line of words."""

    def counts(head: str) -> bool:
        named = tolerances.named(head.partition(" [")[0]) or tolerances.of(having.kinds[head])
        return not named.ignores

    absent = [head for head in having.heads if head not in lacking.heads and counts(head)]
    if not having.whole:
        report.missing.extend(f"{head}: not in {lacking.name}" for head in absent)
    elif absent:
        more = f" and {len(absent) - SHOWN_HEADS} more" if len(absent) > SHOWN_HEADS else ""
        names = ", ".join(absent[:SHOWN_HEADS]) + more
        report.words.append(f"not compared, not among the columns of {lacking.name}: {names}")
