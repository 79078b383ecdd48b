"""Decks solved in several processes at once.

A pool of one process for each of the jobs: whichever is killed takes no other along, and its deck is known.
"""

import os
import signal
import sys
from collections import deque
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, ProcessPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import active_children, get_context

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
    """`waiting` (index, deck), `running` (index, deck, pool) by its future, `ended` outcomes by index."""

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
            wait(self.running, return_when=FIRST_COMPLETED)
        self._take_ended()

    def _begin(self, index, deck):
        try:
            pool, future = self._begun(deck)
            self.running[future] = index, deck, pool
        except (OSError, RuntimeError) as fault:  # a thread that cannot be started is the latter
            self.ended[index] = _failed(deck, f"no process can be started for this deck: {fault}")

    def _begun(self, deck):
        with stops_blocked():
            if self.idle:
                pool = self.idle.pop()
                with suppress(BrokenExecutor):  # killed while it had nothing to do
                    return pool, pool.submit(_solve, deck, self.options)
            pool = _pool()
            return pool, pool.submit(_solve, deck, self.options)

    def stop(self, number):
        """Stop the processes as this one was: a signal may have come to this process alone."""
        for child in active_children():
            with suppress(ProcessLookupError):
                os.kill(child.pid, number)
        wait(self.running)
        self._take_ended()

    def leave(self):
        for pool in [*self.idle, *(pool for _, _, pool in self.running.values())]:
            pool.shutdown(wait=False, cancel_futures=True)

    def _take_ended(self):
        for future in [future for future in self.running if future.done()]:
            self._take(*self.running.pop(future), future)

    def _take(self, index, deck, pool, future):
        try:
            self.ended[index] = future.result()
            self.idle.append(pool)
        except BrokenExecutor:
            self.ended[index] = _failed(deck, KILLED)


def _failed(deck, told):
    return Outcome(deck, ANALYSIS_FAILED, faults=[Fault("error", told)])


def _pool():
    return ProcessPoolExecutor(1, get_context("spawn"), initializer=_begin_process)


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
    finally:
        # Who stopped this deck from outside did not mean the next one.
        Stop.asked, Stop.held = None, 1
