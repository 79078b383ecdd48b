"""Ctrl-C, SIGTERM and a closed terminal."""

import signal
from contextlib import contextmanager

from ..run.outcome import Stop, Terminated

# SIGHUP, which not every system has: the terminal is closed, or the connection to it.
STOPS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


def stop_on_signals(once: bool = False) -> None:
    """Have them raised where the program is, but for where `Stop.later` holds them back.

    `once`: where one was raised already, a second changes nothing.
    """

    def stop(number, frame):
        before, Stop.asked = Stop.asked, KeyboardInterrupt if number == signal.SIGINT else Terminated
        if not Stop.held and not (once and before):
            raise Stop.asked

    for number in STOPS:
        # A shell that runs its commands in the background has them ignore Ctrl-C, `nohup` a closed terminal.
        if number == signal.SIGTERM or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)


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
