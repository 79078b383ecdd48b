"""Ctrl-C, SIGTERM and a closed terminal."""

import signal
import sys
from typing import TYPE_CHECKING, Any

from ...run.outcome import Stop, Terminated
from ...run.processes.signal_mask import STOPS

if TYPE_CHECKING:
    from types import FrameType


def stop_on_signals() -> None:
    """Note SIGINT and SIGTERM from here on; raise the first where stops are released (`Stop.released`).

    A second signal is ignored: rows are being kept then, and a process may receive the same signal from the
    terminal and from its parent.
    """

    def stop(number: int, frame: "FrameType | None") -> None:
        before, Stop.asked = Stop.asked, KeyboardInterrupt if number == signal.SIGINT else Terminated
        if before is None and not Stop.held:
            raise Stop.asked

    Stop.held = 1
    for number in STOPS:
        # A shell that runs its commands in the background has them ignore Ctrl-C, `nohup` a closed terminal.
        if number == signal.SIGTERM or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)


def ignore_stops() -> None:
    """Ignore further stops: a process that has obeyed one ends by itself, with its own exit code."""
    for number in STOPS:
        signal.signal(number, signal.SIG_IGN)


def pass_over_stops(lost: Any) -> None:
    """`sys.unraisablehook`: a stop amid Python's own clearing up is not raised there; it is no traceback.

    Nor is it where memory is short: what needs it says so.
    """
    if not issubclass(lost.exc_type, KeyboardInterrupt | Terminated | MemoryError):
        sys.__unraisablehook__(lost)
