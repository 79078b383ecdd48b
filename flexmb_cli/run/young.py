"""A YOUNG deck from its records to OUT table and HDF5 result."""

from dataclasses import dataclass

from ..errors import AnalysisError
from ..model.build_young import build_young
from ..read.deck import Deck
from ..write.file_names import STANDARD_OUTPUT, ResultPaths
from .compiling import tell_of_compiling
from .outcome import Listener, Outcome, RunOptions, refuse_warnings


def run_young(
    deck: Deck, paths: ResultPaths, options: RunOptions, outcome: Outcome, listener, stdout
) -> None:
    """Analyse the mechanism of `deck` and write its results; `outcome` records how it went.

    Raises FlexmbError, and KeyboardInterrupt or Terminated after keeping the rows so far.
    """
    mechanism, warnings = build_young(deck)
    outcome.faults += warnings
    refuse_warnings(outcome, options)
    analysis = _analysis(mechanism, options, listener)
    files = _ResultFiles(deck, mechanism, paths, options, stdout)
    count = _NewtonCount()
    try:
        listener.begin(mechanism.time.rows)
        for rows in analysis.rows():
            files.rows(rows)
            count.add(rows)
            outcome.rows += rows.time.size
            outcome.statistics = str(count)
            listener.advance(rows.time.size)
        outcome.faults += analysis.warnings
        refuse_warnings(outcome, options)
    except AnalysisError as failure:
        outcome.faults += analysis.warnings
        outcome.files = files.close_failed(failure.args[0], no_convergence=True)
        raise
    except Exception:
        files.discard()
        raise
    except BaseException:
        outcome.files = files.close_failed("interrupted", no_convergence=False)
        raise
    outcome.files = files.close()


def _analysis(mechanism, options, listener: Listener):
    from ..solve.kinematics import KinematicAnalysis, KinematicSettings

    tell_of_compiling(listener, "kinematic_march.march")
    return KinematicAnalysis(mechanism, KinematicSettings(**options.solver))


@dataclass
class _NewtonCount:
    """Iterations and residuals so far."""

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


class _ResultFiles:
    """The OUT table and the HDF5 file of a run; both appear whole or not at all."""

    def __init__(self, deck, mechanism, paths: ResultPaths, options, stdout):
        from ..write.atomic import ReplacedText, make_folder

        self.paths = paths
        self.table = self.table_file = self.result = None
        self.begun = False
        if paths.files:
            make_folder(options.folder)
        if paths.out is not None:
            self._open_table(deck, options, stdout, ReplacedText)
        if paths.h5 is not None:
            from ..write.hdf5_kinematic import kinematic_layout
            from ..write.result_file import ResultFile

            try:
                self.result = ResultFile(paths.h5, deck, kinematic_layout(mechanism))
            except Exception:
                self.discard()
                raise

    def _open_table(self, deck, options, stdout, replaced_text):
        from ..write.young import OutTable

        if self.paths.out != STANDARD_OUTPUT:
            self.table_file = replaced_text(self.paths.out)
        self.table = OutTable(self.table_file or stdout, deck, options.layout)

    def _begin(self):
        if self.table and not self.begun:
            self.begun = True
            self.table.begin()

    def rows(self, rows):
        self._begin()
        if self.table:
            self.table.rows(rows)
        if self.result:
            from ..write.hdf5_kinematic import kinematic_values

            self.result.rows(kinematic_values(rows))

    def close(self):
        if self.table_file:
            self.table_file.commit()
        if self.result:
            self.result.close()
        return self.paths.files

    def close_failed(self, message, no_convergence):
        self._begin()
        if self.table and no_convergence:
            self.table.failed()
        if self.table_file:
            self.table_file.commit()
        if self.result:
            self.result.close("failed", message)
        return self.paths.files

    def discard(self):
        for file in (self.table_file, self.result):
            if file:
                file.discard()
