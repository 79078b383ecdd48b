"""Accept a result as the new reference: the whole file or nothing."""

import os
import shutil
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from ...deck.listing import TableError
from ...errors import Fault, FlexmbError
from ..files.replaced_file import make_folder, replaced
from .folders import Compared, Pair
from .listings import read_listing
from .tolerances import CSV, HDF5, MATLAB, form_of

if TYPE_CHECKING:
    from pathlib import Path


def accept(reference: "Path | str", result: "Path | str") -> None:
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
        message = "its run failed before the first row: that is no reference, and nothing was accepted"
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
        message = "a new reference needs a folder for A, and no pattern"
        raise TableError(pair.b or pair.name, [Fault("error", message, id="DIFF-013")])
    place = os.path.join(folder, pair.name)
    if os.path.lexists(place) or os.path.realpath(place) != os.path.join(
        os.path.realpath(folder), *PurePath(pair.name).parts
    ):
        _refuse(place, "a link, a pipe or a device stands in its place; remove it", id="DIFF-037")
    return place


def _refuse(result: Any, message: str, *, id: str) -> None:
    raise TableError(str(result), [Fault("error", message, id=id)])


def _ending(path: "Path | str") -> tuple[bool, bool]:
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


def is_missing(reference: "Path | str") -> bool:
    """Return whether there is no reference yet."""
    return not os.path.lexists(reference)
