"""`flexmb sweep`: many variants of one deck."""

import os
import sys
from collections.abc import Callable
from itertools import islice
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import click

from ..errors import ANALYSIS_FAILED, BAD_INPUT, DONE, DeckError, Fault, compiler_style
from ..memory import TO_LOAD, require_memory
from ..results.files.file_names import refuse_foreign
from ..results.files.replaced_file import refuse_unwritable
from ..run.outcome import INTERRUPTED, TERMINATED, Listener, Stop, Terminated
from ..run.processes.signal_mask import stop_on_signals
from .options.deck_options import LOOP_TOLERANCE
from .options.output_file import AS_JSON, FORCE, VERBOSE, WrittenPlace, files, refuse_inputs
from .terminal.notices import Notices
from .terminal.progress import Progress
from .terminal.screen import WrongCall, notify, say, show

if TYPE_CHECKING:
    from ..study.sweep import Sweep


MOST_FAILURES = 3  # that are named


@click.command()
@click.argument("study", shell_complete=files)
@click.option("-o", "--output", type=WrittenPlace(), metavar="PATH",
              help="Table: .h5, or .parquet.  [default: STUDY's name, .h5]")  # fmt: skip
@click.option("-j", "--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option("--scheduler", metavar="ADDRESS", help="Solve on the Dask cluster with this scheduler.")
@click.option("--parts", type=WrittenPlace(), metavar="DIR",
              help="Folder of the cases so far, which all workers must share; "
              "goes away at the end.  [default: beside the table]")  # fmt: skip
@click.option("--fresh", is_flag=True, help="Discard the cases of a stopped study, and start again.")
@FORCE
@LOOP_TOLERANCE
@AS_JSON
@VERBOSE
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def sweep(
    study: str, output: str | None, parts: str | None, force: bool, as_json: bool, quiet: bool, **options: Any
) -> None:
    """Solve the variants of a deck that STUDY (TOML) describes, and write a table with a row for each.

    Give the same command again to continue a study that was stopped.  A case that
    fails is recorded with its message and stops nothing; the exit code is then 1.

    \b
    Example:
        flexmb sweep study.toml -j 4
    """
    require_memory(TO_LOAD)  # of numpy, below
    from .. import interface

    stem = "" if study == "-" else PurePath(study).stem
    force, output = force or bool(output), output or f"{stem or 'flexmb'}.h5"
    parts = parts or f"{output}.parts"
    refuse_inputs(output, [study])
    refuse_foreign([output], force)
    notices = Notices("study", study, quiet, as_json)
    study_run = begun(notices, output, parts, options, interface.open_study)
    warn_of_result(notices, output)
    stop_on_signals()
    try:
        with notices.failures(), Stop.released():
            _solve(study_run, notices, options)
            failed = (case for case in study_run.results() if case.exit_code and study_run.failed)
            failures = [(case.case + 1, case.message) for case in islice(failed, MOST_FAILURES)]
            interface.write_study(output, study_run)
    except (KeyboardInterrupt, Terminated) as stop:
        exit_code = INTERRUPTED if isinstance(stop, KeyboardInterrupt) else TERMINATED
        _report_stop(notices, output, study_run, parts, bool(options["scheduler"]), exit_code)
        # Workers that are still solving end with this process; whole cases are kept.
        os._exit(exit_code)
    _report(notices, output, study_run, failures)
    scatter = study_run.scatter
    if scatter and not (quiet or as_json):
        show("".join(f"{line}\n" for line in scatter.lines()))
    more = {"scatter": scatter.record()} if scatter else {}
    status, exit_code = ("failed", ANALYSIS_FAILED) if study_run.failed else ("complete", DONE)
    notices.end(
        status, exit_code, cases=study_run.job.study.cases, failed=study_run.failed, file=output, **more
    )
    sys.exit(exit_code)


def _report_stop(
    notices: Notices, output: str, study_run: "Sweep", parts: str, on_cluster: bool, exit_code: int
) -> None:
    cases, failed = study_run.job.study.cases, study_run.failed
    table: str | None = output
    reported = f"{output} is complete"
    if os.path.isdir(parts):
        with notices.failures():
            study_run.job.parts.sync_all()
        codes = [result.exit_code for result in study_run.results()]
        more = " so far; its workers end what they have begun" if on_cluster else ""
        reported = f"{len(codes)} of {cases} cases are kept in {parts}{more}; the same command continues it"
        failed, table = sum(map(bool, codes)), None
        set_aside(output)
    notify(f"{notices.file}: interrupted; {reported}")
    notices.end("interrupted", exit_code, cases=cases, failed=failed, file=table)
    sys.stdout.flush()


def begun(
    notices: Notices, output: str, parts: str, options: dict[str, Any], begin: Callable[..., Any]
) -> Any:
    """Return the study that `begin` opens, after warnings about its deck; a wrong one ends the command."""
    from ..study.cluster import require_dask
    from ..study.sweep import StudyError
    from ..study.table import require_library

    if PurePath(output).suffix not in (".h5", ".parquet"):
        raise WrongCall("-o needs a name that ends in .h5 or .parquet", id="CLI-054")
    # What is missing is refused before hours of work.
    require_library(output)
    if options["scheduler"]:
        require_dask()
    try:
        with notices.failures():
            # The cases are kept beside the table: without this their folder would be made with all its
            # parents.
            refuse_unwritable(output, special=False)
            study_run = begin(notices.file, parts, options["fresh"], options["loop_tolerance"])
            deck = os.path.join(os.path.dirname(notices.file), study_run.solver.study.deck)
            notices.add_of_deck(study_run.solver.warnings(), study_run.solver.deck.source.lines, deck)
            return study_run
    except StudyError as failure:
        say(compiler_style(failure.file, failure.faults, failure.lines))
    except DeckError as failure:
        say(compiler_style(notices.file, failure.faults))
    set_aside(output)
    sys.exit(BAD_INPUT)


def set_aside(output: str) -> None:
    """Rename the table of an earlier call, which must not pass for that of this one."""
    from ..run.earlier_results import set_study_aside

    if stale := set_study_aside(output):
        notify(f"{output}: of an earlier call, now {stale}")


def warn_of_result(notices: Notices, output: str) -> None:
    """Warn before anything is solved: arm.toml and a run of arm.vsdf both write arm.h5."""
    from ..results.hdf5.stored_result import is_run

    if is_run(output):
        reported = f"{output} is the result of a run, which the table will replace; -o gives the table a name"
        notices.add([Fault("warning", reported, id="STUDY-029")])


def _solve(study_run: "Sweep", notices: Notices, options: dict[str, Any]) -> None:
    from .. import interface
    from ..run.processes.signal_mask import outlive_workers

    outlive_workers()
    blocks, warnings = study_run.pending(), list[Fault]()
    cases, left = study_run.job.study.cases, study_run.left
    if left < cases:
        notices.say(f"continuing a stopped study: {cases - left} of {cases} cases are complete")
        # Its rows may be anything that another user wrote into the prepared folder.
        if study_run.job.parts.is_of_another_user():
            folder = study_run.job.parts_folder
            message = f"{folder} belongs to another user; its cases are used, with --fresh none are"
            notices.add([Fault("warning", message, id="STUDY-030")])
    try:
        with Progress(notices.file, "cases", notices.quiet, options["verbose"]) as progress:
            progress.begin(left)
            listener = Listener(notice=progress.notice, status=progress.status).kept_in(warnings)
            jobs, scheduler = options["jobs"], options["scheduler"]
            interface.solve_study(study_run, blocks, progress.advance, jobs, scheduler, listener)
    finally:
        notices.faults += [(notices.file, fault) for fault in warnings]


def _report(notices: Notices, output: str, study_run: "Sweep", failures: Any) -> None:
    cases, study = study_run.job.study.cases, notices.file
    for case, message in failures:
        notices.say(f"{study}: case {case}: {message}")
        notices.faults.append((study, Fault("error", f"case {case}: {message}", id="STUDY-031")))
    if study_run.failed > len(failures):
        more = f"{study_run.failed - len(failures)} more cases failed; flexmb table {output} message"
        notices.say(f"{study}: {more}")
        notices.faults.append((study, Fault("error", more, id="STUDY-032")))
    notices.add(study_run.faults)
    reported = f", {study_run.failed} failed" if study_run.failed else ""
    notices.say(f"{study}: {cases} cases{reported} → {output}")
