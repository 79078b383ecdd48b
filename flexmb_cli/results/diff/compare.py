"""Compare two results, whatever their form: listings, HDF5 results, and what was exported from these."""

from typing import Any

from ...deck.listing import Listing, TableError
from ...errors import Fault
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
            "this is no HDF5 result, the other file is" if HDF5 in forms else "the two are of different forms"
        )
        message = f"{form}; compare two tables, two HDF5 results, or an export with its HDF5 result"
        raise TableError(other, [Fault("error", message, id="DIFF-008")])
