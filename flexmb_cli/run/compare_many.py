"""Compare the pairs of files of two folders, in one process or in several."""

import os
import re
from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from ..errors import FlexmbError
from ..results.diff.compare import compare
from ..results.diff.folders import Compared, Pair, Summary
from ..results.diff.tolerance_file import FileTolerances
from ..results.diff.tolerances import CSV, HDF5, LISTING, MATLAB, form_of
from ..results.files.file_names import STALE

if TYPE_CHECKING:  # multiprocessing is for -j only
    from .processes.worker import Worker

# A table for print is known by its name or by its content; these are the names that runs give.
RESULT_NAME = re.compile(r"OUT.*|.*\.(OUT|T2|T3|h5|csv|tsv|mat)")


def compare_many(
    summary: Summary, tolerances: FileTolerances, options: dict[str, Any], jobs: int = 1
) -> None:
    """Compare all results among the pairs, in `jobs` processes; a file that cannot be read stops no other.

    `options` are those of `compare`.
    """
    pairs = [pair for pair in summary.pairs if _is_result(pair)]
    summary.passed_over += [pair.name for pair in summary.pairs if pair not in pairs]
    jobs = min(jobs, len(pairs))
    if jobs < 2:
        summary.compared += [_compared(pair, summary, tolerances, options) for pair in pairs]
        return
    from .processes.worker import Worker, end_all

    workers = [Worker(_serve, pairs[k::jobs], summary, tolerances, options) for k in range(jobs)]
    try:
        shares = [_answer_of(worker, tolerances) for worker in workers]
    finally:
        end_all(workers)
    summary.compared += [shares[k % jobs][k // jobs] for k in range(len(pairs))]


def _serve(
    line: Any, pairs: Sequence[Pair], summary: Summary, tolerances: FileTolerances, options: Any
) -> None:
    """Send the comparisons of `pairs` and the names of the tolerances used, or the failure of the call."""
    from .processes.worker import portable, why_unable

    if why_unable():
        return
    try:
        compared = [_compared(pair, summary, tolerances, options) for pair in pairs]
        line.send((compared, tolerances.used, tolerances.general.used))
    except BaseException as failure:
        line.send(portable(failure))


def _answer_of(worker: "Worker", tolerances: FileTolerances) -> list[Compared]:
    from .processes.worker import having_answers

    having_answers([worker])
    answer = worker.answer()
    if answer is None:
        raise FlexmbError(
            "a process that compared files was killed: run diff again, without -j", id="DIFF-040"
        )
    if isinstance(answer, BaseException):
        raise answer
    compared, of_files, of_quantities = answer
    tolerances.used |= of_files
    tolerances.general.used.update(of_quantities)
    return list(compared)


def _compared(pair: Pair, summary: Summary, tolerances: FileTolerances, options: Any) -> Compared:
    if pair.a is None or pair.b is None:
        lacking = summary.a if pair.a is None else summary.b
        stale = f"{pair.name}{STALE}"
        of_earlier = f" ({stale} is of an earlier run)" * os.path.isfile(os.path.join(lacking, stale))
        return Compared(pair, missing=f"{pair.name}: not in {lacking}{of_earlier}")
    chosen = tolerances.of_file(pair.name)
    if form_of(pair.a) != LISTING:
        # Results in full precision have no last printed digit: other files of the folder have.
        chosen = chosen.without_digits()
    try:
        return Compared(pair, compare(pair.a, pair.b, chosen, **options))
    except FlexmbError as failure:
        if failure.of_the_call:
            raise
        return Compared(pair, failure=failure)


def _is_result(pair: Pair) -> bool:
    """Return whether a pair is to be compared: by its name, or by the content of one of its files."""
    if re.search(rf"{re.escape(STALE)}(\.\d+)?$", pair.name):  # NAME.stale, NAME.stale.2
        return False
    if RESULT_NAME.fullmatch(PurePath(pair.name).name):
        return True
    return any(path is not None and _reads_as_result(path) for path in (pair.a, pair.b))


def _reads_as_result(path: str) -> bool:
    from ..results.diff.listings import read_listing

    form = form_of(path)
    if form in (CSV, MATLAB):
        return True
    if form == HDF5:
        return False  # files of ParaView and of other programs; results of runs have names of their own
    try:
        return form == LISTING and read_listing(path) is not None
    except FlexmbError:
        return False
