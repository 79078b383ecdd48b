"""A DAFMS deck from its records to FMBD.OUT echo, series of units 2 and 3, and HDF5 result."""

import os
from contextlib import contextmanager

from .. import __version__
from ..deck.record import Deck
from ..errors import AnalysisError, Fault, FlexmbError, OutputError, sentences
from ..model.tree import Tree
from ..model.unit_checks import unit_doubts
from ..quick_dataclass import replace
from ..results.files.file_names import STANDARD_OUTPUT, ResultPaths
from ..solvers.compilation import tell_of_compiling
from .absolute_march import AbsoluteMarch
from .checkpoint import Journal
from .dafms_tree import tree_of
from .energy_drift import EnergyDrift
from .error_estimate import FINER, ErrorEstimate, finer, why_no_estimate, with_errors
from .exit_status import reason_of
from .keeping import keep_blocks
from .outcome import ABSOLUTE, Outcome, RunOptions, Stop, Terminated, refuse_warnings


def run_dafms(
    deck: Deck, paths: ResultPaths, options: RunOptions, outcome: Outcome, listener, stdout
) -> None:
    """Integrate the tree of `deck` and write its results; `outcome` records how it went.

    Raises FlexmbError, and KeyboardInterrupt or Terminated after keeping the rows so far.
    """
    with _resumable_if_stopped(paths, options, outcome), Stop.released():
        tree = tree_of(deck, options, outcome)
        doubts = unit_doubts(tree)
        outcome.faults += doubts
        journal, march = _beginning(deck, tree, paths, options, outcome, listener)
    with Stop.later():
        if options.estimate_error:
            outcome.faults += why_no_estimate(tree.integration.rtol)
            march.estimate = error_estimate(tree)
        files = _ResultFiles(deck, tree, paths, options, stdout)
        files.notes = sentences(doubts)
        doubts = _keep_rows(tree, march, journal, files, options, outcome, listener)
        _complete(files, journal, outcome, doubts)


@contextmanager
def _resumable_if_stopped(paths, options, outcome):
    """Who stops a run before it has looked at its journal is told of it, too."""
    try:
        yield
    except (KeyboardInterrupt, Terminated):
        outcome.resumable = options.resume and os.path.isfile(paths.resume)
        raise


def _keep_rows(tree, march, journal, files, options, outcome, listener):
    """Write the rows as they come; what the energy makes doubtful.  Raises as `run_dafms`."""

    def keep(values):
        files.rows(values)
        outcome.statistics = march.statistics
        if march.estimate is not None:
            outcome.errors = march.estimate.as_dict
        return len(values["time"])

    try:
        journal.begin(files.unfinished)
        keep_blocks(march.blocks(options.resume), keep, tree.time.rows, outcome, listener)
        return _doubts_of_energy(tree, march, options, outcome)
    except AnalysisError as failure:
        outcome.files = files.close_failed(failure.args[0], march.stopped_at)
        journal.remove()
        raise
    except OutputError:
        files.discard()
        journal.close()
        outcome.resumable = journal.begun
        raise
    except FlexmbError as ending:
        outcome.files = files.close_stopped(outcome.rows, str(ending), march.stopped_at)
        journal.remove()
        raise
    except BaseException as ending:
        journal.close()
        outcome.resumable = journal.begun
        outcome.files = files.close_stopped(outcome.rows, reason_of(ending), march.stopped_at)
        raise


def _doubts_of_energy(tree, march, options, outcome):
    doubts = () if tree.one_way else march.drift.doubts
    if march.estimate is not None:
        doubts = (*doubts, *march.estimate.doubts)
    outcome.faults += doubts
    refuse_warnings(outcome, options)
    return doubts


def _complete(files, journal, outcome, doubts):
    """Put the results in their places; where they cannot be, the journal stays for the next attempt."""
    try:
        outcome.files = files.close(sentences(doubts))
    except (OutputError, MemoryError):
        journal.close()
        outcome.resumable = journal.begun
        raise
    journal.remove()


def _beginning(deck, tree, paths, options, outcome, listener):
    """Journal and march of a run; that in absolute coordinates keeps no checkpoints."""
    absolute = options.formulation == ABSOLUTE
    journal = Journal(None if absolute else paths.resume, identity_of(deck, tree, options))
    if options.resume:
        journal.find()
        outcome.faults += journal.doubts
    if not absolute:
        return journal, _March(tree, journal, listener)
    outcome.faults += _doubts(tree)
    refuse_warnings(outcome, options)
    return journal, AbsoluteMarch(tree, listener)


def _doubts(tree):
    """The choice of an integrator is one of Kane's equations."""
    if tree.integration.method != "dop853":
        message = f"absolute coordinates are stepped by DOP853: {tree.integration.method} is not used"
        yield Fault("warning", message, id="RUN-010")


def identity_of(deck: Deck, tree: Tree, options: RunOptions) -> dict:
    """All that the numbers of a run depend on: only the same run can be resumed."""
    return {
        "flexmb": __version__,
        "deck": f"{deck.model}:{deck.source.name}" if deck.model else deck.source.name,
        "text of the deck": deck.source.sha256,
        "--set": list(options.changes),
        "method": tree.integration.method,
        "rtol": tree.integration.rtol,
        "atol": tree.integration.atol,
        **({"--estimate-error": True} if options.estimate_error else {}),
    }


def error_estimate(tree: Tree) -> ErrorEstimate:
    """Errors against a second run of `tree` at a tighter tolerance."""
    from ..results.hdf5.tree import tree_values
    from ..solvers.tree.analysis import TreeAnalysis
    from ..solvers.tree.points import point_motion

    given = tree.integration
    # An absolute tolerance has no round-off to heed.
    second = replace(tree, integration=replace(given, rtol=finer(given.rtol), atol=FINER * given.atol))
    rows = TreeAnalysis(second).rows()
    return ErrorEstimate(tree_values(second, block, point_motion(second, block)) for block in rows)


class _March:
    """The blocks of one run: those of a stopped one first, then what the analysis adds."""

    estimate: ErrorEstimate | None = None

    def __init__(self, tree, journal, listener):
        self.tree = tree
        self.journal = journal
        self.listener = listener
        self.analysis = None
        self.drift = EnergyDrift()

    def blocks(self, resume):
        """Yield report rows by the paths of their datasets; those computed are in the journal before."""
        state = None
        for values, state in self.journal.stored():  # noqa: B007
            self.drift.add(values)
            # The second run is not kept: it begins anew.
            yield self._with_errors(values)
        if resume and state is None:
            self.listener.notice("nothing to resume; the run starts at its beginning")
        if state is None or state["row"] < self.tree.time.rows:
            yield from self._computed(state)

    def _computed(self, state):
        from ..results.hdf5.tree import tree_values
        from ..solvers.tree.analysis import Checkpoint, TreeAnalysis
        from ..solvers.tree.points import point_motion

        tell_of_compiling(self.listener, "integrators.tree_dop853.call")
        checkpoint = None if state is None else Checkpoint(**state | {"row": int(state["row"])})
        self.analysis = TreeAnalysis(self.tree, checkpoint)
        for rows in self.analysis.rows():
            values = tree_values(self.tree, rows, point_motion(self.tree, rows))
            with Stop.later():
                self.journal.append(values, vars(self.analysis.checkpoint))
            self.drift.add(values)
            yield self._with_errors(values)

    def _with_errors(self, values):
        return values if self.estimate is None else self.estimate.of(values)

    @property
    def statistics(self):
        """Return what -v prints."""
        parts = []
        if self.analysis:
            clock = self.analysis.clock[0]
            parts.append(f"{clock['evaluations']} evaluations, {clock['rejections']} rejected steps")
        if not self.tree.one_way:
            parts.append(str(self.drift))
        return "; ".join(parts)

    @property
    def stopped_at(self):
        """Return the record of a stop for unit 3: tolerance, aim, step, time, speeds, coordinates."""
        if self.analysis is None:
            return None
        clock, grid = self.analysis.clock[0], self.tree.time
        aim = grid.time(min(self.analysis.row, grid.rows - 1))
        state = self.analysis.state[: 2 * len(self.tree.coordinates)]
        return float(clock["rtol"]), aim, float(clock["step"]), float(clock["t"]), state


class _ResultFiles:
    """Echo, series and HDF5 file of a run; each appears whole or not at all.

    `notes`: what the result tells besides its rows.
    """

    def __init__(self, deck, tree, paths: ResultPaths, options, stdout):
        from ..results.files.replaced_file import make_folder

        self.deck, self.options, self.paths, self.stdout = deck, options, paths, stdout
        self.texts, self.result, self.series = [], None, None
        self.notes: tuple[str, ...] = ()
        self.echoed = self.torn = False
        if paths.files:
            make_folder(options.folder)
        try:
            self._open(tree)
        except BaseException:
            self.discard()
            raise

    def _open(self, tree):
        from ..dialects.dafms.listing import Series
        from ..results.files.replaced_file import ReplacedText

        names = [] if self.paths.out in (None, STANDARD_OUTPUT) else [self.paths.out]
        for name in (*names, *self.paths.series):
            self.texts.append(ReplacedText(name))
        if self.paths.series:
            self.series = Series(*self.texts[-2:], len(tree.coordinates), self.options.layout)
        if self.paths.h5 is not None:
            self._open_result(tree)

    def _open_result(self, tree):
        from ..results.hdf5.result_file import ResultFile
        from ..results.hdf5.tree import tree_layout
        from ..results.quantities.selection import selected
        from ..solvers.tree.points import point_names

        layout = tree_layout(tree, point_names(tree))
        layout = with_errors(layout) if self.options.estimate_error else layout
        self.result = ResultFile(self.paths.h5, self.deck, selected(layout, self.deck, self.options.only))

    @property
    def unfinished(self):
        """Return where the files are until they are complete."""
        return tuple(file.temporary for file in self._all())

    def _all(self):
        return (*self.texts, self.result) if self.result else tuple(self.texts)

    def _echo(self):
        from ..dialects.dafms.listing import echo_text

        if self.echoed or self.paths.out is None:
            return
        self.echoed = True
        stream = self.stdout if self.paths.out == STANDARD_OUTPUT else self.texts[0]
        stream.write(echo_text(self.deck, self.options.layout))

    def rows(self, values):
        self.torn = True
        self._echo()
        if self.series:
            self.series.rows(values["time"], values["coordinate/q"], values["coordinate/u"])
        if self.result:
            self.result.rows(values)
        self.torn = False

    def close(self, notes=()):
        from ..results.files.replaced_file import put_in_place

        if self.result:
            self.result.note((*self.notes, *notes))
        put_in_place(self._all())
        return self.paths.files

    def close_failed(self, message, stopped_at=None):
        self._echo()
        if self.series:
            self.series.failed(*stopped_at) if stopped_at else self.series.stopped()
        if self.result:
            self.result.mark("failed", message)
        return self.close()

    def close_stopped(self, rows, reason, stopped_at):
        """Keep the rows so far, if all files have the same; else the results of an earlier run stay."""
        if rows == 0 or self.torn:
            self.discard()
            return ()
        return self.close_failed(reason, stopped_at)

    def discard(self):
        for file in self._all():
            file.discard()
