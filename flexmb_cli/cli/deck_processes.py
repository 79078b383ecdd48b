"""Decks solved in several processes at once.

Each process has a line of its own: whichever is killed takes no other along, and its deck is known.  No
executor: its threads tell one another of a killed process while Python ends, and fail at closed lines.
"""

import os
import signal
import sys
import traceback
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import connection, get_context

from ..errors import ANALYSIS_FAILED, Fault
from ..run.outcome import Outcome, RunOptions, Stop, Terminated
from .stops import pass_over_stops, stop_on_signals, stops_blocked, unblock_stops

KILLED = (
    "the process that solved this deck was killed from outside, or out of memory: give it again; a DAFMS "
    "deck goes on with --resume"
)


def outcomes_in_parallel(decks, options: RunOptions, jobs: int) -> Iterator[Outcome]:
    """What became of every deck, in order; after a stop, of those that had been begun."""
    from ..run.orphans import outlive_workers

    outlive_workers()
    work = _Work(options, deque(enumerate(decks)))
    try:
        for index in range(len(decks)):
            while index not in work.ended:
                work.go_on(jobs)
            yield work.ended.pop(index)
    except (KeyboardInterrupt, Terminated) as stop:
        work.stop(signal.SIGINT if isinstance(stop, KeyboardInterrupt) else signal.SIGTERM)
        yield from (outcome for _, outcome in sorted(work.ended.items()))
    except BaseException:
        work.stop(signal.SIGTERM)
        raise
    finally:
        work.leave()


@dataclass
class _Work:
    """`waiting` (index, deck), `running` (index, deck, worker) by its line, `ended` outcomes by index."""

    options: RunOptions
    waiting: deque
    running: dict = field(default_factory=dict)
    idle: list = field(default_factory=list)
    ended: dict = field(default_factory=dict)

    def go_on(self, jobs):
        """Give decks to `jobs` processes, and wait until one has ended."""
        while self.waiting and len(self.running) < jobs and Stop.asked is None:
            self._begin(*self.waiting.popleft())
        with Stop.released():
            ready = connection.wait(self.running) if self.running else []
        self._take_ended(ready)

    def _begin(self, index, deck):
        try:
            worker = self._begun(deck)
            self.running[worker.line] = index, deck, worker
        except OSError as fault:
            self.ended[index] = _failed(deck, f"no process can be started for this deck: {fault}")

    def _begun(self, deck):
        if self.idle:
            worker = self.idle.pop()
            with suppress(OSError):  # killed while it had nothing to do
                worker.line.send(deck)
                return worker
        worker = _Worker(self.options)
        worker.line.send(deck)
        return worker

    def stop(self, number):
        """Stop the processes as this one was: a signal may have come to this process alone."""
        for _, _, worker in self.running.values():
            with suppress(ProcessLookupError):
                os.kill(worker.process.pid, number)
        while self.running:
            self._take_ended(connection.wait(self.running))

    def leave(self):
        for worker in self.idle:
            worker.line.close()
        for worker in self.idle:
            worker.process.join()

    def _take_ended(self, lines):
        for line in lines:
            self._take(*self.running.pop(line))

    def _take(self, index, deck, worker):
        try:
            outcome = worker.line.recv()
        except (EOFError, OSError):
            worker.process.join()
            self.ended[index] = _failed(deck, KILLED)
            return
        self.idle.append(worker)
        if isinstance(outcome, BaseException):
            raise outcome
        self.ended[index] = outcome


class _Worker:
    """A process that solves deck after deck; `line` takes a deck, and gives what became of it."""

    def __init__(self, options):
        spawn = get_context("spawn")
        self.line, theirs = spawn.Pipe()
        self.process = spawn.Process(target=_serve, args=(theirs, options))
        with theirs, stops_blocked():
            self.process.start()


def _failed(deck, told):
    return Outcome(deck, ANALYSIS_FAILED, faults=[Fault("error", told)])


def _serve(line, options):
    """Solve what comes through `line` until nothing more can come."""
    _begin_process()
    with suppress(EOFError, OSError):
        while True:
            line.send(_solve(line.recv(), options))


def _begin_process():
    from ..run.orphans import end_with_parent

    end_with_parent()
    sys.unraisablehook = pass_over_stops
    stop_on_signals()
    unblock_stops()


def _solve(deck, options):
    from ..run.deck import run_deck

    try:
        return run_deck(deck, options)
    except Exception as fault:  # of flexmb itself, with --debug
        fault.add_note("".join(traceback.format_exception(fault)))
        return fault
    finally:
        # Who stopped this deck from outside did not mean the next one.
        Stop.asked, Stop.held = None, 1
