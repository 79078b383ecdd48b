"""`flexmb sweep`: many variants of one deck."""

import json
import os
import sys
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import click

from ..errors import ANALYSIS_FAILED, BAD_INPUT, DONE, DeckError, Fault, compiler_style
from ..memory import TO_LOAD, require_memory
from ..results.files.own_files import refuse_foreign
from ..run.outcome import INTERRUPTED, TERMINATED, Listener, Stop, Terminated
from .options.deck_options import LOOP_TOLERANCE
from .options.output_file import FORCE, WrittenPlace, files, refuse_inputs
from .terminal.notices import faults_in_json
from .terminal.progress import Progress
from .terminal.screen import WrongCall, notify
from .terminal.stops import stop_on_signals

if TYPE_CHECKING:
    from ..study.sweep import Sweep


@click.command()
@click.argument("study", shell_complete=files)
@click.option("-o", "--output", type=WrittenPlace(), metavar="PATH",
              help="Table: .h5, or .parquet.  [default: STUDY's name, .h5]")  # fmt: skip
@click.option("-j", "--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option("--scheduler", metavar="ADDRESS", help="Solve on the Dask cluster with this scheduler.")
@click.option("--parts", type=WrittenPlace(), metavar="DIR",
              help="Folder of the cases so far, which all workers must share; "
              "goes away at the end.  [default: beside the table]")  # fmt: skip
@click.option("--fresh", is_flag=True, help="Throw away what a stopped study left, and start anew.")
@FORCE
@LOOP_TOLERANCE
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@click.option(
    "-v", "--verbose", is_flag=True, help="Without a terminal, print the progress every ten seconds."
)
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def sweep(
    study: str,
    output: str | None,
    jobs: int,
    scheduler: str | None,
    parts: str | None,
    fresh: bool,
    force: bool,
    loop_tolerance: float | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Solve the variants of a deck that STUDY (TOML) describes, and write a table with a row for each.

    Give the same command again to continue a study that was stopped.  A case that
    fails is recorded with its message and stops nothing; the exit code is then 1.

    \b
    Example:
        flexmb sweep study.toml -j 4
    """
    stem = "" if study == "-" else PurePath(study).stem
    force, output = force or bool(output), output or f"{stem or 'flexmb'}.h5"
    parts = parts or f"{output}.parts"
    refuse_inputs(output, [study])
    refuse_foreign([output], force)
    made = _begun(study, output, parts, scheduler, fresh, as_json, loop_tolerance)
    notices = _Notices(study, quiet)
    _warn_of_result(notices, output)
    stop_on_signals()
    try:
        with faults_in_json(as_json, {"study": study}, study), Stop.released():
            _solve(made, notices, jobs, scheduler, verbose)
            failures = _first_failures(made)
            _write(made, output)
    except (KeyboardInterrupt, Terminated) as stop:
        exit_code = INTERRUPTED if isinstance(stop, KeyboardInterrupt) else TERMINATED
        _report_stop(notices, output, made, parts, bool(scheduler), as_json, exit_code)
        # Workers that are still solving end with this process; whole cases are kept.
        os._exit(exit_code)
    _report(notices, output, made, failures)
    exit_code = ANALYSIS_FAILED if made.failed else DONE
    if as_json:
        _print_record(notices, "failed" if made.failed else "complete", exit_code, made, made.failed, output)
    sys.exit(exit_code)


def _require_libraries(output: str, scheduler: str | None) -> None:
    """Refuse what is missing before hours of work."""
    if output.endswith(".parquet"):
        from ..study.table import require_library

        require_library(output)
    if scheduler:
        from ..study.cluster import require_dask

        require_dask()


def _report_stop(
    notices: "_Notices",
    output: str,
    made: "Sweep",
    parts: str,
    on_cluster: bool,
    as_json: bool,
    exit_code: int,
) -> None:
    study = notices.study
    cases, failed = made.job.study.cases, made.failed
    table: str | None = output
    reported = f"{output} is complete"
    if os.path.isdir(parts):
        with faults_in_json(as_json, {"study": study}, study):
            made.job.parts.sync_all()
        codes = [result.exit_code for result in made.results()]
        more = " so far; its workers end what they have begun" if on_cluster else ""
        reported = f"{len(codes)} of {cases} cases are kept in {parts}{more}; the same command continues it"
        failed, table = sum(map(bool, codes)), None
        _set_aside(output)
    notify(f"{study}: interrupted; {reported}")
    if as_json:
        _print_record(notices, "interrupted", exit_code, made, failed, table)
        sys.stdout.flush()


def _begun(
    study: str,
    output: str,
    parts: str,
    scheduler: str | None,
    fresh: bool,
    as_json: bool,
    loop_tolerance: float | None,
) -> "Sweep":
    require_memory(TO_LOAD)  # of numpy, below
    from .. import interface
    from ..results.files.replaced_file import refuse_unwritable
    from ..study.sweep import StudyError

    if PurePath(output).suffix not in (".h5", ".parquet"):
        raise WrongCall("-o needs a name that ends in .h5 or .parquet", id="CLI-054")
    _require_libraries(output, scheduler)
    try:
        with faults_in_json(as_json, {"study": study}, study):
            # The cases are kept beside the table: without this their folder would be made with all its
            # parents.
            refuse_unwritable(output, special=False)
            return interface.open_study(study, parts, fresh, loop_tolerance)
    except StudyError as failure:
        click.echo(compiler_style(failure.file, failure.faults, failure.lines), err=True)
    except DeckError as failure:
        click.echo(compiler_style(study, failure.faults), err=True)
    _set_aside(output)
    sys.exit(BAD_INPUT)


def _set_aside(output: str) -> None:
    """Rename the table of an earlier call, which must not pass for that of this one."""
    from ..run.earlier_results import set_study_aside

    if stale := set_study_aside(output):
        notify(f"{output}: of an earlier call, now {stale}")


def _warn_of_result(notices: "_Notices", output: str) -> None:
    """Warn before anything is solved: arm.toml and a run of arm.vsdf both write arm.h5."""
    from ..results.hdf5.stored_result import is_run

    if is_run(output):
        reported = f"{output} is the result of a run, which the table will replace; -o gives the table a name"
        notices.fault(Fault("warning", reported, id="STUDY-029"))


def _warn_of_another_user(made: "Sweep", notices: "_Notices") -> None:
    """Warn where rows of the table may be anything that another user wrote into the prepared folder."""
    if made.job.parts.is_of_another_user():
        reported = f"{made.job.parts_folder} is of another user, whose cases are taken; with --fresh none are"
        notices.fault(Fault("warning", reported, id="STUDY-030"))


def _solve(made: "Sweep", notices: "_Notices", jobs: int, scheduler: str | None, verbose: bool) -> None:
    from .. import interface
    from ..run.processes.signal_mask import outlive_workers

    outlive_workers()
    blocks = made.pending()
    cases, left = made.job.study.cases, made.left
    if left < cases:
        notices.say(f"continuing a stopped study: {cases - left} of {cases} cases are complete")
        _warn_of_another_user(made, notices)
    with Progress(notices.study, "cases", notices.quiet, verbose) as progress:
        progress.begin(left)
        listener = Listener(notice=progress.notice, status=progress.status).kept_in(notices.faults)
        interface.solve_study(made, blocks, progress.advance, jobs, scheduler, listener)


def _first_failures(made: "Sweep", most: int = 3) -> list[Any]:
    if not made.failed:
        return []
    from itertools import islice

    failed = ((result.case + 1, result.message) for result in made.results() if result.exit_code)
    return list(islice(failed, most))


def _write(made: "Sweep", output: str) -> None:
    from .. import interface

    interface.write_study(output, made)


def _report(notices: "_Notices", output: str, made: "Sweep", failures: Any) -> None:
    cases, study = made.job.study.cases, notices.study
    for case, message in failures:
        notices.say(f"{study}: case {case}: {message}")
        notices.faults.append(Fault("error", f"case {case}: {message}", id="STUDY-031"))
    if made.failed > len(failures):
        more = f"{made.failed - len(failures)} more cases failed; flexmb table {output} message"
        notices.say(f"{study}: {more}")
        notices.faults.append(Fault("error", more, id="STUDY-032"))
    reported = f", {made.failed} failed" if made.failed else ""
    notices.say(f"{study}: {cases} cases{reported} → {output}")


def _print_record(
    notices: "_Notices", status: str, exit_code: int, made: "Sweep", failed: Any, table: Any
) -> None:
    """`table` is None while there is none yet."""
    faults = [{"file": notices.study} | fault.as_dict() for fault in notices.faults]
    record = {"study": notices.study, "status": status, "exit_code": exit_code, "faults": faults}
    record |= {"cases": made.job.study.cases, "failed": failed, "file": table}
    click.echo(json.dumps(record))


class _Notices:
    """Warnings about a study: words on standard error unless `quiet`, `faults` for `--json`."""

    def __init__(self, study: str, quiet: bool):
        self.study, self.quiet = study, quiet
        self.faults: list[Fault] = []

    def say(self, sentence: str) -> None:
        """Print a sentence."""
        if not self.quiet:
            notify(sentence)

    def fault(self, fault: Fault) -> None:
        """Print a warning, and keep it."""
        self.faults.append(fault)
        self.say(f"{self.study}: {fault.severity}: {fault.sentence}")
