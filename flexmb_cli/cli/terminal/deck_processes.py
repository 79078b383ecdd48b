"""Decks solved in several processes at once: whichever is killed, its deck is known."""

import signal
import sys
from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import Any

from ...errors import ANALYSIS_FAILED, Fault
from ...memory import lack_of_memory_text, lacks_memory
from ...run.earlier_results import EarlierResults
from ...run.outcome import Listener, Outcome, RunOptions, Stop, Terminated
from ...run.processes.signal_mask import pass_over_stops, stop_on_signals
from ...run.processes.worker import Remark, Worker, end_all, having_answers, portable, remarking, why_unable
from .progress import Progress

KILLED = (
    "the process that solved this deck was killed from outside, or out of memory: give it again; "
    "--resume continues the run"
)


def outcomes_in_parallel(
    earlier: dict[str, EarlierResults], options: RunOptions, jobs: int, progress: Progress
) -> Iterator[Outcome]:
    """Return what became of every deck, in order; after a stop, of those that had been begun."""
    from ...run.processes.signal_mask import outlive_workers

    outlive_workers()
    work = _Work(options, jobs, progress, deque(enumerate(earlier)), list(earlier.values()))
    try:
        for index in range(len(earlier)):
            while index not in work.ended:
                work.proceed()
            yield work.ended.pop(index)
    except (KeyboardInterrupt, Terminated) as stop:
        work.stop(signal.SIGINT if isinstance(stop, KeyboardInterrupt) else signal.SIGTERM)
        yield from (outcome for _, outcome in sorted(work.ended.items()))
    except BaseException:
        work.stop(signal.SIGTERM)
        raise
    finally:
        end_all(work.idle)


@dataclass
class _Unable:
    """Message of a process that cannot begin."""

    reason: str


@dataclass
class _Work:
    """`waiting` (index, deck), `running` (index, deck) by worker, `ended` outcomes by index.

    `earlier` results by index: those of a process that is killed are set aside here.

    `reported`: what one process or another had to say; `fault`: one of flexmb, with --debug.
    """

    options: RunOptions
    jobs: int
    progress: Progress
    waiting: deque[tuple[int, str]]
    earlier: list[EarlierResults]
    running: dict[Worker, tuple[int, str]] = field(default_factory=dict)
    idle: list[Worker] = field(default_factory=list)
    ended: dict[int, Outcome] = field(default_factory=dict)
    reported: set[Remark] = field(default_factory=set)
    fault: BaseException | None = None

    def proceed(self) -> None:
        """Give decks to processes, and wait until one has something to say."""
        while self.waiting and len(self.running) < self.jobs and Stop.asked is None:
            self._begin(*self.waiting.popleft())
        with Stop.released():
            ready = having_answers(self.running) if self.running else []
        self._hear(ready)
        if self.fault:
            raise self.fault

    def _begin(self, index: int, deck: str) -> None:
        while self.idle:
            worker = self.idle.pop()
            if worker.send(deck):
                self.running[worker] = index, deck
                return
            worker.kill()  # as somebody has while it had nothing to do
        try:
            worker = Worker(_serve, self.options)
        except OSError as fault:
            self._put_back(index, deck, str(fault))
            return
        worker.send(deck)
        self.running[worker] = index, deck

    def _put_back(self, index: int, deck: str, reason: str) -> None:
        """Let a deck wait whose process did not start; record it as failed if none is running."""
        if self.running:
            self.jobs = len(self.running)
            self.waiting.appendleft((index, deck))
        else:
            message = f"no process can be started for this deck: {reason}"
            self._end(index, _failed(deck, message, id="CLI-009"))

    def _end(self, index: int, outcome: Outcome) -> None:
        self.earlier[index].set_aside(outcome)
        self.ended[index] = outcome

    def stop(self, number: int) -> None:
        """Stop the processes as this one was: a signal may have come to this process alone."""
        for worker in self.running:
            worker.signal(number)
        while self.running:
            self._hear(having_answers(self.running))

    def _hear(self, workers: Collection[Worker]) -> None:
        for worker in workers:
            answer = worker.answer()
            if isinstance(answer, Remark):
                # Processes say the same.
                if answer not in self.reported:
                    getattr(self.progress, answer.kind)(answer.said)
                self.reported.add(answer)
            else:
                self._take(worker, *self.running.pop(worker), answer)

    def _take(self, worker: Worker, index: int, deck: str, answer: Any) -> None:
        """Return what became of a deck; `answer` None: its process was killed."""
        outcome, takes_more = answer or (_failed(deck, KILLED, id="CLI-008"), False)
        if takes_more:
            self.idle.append(worker)
        else:
            worker.end()
        if isinstance(outcome, Outcome):
            self._end(index, outcome)
        elif isinstance(outcome, _Unable):
            self._put_back(index, deck, outcome.reason)
        else:
            self.fault = outcome


def _failed(deck: str, reported: str, *, id: str) -> Outcome:
    return Outcome(deck, ANALYSIS_FAILED, faults=[Fault("error", reported, id=id)])


def _serve(line: Any, options: RunOptions) -> None:
    """Solve the decks that arrive through `line` until the other end closes it.

    Sends notices while a deck is solved, then (outcome, whether this process takes further decks).  After a
    stop it takes none: a module whose import was interrupted stays half imported.
    """
    sys.unraisablehook = pass_over_stops
    stop_on_signals()
    reason, listener = why_unable(), remarking(line)
    unable = _Unable(reason) if reason else None
    takes_more = True
    while takes_more:
        deck = line.recv()
        outcome = unable or _solve(deck, options, listener)
        takes_more = Stop.asked is None and isinstance(outcome, Outcome)
        line.send((outcome, takes_more))


def _solve(deck: str, options: RunOptions, listener: Listener) -> Any:
    try:
        from ... import interface

        return interface.solve_to_files(deck, options, listener)
    except Exception as fault:
        if lacks_memory(fault):
            return _failed(deck, lack_of_memory_text(fault), id="CLI-010")
        return portable(fault)  # of flexmb itself, with --debug
