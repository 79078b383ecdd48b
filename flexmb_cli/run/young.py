"""A YOUNG deck from its records to OUT table and HDF5 result."""

from dataclasses import replace

from ..errors import AnalysisError, ModelError
from ..model.build_young import build_young
from ..read.deck import Deck
from ..write.file_names import STANDARD_OUTPUT, ResultPaths
from .outcome import Listener, Outcome, RunOptions


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
    try:
        listener.begin(mechanism.time.rows)
        for rows in analysis.rows():
            files.rows(rows)
            _count(outcome, rows)
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


def refuse_warnings(outcome: Outcome, options: RunOptions) -> None:
    """Under `--strict` the warnings so far become errors, and end the run."""
    if options.strict and any(fault.severity == "warning" for fault in outcome.faults):
        outcome.faults[:] = [
            replace(f, severity="error") if f.severity == "warning" else f for f in outcome.faults
        ]
        raise ModelError(outcome.faults)


def _analysis(mechanism, options, listener: Listener):
    from ..kernels import _jit
    from ..solve.kinematics import KinematicAnalysis, KinematicSettings

    if _jit.Cache.must_compile("kinematic_march.march"):
        listener.notice("compiling kernels (once per version, 10 to 20 s)")
    if not _jit.Cache.lasting:
        listener.notice(
            "no folder to keep compiled kernels in; set NUMBA_CACHE_DIR to one that can be written"
        )
    return KinematicAnalysis(mechanism, KinematicSettings(**options.solver))


def _count(outcome, rows):
    outcome.rows += rows.time.size
    outcome.iterations += int(rows.newton_iterations.sum())
    outcome.most_iterations = max(outcome.most_iterations, int(rows.newton_iterations.max()))
    outcome.largest_residual = max(outcome.largest_residual, float(rows.constraint_residual.max()))


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
            from ..write.hdf5 import ResultFile

            try:
                self.result = ResultFile(paths.h5, deck, mechanism, "kinematic")
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
            self.result.rows(rows)

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
