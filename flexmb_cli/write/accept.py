"""Accept a result as the new reference: the whole file or nothing."""

import os
import shutil

from ..errors import Fault
from .atomic import Replacement, located
from .listing import TableError


def accept(reference, result) -> None:
    """Put a copy of `result` in the place of `reference`; a reader sees the old file or the new one.

    Raises `OutputError` when the reference cannot be written, `TableError` when the result cannot be read.
    """
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


def is_missing(reference) -> bool:
    """Whether there is no reference yet."""
    return not os.path.lexists(reference)
