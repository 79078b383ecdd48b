"""The Python interface: read a deck, check it, solve it in memory, run a study.

The commands `check`, `run` and `sweep` call these functions.  Only `Result.save`, `solve_to_files` and
`write_study` leave files.  Units are SI; names of quantities are those of `flexmb table`.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import COMPLETE, FAILED, AnalysisError, DeckError, Fault, FlexmbError, ModelError
from .result import OpenDeck, Result

if TYPE_CHECKING:
    from .run.check.check import CheckReport
    from .run.earlier_results import EarlierResults
    from .run.outcome import Listener, Outcome, RunOptions, TextStream
    from .run.solutions import Solution
    from .study.fit import FitRun
    from .study.sensitivity import Sensitivity
    from .study.sweep import Sweep


TEXT_NAME = "deck"  # in messages and results, of a deck that was given as text


def read_deck(
    path: str | os.PathLike[str], changes: Mapping[str, object] | None = None, dialect: str = "auto"
) -> OpenDeck:
    """Read the deck at `path`, with the numbers in `changes` set ({"driver.1.B": 6.28}).

    A string of several lines is the text of a deck; files that it names are relative to the working folder.
    Raises FlexmbError, whose `faults` have place, subject and remedy, for a deck that cannot be read.
    """
    from .run.model import open_deck
    from .run.outcome import Outcome, RunOptions

    words = tuple(f"{name}={value}" for name, value in (changes or {}).items())
    name, text = os.fspath(path), None
    if "\n" in name and not os.path.exists(name):
        name, text = TEXT_NAME, name
    outcome = Outcome(name)
    with _naming(outcome):
        deck = open_deck(name, RunOptions(dialect=dialect, changes=words), outcome, text)
    return OpenDeck(deck, outcome.deck, words, tuple(outcome.faults))


def check(
    deck: OpenDeck | str | os.PathLike[str], options: "RunOptions | None" = None, jacobian: str | None = None
) -> "CheckReport":
    """Diagnose a deck without solving it, as `flexmb check`; faults are in the report, nothing is raised.

    `jacobian`: a time, s, or "estimate": the report then has the constraint Jacobian there.
    """
    from .run.check.check import check_deck
    from .run.model import take_open_deck
    from .run.outcome import RunOptions

    if isinstance(deck, OpenDeck):
        opened, options = deck, replace(options or RunOptions(), changes=deck.changes)
        return check_deck(
            opened.path,
            options,
            jacobian,
            lambda _, given, outcome: take_open_deck(opened.deck, opened.warnings, given, outcome),
        )
    return check_deck(os.fspath(deck), options or RunOptions(), jacobian)


def solve_to_files(
    deck: str | os.PathLike[str],
    options: "RunOptions | None" = None,
    listener: "Listener | None" = None,
    stdout: "TextStream | None" = None,
    earlier: "EarlierResults | None" = None,
) -> "Outcome":
    """Solve a deck and write its listing and its HDF5 file, as `flexmb run`.

    `listener` receives the progress of the run, `stdout` the listing where `options.out` is "-"; `earlier`:
    the files in the places of its results, if the caller has looked.  Nothing is raised: the outcome has
    exit code, faults and the files written.
    """
    from .run.outcome import RunOptions
    from .run.solution import run_deck

    return run_deck(os.fspath(deck), options or RunOptions(), listener, stdout, earlier)


def solve(deck: OpenDeck | str | os.PathLike[str], **options: float | str) -> Result:
    """Solve a deck in memory.

    `options`: those of `flexmb run` that numbers depend on: `rtol`, `atol`, `method` of the integration;
    `tolerance`, `smallest_pivot`, `most_iterations` of the kinematics; `formulation` ("absolute") of trees;
    `loop_tolerance` of overconstrained loops.
    Raises TypeError for another option, ValueError for a value out of range, FlexmbError for a deck that
    cannot be solved.  A run that fails on its way raises AnalysisError,
    whose attribute `result` holds the rows so far.
    """
    from .run.outcome import Outcome, Run
    from .run.solution import prepared

    opened = deck if isinstance(deck, OpenDeck) else read_deck(deck)
    run = Run(Outcome(opened.path), _run_options(options))
    run.outcome.source = opened.deck.source
    with _naming(run.outcome):
        solution, of_model = prepared(opened.deck, run)
        blocks: list[Mapping[str, np.ndarray]] = []
        try:
            blocks.extend(solution.blocks_counted())
        except AnalysisError as failure:
            failure.result = _result(opened, solution, blocks, [*run.outcome.faults, *of_model], failure)
            raise
    return _result(opened, solution, blocks, [*run.outcome.faults, *of_model], None)


def _run_options(options: dict[str, Any]) -> "RunOptions":
    from .run.outcome import RunOptions
    from .run.python_options import refuse_wrong

    refuse_wrong(options)
    of_steps, of_solver = ("rtol", "atol", "method"), ("tolerance", "smallest_pivot", "most_iterations")
    steps: dict[str, Any] = {name: options.pop(name) for name in of_steps if name in options}
    solver: dict[str, Any] = {name: options.pop(name) for name in of_solver if name in options}
    return RunOptions(integration=steps, solver=solver, **options)


@contextmanager
def _naming(outcome: "Outcome") -> Iterator[None]:
    """Put the deck's name and the place of the fault in front of the message of a FlexmbError."""
    try:
        yield
    except FlexmbError as failure:
        if not failure.file:
            fault = next((f for f in failure.faults if f.severity == "error"), failure.faults[0])
            place = fault.as_dict(outcome.lines)
            file = place.get("file", outcome.deck)
            at = f":{place['line']}:{place['column']}" if fault.place else ""
            failure.file, failure.args = outcome.deck, (f"{file}{at}: {failure}",)
        raise


def _result(
    opened: OpenDeck,
    solution: "Solution",
    blocks: list[Mapping[str, np.ndarray]],
    faults: list[Fault],
    failure: AnalysisError | None,
) -> Result:
    layout = solution.layout()
    # The same datasets as in the HDF5 file: none of what the model lacks, such as pins.
    paths = ("time", *(item.path for item in layout.series)) if blocks else ()
    values = {path: np.concatenate([block[path] for block in blocks]) for path in paths}
    warnings = (*opened.warnings, *faults, *solution.warnings, *solution.count.warnings)
    status, message = (COMPLETE, "") if failure is None else (FAILED, str(failure))
    return Result(opened, values, layout, status, message, tuple(dict.fromkeys(warnings)))


def sensitivity(
    deck: OpenDeck | str | os.PathLike[str],
    of: Sequence[str],
    to: Sequence[str],
    *,
    equilibrium: bool = False,
    at: float | None = None,
    **options: float | str,
) -> "Sensitivity":
    """Return the derivatives of quantities of a deck's motion by numbers of the deck, in every report row.

    of: quantities as `flexmb table` names them, patterns included, or `mode.1.frequency` and
    `mode.1.damping` of the motion linearised at the start or at the time `at`, s.  to: numbers as `changes`
    of `read_deck` names them, variables of the deck included.  `equilibrium`: in the equilibrium instead of
    along the motion; there is one row then.  `options`: those of `solve`.

    The result has `time` (rows,), `values` (rows, of), `derivatives` and `relative` (rows, of, to), the names
    and units of `of` and `to`, and `result`, to save, plot and tabulate.  Raises FlexmbError.
    """
    from .run.outcome import Outcome
    from .study.sensitivity import sensitivity

    opened = deck if isinstance(deck, OpenDeck) else read_deck(deck)
    outcome = Outcome(opened.path, source=opened.deck.source)
    with _naming(outcome):
        return sensitivity(opened, of, to, _run_options(options), None, equilibrium, at)


def sweep(study: str | os.PathLike[str] | Mapping[str, Any], jobs: int = 1) -> dict[str, np.ndarray]:
    """Solve every case of a study; return its table by columns.

    `study` is the path of a study file, or a dict with the content of one, whose deck is relative to the
    working folder: {"deck": …, "parameters": {NAME: values}, "results": {NAME: "max point.1.z"}}.

    Keys are "parameter/NAME" and "result/NAME" (cases,) or (cases, times), "exit_code" and "rows" (cases,).
    A case that fails has an exit code other than 0, and nan.  Raises FlexmbError for a wrong study.
    """
    import tempfile

    import h5py

    with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
        path = _study_file(study, folder) if isinstance(study, Mapping) else study
        study_run = open_study(path, os.path.join(folder, "parts"))
        solve_study(study_run, study_run.pending(), jobs=jobs)
        write_study(written := os.path.join(folder, "table.h5"), study_run)
        with h5py.File(written, "r") as table:
            groups = [table[name] for name in ("parameter", "result")]
            columns = {f"{group.name[1:]}/{name}": group[name][...] for group in groups for name in group}
            return columns | {name: table[name][...] for name in ("exit_code", "rows") if name in table}


def fit(study: str | os.PathLike[str] | Mapping[str, Any], jobs: int = 1) -> dict[str, Any]:
    """Find numbers of a deck as `flexmb fit`; return what the search ends with.

    `study` is the path of a study file, or a dict with the content of one, whose deck is relative to the
    working folder.  Keys: "parameters" and "results" of the best variant by name, its "cost" (half the sum of
    squares of the residuals, or the objective) and "violation" of constraints; "numbers", a record for each
    unknown number with name, unit, value, standard_error and the ends `low` and `high` of its 95 % interval;
    "converged", "message", and "history", the cost of every variant (variants,).  Raises FlexmbError for a
    wrong study, and if no variant can be solved.
    """
    import tempfile

    from .study.fit import fit_of

    with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
        path = _study_file(study, folder) if isinstance(study, Mapping) else study
        run = open_fit(path, os.path.join(folder, "parts"))
        try:
            run.find(jobs)
            history = np.array([variant.cost for variant in run.known.values()])
            return fit_of(run) | {"history": history}
        finally:
            run.end()


def open_fit(
    study: str | os.PathLike[str], parts: str, fresh: bool = False, loop_tolerance: float | None = None
) -> "FitRun":
    """Return the fit in a file, whose variants are kept in the folder `parts`; raises DeckError.

    A fit that was stopped continues with the variants that are there, unless it is to be `fresh`.
    """
    from .study.fit import FitRun

    return FitRun.of(os.fspath(study), parts, fresh, loop_tolerance)


def _study_file(study: Mapping[str, Any], folder: str) -> str:
    from .deck.toml_table import toml_text

    path = os.path.join(folder, "study.toml")
    deck = {"deck": os.path.abspath(study["deck"])} if "deck" in study else {}
    with open(path, "w", encoding="utf-8") as file:
        file.write(toml_text({**study, **deck}))
    return path


def open_study(
    study: str | os.PathLike[str], parts: str, fresh: bool = False, loop_tolerance: float | None = None
) -> "Sweep":
    """Return the study in a file, whose cases are kept in the folder `parts`; raises DeckError.

    A study that was stopped continues with the cases that are there, unless it is to be `fresh`.
    """
    from .study.sweep import Sweep

    return Sweep.of(os.fspath(study), parts, fresh, loop_tolerance)


def solve_study(
    study: "Sweep",
    blocks: list[int],
    advance: Callable[[int], None] = lambda cases: None,
    jobs: int = 1,
    scheduler: str | None = None,
    listener: "Listener | None" = None,
) -> None:
    """Solve blocks of a study's cases here, in so many processes, or on the Dask cluster of `scheduler`.

    `advance` is called with the number of cases solved since; `listener` receives what happens before the
    first case on this machine, such as compiling.
    """
    from .run.outcome import Listener

    listener = listener or Listener()
    if scheduler:
        from .study.cluster import solve_on_cluster

        solve_on_cluster(study, blocks, advance, scheduler)
    elif jobs > 1:
        from .study.workers import solve_in_processes

        solve_in_processes(study, blocks, advance, jobs, listener)
    else:
        from .study.workers import solve_here

        solve_here(study, blocks, advance, listener)


def write_study(path: str, study: "Sweep") -> None:
    """Write the table of a solved study and remove its parts; raises OutputError."""
    from .study.sweep import write_study_table

    write_study_table(path, study)


def __getattr__(name: str) -> object:
    """Import CheckReport and RunOptions at first use: commands start without them."""
    if name == "CheckReport":
        from .run.check.check import CheckReport

        return CheckReport
    if name == "RunOptions":
        from .run.outcome import RunOptions

        return RunOptions
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "AnalysisError",
    "CheckReport",
    "DeckError",
    "FlexmbError",
    "ModelError",
    "OpenDeck",
    "Result",
    "RunOptions",
    "check",
    "fit",
    "open_fit",
    "open_study",
    "read_deck",
    "sensitivity",
    "solve",
    "solve_study",
    "solve_to_files",
    "sweep",
    "write_study",
]
