"""The file below HDF5, which must not learn that a disk is full."""

import io
from collections.abc import Iterator
from contextlib import contextmanager


class ForgivingDisk(io.FileIO):
    """The file below HDF5.  It remembers the first failure to write and pretends that all goes well.

    HDF5 itself must not meet a full disk: it then crashes the process when its file is closed, or when it
    does not read back what it has written.  What the disk has refused is kept here until the next `blamed`.
    """

    def __init__(self, place: str | int):
        """`place` is a path, or the descriptor of an empty file open for reading and writing."""
        self.failure: OSError | None = None
        self._refused: list[tuple[int, bytes]] = []  # place, bytes
        super().__init__(place, "w+")

    def write(self, data):
        """Write all of `data`; tell HDF5 that it is done in any case."""
        view, start, done = memoryview(data).cast("B"), self.tell(), 0
        while done < len(view) and self.failure is None:
            try:
                done += super().write(view[done:])
            except OSError as error:
                self.failure = error
        if done < len(view):
            self._refused.append((start + done, bytes(view[done:])))
            self.seek(start + len(view))
        return len(view)

    def readinto(self, buffer):
        """Fill `buffer` with what HDF5 believes to have written."""
        view, start = memoryview(buffer).cast("B"), self.tell()
        got = super().readinto(view)
        if self.failure is None:
            return got
        view[got:] = bytes(len(view) - got)
        for place, data in self._refused:
            first, last = max(start, place), min(start + len(view), place + len(data))
            if first < last:
                view[first - start : last - start] = data[first - place : last - place]
        self.seek(start + len(view))
        return len(view)

    def truncate(self, size=None):
        """Set the file's length."""
        try:
            return super().truncate(size)
        except OSError as error:
            self.failure = self.failure or error
            return size

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
