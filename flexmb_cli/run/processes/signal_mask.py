"""Signals that stop a command, kept from processes that are only beginning; processes that end with it."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from ..outcome import Stop, Terminated

# SIGHUP, which not every system has: the terminal is closed, or the connection to it.
STOPS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextmanager
def signals_masked() -> Iterator[None]:
    """A process that is started in here has them waiting until it calls `unblock_stops`."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
    try:
        # It starts with the first process, and would be ended by a closed terminal.  It lets through here
        # what it had blocked itself.
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def unblock_stops() -> None:
    """Have this process notified of signals again."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)


def end_with_parent() -> None:
    """Have this worker killed when its parent is gone.

    It would otherwise wait for work for ever, or go on writing files that the next call of the same
    command writes, too.
    """
    from multiprocessing import parent_process
    from threading import Thread

    parent = parent_process()
    if parent is not None:

        def kill_after() -> None:
            parent.join()
            os.kill(os.getpid(), signal.SIGTERM if os.name == "nt" else signal.SIGKILL)

        Thread(target=kill_after, daemon=True).start()


def outlive_workers() -> None:
    """Have a worker, or a scheduler, that dies raise an error here.

    The system would end this process as well, silently, for writing into a pipe that nobody reads.
    """
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)


def stop_on_signals() -> None:
    """Note SIGINT and SIGTERM from here on; raise the first where stops are released (`Stop.released`).

    A second signal is ignored: rows are being kept then, and a process may receive the same signal from the
    terminal and from its parent.
    """

    def stop(number: int, frame: FrameType | None) -> None:
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
