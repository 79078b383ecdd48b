"""A YOUNG deck from its records to OUT table and HDF5 result."""

from collections.abc import Callable
from contextlib import suppress

from ..deck.record import Deck
from ..errors import AnalysisError, Fault, FlexmbError, OutputError, sentences
from ..quick_dataclass import dataclass
from ..results.files.file_names import STANDARD_OUTPUT, ResultPaths
from ..solvers.compilation import tell_of_compiling
from .exit_status import reason_of
from .keeping import keep_blocks
from .outcome import Listener, Outcome, RunOptions, Stop, refuse_warnings

MARCH = "kinematics.continuation.march"


def write_solution(solution: "Solution", deck, paths, options, outcome, listener, stdout) -> None:
    """Write the rows of `solution` as they come; raises as `keep_rows`."""
    with Stop.later():
        files = ResultFiles(deck, solution.contents, paths, options, stdout)
        keep_rows(solution, files, options, outcome, listener)


def kinematic_solution(deck: Deck, options: RunOptions, outcome: Outcome, listener) -> "Solution":
    """The kinematics of `deck`, ready to be solved; warnings go into `outcome`.  Raises ModelError."""
    from ..dialects.young.build import build_young
    from ..results.hdf5.kinematic import kinematic_layout, kinematic_values

    mechanism, warnings = build_young(deck)
    outcome.faults += warnings
    refuse_warnings(outcome, options)
    contents = Contents(lambda: kinematic_layout(mechanism), kinematic_values)
    if options.as_printed:
        from ..solvers.as_printed.analysis import AsPrinted

        analysis = AsPrinted(mechanism, options.solver)
        outcome.as_printed = True
    else:
        analysis = _analysis(mechanism, options, listener)
    return Solution(analysis, mechanism.time.rows, contents, _NewtonCount())


def keep_rows(solution: "Solution", files, options, outcome: Outcome, listener: Listener) -> None:
    """Write the rows of `solution` as they come.

    Raises FlexmbError, and KeyboardInterrupt or Terminated after keeping the rows so far.
    """
    analysis, count = solution.analysis, solution.count
    doubts = solution.doubts()
    outcome.faults += doubts

    def keep(rows):
        files.rows(rows)
        count.add(rows)
        outcome.statistics = str(count)
        return rows.time.size

    try:
        keep_blocks(analysis.rows(), keep, solution.rows, outcome, listener)
        analysis.warnings.extend(count.doubts)
        outcome.faults += analysis.warnings
        refuse_warnings(outcome, options)
    except AnalysisError as failure:
        analysis.warnings.extend(count.doubts)
        outcome.faults += analysis.warnings
        outcome.files = files.close_failed(failure.args[0], True, _notes(doubts, analysis))
        raise
    except OutputError:
        files.discard()
        raise
    except BaseException as ending:
        if not isinstance(ending, FlexmbError):
            outcome.faults += analysis.warnings
        outcome.files = files.close_stopped(outcome.rows, reason_of(ending), _notes(doubts, analysis))
        raise
    outcome.files = files.close(_notes(doubts, analysis))


def _notes(doubts, analysis) -> tuple[str, ...]:
    """Return what the model made doubtful and the analysis told about its way, for the result file."""
    return sentences((*doubts, *analysis.warnings))


def _analysis(mechanism, options, listener: Listener):
    from ..solvers.kinematics.analysis import KinematicAnalysis, KinematicSettings

    tell_of_compiling(listener, MARCH)
    return KinematicAnalysis(mechanism, KinematicSettings(**options.solver))


@dataclass
class _NewtonCount:
    """Iterations and residuals so far."""

    doubts = ()  # kinematics know no energy
    iterations: int = 0
    most: int = 0
    residual: float = 0.0

    def add(self, rows):
        self.iterations += int(rows.newton_iterations.sum())
        self.most = max(self.most, int(rows.newton_iterations.max()))
        self.residual = max(self.residual, float(rows.constraint_residual.max()))

    def __str__(self):
        return (
            f"Newton iterations {self.iterations}, at most {self.most} in a row; "
            f"largest residual {self.residual:.1e}"
        )


@dataclass(frozen=True)
class Contents:
    """What the HDF5 file of an analysis holds: its layout, and report rows as values by path.

    `table` makes the OUT table of (stream, deck, layout), by default YOUNG's.
    """

    layout: Callable
    values: Callable
    table: Callable | None = None


@dataclass(frozen=True)
class Solution:
    """An analysis that yields blocks of report rows: how many, what they hold, and what counts its work.

    `doubts` finds what its model makes doubtful, for a run to tell and to keep.
    """

    analysis: object
    rows: int
    contents: Contents
    count: object = None
    doubts: Callable[[], list[Fault]] = list


class ResultFiles:
    """The OUT table and the HDF5 file of a run; both appear whole or not at all."""

    def __init__(self, deck, contents: Contents, paths: ResultPaths, options, stdout):
        from ..results.files.replaced_file import ReplacedText, make_folder

        self.paths, self.contents = paths, contents
        self.table = self.table_file = self.result = None
        self.begun = self.torn = False
        if paths.files:
            make_folder(options.folder)
        if paths.out is not None:
            self._open_table(deck, options, stdout, ReplacedText)
        if paths.h5 is not None:
            from ..results.hdf5.result_file import ResultFile
            from ..results.quantities.selection import selected

            try:
                self.result = ResultFile(paths.h5, deck, selected(contents.layout(), deck, options.only))
            except BaseException:
                self.discard()
                raise

    def _open_table(self, deck, options, stdout, replaced_text):
        from ..dialects.young.listing import OutTable

        if self.paths.out != STANDARD_OUTPUT:
            self.table_file = replaced_text(self.paths.out)
        make = self.contents.table or OutTable
        self.table = make(self.table_file or stdout, deck, options.layout)

    def _begin(self):
        if self.table and not self.begun:
            self.begun = True
            self.table.begin()

    def rows(self, rows) -> None:
        """Write report rows."""
        self.torn = True
        self._begin()
        if self.table:
            self.table.rows(rows)
        if self.result:
            self.result.rows(self.contents.values(rows))
        self.torn = False

    def close(self, notes: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Put the finished files in their places; their names."""
        from ..results.files.replaced_file import put_in_place

        if self.result:
            self.result.note(notes)
        put_in_place(self._all())
        return self.paths.files

    def close_failed(self, message, no_convergence, notes=()) -> tuple[str, ...]:
        """Keep the rows so far, marked as those of a failed run; the names of the files."""
        self._begin()
        if self.table:
            self.table.failed() if no_convergence else self.table.stopped()
        if self.result:
            self.result.mark("failed", message)
        return self.close(notes)

    def close_stopped(self, rows: int, reason: str, notes=()) -> tuple[str, ...]:
        """Keep the rows so far, if all files have the same; else the results of an earlier run stay."""
        if rows == 0 or self.torn:
            self.discard()
            return ()
        return self.close_failed(reason, False, notes)

    def discard(self) -> None:
        """Leave no file; what standard output was given already is marked."""
        if self.begun and self.paths.out == STANDARD_OUTPUT:
            # It may be the very thing that fails, and what ended the run is told, not this.
            with suppress(OSError):
                self.table.stopped()
        for file in self._all():
            file.discard()

    def _all(self):
        return [file for file in (self.table_file, self.result) if file]
