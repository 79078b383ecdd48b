"""The table of a study from the cases that are kept."""

from collections.abc import Iterator

from ..read.study import SERIES
from ..write.study_table import Column, Row, TableHead, write_table
from .outcome import Stop
from .sweep import Sweep


def write_study_table(path: str, sweep: Sweep) -> None:
    """Write every case of a finished study to `path`, and remove its parts.

    Raises OutputError when the table cannot be written; the parts then stay.
    """
    # A stop must not be raised where HDF5 calls back for a write.
    with Stop.later():
        write_table(path, _head(sweep), _rows(sweep))
    Stop.heed()
    sweep.job.parts.remove()


def _head(sweep):
    deck = sweep.deck.source
    columns = (*_parameter_columns(sweep), *_result_columns(sweep))
    return TableHead(sweep.study_text.text, deck.text, deck.name, deck.sha256, columns, sweep.job.study.cases)


def _parameter_columns(sweep):
    numbers = dict(sweep.deck.numbers())
    for item in sweep.job.study.parameters:
        number = numbers[item.name]
        yield Column(f"parameter/{item.name}", number.unit or "1", number.meaning)


def _result_columns(sweep):
    for item, quantity in zip(sweep.job.study.results, sweep.solver.quantities, strict=True):
        length = sweep.solver.rows if item.take == SERIES else 0
        yield Column(f"result/{item.name}", quantity.unit, f"{item.take} of {quantity.name}", length)


def _rows(sweep) -> Iterator[Row]:
    takes = sweep.solver.takes
    for result in sweep.results():
        values, series = iter(result.values), iter(result.series)
        kept = [next(series if take == SERIES else values) for take in takes]
        yield result.case + 1, result.exit_code, result.rows, result.message, [*result.parameters, *kept]
