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

Row = tuple[float, ...]  # values of the parameters
Solve = Callable[[int, list[Row]], Iterator[CaseResult]]  # number of the first, and the rows


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


def solve_variant(job: FitJob, number: int, row: Row) -> CaseResult:
    """Return the case of a variant."""
    return solver_of(job).solve(number, list(row))


def solving_here(job: FitJob) -> Solve:
    """Return the solution of rows in this process."""
    return lambda first, rows: (solve_variant(job, first + k, row) for k, row in enumerate(rows))


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

    def __call__(self, first: int, rows: list[Row]) -> Iterator[CaseResult]:
        """Yield the cases of `rows` in their order."""
        waiting, deaths = deque(range(len(rows))), Counter[int]()
        done: dict[int, CaseResult] = {}
        for k in range(len(rows)):
            while k not in done:
                self._hand_out(first, rows, waiting)
                for worker in having_answers(self.busy):
                    self._hear(worker, first, rows, (waiting, deaths, done))
            yield done.pop(k)

    def _hand_out(self, first: int, rows: list[Row], waiting: deque[int]) -> None:
        for worker, at in self.busy.items():
            if at is None and waiting:
                self.busy[worker] = k = waiting.popleft()
                worker.send((first + k, rows[k]))

    def _hear(self, worker: Worker, first: int, rows: list[Row], progress: Any) -> None:
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
                done[at] = unsolved(self.job, first + at, rows[at], message)
            elif at >= 0:
                waiting.appendleft(at)

    def end(self) -> None:
        """End the processes, whatever they are at."""
        for worker in self.busy:
            worker.kill()


def unsolved(job: FitJob, number: int, row: Row, message: str) -> CaseResult:
    """Return the case of a variant of which nothing is known but that it failed."""
    import numpy as np

    solver = solver_of(job)
    values = np.full(len(job.fit.numbers) + solver.residuals, np.nan)
    parameters = np.array(job.fit.study.complete(list(row)), dtype=float)
    return CaseResult(number, INTERNAL_FAULT, 0, parameters, values, np.zeros((0, 0)), message)


def _serve(line: Any, job: FitJob) -> None:
    """Solve the variants that come through `line`."""
    # Ctrl-C reaches every process of the terminal.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    reason = why_unable()
    line.send(RuntimeError(reason) if reason else BEGUN)
    while True:
        number, row = line.recv()
        try:
            answer: Any = solve_variant(job, number, row)
        except Exception as fault:
            answer = portable(fault)
        line.send(answer)


def solving_on(client: Any, job: FitJob) -> Solve:
    """Return the solution of rows by the workers of a Dask client; raises ClusterError."""
    from .cluster import ClusterError

    def solve(first: int, rows: list[Row]) -> Iterator[CaseResult]:
        futures = [
            client.submit(_solve_remote, job, first + k, row, pure=False) for k, row in enumerate(rows)
        ]
        for future in futures:
            version, case = future.result()
            if version != __version__:
                message = f"a worker has flexmb {version}, this fit is solved by {__version__}"
                raise ClusterError(message, id="STUDY-138")
            yield case

    return solve


def _solve_remote(job: FitJob, number: int, row: Row) -> tuple[str, CaseResult]:
    return __version__, solve_variant(job, number, row)
