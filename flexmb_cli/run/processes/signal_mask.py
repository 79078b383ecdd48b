"""Signals that stop a command, kept from processes that are only beginning."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

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
