"""The Python interface: read a deck, check it, solve it in memory, run a study.

Only `Result.save` leaves a file.  Units are SI; names of quantities are those of `flexmb table`.
"""

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .deck.record import Deck
from .errors import COMPLETE, FAILED, AnalysisError, Fault, FlexmbError, sentences
from .quick_dataclass import dataclass, field

if TYPE_CHECKING:
    import pandas
    import xarray

    from .results.hdf5.result_file import Layout
    from .run.check.check import CheckReport


@dataclass(frozen=True)
class OpenDeck:
    """A deck that was read; the finite-element files that it names are looked up beside its `path`.

    `changes`: numbers that differ from the deck's, "NAME=VALUE" each.
    """

    deck: Deck
    path: str
    changes: tuple[str, ...] = ()
    warnings: tuple[Fault, ...] = ()

    def __repr__(self) -> str:
        return f"OpenDeck({self.path!r}, {self.dialect}, {len(self.deck.records)} records)"

    @property
    def dialect(self) -> str:
        """The name of its dialect."""
        return self.deck.dialect

    @property
    def numbers(self) -> dict[str, float | int | str]:
        """Every number of the deck by the name that `changes` take, in SI units."""
        return {name: number.value for name, number in self.deck.numbers()}


def read_deck(
    path: str | os.PathLike, changes: Mapping[str, object] | None = None, dialect: str = "auto"
) -> OpenDeck:
    """Read the deck at `path`, with the numbers in `changes` set ({"driver.1.B": 6.28}).

    Raises FlexmbError, whose `faults` have place, subject and remedy, for a deck that cannot be read.
    """
    from .run.open_deck import open_deck
    from .run.outcome import Outcome, RunOptions

    words = tuple(f"{name}={value}" for name, value in (changes or {}).items())
    outcome = Outcome(os.fspath(path))
    with _naming(outcome.deck):
        deck = open_deck(outcome.deck, RunOptions(dialect=dialect, changes=words), outcome)
    return OpenDeck(deck, outcome.deck, words, tuple(outcome.faults))


def check(deck: OpenDeck | str | os.PathLike) -> "CheckReport":
    """Diagnose a deck without solving it, as `flexmb check`; faults are in the report, nothing is raised."""
    from .run.check.check import check_deck
    from .run.outcome import RunOptions

    path, changes = (deck.path, deck.changes) if isinstance(deck, OpenDeck) else (os.fspath(deck), ())
    return check_deck(path, RunOptions(changes=changes))


def solve(deck: OpenDeck | str | os.PathLike, **options: float | str) -> "Result":
    """Solve a deck in memory.

    `options`: those of `flexmb run` that numbers depend on: `rtol`, `atol`, `method` of the integration;
    `tolerance`, `smallest_pivot`, `most_iterations` of the kinematics; `formulation` ("absolute") of trees.
    Raises TypeError for another option, ValueError for a value out of range, FlexmbError for a deck that
    cannot be solved.  A run that fails on its way raises AnalysisError,
    whose attribute `result` holds the rows so far.
    """
    from .run.context import Run
    from .run.integration_options import refuse_foreign_method
    from .run.model import model_of
    from .run.outcome import Outcome
    from .run.solution import solution_of

    opened = deck if isinstance(deck, OpenDeck) else read_deck(deck)
    run = Run(Outcome(opened.path), _run_options(options))
    with _naming(opened.path):
        refuse_foreign_method(opened.deck, run.options)
        solution = solution_of(model_of(opened.deck, run), run)
        doubts = solution.doubts()
        blocks: list[Any] = []
        try:
            blocks.extend(solution.blocks_counted())
        except AnalysisError as failure:
            failure.result = _result(  # type: ignore[attr-defined]
                opened, solution, blocks, [*run.outcome.faults, *doubts], failure
            )
            raise
    return _result(opened, solution, blocks, [*run.outcome.faults, *doubts], None)


def _run_options(options: Any) -> Any:
    from .run.outcome import RunOptions
    from .run.python_options import refuse_wrong

    refuse_wrong(options)
    steps = {name: options.pop(name) for name in ("rtol", "atol", "method") if name in options}
    names = ("tolerance", "smallest_pivot", "most_iterations")
    solver = {name: options.pop(name) for name in names if name in options}
    return RunOptions(integration=steps, solver=solver, **options)


@contextmanager
def _naming(path: Any) -> Any:
    """Put the deck, and the place in it, before what a failure says."""
    try:
        yield
    except FlexmbError as failure:
        if not failure.file:
            fault = next((f for f in failure.faults if f.severity == "error"), failure.faults[0])
            place = "".join(f":{number}" for number in fault.place[:2]) if fault.place else ""
            failure.file, failure.args = path, (f"{path}{place}: {failure}",)
        raise


def _result(opened: Any, solution: Any, blocks: Any, faults: Any, failure: Any) -> Any:
    layout = solution.layout()
    values = {path: np.concatenate([block[path] for block in blocks]) for path in blocks[0]} if blocks else {}
    warnings = (*opened.warnings, *faults, *solution.warnings, *solution.count.doubts)
    status, message = (COMPLETE, "") if failure is None else (FAILED, str(failure))
    return Result(opened, values, layout, status, message, tuple(dict.fromkeys(warnings)))


@dataclass(frozen=True)
class Result(Mapping):
    """The motion of a deck: `result["body/position"]` is an array (times, bodies, 3), as in the HDF5 file.

    A name of `flexmb table` works, too: `result["point.1.z"]` is an array (times,).  `status` is "complete",
    or "failed" with the reason in `message`.
    """

    deck: OpenDeck
    values: dict[str, np.ndarray]  # type: ignore[assignment]
    layout: "Layout"
    status: str = COMPLETE
    message: str = ""
    warnings: tuple[Fault, ...] = ()
    found: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a dataset by its path, or a quantity by its name; raises KeyError with near names."""
        if name in self.values:
            return self.values[name]
        quantity = self._quantity(name)
        return self.values[quantity.dataset][(slice(None), *quantity.index)]

    def __repr__(self) -> str:
        rows = len(self.values.get("time", ()))
        return f"Result of {self.deck.path!r}: {self.status}, {rows} rows of {len(self.values)} datasets"

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def __len__(self) -> int:
        return len(self.values)

    @property
    def time(self) -> np.ndarray:
        """The times of the rows, s (times,)."""
        return self.values["time"]

    def unit(self, name: str) -> str:
        """Return the SI unit of a dataset or a quantity, "1" for a pure number."""
        units = {item.path: item.units for item in self.layout.series} | {"time": "s"}
        return units[name] if name in units else self._quantity(name).unit

    def save(self, path: str | os.PathLike) -> None:
        """Write the HDF5 file that `flexmb run` writes; raises OutputError where it cannot be written."""
        from .results.hdf5.result_file import ResultFile

        file = ResultFile(os.fspath(path), self.deck.deck, self.layout)
        if self.values:
            file.rows(self.values)
        if self.status == FAILED:
            file.mark(FAILED, self.message)
        file.note(sentences(fault for fault in self.warnings if fault.severity != "error"))
        file.close()

    def to_xarray(self) -> "xarray.DataTree":
        """Return the result as xarray opens its file: groups of labelled arrays; needs h5netcdf."""
        import xarray

        with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
            self.save(path := Path(folder) / "result.h5")
            with xarray.open_datatree(path, engine="h5netcdf") as tree:
                return tree.load()

    def to_pandas(self, *names: str) -> "pandas.DataFrame":
        """Return the quantities named, each a column, with the time as index."""
        import pandas

        columns = {
            quantity.name: self.values[quantity.dataset][(slice(None), *quantity.index)]
            for name in names
            for quantity in self._quantities(name)
        }
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))

    def _quantity(self, name: Any) -> Any:
        quantities = self._quantities(name)
        if len(quantities) > 1:
            several = ", ".join(quantity.name for quantity in quantities[:6])
            raise KeyError(f"{name} is more than one number: {several} …; name one, or use to_pandas")
        return quantities[0]

    def _quantities(self, name: Any) -> Any:
        """The quantities that a name means; they are looked up in a file without rows."""
        if name not in self.found:
            import h5py

            from .results.hdf5.result_file import ResultFile
            from .results.quantities.quantities import SHOWS_ALL, ResultError, resolve

            with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
                path = os.path.join(folder, "empty.h5")
                ResultFile(path, self.deck.deck, self.layout).close()
                with h5py.File(path, "r") as file:
                    try:
                        self.found[name] = resolve(file, [name])
                    except ResultError as fault:
                        raise KeyError(str(fault).removesuffix(SHOWS_ALL)) from None
        return self.found[name]


def sweep(study: str | os.PathLike, jobs: int = 1) -> dict[str, np.ndarray]:
    """Solve every case of a study file; return its table by columns.

    Keys are "parameter/NAME" and "result/NAME" (cases,) or (cases, times), "exit_code" and "rows" (cases,).
    A case that fails has an exit code other than 0, and nan.  Raises FlexmbError for a wrong study.
    """
    import h5py

    from .study.sweep import Sweep
    from .study.table_writer import write_study_table
    from .study.workers import solve_here, solve_in_processes

    with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
        made = Sweep.of(os.fspath(study), os.path.join(folder, "parts"))
        blocks = made.pending()
        if jobs > 1:
            solve_in_processes(made, blocks, lambda cases: None, jobs)
        else:
            solve_here(made, blocks, lambda cases: None)
        write_study_table(path := os.path.join(folder, "table.h5"), made)
        with h5py.File(path, "r") as table:
            groups = [table[name] for name in ("parameter", "result")]
            columns = {f"{group.name[1:]}/{name}": group[name][...] for group in groups for name in group}
            return columns | {name: table[name][...] for name in ("exit_code", "rows") if name in table}


__all__ = ["FlexmbError", "OpenDeck", "Result", "check", "read_deck", "solve", "sweep"]
