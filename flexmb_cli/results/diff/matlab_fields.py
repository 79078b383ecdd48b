"""Compare MATLAB files of results with each other and with HDF5 results, field by field."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...deck.listing import TableError
from ...errors import Fault
from ..files.matlab import matlab_fields, read_matlab
from .hdf5 import COMPARED_ATTRIBUTES, NOT_COMPARED, kind_of, open_sound, quantity_places
from .report import WORDS_OF_RESULTS, Found, Report, compare_names
from .tolerances import MATLAB, Tolerance, ToleranceError, Tolerances


def compare_matlab(report: Report, forms: Sequence[str], tolerances: Tolerances) -> None:
    """Compare two MATLAB files, or one with an HDF5 result.  Raises TableError when one cannot be read."""
    special: dict[str, list[Any]] = {}
    pairs = []
    for path, form in zip((report.a, report.b), forms, strict=True):
        if form == MATLAB:
            pairs.append(_read(path))
            continue
        with open_sound(path) as file:
            special = quantity_places(file, tolerances)
            pairs.append(matlab_fields(file))
    if tolerances.quantities and set(forms) == {MATLAB}:
        message = "MATLAB files hold no names of quantities: give tolerances of types, or one HDF5 result"
        raise ToleranceError(message, id="DIFF-018")
    _compare_info(report, *pairs)
    for name in dict.fromkeys((*pairs[0], *pairs[1])):
        if not name.startswith("info/") and name not in NOT_COMPARED:
            _compare_field(report, name, pairs, tolerances, special)


def _read(path: str) -> dict[str, np.ndarray]:
    try:
        return read_matlab(path)
    except ValueError as error:
        message = f"no MATLAB file that flexmb wrote can be read from it: {error}"
        raise TableError(path, [Fault("error", message, id="DIFF-019")]) from error


def _compare_info(report: Report, a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> None:
    for name in (*COMPARED_ATTRIBUTES, *WORDS_OF_RESULTS):
        first, second = (_text(fields.get(f"info/{name}", "")) for fields in (a, b))
        if first != second:
            reported = report.missing if name in COMPARED_ATTRIBUTES else report.words
            reported.append(f"{name}: {first!r} against {second!r}")


def _text(value: np.ndarray | str) -> str:
    return " ".join(map(str, np.ravel(value).tolist()))


def _compare_field(
    report: Report,
    name: str,
    pairs: list[dict[str, np.ndarray]],
    tolerances: Tolerances,
    special: Mapping[str, Sequence[tuple[tuple[Any, ...], Tolerance]]],
) -> Any:
    values = [fields.get(name) for fields in pairs]
    kind = kind_of(name)
    if tolerances.of(kind).ignores and name not in special:
        return
    if any(value is None for value in values):
        report.missing.append(f"/{name}: not in {report.a if values[0] is None else report.b}")
        return
    a, b = map(np.asarray, values)
    if a.dtype.kind not in "fiu" or b.dtype.kind not in "fiu":
        a, b = (np.array(list(map(str, np.ravel(x).tolist()))) for x in (a, b))
        _compare_texts(report, name, a, b)
        return
    # MATLAB has no arrays of fewer than two axes, and drops the last ones of length 1.
    if np.squeeze(a).shape != np.squeeze(b).shape:
        report.missing.append(f"/{name}: shape {a.shape} against {b.shape}")
        return
    shape = max(a.shape, b.shape, key=len)
    a, b = (x.reshape(shape).astype(float) for x in (a, b))
    tolerance = tolerances.of_places(kind, shape[1:], special.get(name, ()))

    def describe(position: tuple[int, int, int], distance: float) -> Found:
        column = ", ".join(str(index + 1) for index in position)
        return Found(
            f"/{name}", f"element ({column})", "", None, float(a[position]), float(b[position]), distance
        )

    report.compare(kind, a, b, tolerance, describe)


def _compare_texts(report: Report, name: str, a: np.ndarray, b: np.ndarray) -> None:
    if a.shape != b.shape:
        report.missing.append(f"/{name}: {a.size} texts against {b.size}")
    elif name.endswith("name"):
        report.words += compare_names(name, a, b)
    elif not np.array_equal(a, b):
        report.missing.append(f"/{name}: the text differs")
