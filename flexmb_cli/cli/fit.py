"""`flexmb fit`: numbers of a deck whose results meet targets, or make an objective least."""

import os
import sys
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import click

from ..errors import ANALYSIS_FAILED, DONE, Fault
from ..memory import TO_LOAD, require_memory
from ..results.files.file_names import refuse_foreign
from ..run.outcome import INTERRUPTED, TERMINATED, Stop, Terminated
from ..run.processes.signal_mask import outlive_workers, stop_on_signals
from .options.deck_options import LOOP_TOLERANCE
from .options.output_file import AS_JSON, FORCE, QUIET, WrittenPlace, files, refuse_inputs
from .sweep import begun, set_aside, warn_of_result
from .terminal.notices import Notices
from .terminal.screen import WrongCall, notify, show

if TYPE_CHECKING:
    from ..study.fit import FitRun


@click.command()
@click.argument("study", shell_complete=files)
@click.option("-o", "--output", type=WrittenPlace(), metavar="PATH.h5",
              help="Table of all variants.  [default: STUDY's name, .h5]")  # fmt: skip
@click.option("-j", "--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option("--scheduler", metavar="ADDRESS", help="Solve on the Dask cluster with this scheduler.")
@click.option("--parts", type=WrittenPlace(), metavar="DIR",
              help="Folder of the variants so far, until the end.  [default: beside the table]")  # fmt: skip
@click.option("--fresh", is_flag=True, help="Discard the cases of a stopped fit, and start again.")
@FORCE
@LOOP_TOLERANCE
@AS_JSON
@QUIET
def fit(
    study: str, output: str | None, parts: str | None, force: bool, as_json: bool, quiet: bool, **options: Any
) -> None:
    """Find numbers of a deck so that its results meet targets.

    STUDY (TOML) names unknown numbers with bounds, and targets (a path, a measured column, a frequency) or an
    objective that is least, with constraints.  Every variant goes into a table; flexmb report draws it.
    Give the same command again to continue a fit that was stopped: it ends with the same numbers.

    \b
    Example:
        flexmb fit decks/studies/spring.toml
    """
    require_memory(TO_LOAD)  # of numpy, below
    from .. import interface

    stem = "" if study == "-" else PurePath(study).stem
    force, output = force or bool(output), output or f"{stem or 'flexmb'}.h5"
    if PurePath(output).suffix != ".h5":
        raise WrongCall("-o of a fit needs a name that ends in .h5", id="CLI-110")
    refuse_inputs(output, [study])
    refuse_foreign([output], force)
    notices = Notices("study", study, quiet, as_json)
    parts = parts or f"{output}.parts"
    run = begun(notices, output, parts, options, interface.open_fit)
    warn_of_result(notices, output)
    outlive_workers()
    stop_on_signals()
    try:
        with notices.failures(), Stop.released():
            _find(run, notices, options)
            record = _record(run)
            run.write(output)
    except (KeyboardInterrupt, Terminated) as stop:
        _report_stop(notices, run, output, INTERRUPTED if isinstance(stop, KeyboardInterrupt) else TERMINATED)
    if not quiet and not as_json:
        show("".join(f"{line}\n" for line in _lines(record)))
    notices.say(f"{study}: {record['variants']} variants → {output}")
    if not record["converged"]:
        message = f"the search has not converged: {record['message']}; see iterations and restarts"
        notices.add([Fault("warning", message, id="STUDY-139")])
    status, exit_code = ("complete", DONE) if record["converged"] else ("failed", ANALYSIS_FAILED)
    notices.end(status, exit_code, fit=record, file=output)
    sys.exit(exit_code)


def _find(run: "FitRun", notices: Notices, options: dict[str, Any]) -> None:
    if run.kept:
        notices.say(f"continuing a stopped fit: {run.kept} variants are complete")
    if options["scheduler"]:
        from ..study.cluster import client_of
        from ..study.fit_workers import solving_on

        with client_of(options["scheduler"]) as client:
            run.find(solve=solving_on(client, run.job))
    else:
        run.find(options["jobs"])


def _record(run: "FitRun") -> dict[str, Any]:
    from ..study.fit import fit_of

    return fit_of(run)


def _report_stop(notices: Notices, run: "FitRun", output: str, exit_code: int) -> None:
    with notices.failures():
        run.parts.sync_all()
    set_aside(output)
    count = len(run.known)
    notify(f"{notices.file}: interrupted; {count} variants are kept, the same command continues it")
    notices.end("interrupted", exit_code, variants=count, file=None)
    sys.stdout.flush()
    # Workers that are still solving end with this process.
    os._exit(exit_code)


def _lines(record: dict[str, Any]) -> Any:
    """Yield the numbers of a fit, each with half its 95 % interval, and what is met."""
    width = max(len(number["name"]) for number in record["numbers"])
    for number in record["numbers"]:
        half = number["high"] - number["value"]
        interval = f" ± {half:.3g}" if half == half else " at its bound" if number["at_bound"] else ""
        unit = "" if number["unit"] == "1" else f" {number['unit']}"
        yield f"{number['name']:<{width}} = {number['value']:.9g}{interval}{unit}"
    for name, value in record["results"].items():
        yield f"{name}: {value:.9g}"
    violated = f", constraints violated by {record['violation']:.3g}" if record["violation"] > 1e-8 else ""
    yield f"cost {record['cost']:.9g}{violated}; case {record['case']}"
    yield "--set " + " --set ".join(f"{n['name']}={n['value']!r}" for n in record["numbers"])
