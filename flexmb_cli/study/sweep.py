"""A study from its file to its table: blocks of cases that workers take, each case kept once solved."""

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

from ..deck.record import Deck, DeckText, Lines
from ..deck.text import read_text
from ..dialects.recognise import CHOOSES, open_text, read_deck
from ..errors import ANALYSIS_FAILED, INTERNAL_FAULT, DeckError, Fault, FlexmbError, OutputError
from ..memory import with_present_objects_frozen
from ..run.outcome import Listener, RunOptions, Stop
from ..version import __version__
from .checkpoints import Part, Parts, RecordForm, StudyLock
from .reader import read_study
from .solver import CaseResult, CaseSolver
from .study import LARGEST, MEAN, SERIES, SMALLEST, Study
from .table import Column, Row, TableHead, write_table

MOST_CASES_A_BLOCK = 200  # cases
BLOCKS_WANTED = 100
MOST_DEATHS = 3  # of workers at one case
SILENT = Listener()


@dataclass(frozen=True)
class Job:
    """Input of a worker for any block, as texts instead of paths: it may run on another machine."""

    deck: DeckText
    deck_folder: str
    study: Study
    block_size: int
    parts_folder: str
    identity: tuple[tuple[str, str], ...]
    rows: int = 0  # of the deck, once it is known
    loop_tolerance: float | None = None

    @property
    def parts(self) -> Parts:
        """Return where the cases are kept."""
        return Parts(self.parts_folder, dict(self.identity), RecordForm.of(self.study, self.rows))

    @property
    def blocks(self) -> int:
        """Return how many blocks there are."""
        return -(-self.study.cases // self.block_size)

    def cases(self, block: int) -> range:
        """Numbers of the cases of a block."""
        first = block * self.block_size
        return range(first, min(first + self.block_size, self.study.cases))

    def stored(self, block: int) -> Iterator[CaseResult]:
        """The cases of a block that are kept, from its first on."""
        return self.parts.stored(block, self.cases(block))

    def part(self, block: int) -> Part:
        """The file of a block, held until it is closed."""
        return self.parts.block(block, self.cases(block))


@dataclass(frozen=True)
class BlockDone:
    """Progress of a block: cases that this call solved, and failures among all its cases."""

    block: int
    solved: int
    failed: int


@dataclass
class Sweep:
    """A study ready to be solved.  Raises DeckError where study or deck cannot be read as they are.

    `restored`: the study was stopped before and continues; `kept`: how many cases of a block there were then.
    """

    job: Job
    study_text: DeckText
    deck: Deck
    solver: CaseSolver
    lock: StudyLock
    restored: bool = False
    faults: list[Fault] = field(default_factory=list)
    kept: dict[int, int] = field(default_factory=dict)
    done: dict[int, BlockDone] = field(default_factory=dict)

    @classmethod
    def of(
        cls, path: str, parts_folder: str, fresh: bool = False, loop_tolerance: float | None = None
    ) -> "Sweep":
        """The study in the file at `path`; begins its folder of parts or continues with it."""
        text = study_text(path)
        with reported_at(path, text.lines):
            study = read_study(text)
        deck_path = os.path.join(os.path.dirname(path), study.deck)
        deck_text = readable_deck(deck_path, study)
        folder = os.path.dirname(os.path.abspath(deck_path))
        size = max(1, min(MOST_CASES_A_BLOCK, study.cases // BLOCKS_WANTED))
        identity = {"version": __version__, "deck": deck_text.sha256, "study": text.sha256}
        if loop_tolerance is not None:
            identity["loop_tolerance"] = str(loop_tolerance)
        place, items = os.path.abspath(parts_folder), tuple(identity.items())
        job = Job(deck_text, folder, study, size, place, items, loop_tolerance=loop_tolerance)
        with reported_at(path, text.lines):
            solver = solver_of(job)
        job = replace(job, rows=solver.rows)
        lock = job.parts.lock(path)
        try:
            restored = job.parts.begin(fresh)
        except BaseException:
            lock.leave()
            raise
        return cls(job, text, solver.deck, solver, lock, restored)

    def pending(self) -> list[int]:
        """Blocks that lack cases; the others count as done."""
        missing = []
        for block in range(self.job.blocks):
            codes = [result.exit_code for result in self.job.stored(block)] if self.restored else []
            self.kept[block] = len(codes)
            if len(codes) == len(self.job.cases(block)):
                self.done[block] = BlockDone(block, 0, sum(code != 0 for code in codes))
            else:
                missing.append(block)
        return missing

    @property
    def left(self) -> int:
        """Return how many cases there were still to solve when `pending` looked."""
        return self.job.study.cases - sum(self.kept.values())

    def results(self) -> Iterator[CaseResult]:
        """Every case that is kept, in order."""
        for block in range(self.job.blocks):
            yield from self.job.stored(block)

    def end(self) -> None:
        """Remove what was kept: the table has it."""
        try:
            self.job.parts.remove()
        finally:
            self.lock.leave()

    @cached_property
    def scatter(self) -> Any:
        """Return the scatter by tolerances when all cases are there, None without.

        If the middle of the ranges cannot be solved, `faults` say so.
        """
        if not any(item.tolerance for item in self.job.study.parameters):
            return None
        from .scatter import scatter_of

        try:
            return scatter_of(self.solver, list(self.results()))
        except FlexmbError as failure:
            message = f"no scatter: in the middle of the ranges {failure.faults[0].sentence}"
            self.faults.append(Fault("warning", message, id="STUDY-142"))
            return None

    @property
    def failed(self) -> int:
        """Return how many of the cases done failed."""
        return sum(block.failed for block in self.done.values())


class StudyError(DeckError):
    """A study or its deck cannot be read: `file` is the one at fault as the user has it, and its lines."""

    def __init__(self, path: str, faults: tuple[Fault, ...], lines: Lines | tuple[Any, ...] = ()):
        super().__init__(faults)
        self.file, self.lines = path, lines


@contextmanager
def reported_at(path: str, lines: Lines | tuple[Any, ...] = ()) -> Iterator[None]:
    """Faults of what is done here are those of the file at `path`, whose `lines` are."""
    try:
        yield
    except DeckError as failure:
        raise StudyError(path, failure.faults, lines) from failure


def study_text(path: str) -> DeckText:
    """Return the text of the study at `path`; raises StudyError."""
    with reported_at(path):
        text = read_text(path, "study")
    with reported_at(path, text.lines):
        if text.warnings:
            place = text.warnings[0].place
            raise DeckError(
                [Fault("error", "the study is not UTF-8, which TOML has to be", place, id="STUDY-017")]
            )
    return text


def readable_deck(path: str, study: Study) -> DeckText:
    """The text of the study's deck; what is wrong with it is reported at its own lines."""
    with reported_at(path):
        if os.path.exists(path) and not os.path.isfile(path):
            # A pipe would be waited for: the study, which may be untrusted, chose the name.
            raise DeckError(
                [Fault("error", "is not a regular file, but a folder, a pipe or a device", id="STUDY-018")]
            )
        text = open_text(path, study.dialect)
    with reported_at(path, text.lines):
        try:
            read_deck(text, study.dialect)
        except DeckError as failure:
            raise DeckError(map(_for_a_study, failure.faults)) from failure
    return text


def _for_a_study(fault: Fault) -> Fault:
    """A study has a key where the commands have an option."""
    return replace(fault, message=fault.message.replace(CHOOSES, 'dialect = "…" in the study chooses one'))


def solver_of(job: Job) -> CaseSolver:
    """The solver of a job, made once in a process."""
    return _solver(job.deck, job.deck_folder, job.study, job.loop_tolerance)


@lru_cache(maxsize=2)
def _solver(text: DeckText, folder: str, study: Study, loop_tolerance: float | None) -> CaseSolver:
    options = RunOptions(loop_tolerance=loop_tolerance)
    solver = CaseSolver(read_deck(text, study.dialect), study, folder, options)
    gc.collect()  # before the cases freeze what is there
    return solver


def solve_block(
    job: Job, block: int, advance: Callable[[int], None] = lambda cases: None, listener: Listener = SILENT
) -> BlockDone:
    """Solve what a block lacks; cases are kept before others begin."""
    job.parts.check_shared()
    solver = solver_of(job)
    solver.listened_by(listener)
    # Cases make garbage by the thousand: to look through all that stays, too, costs a tenth.
    with job.part(block) as part, with_present_objects_frozen():
        missing = job.cases(block)[part.count :]
        for first in range(0, len(missing), solver.at_once):
            several = missing[first : first + solver.at_once]
            part.append(solver.solve_several(several))
            advance(len(several))
            Stop.raise_if_asked()
        return BlockDone(block, len(missing), part.failed)


def give_up_case(job: Job, block: int) -> None:
    """Record that the next case of a block ends the process that solves it."""
    with job.part(block) as part:
        if part.count < len(job.cases(block)):
            message = (
                f"the process that solved this case ended {MOST_DEATHS} times: killed from outside, or out "
                "of memory"
            )
            part.append([solver_of(job).unsolved(job.cases(block)[part.count], INTERNAL_FAULT, message)])


def next_case(job: Job, block: int) -> int:
    """Number of the case of a block that comes next."""
    return job.cases(block).start + sum(1 for _ in job.stored(block))


MOST_RANGES = 5  # of missing cases named


def write_study_table(path: str, sweep: Sweep) -> None:
    """Write every case of a finished study to `path`, and remove its parts.

    Raises OutputError when the table cannot be written or cases are missing; the parts then stay.  Where only
    the parts cannot be removed, the table is there: no wrong command, exit 1.
    """
    # A stop must not be raised where HDF5 calls back for a write.
    with Stop.later():
        write_table(path, _head(sweep), _rows(sweep))
    Stop.raise_if_asked()
    with Stop.later():
        try:
            sweep.end()
        except OutputError as error:
            message = f"{error}; the table {path} is complete, remove the folder of its parts"
            raise OutputError(message, ANALYSIS_FAILED, id="STUDY-026") from error


def _head(sweep: Sweep) -> TableHead:
    deck = sweep.deck.source
    columns = (*_parameter_columns(sweep), *_result_columns(sweep))
    summary = tuple(sweep.scatter.datasets()) if sweep.scatter else ()
    return TableHead(
        sweep.study_text.text, deck.text, deck.name, deck.sha256, columns, sweep.job.study.cases, summary
    )


def _parameter_columns(sweep: Sweep) -> Iterator[Column]:
    numbers = dict(sweep.deck.numbers()) | dict(sweep.deck.variables)
    for item in sweep.job.study.parameters:
        number = numbers.get(item.name)
        meaning = number.meaning if number else "number of the study"
        yield Column(f"parameter/{item.name}", (number and number.unit) or "1", meaning)


def _result_columns(sweep: Sweep) -> Iterator[Column]:
    for item, quantity in zip(sweep.job.study.results, sweep.solver.quantities, strict=True):
        length = sweep.solver.rows if item.take == SERIES else 0
        # A peak between two report rows is none of the rows.
        over = " over the report rows" if item.take in (LARGEST, SMALLEST, MEAN) else ""
        meaning = f"{item.take} of {quantity.name}{over}"
        yield Column(f"result/{item.name}", quantity.unit, meaning, length)


def _rows(sweep: Sweep) -> Iterator[Row]:
    takes = sweep.solver.takes
    for result in _every_case(sweep):
        values, series = iter(result.values), iter(result.series)
        results = [next(series if take == SERIES else values) for take in takes]
        yield result.case + 1, result.exit_code, result.rows, result.message, [*result.parameters, *results]


def _every_case(sweep: Sweep) -> Iterator[CaseResult]:
    """The result of every case.  Raises OutputError with the numbers of those that are not kept."""
    missing: list[range] = []
    for block in range(sweep.job.blocks):
        stored, cases = list(sweep.job.stored(block)), sweep.job.cases(block)
        if len(stored) < len(cases):
            _add(missing, cases[len(stored) :])
        elif not missing:
            yield from stored
    if missing:
        raise OutputError(_reported(missing, sweep.job), ANALYSIS_FAILED, id="STUDY-020")


def _add(ranges: list[range], cases: range) -> None:
    if ranges and ranges[-1].stop == cases.start:
        cases = range(ranges.pop().start, cases.stop)
    ranges.append(cases)


def _reported(missing: list[range], job: Job) -> str:
    numbers = ", ".join(map(_numbers, missing[:MOST_RANGES])) + (", …" if len(missing) > MOST_RANGES else "")
    return (
        f"{job.parts_folder}: {sum(map(len, missing))} of {job.study.cases} cases are missing ({numbers}): "
        "their files were removed or damaged after they were solved; no table is written, the same command "
        "solves them"
    )


def _numbers(cases: range) -> str:
    return f"{cases.start + 1} to {cases.stop}" if len(cases) > 1 else str(cases.stop)
