"""Pipes and devices that users name in the place of a result: opened without waiting for ever."""

import errno
import os
import stat
from time import monotonic, sleep

from ...errors import OutputError

LONGEST_WAIT = 10.0  # s, in which a program that reads the pipe starts
_PAUSE = 0.02  # s, between two tries


def open_special(path: str) -> int:
    """Return a descriptor that writes to the pipe or device at `path`.

    A plain opening of a pipe waits for its reader and continues waiting when a signal asks for the end.
    Raises OutputError where no program reads the pipe, OSError as `os.open`.
    """
    last = monotonic() + LONGEST_WAIT
    while True:
        try:
            number = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))
        except OSError as error:
            if error.errno != errno.ENXIO or not _is_pipe(path):
                raise
        else:
            break
        if monotonic() > last:
            raise OutputError(
                f"{path}: cannot be written: it is a pipe that nothing reads; start its reader or remove it",
                id="RESULT-052",
            )
        sleep(_PAUSE)
    if hasattr(os, "set_blocking"):
        os.set_blocking(number, True)
    return number


def _is_pipe(path: str) -> bool:
    return stat.S_ISFIFO(os.stat(path).st_mode)
