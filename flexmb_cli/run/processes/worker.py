"""Processes of this machine, each with a line of its own.

Whichever is killed takes no other along, and what it was at is known.  No executor: its threads, when one
cannot be started, leave it waiting for ever, and write to closed lines while Python ends.
"""

import os
import pickle
import sys
import traceback
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, nullcontext, suppress
from multiprocessing import connection, get_context, util
from types import ModuleType
from typing import Any, NamedTuple

from ..outcome import Listener
from .signal_mask import end_with_parent, signals_masked, unblock_stops


class Worker:
    """A process that runs `serve(line, *given)`; what goes through its `line` is between the two.

    It ends when its `line` is closed, at the latest where `serve` next turns to it.
    `given` is pickled, and so is `serve` by its name.  Signals that stop are kept from the process until it
    unblocks them.  `runs_script`: the process first runs the file of `__main__`, as multiprocessing does for
    functions that are pickled from there.  Raises OSError when no process can be started.
    """

    def __init__(self, serve: Callable[..., Any], *given: Any, runs_script: bool = True):
        spawn = get_context("spawn")
        self.line, theirs = spawn.Pipe()
        self.process = spawn.Process(target=_served, args=(serve, theirs, *given))
        script = nullcontext() if runs_script else _script_hidden()
        with theirs, _safe_path(), signals_masked(), script:
            self.process.start()

    def send(self, message: Any) -> bool:
        """Return whether it was there to be notified."""
        with suppress(OSError):
            self.line.send(message)
            return True
        return False

    def answer(self) -> Any:
        """Return what the process has sent; None when it has ended, and nothing is left to be read."""
        with suppress(EOFError, OSError):
            if self.line.poll():
                return self.line.recv()
        self.kill()
        return None

    def signal(self, number: int) -> None:
        """Pass a stop on.  Windows sends it to every process of the console, and has no other signals."""
        pid = self.process.pid
        if os.name != "nt" and pid is not None and self.process.is_alive():
            os.kill(pid, number)

    def end(self) -> None:
        """Wait for a process that ends when nothing more can come."""
        self.line.close()
        self.process.join()

    def kill(self) -> None:
        """End the process, whatever it is at."""
        self.process.kill()
        self.end()


@contextmanager
def _safe_path() -> Iterator[None]:
    """Start processes with Python's option -P: modules in the working folder are not theirs to import.

    The variable PYTHONSAFEPATH would not do: a Python that was started with -E passes it over.
    """
    flags, of_util = util._args_from_interpreter_flags, vars(util)  # type: ignore[attr-defined]
    of_util["_args_from_interpreter_flags"] = lambda: [*flags(), "-P"]
    try:
        yield
    finally:
        of_util["_args_from_interpreter_flags"] = flags


@contextmanager
def _script_hidden() -> Iterator[None]:
    """Hide the script that called flexmb: without a test of its `__name__` it would begin anew."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


def _served(serve: Any, line: Any, *given: Any) -> None:
    """Return what a process does."""
    try:
        serve(line, *given)
    except (EOFError, OSError, MemoryError):
        # The other side has ended, or too little memory is left to say so: the closed line does.
        return


def having_answers(workers: Collection[Worker]) -> list[Worker]:
    """Wait until some of `workers` have sent something, or have ended; return these."""
    # A process that ended before it opened its line shows by its sentinel only.
    ready = set(connection.wait([thing for w in workers for thing in (w.line, w.process.sentinel)]))
    return [worker for worker in workers if ready & {worker.line, worker.process.sentinel}]


def end_all(workers: Collection[Worker]) -> None:
    """Wait for processes that end when nothing more can come, for all at once."""
    for worker in workers:
        worker.line.close()
    for worker in workers:
        worker.process.join()


def portable(fault: BaseException) -> BaseException:
    """`fault` as it can be sent, with the place where it was raised."""
    place = "".join(traceback.format_exception(fault))
    with suppress(Exception):
        fault.add_note(place)
        # Exceptions may be made with other arguments than they hold: tried here, where it can be helped.
        pickle.loads(pickle.dumps(fault))
        return fault
    return RuntimeError(place)


class Remark(NamedTuple):
    """A report of a process to the user."""

    kind: str  # "notice", or "status" until the first row: the method of `Listener` that takes it
    said: Any  # a Fault, or what is done


def remarking(line: Any) -> Listener:
    """Return a listener that sends reports through the line of a process."""
    return Listener(
        notice=lambda fault: line.send(Remark("notice", fault)),
        status=lambda doing: line.send(Remark("status", doing)),
    )


def why_unable() -> str:
    """Let a process that begins have its signals, and end with its parent; return why it cannot, or ""."""
    unblock_stops()
    try:
        end_with_parent()
    except RuntimeError as fault:  # no thread can be started
        return str(fault)
    return ""
