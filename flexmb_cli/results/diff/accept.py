"""Accept a result as the new reference: the whole file or nothing."""

import os
import shutil

from ...deck.listing import TableError
from ...errors import Fault
from ..files.replaced_file import Replacement, located
from .listings import is_hdf5, read_listing


def accept(reference, result) -> None:
    """Put a copy of `result` in the place of `reference`; a reader sees the old file or the new one.

    Both were compared.  Raises `OutputError` when the reference cannot be written, `TableError` when the
    result cannot be read, shows nothing since its run failed before the first row, or is of a run that
    failed later, unless the reference is so too: a mechanism that locks has no other.
    """
    failed, rows = _ending(result)
    if failed and not rows:
        _refuse(result, "its run failed before the first row: that is no reference, and nothing was accepted")
    if failed and (is_missing(reference) or not _ending(reference)[0]):
        message = "its run did not complete: only a reference that did not either is replaced by it, and"
        _refuse(result, f"{message} nothing was accepted; copy the file if it shall be one")
    try:
        source = open(result, "rb")  # noqa: SIM115
    except OSError as error:
        raise TableError(
            str(result), [Fault("error", f"cannot be read: {error.strerror}", id="DIFF-001")]
        ) from error
    with source:
        place = Replacement(reference)
        try:
            with located(place.path), place.open("wb") as copy:
                shutil.copyfileobj(source, copy)
        except BaseException:
            place.discard()
            raise
        place.commit()


def _refuse(result, message):
    raise TableError(str(result), [Fault("error", message, id="DIFF-002")])


def _ending(path):
    """Whether the run of a result did not complete, and whether it has any rows."""
    if is_hdf5(path):
        from ..hdf5.stored_result import attribute
        from .hdf5 import open_sound

        with open_sound(str(path)) as file:
            failed = attribute(file, "status", "complete") != "complete"  # the table of a study has none
            return failed, "time" in file and len(file["time"]) > 0
    listing = read_listing(path)
    # The echo of a tree has no rows in any case; they are in its series.
    return listing.failed, len(listing.time) > 0 or not listing.form.has_rows


def is_missing(reference) -> bool:
    """Whether there is no reference yet."""
    return not os.path.lexists(reference)
