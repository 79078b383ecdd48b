"""The table of a study, a row a case: HDF5, or Parquet by its suffix.

Rows are written in blocks as they come: a study may be larger than the memory.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import h5py
import numpy as np

from ..extras import needed
from ..results.files.disk_failures import FullDiskGuard, located
from ..results.files.replaced_file import Replacement
from ..results.hdf5.result_file import FILE_FORMAT, TEXT, printable_name
from ..version import __version__

# 2: series have a dimension scale along their report rows, too.
CONVENTIONS = "flexmb-study-2"
NUMBERS_WRITTEN = 2**17  # written at a time
PARQUET = ".parquet"


@dataclass(frozen=True)
class Column:
    """A column of numbers: `path` in HDF5, unit, meaning, and how many numbers a row has (0: just one)."""

    path: str
    units: str
    long_name: str
    length: int = 0


@dataclass(frozen=True)
class TableHead:
    """Head of a table: texts of study and deck, name and digest of the deck, columns in order, rows.

    `summary`: datasets of HDF5 that have no row for each case, arrays of numbers or lists of texts.
    """

    study: str
    deck: str
    deck_name: str
    deck_sha256: str
    columns: tuple[Column, ...]
    rows: int
    summary: tuple[tuple[Column, Any], ...] = ()


# A row: case number from 1, exit code, report rows solved, message, and the numbers of the columns.
Row = tuple[int, int, int, str, list[Any]]
COUNTS = (("case", "number of the case"), ("exit_code", "0 when the case was solved, else as of flexmb run"),
          ("rows", "report rows solved"))  # fmt: skip


def write_table(path: str, head: TableHead, rows: Iterable[Row]) -> None:
    """Write the table; it appears whole at `path`, or not at all.

    Raises OutputError when it cannot be written, MissingExtra without pyarrow.
    """
    write = _write_parquet if path.endswith(PARQUET) else _write_hdf5
    require_library(path)
    place = Replacement(path, special=False)
    try:
        with located(path):
            write(place, head, rows)
    except BaseException:
        place.discard()
        raise
    place.commit()


def _blocks(head: TableHead, rows: Iterable[Any]) -> Iterator[list[Row]]:
    size = max(1, NUMBERS_WRITTEN // (4 + sum(max(1, column.length) for column in head.columns)))
    rows = iter(rows)
    while block := list(islice(rows, size)):
        yield block


def _write_hdf5(place: Replacement, head: TableHead, rows: Iterable[Any]) -> None:
    with (
        FullDiskGuard(place.duplicate()) as disk,
        disk.blamed(),
        h5py.File(disk, "w", libver=FILE_FORMAT) as file,
    ):
        _fill(file, head, rows, disk)


def _fill(file: h5py.File, head: TableHead, rows: Iterable[Any], disk: FullDiskGuard) -> None:
    datasets = _datasets(file, head)
    _add_summary(file, head)
    start = 0
    for block in _blocks(head, rows):
        with disk.blamed():  # a long study need not be gone through for nothing
            stop = start + len(block)
            counts = list(zip(*block, strict=True))
            for name, values in zip(("case", "exit_code", "rows"), counts, strict=False):
                datasets[name][start:stop] = values
            datasets["message"][start:stop] = counts[3]
            for k, column in enumerate(head.columns):
                datasets[column.path][start:stop] = np.array([row[4][k] for row in block])
            start = stop


def _datasets(file: h5py.File, head: TableHead) -> dict[str, h5py.Dataset]:
    attributes = {
        "Conventions": CONVENTIONS, "flexmb_version": __version__,
        "deck_name": printable_name(head.deck_name), "deck_sha256": head.deck_sha256,
    }  # fmt: skip
    file.attrs.update(attributes)
    for name, text in (("study", head.study), ("deck", head.deck)):
        _describe(file.create_dataset(name, data=text, dtype=TEXT), "1", f"text of the {name}")
    datasets = {name: _dataset(file, name, head.rows, "i8", long_name) for name, long_name in COUNTS}
    datasets["message"] = _dataset(file, "message", head.rows, TEXT, "why the case failed")
    for column in head.columns:
        shape = (head.rows, column.length) if column.length else head.rows
        datasets[column.path] = _dataset(file, column.path, shape, "f8", column.long_name, column.units)
    datasets["case"].make_scale("case")
    for name, dataset in datasets.items():
        if name != "case":
            dataset.dims[0].attach_scale(datasets["case"])
    for length in sorted({column.length for column in head.columns if column.length}):
        scale = _row_scale(file, length)
        for column in head.columns:
            if column.length == length:
                datasets[column.path].dims[1].attach_scale(scale)
    return datasets


def _add_summary(file: h5py.File, head: TableHead) -> None:
    for column, values in head.summary:
        is_text = isinstance(values, list)
        dataset = file.create_dataset(column.path, data=values, dtype=TEXT if is_text else "f8")
        _describe(dataset, column.units, column.long_name)
        for axis, length in enumerate(dataset.shape):
            name = f"entry_{length}"
            if name not in file:
                file[name] = np.arange(1, length + 1)
                file[name].make_scale(name)
                _describe(file[name], "1", "number of the entry")
            dataset.dims[axis].attach_scale(file[name])


def _row_scale(file: h5py.File, length: int) -> h5py.Dataset:
    """The scale along series of so many report rows, `/row`; further ones have their length in the name."""
    name = f"row_{length}" if "row" in file else "row"
    scale = file.create_dataset(name, data=np.arange(1, length + 1))
    scale.make_scale(name)
    _describe(scale, "1", "number of the report row of a series")
    return scale


def _dataset(
    file: h5py.File,
    path: str,
    shape: int | tuple[int, int],
    kind: np.dtype | str,
    long_name: str,
    units: str = "1",
) -> h5py.Dataset:
    # Chunks, so that a column can be read without the others and a table is not taken as a whole.
    dataset = file.create_dataset(path, shape, kind, chunks=True if np.prod(shape) > 0 else None)
    _describe(dataset, units, long_name)
    return dataset


def _describe(dataset: h5py.Dataset, units: str, long_name: str) -> None:
    dataset.attrs["units"] = units
    dataset.attrs["long_name"] = long_name


def require_library(path: str) -> None:
    """Raise MissingExtra when the table at `path` cannot be written for want of a library."""
    if path.endswith(PARQUET):
        _pyarrow()


def _pyarrow() -> Any:
    needed("pyarrow.parquet", "pyarrow", "parquet", "a Parquet table (a table .h5 needs nothing more)")
    import pyarrow

    return pyarrow


def _write_parquet(place: Any, head: TableHead, rows: Iterable[Row]) -> None:
    pyarrow = _pyarrow()
    kinds = {name: pyarrow.int64() for name, _ in COUNTS} | {"message": pyarrow.string()}
    for column in head.columns:
        number = pyarrow.float64()
        kinds[column.path.replace("/", ".", 1)] = pyarrow.list_(number) if column.length else number
    about = {"deck": head.deck, "study": head.study, "deck_name": printable_name(head.deck_name),
             "deck_sha256": head.deck_sha256, "flexmb_version": __version__}  # fmt: skip
    schema = pyarrow.schema(list(kinds.items()), metadata=about)
    with place.open("wb") as stream, pyarrow.parquet.ParquetWriter(stream, schema) as writer:
        for block in _blocks(head, rows):
            counts = [list(values) for values in zip(*(row[:4] for row in block), strict=True)]
            columns = [[_plain(row[4][k]) for row in block] for k in range(len(head.columns))]
            arrays = [pyarrow.array(v, k) for v, k in zip(counts + columns, kinds.values(), strict=True)]
            writer.write_table(pyarrow.Table.from_arrays(arrays, schema=schema))


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else float(value)
