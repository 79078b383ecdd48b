"""HDF5 result of any analysis: netCDF-4 compatible, every axis a dimension scale, SI units
unless the deck says others.

What a file holds is its `Layout`; rows are gathered and written by whole chunks, so that the bytes of
the file do not depend on the blocks in which the analysis delivers them.
"""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...deck.record import Deck
from ...deck.units import UNITS, declared
from ...dialects.elements_block.line import system_of
from ...errors import COMPLETE, FAILED, OutputError
from ...solvers.as_printed.errors import AS_PRINTED, EMULATED
from ...version import __version__
from ..files.disk_failures import FullDiskGuard, located
from ..files.replaced_file import Replacement, put_in_place
from .layout import TIME, Axis, Constant, Layout, Series, Values

# 2: every dimension scale lies in the group of its datasets or above it; until then those of reactions and
# of the shapes of bodies lay beside it, which netCDF does not know.
CONVENTIONS = "flexmb-2"
CUT_SHORT = "the run was cut short"

# HDF5 1.8 is what MATLAB releases of the last ten years and every netCDF-4 library can read.
FILE_FORMAT = ("v108", "v108")
CHUNK_ROWS = 1024
CHUNK_BYTES = 2**20
TEXT = h5py.string_dtype()


class ResultFile(Replacement):
    """The HDF5 file of one run, complete at `path` only after `close`.

    Raises `OutputError` when the place cannot be written or the disk is full.
    """

    def __init__(self, path: Path | str, deck: Deck, layout: Layout):
        super().__init__(path)
        if self.direct:
            raise OutputError(
                f"{path}: an HDF5 file can only be a regular file; --no-h5 writes none", id="RESULT-014"
            )
        self._written = 0
        self._status, self._message = COMPLETE, ""
        self._notes: tuple[str, ...] = ()
        self._waiting: list[Values] = []
        self._chunk, self._system = chunk_rows(layout), ""
        self._file: h5py.File = None  # until the file is open
        try:
            with located(self.path):
                self._disk = FullDiskGuard(self.duplicate())
        except BaseException:
            super().discard()
            raise
        with self._on_disk():
            self._file = h5py.File(self._disk, "w", libver=FILE_FORMAT)
            self._system = system_of(deck)
            self._begin(deck, layout)

    def rows(self, values: Values) -> None:
        """Add report rows, every series by its path; whole chunks are written at once."""
        self._waiting.append(values)
        if self._rows_waiting >= self._chunk:
            self._write(self._rows_waiting // self._chunk * self._chunk)

    def mark(self, status: str, message: str) -> None:
        """Say how the run ended; without a word it is complete."""
        self._status, self._message = status, message

    def note(self, notes: tuple[str, ...]) -> None:
        """Sentences that the run is to be remembered for, such as singular positions that it passed."""
        self._notes = notes

    def finish(self) -> None:
        """Write what waits and how the run ended; the file is whole, but not in its place."""
        if self._rows_waiting:
            self._write(self._rows_waiting)
        with self._on_disk():
            self._file.attrs["status"] = self._status
            self._file.attrs["message"] = self._message
            if self._notes:
                self._file.attrs["notes"] = "\n".join(self._notes)
            self._file.close()
            self._disk.close()
        super().finish()

    def close(self, status: str = COMPLETE, message: str = "", notes: tuple[str, ...] = ()) -> None:
        """Mark the file, finish it and put it in its place."""
        self.mark(status, message)
        self.note(notes)
        put_in_place([self])

    def discard(self) -> None:
        """Leave no file; one that stood at the path before stays."""
        # HDF5 may trip over what the disk has refused; all of it is thrown away.
        with suppress(Exception):
            if self._file:
                self._file.close()
        with suppress(OSError):
            self._disk.close()
        super().discard()

    @property
    def _rows_waiting(self) -> int:
        return sum(len(block["time"]) for block in self._waiting)

    def _begin(self, deck: Deck, layout: Layout) -> None:
        self._describe(deck, layout.analysis)
        scales = {axis.path: self._make_axis(axis) for axis in layout.axes}
        for constant in layout.constants:
            self._make_constant(constant, scales)
        self._series = self._make_series(layout.series, scales)

    def _describe(self, deck: Deck, analysis: str) -> None:
        self._file.attrs.update(
            Conventions=CONVENTIONS,
            flexmb_version=__version__,
            dialect=deck.dialect,
            analysis=analysis,
            deck_name=printable_name(deck.source.name),
            deck_sha256=deck.source.sha256,
            status=FAILED,
            message=CUT_SHORT,
        )
        for name, lines in (("settings", deck.settings), ("options", deck.options)):
            if lines:
                self._file.attrs[name] = "\n".join(lines)
        if AS_PRINTED in deck.options:
            self._file.attrs["emulation"] = EMULATED
        if self._system:
            self._file.attrs["units"] = self._system
        text = self._file.create_dataset("deck", data=deck.source.text, dtype=TEXT)
        text.attrs.update(units="1", long_name="text of the deck")

    def _unit(self, unit: str) -> str:
        """Return an SI unit in the system of the deck."""
        return declared(unit, UNITS[self._system]) if self._system else unit

    def _make_axis(self, axis: Axis) -> h5py.Dataset:
        scale = self._file.create_dataset(axis.path, data=_plain(axis.values), dtype=_kind(axis.values))
        scale.make_scale(axis.path.rpartition("/")[2])
        scale.attrs.update(units="1", long_name=axis.long_name)
        for path, texts, long_name in axis.labels:
            if path.endswith("/unit"):
                texts = tuple(map(self._unit, texts))
            dataset = self._file.create_dataset(path, data=list(texts), dtype=TEXT)
            _attach_scales(dataset, [scale])
            dataset.attrs.update(units="1", long_name=long_name)
        return scale

    def _make_constant(self, constant: Constant, scales: dict[str, h5py.Dataset]) -> None:
        dataset = self._file.create_dataset(constant.path, data=constant.values)
        _attach_scales(dataset, [self._scale_for(constant.path, path, scales) for path in constant.axes])
        dataset.attrs.update(units=self._unit(constant.units), long_name=constant.long_name)

    def _scale_for(self, dataset: str, axis: str, scales: dict[str, h5py.Dataset]) -> h5py.Dataset:
        """The scale `axis` where netCDF looks for it: a copy, if it lies beside the dataset's group."""
        folder, _, name = axis.rpartition("/")
        if not folder or dataset.startswith(f"{folder}/"):
            return scales[axis]
        path = f"{dataset.rpartition('/')[0]}/{name}"
        if path not in scales:
            scales[path] = self._file.create_dataset(path, data=scales[axis][:])
            scales[path].make_scale(name)
            scales[path].attrs.update(units="1", long_name=scales[axis].attrs["long_name"])
        return scales[path]

    def _make_series(
        self, series: tuple[Series, ...], scales: dict[str, h5py.Dataset]
    ) -> dict[str, h5py.Dataset]:
        time = self._growing(TIME, ())
        time.make_scale("time")
        datasets = {TIME.path: time}
        for item in series:
            axes = [self._scale_for(item.path, path, scales) for path in item.axes]
            datasets[item.path] = self._growing(item, axes)
            _attach_scales(datasets[item.path], [time, *axes])
        return datasets

    def _growing(self, series: Series, axes: Sequence[Any]) -> h5py.Dataset:
        """A dataset without rows that grows along time."""
        item = tuple(len(axis) for axis in axes)
        dataset = self._file.create_dataset(
            series.path, (0, *item), float, maxshape=(None, *item), chunks=(self._chunk, *item)
        )
        dataset.attrs.update(units=self._unit(series.units), long_name=series.long_name)
        return dataset

    def _write(self, count: int) -> None:
        """Write the first `count` waiting rows; the others go on waiting."""
        gathered = {path: np.concatenate([block[path] for block in self._waiting]) for path in self._series}
        with self._on_disk():
            for path, dataset in self._series.items():
                dataset.resize(self._written + count, axis=0)
                dataset[self._written :] = gathered[path][:count]
        self._written += count
        rest = {path: values[count:] for path, values in gathered.items()}
        self._waiting = [rest] if len(rest["time"]) else []

    @contextmanager
    def _on_disk(self) -> Iterator[None]:
        """Leave no file when the disk, or anything else, ends the writing."""
        try:
            with located(self.path), self._disk.blamed():
                yield
        except BaseException:
            self.discard()
            raise


def printable_name(name: str) -> str:
    """A file name as UTF-8 can hold it: bytes that are none are written as \\xff."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


def chunk_rows(layout: Layout) -> int:
    """Rows of a chunk: no more than the run has, and at most a megabyte for the largest dataset."""
    length = {axis.path: len(axis.values) for axis in layout.axes}
    widest = 8 * max((prod(length[path] for path in series.axes) for series in layout.series), default=1)
    return max(1, min(layout.rows, CHUNK_ROWS, CHUNK_BYTES // widest))


def _plain(values: tuple[Any, ...]) -> list[str] | np.ndarray:
    return list(values) if isinstance(values[0], str) else np.array(values, np.int32)


def _kind(values: tuple[Any, ...]) -> Any:
    return TEXT if isinstance(values[0], str) else None


def _attach_scales(dataset: h5py.Dataset, scales: Sequence[h5py.Dataset]) -> None:
    for dimension, scale in zip(dataset.dims, scales, strict=True):
        dimension.attach_scale(scale)


@contextmanager
def empty_result(deck: Deck, layout: Layout) -> Iterator[h5py.File]:
    """Give the result of a run without rows, in which names of quantities are looked up."""
    import tempfile  # which takes its time, and few runs need it

    with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
        path = os.path.join(folder, "empty.h5")
        ResultFile(path, deck, layout).close()
        with h5py.File(path, "r") as result:
            yield result
