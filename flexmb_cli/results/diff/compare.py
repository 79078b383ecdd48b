"""Compare two results, whatever their form: listings, HDF5 results, and what was exported from these.

A result is accepted as the new reference as a whole or not at all.
"""

import os
from pathlib import Path, PurePath
from typing import Any

from ...deck.listing import Listing, TableError
from ...errors import Fault, FlexmbError
from ..files.replaced_file import make_folder, replaced
from .folders import Compared, Pair
from .listings import compare_listings, read_listing
from .report import Report
from .tolerances import (
    CSV,
    DEFAULT_ATOL,
    DEFAULT_RTOL,
    HDF5,
    LISTING,
    MATLAB,
    UNREADABLE,
    ToleranceError,
    Tolerances,
    form_of,
)


def compare(
    path_a: Any,
    path_b: Any,
    tolerances: Tolerances | None = None,
    same_attitude: bool = False,
    explain: bool = False,
    words: bool = False,
    deck: str | None = None,
    listed: int = 0,
) -> Report:
    """Compare two results of the same form, or an HDF5 result with a CSV or MATLAB file exported from one.

    `same_attitude`: Euler parameters p and -p (with their rates) count as equal.  `explain`: differences
    that are known errors of the historic programs are counted as such.  Raises `TableError` when a file
    cannot be read, or when the two are of different types.  `words`: lines of text that differ count, too.
    `listed`: how many of the numbers that differ the report names, besides the worst of each type.
    `deck`: that of two listings of YOUNG, run with the errors of the program of 1996 to explain differences.
    """
    tolerances = tolerances or Tolerances()
    forms = form_of(path_a), form_of(path_b)
    if UNREADABLE in forms or set(forms) == {LISTING}:
        a, b = _listings(path_a, path_b, forms)
        emulation = None
        if deck is not None and a.form.emulated:
            from .emulated import Emulation

            emulation = Emulation(deck)
        report = compare_listings(a, b, tolerances, same_attitude, explain, emulation, listed)
    elif tolerances.last_digit:
        message = "--last-digit: HDF5 results have no printed digits; --atol and --rtol are for them"
        raise ToleranceError(message, id="DIFF-007")
    else:
        report = Report(str(path_a), str(path_b), most_listed=listed)
        tolerances = tolerances.with_defaults(DEFAULT_ATOL, DEFAULT_RTOL)
        _compare_stored(report, forms, tolerances, same_attitude)
    report.words_count = words
    return report


def _listings(path_a: Any, path_b: Any, forms: tuple[str, str]) -> tuple[Listing, Listing]:
    if set(forms) - {LISTING, UNREADABLE}:
        read_listing(path_a if forms[0] == UNREADABLE else path_b)  # it words why the file cannot be opened
    a, b = (read_listing(path) for path in (path_a, path_b))
    if a.form.name != b.form.name:
        message = f"it is of another type ({b.form.name}) than {a.name} ({a.form.name})"
        raise TableError(b.name, [Fault("error", message, id="DIFF-009")])
    return a, b


def _compare_stored(
    report: Report, forms: tuple[str, str], tolerances: Tolerances, same_attitude: bool
) -> None:
    """Compare HDF5 results, or what was exported from them; these modules need the HDF5 library."""
    if set(forms) == {HDF5}:
        from .hdf5 import compare_hdf5

        compare_hdf5(report, tolerances, same_attitude)
    elif CSV in forms and set(forms) <= {HDF5, CSV}:
        from .csv_columns import compare_csv

        compare_csv(report, forms, tolerances)
    elif MATLAB in forms and set(forms) <= {HDF5, MATLAB}:
        from .matlab_fields import compare_matlab

        compare_matlab(report, forms, tolerances)
    else:
        other = report.b if forms[0] == HDF5 else report.a
        form = (
            "this is not an HDF5 result, the other file is"
            if HDF5 in forms
            else "the two are of different forms"
        )
        message = f"{form}; compare two tables, two HDF5 results, or an export with its HDF5 result"
        raise TableError(other, [Fault("error", message, id="DIFF-008")])


def accept(reference: Path | str, result: Path | str) -> None:
    """Put a copy of `result` in the place of `reference`; a reader sees the old file or the new one.

    Both were compared.  Raises `OutputError` when the reference cannot be written, `TableError` when the
    result cannot be read, shows nothing since its run failed before the first row, or is of a run that
    failed later, unless the reference is so too: a mechanism that locks has no other.
    """
    if not is_missing(reference) and form_of(reference) != form_of(result):
        message = f"it is {form_of(result)} and the reference {form_of(reference)}: nothing was accepted"
        _refuse(result, message, id="DIFF-035")
    failed, rows = _ending(result)
    if failed and not rows:
        message = "its run failed before the first row: that is not a reference, and nothing was accepted"
        _refuse(result, message, id="DIFF-002")
    if failed and (is_missing(reference) or not _ending(reference)[0]):
        message = "its run did not complete: only a reference that did not either is replaced by it, and"
        _refuse(result, f"{message} nothing was accepted; copy the file if it shall be one", id="DIFF-034")
    try:
        source = open(result, "rb")  # noqa: SIM115
    except OSError as error:
        raise TableError(
            str(result), [Fault("error", f"cannot be read: {error.strerror}", id="DIFF-001")]
        ) from error
    import shutil  # with its libraries of compression, which a comparison does not need

    with source, replaced(reference) as copy:
        shutil.copyfileobj(source, copy)


def accept_pair(compared: Compared, folder: str) -> None:
    """Accept the new file of a pair of two folders where it differs, or has no reference in `folder` yet.

    A failure to do so is kept in `compared`, since it concerns no other file.
    """
    pair = compared.pair
    if pair.b is None or compared.equal or compared.failure is not None:
        return
    try:
        reference = pair.a or _new_reference(folder, pair)
        if os.path.dirname(reference):
            make_folder(os.path.dirname(reference))
        accept(reference, pair.b)
        compared.updated, compared.new = True, pair.a is None
    except FlexmbError as failure:
        compared.failure = failure


def _new_reference(folder: str, pair: Pair) -> str:
    """Return the place of a reference that `folder` lacks: no link on the way to it is followed."""
    if not os.path.isdir(folder):
        message = "a new reference needs a folder for A, not a pattern"
        raise TableError(pair.b or pair.name, [Fault("error", message, id="DIFF-013")])
    place = os.path.join(folder, pair.name)
    if os.path.lexists(place) or os.path.realpath(place) != os.path.join(
        os.path.realpath(folder), *PurePath(pair.name).parts
    ):
        _refuse(place, "a link, a pipe or a device stands in its place; remove it", id="DIFF-037")
    return place


def _refuse(result: Any, message: str, *, id: str) -> None:
    raise TableError(str(result), [Fault("error", message, id=id)])


def _ending(path: Path | str) -> tuple[bool, bool]:
    """Return whether the run of a result did not complete, and whether it has any rows."""
    if form_of(path) in (CSV, MATLAB):
        return False, True  # an export keeps no mark that can be relied on
    if form_of(path) == HDF5:
        from ..hdf5.stored_result import attribute
        from .hdf5 import open_sound

        with open_sound(str(path)) as file:
            failed = attribute(file, "status", "complete") != "complete"  # the table of a study has none
            return failed, "time" in file and len(file["time"]) > 0
    listing = read_listing(path)
    # The echo of a tree has no rows in any case; they are in its series.
    return listing.failed, len(listing.time) > 0 or not listing.form.has_rows


def is_missing(reference: Path | str) -> bool:
    """Return whether there is no reference yet."""
    return not os.path.lexists(reference)
