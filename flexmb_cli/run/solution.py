"""Solve a deck of any dialect and write its results by blocks: to the resume file, tables and HDF5 file."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..deck.record import Deck
from ..dialects.elements_block.line import has_outputs
from ..errors import AnalysisError, Fault, FlexmbError, OutputError, sentences
from ..results.files.file_names import ResultPaths, refuse_foreign
from ..solvers.compilation import report_damage
from ..version import __version__
from .checkpoint import ResumeFile
from .earlier_results import EarlierResults
from .model import model_of, module_for, open_deck, own_options, warn_of_foreign_options
from .outcome import (
    Listener,
    Outcome,
    Run,
    RunOptions,
    Stop,
    Terminated,
    TextStream,
    ending_recorded,
    reason_of,
)
from .python_options import refuse_foreign_method
from .result_files import ResultFiles
from .solutions import Solution

if TYPE_CHECKING:
    import numpy as np

    from .error_estimate import ErrorEstimate


def solution_of(model: Any, run: Run) -> Solution:
    """Return the solution of a model; raises ModelError."""
    return module_for(model, "solutions").solution(model, run)


def prepared(deck: Deck, run: Run) -> tuple[Solution, list[Fault]]:
    """Return the solution of a deck, and the warnings about its model; raises ModelError."""
    refuse_foreign_method(deck, run.options)
    solution = complete_solution(model_of(deck, run), deck, run)
    return solution, solution.model_warnings()


def complete_solution(model: Any, deck: Deck, run: Run) -> Solution:
    """Return the solution of a model with outputs, and what is caught or let go; raises ModelError."""
    elements = getattr(model, "elements", None)
    if elements is None or not elements.switches:
        return with_outputs(solution_of(model, run), deck)
    # Few decks have any.
    from .solutions.switched import switched

    return switched(model, deck, run, solution_of, with_outputs)


def with_outputs(solution: Solution, deck: Deck) -> Solution:
    """Return the solution with the quantities of the deck's lines OUTPUT.  Raises ModelError."""
    if not has_outputs(deck):
        return solution
    # Few decks have any.
    from ..results.outputs.outputs import Outputs

    layout = solution.layout()
    outputs = Outputs(deck, layout)

    def finer(run: Run) -> Iterator[Mapping[str, "np.ndarray"]] | None:
        blocks = solution.finer(run)
        return None if blocks is None else map(Outputs(deck, layout).of, blocks)

    return replace(
        solution,
        layout=lambda: outputs.layout,
        values=lambda rows: outputs.of(solution.values(rows)),
        finer=finer,
        variants=lambda: None,
        outputs=outputs.of,
    )


def solve_deck(deck: Deck, paths: ResultPaths, run: Run) -> None:
    """Solve `deck` and write its results; the outcome records how it went.

    Raises FlexmbError, and KeyboardInterrupt or Terminated after keeping the rows so far.
    """
    with _resumable_if_stopped(paths, run), Stop.released():
        solution, model_warnings = prepared(deck, run)
        run.outcome.faults += model_warnings
        resume_file = _resume_file(deck, solution, paths, run)
        estimate = _estimate(solution, run)
    with Stop.later():
        try:
            files = ResultFiles(deck, solution, paths, run, estimate is not None)
            _RowWriter(solution, run, resume_file, estimate, model_warnings, files).write()
        finally:
            report_damage(run.listener)


@contextmanager
def _resumable_if_stopped(paths: ResultPaths, run: Run) -> Iterator[None]:
    """Report an earlier run's resume file as usable if this run is stopped before it opens the file."""
    try:
        yield
    except (KeyboardInterrupt, Terminated):
        path = paths.resume
        run.outcome.resumable = run.options.resume and path is not None and os.path.isfile(path)
        raise


def _resume_file(deck: Deck, solution: Solution, paths: ResultPaths, run: Run) -> ResumeFile:
    """Return the resume file of a run, one without a path where the run cannot be resumed."""
    path = paths.resume if solution.resumable else None
    resume_file = ResumeFile(path, identity_of(deck, solution, run))
    if run.options.resume:
        from .resumed import largest_entry, restore

        layout = solution.layout()
        resume_file.find(largest_entry(layout))
        run.outcome.faults += resume_file.warnings
        if resume_file.last_checkpoint is not None:
            restore(resume_file, solution.analysis, layout)
    return resume_file


def identity_of(deck: Deck, solution: Solution, run: Run) -> dict[str, Any]:
    """Return everything that the results of a run depend on: only the same run can be resumed."""
    return {
        "flexmb": __version__,
        "deck": f"{deck.model}:{deck.source.name}" if deck.model else deck.source.name,
        "text of the deck": deck.source.sha256,
        "--set": list(run.options.changes),
        **solution.identity,
        **({"--estimate-error": True} if run.options.estimate_error else {}),
    }


def _estimate(solution: Solution, run: Run) -> "ErrorEstimate | None":
    """Return the comparison with a second run, where it is requested and can be made."""
    if not run.options.estimate_error:
        return None
    from .error_estimate import ErrorEstimate

    finer = solution.finer(run)
    return None if finer is None else ErrorEstimate(finer)


@dataclass
class _RowWriter:
    """Writes the rows of one run: resume file first, then tables and result."""

    solution: Solution
    run: Run
    resume_file: ResumeFile
    estimate: "ErrorEstimate | None"
    model_warnings: list[Fault]
    files: ResultFiles

    def write(self) -> None:
        """Write the rows as they come, and put the files in their places; raises as `solve_deck`."""
        outcome, resume_file, files = self.run.outcome, self.resume_file, self.files
        try:
            resume_file.begin(files.unfinished)
            self._write_blocks()
            self._record_warnings()
            self.run.warn(())
        except AnalysisError as failure:
            self._record_warnings()
            outcome.files = files.close_failed(failure.args[0], True, self.notes)
            resume_file.remove()
            raise
        except OutputError:
            files.discard()
            self._leave_resume_file()
            raise
        except BaseException as ending:
            if isinstance(ending, FlexmbError):
                resume_file.remove()
            else:
                outcome.faults += self.solution.warnings
                self._leave_resume_file()
            outcome.files = files.close_stopped(outcome.rows, reason_of(ending), self.notes)
            raise
        self._complete()

    def _write_blocks(self) -> None:
        """Write block by block; a run can be stopped between two of them.

        Raises KeyboardInterrupt or Terminated only before the last row is written.
        """
        outcome, listener, rows = self.run.outcome, self.run.listener, self.solution.rows
        with Stop.released():
            listener.begin(rows)
            for values in self._blocks():
                with Stop.later():
                    self._write_block(values)
                    if outcome.rows >= rows:
                        Stop.too_late()
                listener.advance(len(values["time"]))
                Stop.raise_if_asked()

    def _blocks(self) -> "Iterator[Mapping[str, np.ndarray]]":
        """Yield blocks of values: those of a stopped run first, then those that the analysis adds."""
        solution, resume_file = self.solution, self.resume_file
        if resume_file.last_checkpoint is not None:
            from .resumed import stored_blocks

            for values in stored_blocks(resume_file, solution.layout()):
                # The resume file has no rows of the second, finer run: that starts again.
                yield self._with_errors(solution.outputs(values))
        elif self.run.options.resume:
            message = "nothing to resume; the run starts at its beginning"
            self.run.listener.notice(Fault("note", message, id="RUN-064"))
        if self.run.outcome.rows >= solution.rows:
            return
        for rows in solution.analysis.rows():
            values = solution.values(rows)
            if resume_file.path is not None:
                with Stop.later():
                    resume_file.append(values, solution.analysis.checkpoint)
            yield self._with_errors(values)

    def _with_errors(self, values: Mapping[str, "np.ndarray"]) -> Mapping[str, "np.ndarray"]:
        return values if self.estimate is None else self.estimate.of(values)

    def _write_block(self, values: Mapping[str, "np.ndarray"]) -> None:
        outcome, count = self.run.outcome, self.solution.count
        self.files.rows(values)
        count.add(values)
        outcome.statistics = str(count)
        outcome.rows += len(values["time"])
        if self.estimate is not None:
            outcome.errors = self.estimate.as_dict

    def _record_warnings(self) -> None:
        """Record the warnings of the analysis, of the energy of the rows and of the second run."""
        estimated = () if self.estimate is None else self.estimate.warnings
        self.solution.warnings.extend((*self.solution.count.warnings, *estimated))
        self.run.outcome.faults += self.solution.warnings

    @property
    def notes(self) -> tuple[str, ...]:
        """Return the warnings about the model and the analysis as sentences, for the result file."""
        return sentences((*self.model_warnings, *self.solution.warnings))

    def _leave_resume_file(self) -> None:
        self.resume_file.close()
        self.run.outcome.resumable = self.resume_file.begun

    def _complete(self) -> None:
        """Put the results in their places; if that fails, the resume file stays for the next attempt."""
        try:
            self.run.outcome.files = self.files.close(self.notes)
        except (OutputError, MemoryError):
            self._leave_resume_file()
            raise
        self.resume_file.remove()


def run_deck(
    path: str,
    options: RunOptions,
    listener: Listener | None = None,
    stdout: TextStream | None = None,
    earlier: EarlierResults | None = None,
) -> Outcome:
    """Read, solve and write the deck at `path` ("-": standard input).

    `stdout` receives the OUT table of `--out -`; `earlier`: the results that stand in the places of its
    own, if the caller has looked.  Faults of the deck, a full disk and stops by signals are in
    the outcome; they raise nothing.
    """
    outcome, earlier = Outcome(path), earlier or EarlierResults(path, options)
    with ending_recorded(outcome, options):
        with Stop.released():
            deck = open_deck(path, replace(options, dialect=earlier.dialect), outcome)
        warn_of_foreign_options(deck, options, outcome)
        run = Run(
            outcome, own_options(deck, options), (listener or Listener()).kept_in(outcome.notices), stdout
        )
        paths = earlier.paths_of(deck, options)
        try:
            refuse_foreign((file for file in paths.files if file not in paths.named), options.force)
            solve_deck(deck, paths, run)
        finally:
            if options.echo:
                from ..results.texts.echo import echo

                # Building the model has filled in the defaults of empty fields.
                outcome.echo = echo(deck)
    earlier.set_aside(outcome)
    return outcome
