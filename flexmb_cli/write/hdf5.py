"""HDF5 result of a mechanism: netCDF-4 compatible, every axis a dimension scale, SI units.

Rows are gathered and written by whole chunks, so that the bytes of the file do not depend on the
blocks in which the analysis delivers them.
"""

import io
from dataclasses import dataclass, fields

import h5py
import numpy as np

from .. import __version__
from ..errors import OutputError
from ..model.mechanism import Mechanism
from ..read.deck import Deck
from ..solve.rows import Rows
from .atomic import Replacement, output_error

CONVENTIONS = "flexmb-1"
COMPLETE, FAILED = "complete", "failed"
CUT_SHORT = "the run was cut short"

# HDF5 1.8 is what MATLAB releases of the last ten years and every netCDF-4 library can read.
FILE_FORMAT = ("v108", "v108")
CHUNK_ROWS = 1024
CHUNK_BYTES = 2**20

TEXT = h5py.string_dtype()


@dataclass(frozen=True)
class Series:
    """A dataset along time: a field of `Rows`, its place in the file, its axes after time."""

    field: str
    path: str
    axes: tuple[str, ...]
    units: str
    long_name: str


BODY_VECTOR = ("body/body", "xyz")
BODY_PARAMETERS = ("body/body", "euler_parameter")
POINT_VECTOR = ("point/point", "xyz")

SERIES = (
    Series("time", "time", (), "s", "time"),
    Series("position", "body/position", BODY_VECTOR, "m", "origin of the body frame, global axes"),
    Series(
        "euler_parameters", "body/euler_parameters", BODY_PARAMETERS, "1", "Euler parameters, body to global"
    ),
    Series("velocity", "body/velocity", BODY_VECTOR, "m/s", "velocity of the origin, global axes"),
    Series(
        "euler_parameter_rates",
        "body/euler_parameter_rates",
        BODY_PARAMETERS,
        "1/s",
        "rates of Euler parameters",
    ),
    Series(
        "acceleration", "body/acceleration", BODY_VECTOR, "m/s2", "acceleration of the origin, global axes"
    ),
    Series(
        "euler_parameter_accelerations",
        "body/euler_parameter_accelerations",
        BODY_PARAMETERS,
        "1/s2",
        "second derivatives of Euler parameters",
    ),
    Series(
        "angular_velocity", "body/angular_velocity", BODY_VECTOR, "rad/s", "angular velocity, global axes"
    ),
    Series(
        "angular_acceleration",
        "body/angular_acceleration",
        BODY_VECTOR,
        "rad/s2",
        "angular acceleration, global axes",
    ),
    Series("point_position", "point/position", POINT_VECTOR, "m", "position of the point, global axes"),
    Series("point_velocity", "point/velocity", POINT_VECTOR, "m/s", "velocity of the point, global axes"),
    Series(
        "point_acceleration",
        "point/acceleration",
        POINT_VECTOR,
        "m/s2",
        "acceleration of the point, global axes",
    ),
    Series(
        "constraint_residual", "audit/constraint_residual", (), "1", "largest constraint equation, max-norm"
    ),
    Series("velocity_residual", "audit/velocity_residual", (), "1/s", "largest constraint rate, max-norm"),
    Series("newton_iterations", "audit/newton_iterations", (), "1", "Newton iterations for the position"),
)


class ResultFile:
    """The HDF5 file of one run, complete at `path` only after `close`.

    Raises `OutputError` when the place cannot be written or the disk is full.
    """

    def __init__(self, path, deck: Deck, mechanism: Mechanism, analysis: str = "kinematic"):
        self._place = Replacement(path)
        if self._place.direct:
            raise OutputError(f"{path}: an HDF5 file can only be a regular file; --no-h5 writes none")
        self._written = 0
        self._waiting: list[Rows] = []
        self._disk = _ForgivingDisk(self._place.temporary)
        self._file = h5py.File(self._disk, "w", libver=FILE_FORMAT)
        self._describe(deck, analysis)
        self._chunk = chunk_rows(mechanism)
        self._series = self._make_series(self._make_axes(mechanism))
        self._raise_disk_failure()

    def rows(self, rows: Rows) -> None:
        """Add report rows; whole chunks are written at once."""
        self._waiting.append(rows)
        if self._rows_waiting >= self._chunk:
            whole = self._rows_waiting // self._chunk * self._chunk
            self._write(whole)

    def close(self, status: str = COMPLETE, message: str = "") -> None:
        """Write what waits, mark the file with `status` and `message`, and put it in its place."""
        if self._rows_waiting:
            self._write(self._rows_waiting)
        self._file.attrs["status"] = status
        self._file.attrs["message"] = message
        self._file.close()
        self._disk.close()
        self._raise_disk_failure()
        self._place.commit()

    def discard(self) -> None:
        """Leave no file; one that stood at the path before stays."""
        self._file.close()
        self._disk.close()
        self._place.discard()

    @property
    def _rows_waiting(self):
        return sum(len(block.time) for block in self._waiting)

    def _describe(self, deck, analysis):
        for name, value in (
            ("Conventions", CONVENTIONS),
            ("flexmb_version", __version__),
            ("dialect", deck.dialect),
            ("analysis", analysis),
            ("deck_name", deck.source.name),
            ("deck_sha256", deck.source.sha256),
            ("status", FAILED),
            ("message", CUT_SHORT),
        ):
            self._file.attrs[name] = value
        _describe(
            self._file.create_dataset("deck", data=deck.source.text, dtype=TEXT), "1", "text of the deck"
        )

    def _make_axes(self, mechanism):
        scales = {
            "xyz": self._scale("xyz", list("xyz"), "component along the axis"),
            "euler_parameter": self._scale("euler_parameter", ["e0", "e1", "e2", "e3"], "Euler parameter"),
        }
        for kind, items in (
            ("body", mechanism.bodies),
            ("point", mechanism.points),
            ("joint", mechanism.joints),
            ("driver", mechanism.drivers),
        ):
            if items:
                scales[f"{kind}/{kind}"] = self._numbered_axis(kind, readable_names(kind, items))
        return scales

    def _numbered_axis(self, kind, names):
        """The scale `/<kind>/<kind>`, numbers as in the deck, and `/<kind>/name` along it."""
        numbers = np.arange(1, len(names) + 1, dtype=np.int32)
        scale = self._scale(f"{kind}/{kind}", numbers, f"number of the {kind} in the deck")
        dataset = self._file.create_dataset(f"{kind}/name", data=names, dtype=TEXT)
        dataset.dims[0].attach_scale(scale)
        _describe(dataset, "1", f"name of the {kind}")
        return scale

    def _scale(self, path, values, long_name):
        dtype = TEXT if isinstance(values[0], str) else None
        dataset = self._file.create_dataset(path, data=values, dtype=dtype)
        dataset.make_scale(path.rpartition("/")[2])
        _describe(dataset, "1", long_name)
        return dataset

    def _make_series(self, scales):
        time, *others = SERIES
        datasets = {time.field: self._growing(time, ())}
        scales["time"] = datasets["time"]
        scales["time"].make_scale("time")
        for series in others:
            if all(axis in scales for axis in series.axes):
                axes = [scales[axis] for axis in series.axes]
                datasets[series.field] = self._growing(series, axes)
                for number, scale in enumerate([scales["time"], *axes]):
                    datasets[series.field].dims[number].attach_scale(scale)
        return datasets

    def _growing(self, series, axes):
        """A dataset without rows that grows along time."""
        item = tuple(len(axis) for axis in axes)
        dataset = self._file.create_dataset(
            series.path,
            shape=(0, *item),
            maxshape=(None, *item),
            chunks=(self._chunk, *item),
            dtype="f8",
        )
        _describe(dataset, series.units, series.long_name)
        return dataset

    def _write(self, count):
        """Write the first `count` waiting rows; the others go on waiting."""
        gathered = _joined(self._waiting)
        stop = self._written + count
        for field, dataset in self._series.items():
            dataset.resize(stop, axis=0)
            dataset[self._written : stop] = getattr(gathered, field)[:count]
        self._raise_disk_failure()
        self._written = stop
        rest = Rows(**{f.name: getattr(gathered, f.name)[count:] for f in fields(Rows)})
        self._waiting = [rest] if len(rest.time) else []

    def _raise_disk_failure(self):
        failure = self._disk.failure
        if failure is not None:
            self.discard()
            raise output_error(self._place.path, failure) from failure


class _ForgivingDisk(io.FileIO):
    """The file below HDF5.  It remembers the first failure to write and swallows what follows.

    HDF5 itself must not meet a full disk: it then crashes the process when its file is closed.
    """

    def __init__(self, path):
        self.failure: OSError | None = None
        super().__init__(path, "w+")

    def write(self, data):
        """Write all of `data`; tell HDF5 that it is done in any case."""
        view = memoryview(data)
        while view and self.failure is None:
            try:
                view = view[super().write(view) :]
            except OSError as error:
                self.failure = error
        return len(data)

    def truncate(self, size=None):
        """Set the file's length."""
        try:
            return super().truncate(size)
        except OSError as error:
            self.failure = self.failure or error
            return size


def readable_names(kind: str, items) -> list[str]:
    """Names as in the settings of the deck: "body 1", "point 2"; joints count by their type: "spherical 1".

    Messages name the same items in words ("spherical joint 1"); scripts rely on the names here.
    """
    counts: dict[str, int] = {}
    names = []
    for item in items:
        word = item.kind if kind == "joint" else kind
        counts[word] = counts.get(word, 0) + 1
        names.append(f"{word} {counts[word]}")
    return names


def chunk_rows(mechanism: Mechanism) -> int:
    """Rows of a chunk: no more than the run has, and at most a megabyte for the largest dataset."""
    widest = max(4 * len(mechanism.bodies), 3 * len(mechanism.points), 1) * 8
    return max(1, min(mechanism.time.rows, CHUNK_ROWS, CHUNK_BYTES // widest))


def _describe(dataset, units, long_name):
    dataset.attrs["units"] = units
    dataset.attrs["long_name"] = long_name


def _joined(blocks):
    if len(blocks) == 1:
        return blocks[0]
    return Rows(
        **{f.name: np.concatenate([getattr(block, f.name) for block in blocks]) for f in fields(Rows)}
    )
