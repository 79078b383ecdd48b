"""Quantities of a result as text: CSV, TSV, JSON Lines or aligned columns, the time first, block by block."""

import csv
import io
import json
import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from functools import partial
from math import prod
from typing import Any, TypeVar

import h5py
import numpy as np

from ...deck.units import AS_STORED, Wishes
from .quantities import Quantity, ResultError, read, time_at, time_quantity
from .quantity_names import TIME

FORMATS = ("csv", "tsv", "jsonl", "text")
SEPARATOR = {"csv": ",", "tsv": "\t"}
# A block of all datasets that are read holds about so many numbers, so that results may exceed the memory.
BLOCK_NUMBERS, BLOCK_ROWS = 2**20, 8192
# Report times are known to this part of a step; `--to 0.3` means the row at 0.30000000000000004 too.
TIME_TOLERANCE = 1e-6
TEXT_NUMBER, TEXT_WIDTH = "{:.9g}", 15
Column = TypeVar("Column")


def chosen_rows(result: h5py.File, start: float | None, stop: float | None, every: int) -> range:
    """Every `every`-th row from the first with a time >= `start` to the last with a time <= `stop`, s."""
    count = len(result[TIME])
    every = min(every, max(count, 1))  # HDF5 counts strides in 64 bits
    if (start is None and stop is None) or not count:
        return range(0, count, every)
    span = abs(time_at(result, -1) - time_at(result, 0))
    slack = TIME_TOLERANCE * span / max(count - 1, 1)
    first, end = 0, count
    if start is not None:
        first = bisect_left(range(count), start - slack, key=partial(time_at, result))
    if stop is not None:
        end = bisect_right(range(count), stop + slack, key=partial(time_at, result))
    return range(first, max(first, end), every)


def table_text(
    result: h5py.File,
    quantities: Sequence[Quantity],
    rows: range,
    style: str = "csv",
    wishes: Wishes = AS_STORED,
) -> Iterator[str]:
    """Pieces of the table's text: the heads, then the rows block by block; `style` is one of `FORMATS`.

    The time is the first column, whether it is among the quantities or not; `wishes`: its units.
    """
    time = time_quantity(result).in_units(wishes)
    columns = [time, *(quantity for quantity in quantities if quantity.dataset != TIME)]
    heads = [column.header for column in columns]
    if style != "jsonl":
        yield table_lines(heads, [heads], style)
    length = _block_length(result, columns)
    for first in range(0, len(rows), length):
        block = rows[first : first + length]
        values = read(result, columns, slice(block.start, block.stop, block.step)).tolist()
        yield table_lines(heads, values, style)


def fitting_groups(result: h5py.File, quantities: Sequence[Quantity], width: int) -> list[list[Quantity]]:
    """Return the quantities in groups whose aligned columns, with that of the time, take `width` characters.

    A group has one quantity at least.
    """
    time, *widths = widths_of([time_quantity(result).header, *(each.header for each in quantities)])
    return grouped(quantities, widths, width - time)


def grouped(columns: Sequence[Column], widths: Sequence[int], room: int) -> list[list[Column]]:
    """Return the columns in groups that take `room` characters beside their first column, gaps included.

    A group has one column at least.
    """
    groups: list[list[Column]] = []
    left = 0
    for column, width in zip(columns, widths, strict=True):
        if not groups or 2 + width > left:
            groups.append([])
            left = room
        groups[-1].append(column)
        left -= 2 + width
    return groups


def widths_of(heads: Sequence[str]) -> list[int]:
    """Return the widths of aligned columns; those of numbers have a unit in their heads."""
    return [max(len(head), TEXT_WIDTH if " [" in head else 0) for head in heads]


def table_lines(heads: Sequence[str], rows: Sequence[Sequence[Any]], style: str) -> str:
    """Return rows of cells as lines of text in one of `FORMATS`."""
    if style == "jsonl":
        records = (dict(zip(heads, map(_json, row), strict=True)) for row in rows)
        return "".join(json.dumps(record, allow_nan=False) + "\n" for record in records)
    if style == "text":
        widths = widths_of(heads)
        return "".join(_aligned(row, widths) for row in rows)
    page = io.StringIO()
    # The csv module writes the shortest digits that read back to the same double.
    csv.writer(page, delimiter=SEPARATOR[style], lineterminator="\n").writerows(rows)
    return page.getvalue()


def _aligned(row: Sequence[Any], widths: list[int]) -> str:
    cells = (TEXT_NUMBER.format(cell) if isinstance(cell, float) else str(cell) for cell in row)
    return "  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=True)).rstrip() + "\n"


def _json(cell: Any) -> Any:
    """Return the cell; JSON has no nan and no infinity, so they become None."""
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell


def function_points(
    result: h5py.File, quantities: Sequence[Quantity], rows: range, first: int
) -> list[tuple[int, str, list[tuple[float, float]]]]:
    """The rows of each quantity as points of functions `first`, `first` + 1, …: number, heading, points.

    Raises ResultError where a column holds what is no number, or where there is one row only.
    """
    columns = [time_quantity(result), *(quantity for quantity in quantities if quantity.dataset != TIME)]
    values = read(result, columns, slice(rows.start, rows.stop, rows.step))
    if len(values) < 2 or not np.isfinite(values).all():
        raise ResultError(
            result.filename, "a table needs two rows or more, and numbers in all", id="RESULT-050"
        )
    times = values[:, 0].tolist()
    return [
        (first + k, column.header, list(zip(times, values[:, k + 1].tolist(), strict=True)))
        for k, column in enumerate(columns[1:])
    ]


def list_text(quantities: Sequence[Any], style: str = "text") -> str:
    """Name, unit (SI) and meaning of quantities of a result, or of columns of a study, a line each."""
    heads = ("name", "unit", "meaning")
    rows = [(quantity.name, quantity.unit, quantity.long_name) for quantity in quantities]
    if style != "text":
        return table_lines(heads, rows if style == "jsonl" else [heads, *rows], style)
    widths = [max(len(row[k]) for row in rows) for k in (0, 1)]
    return "".join(
        f"{name.ljust(widths[0])}  {unit.ljust(widths[1])}  {reported}\n" for name, unit, reported in rows
    )


def _block_length(result: h5py.File, columns: list[Quantity]) -> int:
    paths = {column.dataset for column in columns}
    width = sum(prod(result[path].shape[1:]) for path in paths)
    return int(max(1, min(BLOCK_ROWS, BLOCK_NUMBERS // width)))
