"""Failures of the disk in sentences."""

import errno
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from ...errors import ANALYSIS_FAILED, BAD_INPUT, OutputError
from ...memory import file_lacks_memory

if TYPE_CHECKING:
    from collections.abc import Iterator


FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


@contextmanager
def located(path: str) -> "Iterator[None]":
    """Turn an `OSError` while writing `path` into an `OutputError` with a clear sentence, or MemoryError."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        if file_lacks_memory(error):
            raise MemoryError(str(error)) from error
        raise output_error(path, error) from error


def output_error(path: str, error: OSError) -> OutputError:
    """A full disk ends the run (exit 1); a place that cannot be written is a wrong command (exit 2)."""
    number = error.errno
    if number in FULL:
        return OutputError(
            f"{path}: no space left for the result; free some and run again", ANALYSIS_FAILED, id="RESULT-004"
        )
    if number == errno.EIO:
        return OutputError(
            f"{path}: the disk reports a failure while the result is written",
            ANALYSIS_FAILED,
            id="RESULT-005",
        )
    if number in (errno.EMFILE, errno.ENFILE):
        reported = "too many files are open; `ulimit -n` shows how many may be"
        return OutputError(f"{path}: cannot be written: {reported}", ANALYSIS_FAILED, id="RESULT-006")
    reason = _reason(number, error)
    if number == errno.ENOENT and os.path.isdir(os.path.dirname(os.path.realpath(path))):
        reason = "its folder takes no new files"  # such as /proc
    return OutputError(f"{path}: cannot be written: {reason}", BAD_INPUT, id="RESULT-007")


def _reason(number: Any, error: Any) -> str:
    return {
        errno.EACCES: "permission denied",
        errno.EPERM: "permission denied",
        errno.EROFS: "the disk is read-only",
        errno.ENOENT: "its folder does not exist",
        errno.ENOTDIR: "a part of the path is a file, not a folder",
        errno.EEXIST: "a file of that name is in the way",
        errno.EISDIR: "it is a folder",
        errno.ENAMETOOLONG: "the name is too long",
    }.get(number, error.strerror or str(error))
