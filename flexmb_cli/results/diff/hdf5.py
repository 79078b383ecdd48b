"""Compare two HDF5 results dataset by dataset, a part of the rows at a time."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import h5py
import numpy as np

from ...deck.listing import TableError
from ...errors import Fault, visible
from ..hdf5.stored_result import (
    Damaged,
    StoredDatasets,
    attribute,
    check_shapes,
    check_structure,
    is_number,
    newer_layout,
    scale_of,
    texts,
    understood,
)
from ..quantities.quantities import ResultError, resolve
from .report import WORDS_OF_RESULTS, Found, Report, compare_names
from .tolerances import Tolerance, Tolerances

# So many numbers are compared at once: results may be larger than the memory.
NUMBERS_AT_ONCE = 2**21

KIND_OF = {
    "time": "time", "body/position": "position", "body/euler_parameters": "euler",
    "body/velocity": "velocity",
    "body/euler_parameter_rates": "euler_rate", "body/angular_velocity": "omega",
    "body/acceleration": "acceleration", "body/euler_parameter_accelerations": "euler_acceleration",
    "body/angular_acceleration": "alpha", "point/position": "point_position",
    "point/velocity": "point_velocity", "point/acceleration": "point_acceleration",
    "coordinate/q": "coordinate", "coordinate/u": "speed", "reaction/force": "force",
    "reaction/torque": "torque", "held/force": "force", "held/torque": "torque", "driver/effort": "effort",
}  # fmt: skip
KIND_OF_GROUP = {"audit": "audit", "energy": "energy", "elastic": "elastic", "modal": "modal"}
SIGNED = ("body/euler_parameters", "body/euler_parameter_rates", "body/euler_parameter_accelerations")
# The text of decks and studies may differ where the results do not: a comment, the order of the spaces.
NOT_COMPARED = ("deck", "study")
COMPARED_ATTRIBUTES = ("analysis", "status")
# What the attribute Conventions begins with, and the dataset that has a number for every row.
KIND_OF_FILE = {"flexmb-study": "the table of a study", "flexmb": "a result"}
REPORTED_BY = {"flexmb-study": "case", "flexmb": "time"}


def compare_hdf5(report: Report, tolerances: Tolerances, same_attitude: bool = False) -> None:
    """Compare the two HDF5 results that a report is about; see `diff.compare`."""
    with open_sound(report.a) as a, open_sound(report.b) as b:
        kinds = [_kind_of_file(path, file) for path, file in ((report.a, a), (report.b, b))]
        if kinds[0] != kinds[1]:
            message = f"it is {kinds[1]}, {report.a} is {kinds[0]}; compare two of the same type"
            raise TableError(report.b, [Fault("error", message, id="DIFF-003")])
        with _understood_in(f"{report.a} or {report.b}"):
            _compare_files(report, a, b, tolerances, same_attitude)


@contextmanager
def open_sound(path: str) -> Iterator[h5py.File]:
    """The HDF5 file at `path`; raises TableError when it is not built as flexmb builds files."""
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise TableError(path, [Fault("error", f"damaged HDF5 file: {error}", id="DIFF-004")]) from error
    with file:
        with _understood_in(path):
            check_structure(file)
        yield file


def _kind_of_file(path: str, file: h5py.File) -> str:
    """Return what the file is, in words; raises TableError when it is nothing that flexmb writes."""
    with _understood_in(path):
        conventions, newer = attribute(file, "Conventions"), newer_layout(file)
    if newer:
        raise TableError(path, [Fault("error", newer, id="DIFF-030")])
    for begins, what in KIND_OF_FILE.items():
        if conventions.startswith(begins) and REPORTED_BY[begins] in file:
            return what
    message = "this HDF5 file is not a result of flexmb: it lacks their attribute Conventions, or its rows"
    raise TableError(path, [Fault("error", message, id="DIFF-005")])


@contextmanager
def _understood_in(path: str) -> Iterator[None]:
    try:
        with understood():
            yield
    except Damaged as fault:
        raise TableError(path, [Fault("error", f"damaged HDF5 file: {fault}", id="DIFF-006")]) from fault


def _compare_files(
    report: Report, a: h5py.File, b: h5py.File, tolerances: Tolerances, same_attitude: bool
) -> None:
    for name in COMPARED_ATTRIBUTES:
        first, second = (attribute(file, name) for file in (a, b))
        if first != second:
            report.missing.append(f"{name}: {first} against {second}")
    for name in WORDS_OF_RESULTS:
        first, second = (attribute(file, name) for file in (a, b))
        if first != second:
            report.words.append(f"{name}: {first!r} against {second!r}")
    flips = same_attitude and _have_attitudes(a, b)
    datasets = _compared_datasets(a), _compared_datasets(b)
    if attribute(a, "Conventions") != attribute(b, "Conventions"):
        # Versions of the format have scales of the same numbers at other places.
        _leave_out_lone_scales(*datasets)
    special = quantity_places(a, tolerances)
    for name in [*datasets[0], *(name for name in datasets[1] if name not in datasets[0])]:
        shape = datasets[0 if name in datasets[0] else 1][name].shape[1:]
        tolerance = tolerances.of_places(kind_of(name), shape, special.get(name, ()))
        if tolerance.ignores:
            continue
        if name in datasets[0] and name in datasets[1]:
            signs = partial(_signs, a, b) if flips and name in SIGNED else None
            _compare_dataset(report, name, (datasets[0][name], datasets[1][name]), tolerance, signs)
        else:
            report.missing.append(f"/{visible(name)}: not in {report.b if name in datasets[0] else report.a}")


def quantity_places(result: h5py.File, tolerances: Tolerances) -> dict[str, list[Any]]:
    """Return the quantities with their own tolerance: pairs (index after time, tolerance) by dataset."""
    places: dict[str, list[Any]] = {}
    if not tolerances.quantities or "time" not in result:
        return places
    for pattern, tolerance in tolerances.quantities.items():
        try:
            quantities = resolve(result, [pattern])
        except ResultError:
            continue  # the patterns that fit nothing are reported when all files are compared
        tolerances.used.add(pattern)
        for quantity in quantities:
            places.setdefault(quantity.dataset, []).append((quantity.index, tolerance))
    return places


def kind_of(name: str) -> str:
    """Type of a dataset, as tolerances name it."""
    return KIND_OF.get(name) or KIND_OF_GROUP.get(name.partition("/")[0], "other")


def _compared_datasets(file: h5py.File) -> StoredDatasets:
    datasets = StoredDatasets(file)
    for name in NOT_COMPARED:
        datasets.leave_out(name)
    return datasets


def _leave_out_lone_scales(one: StoredDatasets, other: StoredDatasets) -> None:
    """Take the dimension scales that only one of two files has out of its datasets."""
    lone = [
        (item, name) for item, beside in ((one, other), (other, one)) for name in item.keys() - beside.keys()
    ]
    for datasets, name in lone:
        if h5py.h5ds.is_scale(datasets[name].id):
            datasets.leave_out(name)


def _compare_dataset(
    report: Report, name: str, pair: tuple[h5py.Dataset, h5py.Dataset], tolerance: Tolerance, signs: Any
) -> None:
    """Compare two datasets; `signs`, where there are any, turn part by part of the second one's rows."""
    first, second = pair
    if is_number(first) != is_number(second):
        report.missing.append(f"/{name}: numbers in one file, text in the other")
        return
    rows = _common_rows(report, name, first, second)
    if rows is None:
        return
    if not is_number(first):
        _compare_text(report, name, first[()], second[()])
    elif first.ndim == 0:
        _compare_part(report, name, first, slice(0, 0), (first[()], second[()]), tolerance)
    else:
        block = max(1, NUMBERS_AT_ONCE // max(1, math.prod(first.shape[1:])))
        for start in range(0, rows, block):
            part = slice(start, min(start + block, rows))
            values = first[part], second[part]
            if signs:
                values = values[0], values[1] * signs(part)
            _compare_part(report, name, first, part, values, tolerance)


def _common_rows(report: Report, name: str, first: h5py.Dataset, second: h5py.Dataset) -> Any:
    """Rows that both datasets have; None when their shapes cannot be compared."""
    if first.shape == second.shape:
        return first.shape[0] if first.shape else 0
    report.missing.append(f"/{name}: shape {_shape(first)} against {_shape(second)}")
    alike = first.ndim == second.ndim and first.shape[1:] == second.shape[1:] and is_number(first)
    return min(first.shape[0], second.shape[0]) if alike and first.ndim else None


def _compare_text(report: Report, name: str, first: np.ndarray, second: np.ndarray) -> None:
    if name.endswith("/name") and np.shape(first) == np.shape(second):
        report.words += compare_names(name, first, second)
    elif not np.array_equal(first, second):
        report.missing.append(f"/{name}: the text differs")


def _compare_part(
    report: Report,
    name: str,
    dataset: h5py.Dataset,
    part: slice,
    values: tuple[np.ndarray, np.ndarray],
    tolerance: Tolerance,
) -> Any:
    first, second = (np.atleast_1d(np.asarray(block, dtype=float)) for block in values)

    def describe(position: tuple[int, int, int], distance: float) -> Found:
        row = part.start + int(position[0])
        scale = scale_of(dataset, 0) if dataset.ndim and name != "time" else None
        timed = scale is not None and scale == dataset.file.get("time") and is_number(scale)
        time = float(dataset.file["time"][row]) if timed else None
        item, column = _labels(dataset, (row, *position[1:]), timed)
        return Found(
            f"/{name}", item, column, time, float(first[position]), float(second[position]), distance
        )

    report.compare(kind_of(name), first, second, tolerance, describe)


def _labels(dataset: h5py.Dataset, position: tuple[int, int, int], timed: bool) -> tuple[str, str]:
    """Readable item and column of an element, from the scales of its axes but time."""
    words = []
    for axis, number in list(enumerate(position[: dataset.ndim]))[timed:]:
        scale = scale_of(dataset, axis)
        bare = f"{'' if axis else 'row '}{int(number) + 1}"
        words.append(_label(scale, int(number)) if scale is not None else bare)
    return (" ".join(words[:-1]), words[-1]) if words else ("", "")


def _label(scale: h5py.Dataset, number: int) -> str:
    if not is_number(scale):
        return texts(scale)[number]
    return f"{scale.name.rpartition('/')[2]} {scale[number]:g}"


def _have_attitudes(a: h5py.File, b: h5py.File) -> bool:
    name = SIGNED[0]
    if name not in a or name not in b:
        return False
    # Rates and accelerations are turned by the signs of the parameters, row by row.
    for file in (a, b):
        check_shapes(file, dict.fromkeys(SIGNED, "tb4"), {})
    return bool(a[name].shape[1:] == b[name].shape[1:])


def _signs(a: h5py.File, b: h5py.File, part: slice) -> np.ndarray:
    """Signs (rows, bodies, 1) that turn b's Euler parameters towards a's."""
    with np.errstate(invalid="ignore"):
        against = (a[SIGNED[0]][part] * b[SIGNED[0]][part]).sum(axis=2, keepdims=True) < 0
    return np.where(against, -1.0, 1.0)


def _shape(dataset: h5py.Dataset) -> str:
    return "(" + ", ".join(map(str, dataset.shape)) + ")"
