"""Ctrl-C, SIGTERM and a closed terminal."""

import signal
import sys
from contextlib import contextmanager

from ..run.outcome import Stop, Terminated

# SIGHUP, which not every system has: the terminal is closed, or the connection to it.
STOPS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


def stop_on_signals() -> None:
    """Have them noted from here on, and raised where they are released (`Stop.released`), but once only.

    A second one would come in the midst of what the first one has brought about: rows are being kept.  The
    terminal tells a process what its parent tells it, too.
    """

    def stop(number, frame):
        before, Stop.asked = Stop.asked, KeyboardInterrupt if number == signal.SIGINT else Terminated
        if before is None and not Stop.held:
            raise Stop.asked

    Stop.held = 1
    for number in STOPS:
        # A shell that runs its commands in the background has them ignore Ctrl-C, `nohup` a closed terminal.
        if number == signal.SIGTERM or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)


def ignore_stops() -> None:
    """Where one was obeyed the process ends by itself, with its own exit code."""
    for number in STOPS:
        signal.signal(number, signal.SIG_IGN)


def pass_over_stops(lost) -> None:
    """`sys.unraisablehook`: a stop amid Python's own clearing up is not raised there; it is no traceback."""
    if not issubclass(lost.exc_type, KeyboardInterrupt | Terminated):
        sys.__unraisablehook__(lost)


@contextmanager
def stops_blocked():
    """A process that is started in here has them waiting until it calls `unblock_stops`."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    # It starts with the first process, and lets through what it finds blocked.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def unblock_stops() -> None:
    """Have this process told of signals again."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
