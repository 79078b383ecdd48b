"""The quantities of an HDF5 result by readable names: `body.3.z`, `reaction.4.force`, `coordinate.theta2`.

A name is a row of words separated by points: what (`body`), which (its number or its name), the quantity, the
component.  What a file holds is reported by its datasets and their dimension scales, so that a new dataset
has names without a change here.  A pattern may hold `*`, `?` and `[...]`, which do not reach across a point,
and may end early: `body.1.velocity` is all three components.
"""

import fnmatch
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import h5py
import numpy as np

from ...deck.units import Wishes, converted
from ...errors import Fault, FlexmbError
from ..hdf5.stored_result import Damaged, attribute, check_shapes, check_structure, newer_layout, understood
from .quantity_names import TIME, Family, Slot, families, folded, time_family
from .unknown_names import hint_for

NOTHING = "an empty name"
TIMES_AT_ONCE = 2**20
UNKNOWN = "RESULT-021"  # identifier of the fault of a name that fits nothing
SHOWS_ALL = "; flexmb table RESULT.h5 --list shows all"


class ResultError(FlexmbError):
    """A result cannot be read, or has no quantity of a name (exit 2); a fault for every sentence."""

    exit_code = 2

    def __init__(self, file: str | Path, *sentences: str, id: str = ""):
        first = f"{file}: {sentences[0]}" if file else sentences[0]
        super().__init__(first, tuple(Fault("error", sentence, id=id) for sentence in sentences))
        self.file = str(file)


@dataclass(frozen=True)
class Quantity:
    """One number of every report row, `file[dataset][:, *index]` times `factor`, in `unit`."""

    name: str
    unit: str
    long_name: str
    dataset: str
    index: tuple[int, ...]
    factor: float = 1.0

    def in_units(self, wishes: Wishes) -> "Quantity":
        """Return the quantity in the units that are wanted."""
        unit, factor = converted(self.unit, wishes)
        return replace(self, unit=unit, factor=factor * self.factor)

    @property
    def header(self) -> str:
        """Name and unit, as columns and axes are headed."""
        return f"{self.name} [{self.unit}]"


@contextmanager
def open_result(path: Path | str) -> Iterator[h5py.File]:
    """The result at `path`, open for reading.

    Raises `ResultError` when there is none, when it is another type of file, or when it shows to be damaged
    while it is open.
    """
    try:
        file = h5py.File(path, "r")
    except FileNotFoundError:
        raise ResultError(path, "no such file", id="RESULT-015") from None
    except IsADirectoryError:
        raise ResultError(path, "it is a folder", id="RESULT-016") from None
    except OSError as error:
        raise _other_kind(path, error) from error
    try:
        with file, understood():
            check_structure(file)
            if attribute(file, "Conventions").startswith("flexmb-study"):
                raise ResultError(
                    path,
                    "this is the table of a study, not a result; flexmb table prints it",
                    id="RESULT-018",
                )
            if newer := newer_layout(file):
                raise ResultError(path, newer, id="RESULT-076")
            if not isinstance(file.get(TIME), h5py.Dataset):
                raise ResultError(
                    path, "this HDF5 file is not a result of flexmb: it has no dataset /time", id="RESULT-019"
                )
            check_shapes(file, {TIME: "t"}, {})
            _check_times(file[TIME])
            yield file
    except Damaged as fault:
        raise ResultError(path, f"a damaged result: {fault}", id="RESULT-020") from fault


def _check_times(times: h5py.Dataset) -> None:
    """Rows are found by their times: `Damaged` where these do not ascend."""
    for start in range(0, len(times), TIMES_AT_ONCE):
        part = times[max(0, start - 1) : start + TIMES_AT_ONCE]
        if not (np.isfinite(part).all() and (np.diff(part) > 0).all()):
            raise Damaged("the times of its rows do not ascend, or are not numbers")


def _other_kind(path: Path | str, error: Exception) -> ResultError:
    """Return the fault of a file that HDF5 cannot open: what it is."""
    begins = b""
    with suppress(OSError), open(path, "rb") as file:
        begins = file.read(512)
    if begins.startswith(b"PAR1"):
        message = "this is a Parquet table, which pandas and polars read; flexmb table prints those in HDF5"
        return ResultError(path, message, id="RESULT-064")
    if begins and b"\0" not in begins:
        message = f"this is a text, not an HDF5 result{_result_beside(path)}"
        return ResultError(path, message, id="RESULT-065")
    if "truncated file" in str(error):
        message = "the file is cut off: copy it again, or run the deck again"
        return ResultError(path, message, id="RESULT-066")
    return ResultError(path, f"this is not an HDF5 result that can be read: {error}", id="RESULT-017")


def _result_beside(path: Path | str) -> str:
    """Return which result may be meant by the name of a deck or of a printed table."""
    beside = {
        Path(path).with_suffix(".h5"),
        *(Path(path).with_name(name) for name in _names_of_results(path)),
    }
    neighbour = next(
        (str(result) for result in sorted(beside) if result.is_file() and h5py.is_hdf5(result)), ""
    )
    return f"; is {neighbour} meant?" if neighbour else "; flexmb run writes a deck's result into an .h5 file"


def _names_of_results(path: Path | str) -> Iterator[str]:
    from ...dialects import DIALECTS
    from ..files.file_names import h5_name

    return (h5_name(Path(path).name, dialect) for dialect in DIALECTS)


def names(result: h5py.File) -> list[Quantity]:
    """Every quantity that the result has for every report row, the time first."""
    return [
        _quantity(family, index)
        for family in families(result)
        for index in product(*map(range, family.shape))
    ]


def resolve(result: h5py.File, patterns: Iterable[str], file: str = "", where: str = "") -> list[Quantity]:
    """The quantities that `patterns` name, in their order and each once.

    A pattern that is the whole name of something means just that (`coordinate.2` is the coordinate, not
    also its speed); else it means all whose names it begins: `*` is everything.  Capitals do not matter, and
    a blank may be written as an underscore.  Raises `ResultError`, with near names for every pattern that
    fits nothing; `where` ("--x ") begins its sentences, and `file` is the result's name in them.
    """
    known = families(result)
    quantities: dict[Quantity, None] = {}
    unknown = []
    for pattern in patterns:
        matched = _matched(known, pattern)
        quantities.update(dict.fromkeys(matched))
        if not matched:
            hint = hint_for(pattern, known)
            lacking = f"the result has no such quantity{'; ' * bool(hint)}{hint}{SHOWS_ALL}"
            unknown.append(f"{where}{pattern or NOTHING}: {lacking}")
    if unknown:
        raise ResultError(file, *unknown, id=UNKNOWN)
    return list(quantities)


def time_quantity(result: h5py.File) -> Quantity:
    """The time of the rows."""
    return _quantity(time_family(result), ())


def read(result: h5py.File, quantities: Sequence[Quantity], rows: slice = slice(None)) -> np.ndarray:
    """Values of `quantities` at `rows`, shape (rows, quantities), in the units of the quantities.

    Only the datasets that are requested are read, and of them the smallest box with all wanted elements.
    Raises `ResultError` when the file is damaged.
    """
    columns: dict[str, list[int]] = {}
    for column, quantity in enumerate(quantities):
        columns.setdefault(quantity.dataset, []).append(column)
    values = np.empty((len(range(*rows.indices(len(result[TIME])))), len(quantities)))
    for path, chosen in columns.items():
        index = np.array([quantities[column].index for column in chosen], dtype=int)
        factors = np.array([quantities[column].factor for column in chosen])
        values[:, chosen] = _elements(result, path, rows, index) * factors
    return values


def time_at(result: h5py.File, row: int) -> float:
    """Time of a row, s; raises `ResultError` when the file is damaged."""
    row %= len(result[TIME])
    return float(_elements(result, TIME, slice(row, row + 1), np.empty((1, 0), dtype=int))[0, 0])


def shortfall(result: h5py.File) -> str:
    """A sentence on a run that is not complete: why, and up to which time there are rows; else empty."""
    if attribute(result, "status", "complete") == "complete":
        return ""
    end = f"its rows end at t = {time_at(result, -1):.10g} s" if len(result[TIME]) else "it has no rows"
    message = attribute(result, "message")
    return f"the run is not complete, {end}" + (f": {message}" if message else "")


def remarks(result: h5py.File) -> list[Fault]:
    """Return what a reader of any number must know: an emulation, a run that is not complete."""
    notes = (
        Fault("note", attribute(result, "emulation"), id="RESULT-077"),
        Fault("note", shortfall(result), id="RESULT-078"),
    )
    return [note for note in notes if note.message]


def _elements(result: h5py.File, path: str, rows: slice, index: np.ndarray) -> np.ndarray:
    """Elements (rows, places) of a dataset at the places `index` (places, axes) after time."""
    low, high = index.min(axis=0), index.max(axis=0) + 1
    try:
        with understood():
            box = result[path][(rows, *map(slice, low.tolist(), high.tolist()))]
    except Damaged as fault:
        raise ResultError(result.filename, f"/{path} {fault}", id="RESULT-022") from fault
    _refuse_other_length(result, path)
    return box[(slice(None), *(index - low).T)] if index.shape[1] else box[:, None]


def refuse_uneven(result: h5py.File) -> None:
    """Raise `ResultError` when a series has not a row for every time; no run leaves such a file."""
    for family in families(result):
        _refuse_other_length(result, family.path)


def _refuse_other_length(result: h5py.File, path: str) -> None:
    if len(result[path]) != len(result[TIME]):
        counts = f"{len(result[path])} rows and /time {len(result[TIME])}"
        raise ResultError(
            result.filename, f"a damaged result: /{path} has {counts}; run the deck again", id="RESULT-023"
        )


def _quantity(family: Family, index: tuple[int, ...]) -> Quantity:
    return Quantity(family.name(index), family.unit(index), family.meaning(index), family.path, tuple(index))


def _matched(known: list[Family], pattern: str) -> list[Quantity]:
    words = [re.compile(fnmatch.translate(folded(word))) for word in pattern.split(".")]
    if any(sign in pattern for sign in "*?["):
        # The only name of one word is the time's, which nobody means by `*`.
        return _among([family for family in known if family.path != TIME], words) or _among(known, words)
    return _among(known, words)


def _among(known: Sequence[Family], words: Sequence[re.Pattern[str]]) -> list[Quantity]:
    whole: list[Quantity] = []
    begun: list[Quantity] = []
    for family in known:
        for form in family.forms:
            if len(form) >= len(words):
                (whole if len(form) == len(words) else begun).extend(_matched_form(family, form, words))
    return whole or begun


def _matched_form(family: Family, form: tuple[Slot, ...], words: Sequence[re.Pattern[str]]) -> list[Quantity]:
    """The quantities whose names in this form begin with `words`."""
    along: list[Sequence[int]] = [range(length) for length in family.shape]
    for slot, word in zip(form, words, strict=False):
        positions = slot.positions(word)
        if not positions:
            return []
        if slot.axis is not None:
            along[slot.axis] = positions
    return [_quantity(family, index) for index in product(*along)]
