"""The commands: the only place that prints and exits.

What a command needs is imported inside it, so that `--help`, `check` and `diff` start at once.
"""

import json
import signal
import sys

import click

from . import __version__
from .errors import BAD_INPUT, DONE, INTERNAL_FAULT, FlexmbError, compiler_style

DECK = click.argument("decks", metavar="DECK...", nargs=-1, required=True)


class Group(click.Group):
    """Keeps the commands in the order of their definition."""

    def list_commands(self, ctx):
        """Names in the order a newcomer meets them."""
        return list(self.commands)


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="flexmb")
@click.option("--debug", is_flag=True, help="Show the traceback of a fault of flexmb itself.")
def cli(debug):
    """Solve rigid and flexible multibody systems from legacy decks.

    \b
    Example:
        flexmb run decks/young/IN4-BAR.dat
    """


def _deck_options(command):
    """Options that `run` and `check` share."""
    options = [
        click.option("--dialect", type=click.Choice(["auto", "young", "dafms", "vsdf"]), default="auto",
                     show_default=True, help="Dialect of the decks."),
        click.option("--set", "changes", metavar="NAME=VALUE", multiple=True,
                     help="Give a number of the deck another value, by its readable name (see --echo)."),
        click.option("--echo", is_flag=True, help="List every number of the deck with its meaning."),
        click.option("--strict", is_flag=True, help="Treat warnings as errors."),
        click.option("--json", "as_json", is_flag=True, help="One JSON object a deck on standard output."),
        click.option("-q", "--quiet", is_flag=True, help="Print errors only."),
    ]  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


@cli.command()
@DECK
@_deck_options
@click.option("-v", "--verbose", is_flag=True, help="Add solver statistics.")
@click.option("-o", "--output-dir", "folder", default=".", metavar="DIR", help="Folder of the results.")
@click.option("--out", metavar="PATH|-", help="OUT table; - is standard output.")
@click.option("--h5", metavar="PATH", help="HDF5 result.")
@click.option("--no-out", is_flag=True, help="Write no OUT table.")
@click.option("--no-h5", is_flag=True, help="Write no HDF5 result.")
@click.option("--layout", type=click.Choice(["safe", "historic"]), default="safe", show_default=True,
              help="historic: signed zeros, fields that run together.")  # fmt: skip
@click.option("-j", "--jobs", type=click.IntRange(1), default=1, show_default=True, help="Decks run at once.")
@click.option("--feps", type=click.FloatRange(0), help="YOUNG: end Newton at this residual (historic 1e-4).")
@click.option("--epslu", type=click.FloatRange(0, 1), help="YOUNG: smallest pivot (historic 1e-5).")
@click.option("--nrmax", type=click.IntRange(1), help="YOUNG: most iterations of the assembly (250).")
def run(decks, changes, echo, as_json, quiet, verbose, jobs, feps, epslu, nrmax, **options):
    """Solve every DECK and write its OUT table and HDF5 result.

    \b
    Example:
        flexmb run decks/young/IN4-BAR.dat -o results
    """
    from .run.outcome import RunOptions

    solver = {"tolerance": feps, "smallest_pivot": epslu, "most_iterations": nrmax}
    solver = {name: value for name, value in solver.items() if value is not None}
    choices = RunOptions(changes=changes, solver=solver, **options)
    _refuse_shared_files(decks, choices)
    _stop_on_sigterm()
    codes = []
    for outcome in _outcomes(decks, choices, jobs, quiet, echo):
        _report_outcome(outcome, quiet, verbose)
        if as_json:
            click.echo(json.dumps(outcome.as_dict()))
        codes.append(outcome.exit_code)
        if outcome.exit_code > 128:
            break
    sys.exit(max(codes))


def _outcomes(decks, options, jobs, quiet, echo):
    if jobs > 1 and len(decks) > 1:
        yield from _outcomes_in_parallel(decks, options, jobs)
        return
    from .run.deck import run_deck

    for deck in decks:
        if echo:
            _print_echo(deck, options)
        with _Progress(quiet) as progress:
            yield run_deck(deck, options, progress.listener, sys.stdout)


def _outcomes_in_parallel(decks, options, jobs):
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    from .run.deck import run_deck

    with ProcessPoolExecutor(min(jobs, len(decks)), get_context("spawn")) as pool:
        waiting = [pool.submit(run_deck, deck, options) for deck in decks]
        for outcome in waiting:
            yield outcome.result()


class _Progress:
    """A progress bar on a terminal, and notices; silent with -q."""

    def __init__(self, quiet):
        from .run.outcome import Listener

        self.bar = None
        self.shown = not quiet and sys.stderr.isatty()
        notice = (
            (lambda sentence: None)
            if quiet
            else (lambda sentence: click.echo(f"flexmb: {sentence}", err=True))
        )
        self.listener = Listener(self.begin, self.advance, notice)

    def begin(self, rows):
        if self.shown and rows > 1:
            self.bar = click.progressbar(length=rows, label="rows", file=sys.stderr)
            self.bar.__enter__()

    def advance(self, rows):
        if self.bar:
            self.bar.update(rows)

    def __enter__(self):
        return self

    def __exit__(self, *failure):
        if self.bar:
            self.bar.__exit__(None, None, None)


def _refuse_shared_files(decks, options):
    """Two decks that would write the same file are refused before anything is solved."""
    from pathlib import PurePath

    from .write.file_names import refuse_shared, result_paths

    if len(decks) > 1 and (options.h5 or options.out not in (None, "-")):
        raise click.UsageError("--out and --h5 name one file: give one deck, or use --output-dir")
    names = [(deck, PurePath(deck).name if deck != "-" else deck) for deck in decks]
    guess = "young" if options.dialect == "auto" else options.dialect
    paths = [
        (
            deck,
            result_paths(name, guess, options.folder, options.out, options.h5, options.no_out, options.no_h5),
        )
        for deck, name in names
    ]
    refuse_shared(paths)


def _stop_on_sigterm():
    from .run.outcome import Terminated

    def stop(number, frame):
        raise Terminated

    signal.signal(signal.SIGTERM, stop)


def _report_outcome(outcome, quiet, verbose):
    faults = [fault for fault in outcome.faults if fault.severity == "error" or not quiet]
    if faults:
        lines = outcome.source.lines if outcome.source else ()
        click.echo(compiler_style(outcome.deck, faults, lines), err=True)
    if outcome.exit_code > 128:
        click.echo(f"{outcome.deck}: interrupted; {_kept(outcome)}", err=True)
    elif outcome.exit_code == 1 and not quiet:
        click.echo(f"{outcome.deck}: {_kept(outcome)}", err=True)
    elif outcome.exit_code == DONE and not quiet:
        click.echo(f"{outcome.deck}: {_rows(outcome)} → {', '.join(outcome.files) or 'no file'}", err=True)
    if verbose:
        click.echo(
            f"  Newton iterations {outcome.iterations}, at most {outcome.most_iterations} in a row; "
            f"largest residual {outcome.largest_residual:.1e}",
            err=True,
        )


def _rows(outcome):
    return f"{outcome.rows} row{'' if outcome.rows == 1 else 's'}"


def _kept(outcome):
    if not outcome.files:
        return "nothing was written"
    return f"{_rows(outcome)} kept, marked as failed, in {', '.join(outcome.files)}"


def _print_echo(path, options):
    """The echo of one deck on standard error; its faults are reported by the run itself."""
    from .run.deck import open_deck
    from .run.outcome import Outcome
    from .write.echo import echo

    try:
        click.echo(echo(open_deck(path, options, Outcome(path))), err=True, nl=False)
    except FlexmbError:
        return


@cli.command()
@DECK
@_deck_options
@click.option("--jacobian", metavar="TIME|estimate", help="Print the Jacobian, rows and columns labelled.")
def check(decks, changes, echo, as_json, quiet, jacobian, **options):
    """Read every DECK, assemble it and report what is doubtful, without solving; writes nothing.

    \b
    Example:
        flexmb check decks/young/IN4-BAR.dat --echo
    """
    from .run.check import check_deck
    from .run.outcome import RunOptions

    _check_jacobian_option(jacobian)
    codes = []
    for path in decks:
        report = check_deck(path, RunOptions(changes=changes, **options), jacobian)
        _report_faults(report.outcome, quiet)
        if as_json:
            click.echo(json.dumps(report.as_dict()))
        elif report.deck and not quiet:
            _print_check(report, echo)
        codes.append(report.outcome.exit_code)
    sys.exit(max(codes))


def _check_jacobian_option(jacobian):
    from math import isfinite

    if jacobian in (None, "estimate"):
        return
    try:
        good = isfinite(float(jacobian))
    except ValueError:
        good = False
    if not good:
        raise click.BadParameter(
            f"{jacobian!r} is neither a time in s nor 'estimate'", param_hint="--jacobian"
        )


def _report_faults(outcome, quiet):
    faults = [fault for fault in outcome.faults if fault.severity == "error" or not quiet]
    if faults:
        lines = outcome.source.lines if outcome.source else ()
        click.echo(compiler_style(outcome.deck, faults, lines), err=True)


def _print_check(report, with_echo):
    from .write.check_text import check_text, jacobian_text
    from .write.echo import echo

    if with_echo:
        click.echo(echo(report.deck), nl=False)
    if report.counts:
        click.echo(check_text(report), nl=False)
    if report.jacobian:
        click.echo(jacobian_text(report.jacobian), nl=False)


@cli.command()
@click.argument("a")
@click.argument("b")
@click.option("--last-digit", type=click.IntRange(0), default=0, metavar="N",
              help="Allow N units of the last printed digit.")  # fmt: skip
@click.option("--atol", type=click.FloatRange(0), help="Allow this distance.")
@click.option("--rtol", type=click.FloatRange(0), help="Allow this part of the larger value.")
@click.option("--tol", "kinds", multiple=True, metavar="KIND=ATOL[,RTOL]",
              help="Tolerance of one kind of column (acceleration=1e-3); inf leaves it out.")  # fmt: skip
@click.option("--same-attitude", is_flag=True, help="Euler parameters p and -p count as equal.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing; the exit code tells.")
def diff(a, b, last_digit, atol, rtol, kinds, same_attitude, as_json, quiet):
    """Compare two OUT tables, or two HDF5 results, number by number.

    A value differs when it exceeds all tolerances given; by default every printed digit counts.

    \b
    Example:
        flexmb diff OUT4-BAR.dat reference/OUT4-BAR.dat --last-digit 1
    """
    from .write.diff import compare
    from .write.tolerances import Tolerances, parse_kinds

    tolerances = Tolerances(atol, rtol, last_digit, parse_kinds(kinds))
    report = compare(a, b, tolerances, same_attitude)
    if as_json:
        click.echo(json.dumps(report.as_dict()))
    elif not quiet:
        click.echo(report.text(), nl=False)
    sys.exit(DONE if report.equal else 1)


def main():
    """Entry point of `flexmb`: no traceback reaches a user, and a closed pipe ends quietly."""
    if hasattr(signal, "SIGPIPE"):
        # `flexmb diff a b | head` would otherwise end in a BrokenPipeError.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        cli.main(standalone_mode=False, prog_name="flexmb")
    except SystemExit:
        raise
    except click.exceptions.Exit as ending:
        sys.exit(ending.exit_code)
    except click.Abort:
        sys.exit(130)
    except click.ClickException as fault:
        fault.show()
        sys.exit(BAD_INPUT)
    except FlexmbError as failure:
        _report_failure(failure)
        sys.exit(failure.exit_code)
    except Exception as fault:
        if "--debug" in sys.argv:
            raise
        click.echo(
            f"flexmb: error: a fault of flexmb itself: {type(fault).__name__}: {fault}\n"
            "Please report it with the deck; `flexmb --debug …` shows where it happened.",
            err=True,
        )
        sys.exit(INTERNAL_FAULT)


def _report_failure(failure):
    for fault in failure.faults:
        click.echo(f"flexmb: {fault.severity}: {fault.sentence}", err=True)
