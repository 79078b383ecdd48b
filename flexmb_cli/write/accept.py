"""Accept a result as the new reference: the whole file or nothing."""

import os
import shutil

import h5py

from ..errors import Fault
from .atomic import Replacement, located
from .diff import is_hdf5, read_listing
from .listing import DAFMS_ECHO, TableError
from .stored_result import attribute


def accept(reference, result) -> None:
    """Put a copy of `result` in the place of `reference`; a reader sees the old file or the new one.

    Both were compared.  Raises `OutputError` when the reference cannot be written, `TableError` when the
    result cannot be read, or shows nothing: its run failed before the first row.
    """
    if _shows_nothing(result):
        message = "its run failed before the first row: that is no reference, and nothing was accepted"
        raise TableError(str(result), [Fault("error", message)])
    try:
        source = open(result, "rb")  # noqa: SIM115
    except OSError as error:
        raise TableError(str(result), [Fault("error", f"cannot be read: {error.strerror}")]) from error
    with source:
        place = Replacement(reference)
        try:
            with located(place.path), open(place.temporary, "wb") as copy:
                shutil.copyfileobj(source, copy)
        except BaseException:
            place.discard()
            raise
        place.commit()


def _shows_nothing(result):
    if is_hdf5(result):
        with h5py.File(result, "r") as file:
            return attribute(file, "status", "complete") != "complete" and not len(file["time"])
    listing = read_listing(result)
    # The echo of a tree has no rows in any case; they are in its series.
    return listing.failed and not len(listing.time) and listing.form != DAFMS_ECHO


def is_missing(reference) -> bool:
    """Whether there is no reference yet."""
    return not os.path.lexists(reference)
