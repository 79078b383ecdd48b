"""Files that outlast a loss of power: what the system still holds in memory is handed to the disk.

Payloads one behind the other in a growing file, each with its length and checksum before it.

A kill tears at most the last one, which then does not count.
"""

import errno
import os
import struct
import sys
import time
import zlib
from collections.abc import Iterator
from contextlib import suppress
from typing import BinaryIO

from ...managed_files import open_managed

LONGEST_LOSS = 1.0  # s of work: a sync takes milliseconds, and a case of a study may take less

# File systems without sync, and files that are none of a disk.
_NO_SYNC = (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP)
_FOLDER = getattr(os, "O_DIRECTORY", None)


def sync(number: int) -> None:
    """Wait until what was written to the file of descriptor `number` is on the disk.  Raises OSError."""
    try:
        os.fsync(number)
    except OSError as error:
        if error.errno not in _NO_SYNC:
            raise


def sync_folder(folder: str) -> None:
    """Wait until the names made, changed and removed in `folder` are on the disk.  Raises OSError."""
    if _FOLDER is None:  # Windows opens no folders; there the rename itself is all that can be asked for
        return
    try:
        number = os.open(folder or os.curdir, os.O_RDONLY | _FOLDER)
    except PermissionError:  # one may write into a folder that one may not read
        return
    try:
        sync(number)
    finally:
        with suppress(OSError):  # nothing of the folder waits here
            os.close(number)


class GrowingFiles:
    """Files to which this process appends; all are synced together, at most once in `LONGEST_LOSS`.

    They are known by their paths: a descriptor that waits here would keep the lock of a closed file.
    """

    def __init__(self) -> None:
        self._paths: set[str] = set()
        self._last = time.monotonic()

    def grown(self, path: str) -> None:
        """Note that the file at `path` has grown, and sync when it is time.  Raises OSError."""
        self.note(path)
        if time.monotonic() - self._last >= LONGEST_LOSS:
            self.sync_all()

    def note(self, path: str) -> None:
        """Have the file at `path` synced by the next `sync_all`."""
        self._paths.add(path)

    def sync_all(self) -> None:
        """Sync all that has grown, and its folders.  Raises OSError."""
        paths, self._paths = self._paths, set()
        for path in paths:
            with suppress(FileNotFoundError):  # removed since, for it was no longer needed
                _sync_path(path)
        for folder in {os.path.dirname(path) for path in paths}:
            with suppress(FileNotFoundError):
                sync_folder(folder)
        self._last = time.monotonic()


def _sync_path(path: str) -> None:
    number = open_managed(path, os.O_WRONLY)
    try:
        sync(number)
    finally:
        os.close(number)


GROWING = GrowingFiles()


class LargePayload(ValueError):
    """A payload takes more memory than its reader has for it; `length` in bytes."""

    def __init__(self, length: int):
        super().__init__(length)
        self.length = length


def framed(payload: bytes, head: struct.Struct) -> bytes:
    """Return the payload after its head of two whole numbers: length, CRC-32."""
    return head.pack(len(payload), zlib.crc32(payload)) + payload


def whole_payloads(file: BinaryIO, head: struct.Struct, most: int = sys.maxsize) -> Iterator[bytes]:
    """Yield the payloads from here on, up to the end or the first that is torn or damaged.

    Raises LargePayload before it reads one of more than `most` bytes.
    Zeros, as a loss of power may leave, look like an empty payload with its checksum: the caller must check.
    """
    size = os.fstat(file.fileno()).st_size
    while len(start := file.read(head.size)) == head.size:
        length, checksum = head.unpack(start)
        # A damaged length may be larger than any memory.
        if length > size - file.tell():
            return
        if length > most:
            raise LargePayload(length)
        payload = file.read(length)
        if len(payload) < length or zlib.crc32(payload) != checksum:
            return
        yield payload
