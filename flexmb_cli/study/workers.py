"""Solution of the blocks of a study: by this process, or by processes beside it."""

import signal
from collections import Counter, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from ..errors import ANALYSIS_FAILED, FlexmbError
from ..run.outcome import Listener
from ..run.processes.worker import Remark, Worker, end_all, having_answers, portable, remarking, why_unable
from .sweep import MOST_DEATHS, SILENT, BlockDone, Job, Sweep, give_up_case, next_case, solve_block

IN_FLIGHT = 2  # blocks that a worker, or a thread of one, is given: one that it solves and the next
BEGUN = "begun"


class WorkersError(FlexmbError):
    """The processes of a study end before they solve anything (exit 1)."""

    exit_code = ANALYSIS_FAILED


def solve_here(
    sweep: Sweep, blocks: Iterable[int], advance: Callable[[int], None], listener: Listener = SILENT
) -> None:
    """Solve `blocks` in this process."""
    for block in blocks:
        sweep.done[block] = solve_block(sweep.job, block, advance, listener)


def solve_in_processes(
    sweep: Sweep, blocks: list[int], advance: Callable[[int], None], jobs: int, listener: Listener = SILENT
) -> None:
    """Solve `blocks` in `jobs` processes.  A process that dies is replaced, and its blocks go on.

    A case seen at all deaths but one that are allowed is solved with nothing beside it, which may have taken
    the memory; it is recorded as failed when its process dies even so.
    Raises WorkersError where processes cannot be had, and what a process raised.
    """
    work = _Work(sweep, jobs, advance, deque(blocks), listener)
    try:
        while work.proceed():
            pass
        end_all(work.given)
    except BaseException:
        # What is then reported to be kept shall not grow any more.
        for worker in work.given:
            worker.kill()
        raise


@dataclass
class _Work:
    """`waiting` blocks; `alone` those to be solved with nothing beside them; `given` blocks by worker, in
    the order in which it solves them; `begun` the workers that have reported so.
    """

    sweep: Sweep
    jobs: int
    advance: Callable[[int], None]
    waiting: deque[int]
    listener: Listener
    alone: deque[int] = field(default_factory=deque)
    given: dict[Worker, deque[int]] = field(default_factory=dict)
    begun: set[Worker] = field(default_factory=set)
    deaths: Counter[tuple[int, int]] = field(default_factory=Counter)
    barren: int = 0
    reported: set[Remark] = field(default_factory=set)

    def proceed(self) -> bool:
        """Give blocks to processes and hear what they have to say; False when all are solved."""
        self._start()
        self._hand_out()
        if self.alone and not any(self.given.values()):
            self._give(next(iter(self.given)), self.alone.popleft())
        if not any(self.given.values()):
            return False
        for worker in having_answers(self.given):
            self._hear(worker, worker.answer())
        return True

    def _start(self) -> None:
        count = len(self.waiting) or min(1, len(self.alone))
        while len(self.given) < min(self.jobs, count):
            try:
                self.given[Worker(_serve, self.sweep.job, runs_script=False)] = deque()
            except OSError as fault:
                self._do_with_fewer(str(fault))

    def _hand_out(self) -> None:
        """Every process is given one before any gets its next; of the last ones none waits behind another."""
        for most in range(1, IN_FLIGHT + 1):
            for worker, blocks in self.given.items():
                if len(blocks) < most and len(self.waiting) > (self.jobs if most > 1 else 0):
                    self._give(worker, self.waiting.popleft())

    def _do_with_fewer(self, reason: str) -> None:
        if not self.given:
            raise WorkersError(f"no process can be started: {reason}; -j 1 needs none", id="STUDY-024")
        self.jobs = len(self.given)

    def _give(self, worker: Worker, block: int) -> None:
        self.given[worker].append(block)
        worker.send(block)

    def _hear(self, worker: Worker, answer: Any) -> None:
        if answer is None:
            self._replace(worker)
        elif isinstance(answer, BlockDone):
            self.given[worker].remove(answer.block)
            keep(self.sweep, answer, self.advance)
        elif isinstance(answer, Remark):
            # Processes say the same: they compile the same kernels.
            if answer not in self.reported:
                getattr(self.listener, answer.kind)(answer.said)
            self.reported.add(answer)
        elif answer == BEGUN:
            self.begun.add(worker)
            self.barren = 0
        elif worker in self.begun:
            raise answer
        else:
            worker.kill()
            self._take_back(worker)
            self._do_with_fewer(str(answer))

    def _replace(self, worker: Worker) -> None:
        """A process has died: whatever it was at is counted."""
        if worker in self.begun:
            note_deaths(self.sweep.job, list(self.given[worker])[:1], self.deaths)
        else:
            self.barren += 1
        self._take_back(worker)
        if self.barren == MOST_DEATHS:
            raise WorkersError(
                f"the processes that should solve cases ended {MOST_DEATHS} times before they began one: "
                "killed from outside, or out of memory; fewer of them (-j) or none (-j 1) may do",
                id="STUDY-025",
            )

    def _take_back(self, worker: Worker) -> None:
        """The blocks that a process was given wait again."""
        for block in reversed(self.given.pop(worker)):
            last_try = self.deaths[_place(self.sweep.job, block)] == MOST_DEATHS - 1
            (self.alone if last_try else self.waiting).appendleft(block)


def _serve(line: Any, job: Job) -> None:
    """Solve the blocks that come through `line`."""
    # Ctrl-C reaches every process of the terminal.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    reason, listener = why_unable(), remarking(line)
    line.send(RuntimeError(reason) if reason else BEGUN)
    while True:
        line.send(_solve(job, line.recv(), listener))


def _solve(job: Job, block: int, listener: Listener = SILENT) -> BlockDone | BaseException:
    try:
        return solve_block(job, block, listener=listener)
    except Exception as fault:
        return portable(fault)


def keep(sweep: Sweep, done: BlockDone, advance: Callable[[int], None]) -> None:
    """Note that a block is done; call `advance` with the number of its cases that are new."""
    sweep.done[done.block] = done
    # Cases solved by a process that died afterwards are new, too.
    advance(len(sweep.job.cases(done.block)) - sweep.kept[done.block])


def note_deaths(job: Job, blocks: Iterable[int], deaths: Counter[tuple[int, int]]) -> None:
    """Count a death at the case that is next in each of `blocks`; a case with too many is given up."""
    for block in blocks:
        place = _place(job, block)
        if place[1] in job.cases(block):
            deaths[place] += 1
            if deaths[place] >= MOST_DEATHS:
                give_up_case(job, block)


def _place(job: Job, block: int) -> tuple[int, int]:
    return block, next_case(job, block)
