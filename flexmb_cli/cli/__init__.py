"""The commands, a file each: the only place that prints and exits.

What a command needs is imported inside it, so that `--help`, `check` and `diff` start at once.
"""

import contextlib
import os
import signal
import sys
from collections.abc import Mapping
from errno import EBADF
from importlib import import_module
from types import FrameType
from typing import Any

import click

from ..errors import (
    ANALYSIS_FAILED,
    BAD_INPUT,
    INTERNAL_FAULT,
    Fault,
    FlexmbError,
    compiler_style,
    lines_visible,
)
from ..memory import LACK_OF_MEMORY, lack_of_memory_text, lacks_memory
from ..run.outcome import INTERRUPTED, TERMINATED, Stop, Terminated
from ..run.processes.signal_mask import ignore_stops, pass_over_stops
from ..version import __version__
from .terminal.screen import WrongCall

DONE = {
    "run": "every deck is solved",
    "check": "every deck can be run",
    "verify": "the formulations agree",
    "diff": "no difference beyond tolerance",
    "sweep": "every case is solved",
    "fit": "the search has converged",
    "flexmb": "done",
}
FAILED = {
    "run": "an analysis failed; the rows so far are kept and marked",
    "check": "the machine has too little memory",
    "verify": "an analysis failed, or the motions differ",
    "modes": "an analysis failed",
    "statics": "no equilibrium was found",
    "sensitivity": "an analysis failed",
    "diff": "the results differ, or one is missing",
    "sweep": "some cases failed; the table is complete and says why",
    "fit": "no variant can be solved, or the search has not converged",
    "flexmb": "an analysis failed, results differ, or the disk is full",
}
OF_ALL = {
    "2": "bad input: the call, a file that cannot be read, a deck with errors",
    "3": "a fault of flexmb itself; please report it",
    "130, 143": "interrupted by Ctrl-C; terminated",
}
READ_ON = [
    "",
    "\b",
    "Read on:",
    "  man flexmb               the manual (checkout: man -l docs/man/flexmb.1)",
    "  flexmb examples --all    decks, and their formats (decks/DIALECT/FORMAT.md)",
    "  flexmb docs              lessons, how-to guides, reference, in a browser",
]


def exit_codes(command: str) -> dict[str, str]:
    """Return the meaning of every exit code of a command, "flexmb" for the program."""
    failed = FAILED.get(command, "a file cannot be written, for instance on a full disk")
    return {"0": DONE.get(command, DONE["flexmb"]), "1": failed} | OF_ALL


def epilog(command: str) -> str:
    """Return the lines that end the help of a command."""
    lines = [f"  {code:9} {meaning}" for code, meaning in exit_codes(command).items()]
    return "\n".join(["\b", "Exit codes:", *lines, *(READ_ON if command == "flexmb" else ())])


# Two threads add up in another order than one, and end in other digits; decks in parallel are processes.
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


# In the order a newcomer meets them, with the first lines of their help: no other command is imported for it.
COMMANDS = {
    "run": "Solve every DECK and write its OUT table and HDF5 result.",
    "check": "Read and assemble every DECK and report its faults and counts,...",
    "verify": "Run every DECK by two formulations and compare the motions;...",
    "modes": "List eigenfrequencies and damping of the mechanism of every...",
    "statics": "Find the static equilibrium of every DECK under its loads, its...",
    "diff": "Compare results number by number: OUT tables, DAFMS echoes or...",
    "table": "Print quantities of RESULT.h5 over time, on a terminal and in...",
    "plot": "Draw quantities of RESULT.h5 over time, a panel for each unit.",
    "report": "Write a self-contained HTML page: motion in 3-D, curves, audit...",
    "export": "Write RESULT.h5 for ParaView (vtkhdf), spreadsheets (csv) or...",
    "convert": "Write the model of DECK, or of a URDF or MJCF file, for...",
    "sensitivity": "Print the derivatives of quantities of a DECK's run by numbers...",
    "sweep": "Solve the variants of a deck that STUDY (TOML) describes, and...",
    "fit": "Find numbers of a deck so that its results meet targets.",
    "new": "Ask for the data of a deck, number by number, and write a deck...",
    "beam": "Write the finite-element block of a beam to standard output.",
    "examples": "List the supplied decks, or copy those named, with the files...",
    "docs": "Open the documentation, or a PAGE of it, in a browser; it...",
    "compile": "Compile all kernels now, so that no first run waits for them.",
}


class Commands(Mapping[str, click.Command]):
    """The commands by name, each imported when it is requested."""

    def __getitem__(self, name: str) -> click.Command:
        if name not in COMMANDS:
            raise KeyError(name)
        module = import_module(f".{name}", __name__)
        command: click.Command = getattr(module, name if hasattr(module, name) else f"{name}_")
        command.epilog = epilog(name)
        return command

    def __iter__(self) -> Any:
        return iter(COMMANDS)

    def __len__(self) -> int:
        return len(COMMANDS)


class Group(click.Group):
    """Keeps the commands in the order of `COMMANDS`."""

    def list_commands(self, ctx: click.Context) -> list[Any]:
        """Names in the order a newcomer meets them."""
        return list(self.commands)

    def parse_args(self, ctx: click.Context, args: list[str]) -> Any:
        """Read the options before the command; those of commands belong after it."""
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as fault:
            name = next((word for word in args if word in COMMANDS), "")
            options = {option for each in self.commands[name].params for option in each.opts} if name else ()
            if fault.option_name in options:
                message = (
                    f"{fault.option_name} belongs after the command: flexmb {name} {fault.option_name} ..."
                )
                raise WrongCall(message, ctx, id="CLI-014") from None
            raise

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Return the command that the arguments name; a deck in its place is a slip."""
        if args[0] not in self.commands and os.path.exists(args[0]):
            raise WrongCall(f"{args[0]} is a file, not a command: flexmb run {args[0]}", ctx, id="CLI-015")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the names with their help."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _print_version(context: click.Context, option: Any, asked: bool) -> None:
    if not asked or context.resilient_parsing:
        return
    from .terminal.commit import commit

    hash_of_commit = commit()
    click.echo(f"flexmb, version {__version__}{f' (commit {hash_of_commit})' if hash_of_commit else ''}")
    context.exit()


# Versions of click differ in the brackets of the metavar.
@click.group(cls=Group, invoke_without_command=True, epilog=epilog("flexmb"),
             subcommand_metavar="[COMMAND] [ARGS]...",
             context_settings={"help_option_names": ["-h", "--help"]})  # fmt: skip
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_version,
              help="Show the version and the commit, and exit.")  # fmt: skip
@click.option("--debug", is_flag=True, help="Show the traceback of a fault of flexmb itself.")
@click.pass_context
def cli(context: click.Context, debug: bool) -> None:
    """Solve rigid and flexible multibody systems from legacy decks.

    \b
    Example:
        flexmb examples IN4-BAR
        flexmb check IN4-BAR.dat
        flexmb run IN4-BAR.dat
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


# click changes them only where commands are added.
cli.commands = Commands()  # type: ignore[assignment]


def main() -> None:
    """Entry point of `flexmb`: no traceback reaches a user, and a closed pipe ends quietly."""
    if hasattr(signal, "SIGPIPE"):
        # `flexmb diff a b | head` would otherwise end in a BrokenPipeError.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    # SIGTERM and a closed terminal end the program by an exception, so that it clears up.
    signal.signal(signal.SIGTERM, _terminate)
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signal.signal(signal.SIGHUP, _terminate)
    sys.unraisablehook = pass_over_stops
    os.environ.update(dict.fromkeys(THREADS, "1"))  # read when numpy is imported, by a command
    _open_closed_streams()
    try:
        _run_command()
    except OSError as fault:
        if lacks_memory(fault):
            _refuse_lack(fault)
        _refuse_lost_folder()
        # Files are guarded where they are written: what is left are the standard streams.
        of_closed = fault.strerror if fault.errno == EBADF else ""  # of `closed_output`
        _notify(f"flexmb: error: {of_closed or f'standard input or output: {fault.strerror or fault}'}")
        os._exit(ANALYSIS_FAILED)  # what waits in the broken stream would fail once more at exit
    finally:
        if Stop.asked is not None:
            ignore_stops()


def _run_command() -> None:
    """Run the command that is requested; how it ended is reported, and is the exit code."""
    try:
        cli.main(standalone_mode=False, prog_name="flexmb")
    except (SystemExit, OSError):
        raise
    except click.exceptions.Exit as ending:
        sys.exit(ending.exit_code)
    except (KeyboardInterrupt, click.Abort) as ending:
        # click takes an EOFError for Ctrl-D, wherever it comes from.
        if isinstance(ending.__cause__, EOFError):
            _admit(ending.__cause__)
        _end_stopped("interrupted", INTERRUPTED)
    except Terminated:
        _end_stopped("terminated", TERMINATED)
    except click.ClickException as fault:
        _refuse_usage(fault)
        sys.exit(BAD_INPUT)
    except FlexmbError as failure:
        # After the name of the file in which the faults are, else that of the program.
        _say(compiler_style(failure.file or "flexmb", failure.faults))
        if not failure.printed:
            _print_json(failure.exit_code, *failure.faults, file=failure.file or None)
        sys.exit(failure.exit_code)
    except Exception as fault:
        if lacks_memory(fault) or isinstance(fault, ImportError):
            _refuse_lack(fault)
        _admit(fault)


def _end_stopped(how: str, exit_code: int) -> None:
    """Commands that keep something when they are stopped have their own words for it and end themselves."""
    _notify(f"flexmb: {how}; incomplete results are not written")
    _print_json(exit_code)
    sys.exit(exit_code)


def _refuse_lack(fault: Any) -> None:
    """The machine has too little memory: no fault of flexmb, nor of the deck."""
    if "--debug" in sys.argv:
        raise fault
    said = lack_of_memory_text(fault)
    if said == LACK_OF_MEMORY:
        said = f"{said}; incomplete results are not written"
    _notify(f"flexmb: error: {said}")
    _print_json(ANALYSIS_FAILED, Fault("error", said, id="CLI-001"))
    sys.exit(ANALYSIS_FAILED)


def _admit(fault: Any) -> None:
    """A fault of flexmb itself, with a request to report it."""
    if "--debug" in sys.argv:
        raise fault
    said = lines_visible(f"a fault of flexmb itself: {type(fault).__name__}: {fault}")
    click.echo(
        f"flexmb: error: {said}\nPlease report it with the deck; `flexmb --debug …` shows where it happened.",
        err=True,
    )
    _print_json(INTERNAL_FAULT, Fault("error", said, id="CLI-002"))
    sys.exit(INTERNAL_FAULT)


def _refuse_usage(fault: Any) -> None:
    """Return how the command is called, and what is wrong with the call, in the form of all errors."""
    context = getattr(fault, "ctx", None)
    if context is not None:
        help_line = f"Try '{context.command_path} --help' for help."
        click.echo(lines_visible(f"{context.get_usage()}\n{help_line}\n"), err=True)
    said = fault.format_message()
    _say(f"flexmb: error: {lines_visible(said)}")
    words = " ".join(said.split())
    own = isinstance(fault, WrongCall)
    _print_json(BAD_INPUT, Fault("error", words, id=fault.id) if own else Fault("error", words, id="CLI-003"))


def _print_json(exit_code: int, *faults: Any, file: Any = None) -> None:
    from .terminal.notices import print_record, wants_json

    if wants_json(cli.commands, sys.argv[1:]):
        print_record(exit_code, faults, file)


def _refuse_lost_folder() -> None:
    try:
        os.getcwd()
    except OSError:
        _notify("flexmb: error: the current folder does not exist any more")
        sys.exit(BAD_INPUT)


def _terminate(number: int, frame: FrameType | None) -> None:
    raise Terminated


def _open_closed_streams() -> None:
    """A shell can close a standard stream (`2>&-`); Python then has None in its place.

    Output that is lost is reported, see `main`; where errors are lost there is nowhere to report it.
    """
    if sys.stdin is None:
        sys.stdin = open(os.devnull, encoding="utf-8")  # noqa: SIM115
    if sys.stdout is None:
        from .terminal.screen import closed_output

        sys.stdout = closed_output()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115


def _say(text: str) -> None:
    from .terminal.screen import say

    say(text)


def _notify(sentence: str) -> None:
    with contextlib.suppress(OSError):
        click.echo(lines_visible(sentence), err=True)
