"""The table of a study from the cases that are kept."""

from collections.abc import Iterator

from ..errors import ANALYSIS_FAILED, OutputError
from ..run.outcome import Stop
from .solver import CaseResult
from .study import LARGEST, MEAN, SERIES, SMALLEST
from .sweep import Job, Sweep
from .table import Column, Row, TableHead, write_table

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
    return TableHead(sweep.study_text.text, deck.text, deck.name, deck.sha256, columns, sweep.job.study.cases)


def _parameter_columns(sweep: Sweep) -> Iterator[Column]:
    numbers = dict(sweep.deck.numbers())
    for item in sweep.job.study.parameters:
        number = numbers[item.name]
        yield Column(f"parameter/{item.name}", number.unit or "1", number.meaning)


def _result_columns(sweep: Sweep) -> Iterator[Column]:
    for item, quantity in zip(sweep.job.study.results, sweep.solver.quantities, strict=True):
        length = sweep.solver.rows if item.take == SERIES else 0
        yield Column(f"result/{item.name}", quantity.unit, _meaning(item.take, quantity.name), length)


def _meaning(take: str, name: str) -> str:
    """Return in words what is taken; a peak between two report rows is none of the rows."""
    over = " over the report rows" if take in (LARGEST, SMALLEST, MEAN) else ""
    return f"{take} of {name}{over}"


def _rows(sweep: Sweep) -> Iterator[Row]:
    takes = sweep.solver.takes
    for result in _every_case(sweep):
        values, series = iter(result.values), iter(result.series)
        kept = [next(series if take == SERIES else values) for take in takes]
        yield result.case + 1, result.exit_code, result.rows, result.message, [*result.parameters, *kept]


def _every_case(sweep: Sweep) -> Iterator[CaseResult]:
    """The result of every case.  Raises OutputError with the numbers of those that are not kept."""
    missing: list[range] = []
    for block in range(sweep.job.blocks):
        found, cases = list(sweep.job.stored(block)), sweep.job.cases(block)
        if len(found) < len(cases):
            _add(missing, cases[len(found) :])
        elif not missing:
            yield from found
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
