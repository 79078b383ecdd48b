"""Standard output that a shell has closed (`>&-`): what is written there is lost, which is an error."""

import errno
import io
import os
from typing import Any

CLOSED = "standard output is closed, so nothing can be printed"


class _ClosedFile(io.FileIO):
    """A file that cannot be written, open on the null device so that no other file gets its number."""

    def write(self, content: Any) -> int:
        """Refuse whatever is to be written."""
        if not len(content):  # click tries so what a stream takes
            return 0
        raise OSError(errno.EBADF, CLOSED)


def closed_output() -> io.TextIOWrapper:
    """Return a stream in the place of standard output; writing to it raises OSError at once."""
    file: Any = _ClosedFile(os.devnull, "w")
    return io.TextIOWrapper(file, encoding="utf-8", write_through=True)
