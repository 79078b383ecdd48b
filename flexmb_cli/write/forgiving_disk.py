"""The file below HDF5, which must not learn that a disk is full."""

import io
from collections.abc import Iterator
from contextlib import contextmanager


class ForgivingDisk(io.FileIO):
    """The file below HDF5.  It remembers the first failure to write and swallows what follows.

    HDF5 itself must not meet a full disk: it then crashes the process when its file is closed.
    """

    def __init__(self, path):
        self.failure: OSError | None = None
        super().__init__(path, "w+")

    def write(self, data):
        """Write all of `data`; tell HDF5 that it is done in any case."""
        view = memoryview(data)
        while view and self.failure is None:
            try:
                view = view[super().write(view) :]
            except OSError as error:
                self.failure = error
        return len(data)

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
