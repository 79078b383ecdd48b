"""Solution of variants of a fit: here, in processes beside this one, or on a Dask cluster."""

import signal
from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ..deck.record import DeckText
from ..dialects.recognise import read_deck
from ..errors import INTERNAL_FAULT
from ..run.outcome import RunOptions
from ..run.processes.worker import Worker, having_answers, portable, why_unable
from ..version import __version__
from .fit_file import Fit
from .fit_variants import VariantSolver
from .solver import CaseResult
from .sweep import MOST_DEATHS
from .workers import BEGUN, WorkersError

# Values of the parameters, and the one by which the variant is differentiated, or None.
Task = tuple[tuple[float, ...], int | None]
Solve = Callable[[int, list[Task]], Iterator[CaseResult]]  # number of the first, and the tasks


@dataclass(frozen=True)
class FitJob:
    """Input of a worker, as texts instead of paths: it may run on another machine."""

    deck: DeckText
    deck_folder: str
    fit: Fit
    loop_tolerance: float | None = None


@lru_cache(maxsize=2)
def solver_of(job: FitJob) -> VariantSolver:
    """Return the solver of a job, made once in a process."""
    deck = read_deck(job.deck, job.fit.study.dialect)
    return VariantSolver(deck, job.fit, job.deck_folder, RunOptions(loop_tolerance=job.loop_tolerance))


def solve_task(job: FitJob, number: int, task: Task) -> CaseResult:
    """Return the case of a variant, or its derivatives in the place of values."""
    row, k = task
    solver = solver_of(job)
    return solver.solve(number, list(row)) if k is None else solver.derivative(number, list(row), k)


def solving_here(job: FitJob) -> Solve:
    """Return the solution of tasks in this process."""
    return lambda first, tasks: (solve_task(job, first + k, task) for k, task in enumerate(tasks))


class Processes:
    """Processes that solve variants.

    One that dies is replaced; a variant that ends MOST_DEATHS of them counts as failed.
    """

    def __init__(self, job: FitJob, jobs: int):
        self.job = job
        self.busy: dict[Worker, int | None] = {self._worker(): None for _ in range(jobs)}

    def _worker(self) -> Worker:
        try:
            worker = Worker(_serve, self.job, runs_script=False)
        except OSError as fault:
            message = f"no process can be started: {fault}; -j 1 needs none"
            raise WorkersError(message, id="STUDY-134") from fault
        return worker

    def __call__(self, first: int, tasks: list[Task]) -> Iterator[CaseResult]:
        """Yield the cases of `tasks` in their order."""
        waiting, deaths = deque(range(len(tasks))), Counter[int]()
        done: dict[int, CaseResult] = {}
        for k in range(len(tasks)):
            while k not in done:
                self._hand_out(first, tasks, waiting)
                for worker in having_answers(self.busy):
                    self._hear(worker, first, tasks, (waiting, deaths, done))
            yield done.pop(k)

    def _hand_out(self, first: int, tasks: list[Task], waiting: deque[int]) -> None:
        for worker, at in self.busy.items():
            if at is None and waiting:
                self.busy[worker] = k = waiting.popleft()
                worker.send((first + k, tasks[k]))

    def _hear(self, worker: Worker, first: int, tasks: list[Task], progress: Any) -> None:
        waiting, deaths, done = progress
        answer, at = worker.answer(), self.busy[worker]
        if isinstance(answer, BaseException):
            raise answer
        if isinstance(answer, CaseResult):
            assert at is not None, "it answers"
            done[at], self.busy[worker] = answer, None
        elif answer != BEGUN:
            del self.busy[worker]
            self.busy[self._worker()] = None
            at = -1 if at is None else at
            deaths[at] += 1
            if deaths[at] >= MOST_DEATHS:
                if at < 0:
                    message = f"the processes that should solve variants ended {MOST_DEATHS} times"
                    raise WorkersError(
                        f"{message}: killed, or out of memory; -j 1 needs none", id="STUDY-135"
                    )
                message = f"the process that solved this variant ended {MOST_DEATHS} times"
                done[at] = unsolved(self.job, first + at, tasks[at], message)
            elif at >= 0:
                waiting.appendleft(at)

    def end(self) -> None:
        """End the processes, whatever they are at."""
        for worker in self.busy:
            worker.kill()


def unsolved(job: FitJob, number: int, task: Task, message: str) -> CaseResult:
    """Return the case of a variant of which nothing is known but that it failed."""
    import numpy as np

    solver = solver_of(job)
    values = np.full(len(job.fit.numbers) + solver.residuals, np.nan)
    parameters = np.array(job.fit.study.complete(list(task[0])), dtype=float)
    return CaseResult(number, INTERNAL_FAULT, 0, parameters, values, np.zeros((0, 0)), message)


def _serve(line: Any, job: FitJob) -> None:
    """Solve the variants that come through `line`."""
    # Ctrl-C reaches every process of the terminal.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    reason = why_unable()
    line.send(RuntimeError(reason) if reason else BEGUN)
    while True:
        number, task = line.recv()
        try:
            answer: Any = solve_task(job, number, task)
        except Exception as fault:
            answer = portable(fault)
        line.send(answer)


def solving_on(client: Any, job: FitJob) -> Solve:
    """Return the solution of tasks by the workers of a Dask client; raises ClusterError."""
    from .cluster import ClusterError

    def solve(first: int, tasks: list[Task]) -> Iterator[CaseResult]:
        futures = [
            client.submit(_solve_remote, job, first + k, task, pure=False) for k, task in enumerate(tasks)
        ]
        for future in futures:
            version, case = future.result()
            if version != __version__:
                message = f"a worker has flexmb {version}, this fit is solved by {__version__}"
                raise ClusterError(message, id="STUDY-138")
            yield case

    return solve


def _solve_remote(job: FitJob, number: int, task: Task) -> tuple[str, CaseResult]:
    return __version__, solve_task(job, number, task)
