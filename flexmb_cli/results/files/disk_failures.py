"""Failures of the disk in sentences; and the file below HDF5, which must not learn of them."""

import errno
import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ...errors import ANALYSIS_FAILED, BAD_INPUT, OutputError
from ...memory import file_lacks_memory

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


@contextmanager
def located(path: str) -> Iterator[None]:
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


class FullDiskGuard(io.FileIO):
    """The file below HDF5.  It keeps the first failure of the disk and reports success to HDF5.

    HDF5 itself must not meet a failing disk: it then crashes the process when its file is closed, when it
    cannot find a place, or when it does not read back what it has written.  What the disk has refused is kept
    here until the next `blamed`.
    """

    def __init__(self, place: str | int):
        """`place` is a path, or the descriptor of an empty file open for reading and writing."""
        self.failure: OSError | None = None
        self._refused: list[tuple[int, bytes]] = []  # place, bytes
        self._at = self._length = 0  # where HDF5 believes to be, and how long it believes the file to be
        super().__init__(place, "w+")

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Set the position of the next transfer."""
        self._at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._length}[whence]
        return self._at

    def tell(self) -> int:
        """Return the position after the transfers that HDF5 requested."""
        return self._at

    def write(self, data: Any) -> int:
        """Write all of `data`; report success to HDF5 in any case."""
        view, start, done = memoryview(data).cast("B"), self._at, 0
        try:
            if self.failure is None:
                super().seek(start)
            while done < len(view) and self.failure is None:
                done += super().write(view[done:])
        except OSError as error:
            self.failure = error
        if done < len(view):
            self._refused.append((start + done, bytes(view[done:])))
        self._at = start + len(view)
        self._length = max(self._length, self._at)
        return len(view)

    def readinto(self, buffer: Any) -> int:
        """Fill `buffer` with the bytes that HDF5 requested to be written there."""
        view, start, got = memoryview(buffer).cast("B"), self._at, 0
        try:
            super().seek(start)
            got = super().readinto(view)
        except OSError as error:
            self.failure = self.failure or error
        if self.failure is None:
            self._at = start + got
            return got
        view[got:] = bytes(len(view) - got)
        for place, data in self._refused:
            first, last = max(start, place), min(start + len(view), place + len(data))
            if first < last:
                view[first - start : last - start] = data[first - place : last - place]
        self._at = start + len(view)
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        """Set the file's length."""
        self._length = self._at if size is None else size
        try:
            return super().truncate(self._length)
        except OSError as error:
            self.failure = self.failure or error
            return self._length

    @contextmanager
    def blamed(self) -> Iterator[None]:
        """Raise the OSError that was swallowed, whatever HDF5 made of it."""
        try:
            yield
        except Exception as fault:
            if self.failure is None:
                raise
            raise self.failure from fault
        if self.failure is not None:
            raise self.failure
