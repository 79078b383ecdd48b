"""Options and fault printing of all commands that take decks."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ...deck.several_models import models_of, named_model, refuse_strange
from ...dialects import DIALECTS, ENDINGS
from ...errors import FlexmbError, compiler_style
from ...run.outcome import Outcome, RunOptions
from ...run.processes.signal_mask import stop_on_signals
from ..terminal.closing_lines import ClosingLines, annotations
from ..terminal.screen import WrongCall, notify, say
from .output_file import Finite, files

if TYPE_CHECKING:
    from ...run.check.check import CheckReport
    from ...run.modes import ModesReport
    from ...run.statics import StaticsReport
    from ...run.verify.verify import Verification


# What a command reports of a deck, with its `outcome`.
Report = TypeVar("Report", bound="CheckReport | ModesReport | StaticsReport | Verification")

# Results of an earlier run look like those of this one, which wrote none.
_SHOWN_ALWAYS = frozenset({"RUN-042", "RUN-072"})

DECK = click.argument("decks", metavar="DECK...", nargs=-1, required=True, shell_complete=files)


LOOP_TOLERANCE = click.option(
    "--loop-tolerance", type=Finite(0, 0.02), metavar="FLOAT",
    help="Largest gap, rad or a share of the size, at which an overconstrained loop counts as closed "
    "(default: what the digits of the deck allow).",
)  # fmt: skip


def deck_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Options that `run` and `check` share."""
    options = [
        click.option("--dialect", type=click.Choice(["auto", *reversed(DIALECTS)]), default="auto",
                     show_default=True, help="Dialect of the decks."),
        click.option("--set", "changes", metavar="NAME=VALUE", multiple=True,
                     help="Give a number of the deck another value, by its readable name (see --echo)."),
        click.option("--echo", is_flag=True, help="List every number of the deck with its meaning."),
        click.option("--strict", is_flag=True, help="Treat warnings as errors."),
        LOOP_TOLERANCE,
        click.option("--json", "as_json", is_flag=True, help="One JSON object a deck on standard output."),
        click.option("-q", "--quiet", is_flag=True, help="Print errors only."),
    ]  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


def every_deck(
    decks: tuple[str, ...], options: RunOptions, quiet: bool, examine: Callable[[str], Report]
) -> Iterator[Report]:
    """Yield the report of `examine` on each deck; decks after a stop are named as interrupted.

    The last lines say how many passed, unless `quiet`.

    Raises DeckError for settings of a model that a deck lacks.
    """
    stop_on_signals()
    named = with_models(decks)
    refuse_strange_models(named, options.changes)
    closing_lines = ClosingLines(len(named), "passed")
    for deck in named:
        report = examine(deck)
        code = report.outcome.exit_code
        closing_lines.add(report.outcome)
        yield report
        del report  # a large deck takes hundreds of megabytes, which the next one needs
        if code > 128:
            notify(f"{deck}: interrupted")
    if not quiet:
        closing_lines.show()


def with_models(decks: tuple[str, ...]) -> list[str]:
    """Return the decks, those in it in the place of a folder, `1:DECK` … in that of one with several models.

    Raises UsageError for a folder without decks.
    """
    return [name for path in decks for deck in _decks_at(path) for name in models_of(deck)]


def _decks_at(path: str) -> list[str]:
    if not os.path.isdir(path):
        return [path]
    decks = sorted(str(file) for file in Path(path).rglob("*") if _is_deck(file.relative_to(path), file))
    if not decks:
        raise WrongCall(
            f"{path}: no deck in this folder: their names end in {', '.join(ENDINGS)}", id="CLI-080"
        )
    return decks


def _is_deck(name: Path, file: Path) -> bool:
    """Return whether a file of a folder has the name of a deck, and neither of a result nor of CalculiX."""
    if file.suffix.lower() not in ENDINGS or any(part.startswith(".") for part in name.parts):
        return False
    return not (file.name.startswith("OUT") or file.with_suffix(".inp").exists()) and file.is_file()


def refuse_strange_models(decks: list[str], changes: tuple[str, ...]) -> None:
    """Raise DeckError, once a deck, for a setting of a model that a deck with several of them lacks."""

    for path in dict.fromkeys(path for path, model in map(named_model, decks) if model):
        try:
            refuse_strange(changes, len(models_of(path)))
        except FlexmbError as failure:
            failure.file = path
            raise


def show_faults(outcome: Outcome, quiet: bool) -> None:
    """Faults of an outcome on standard error, as compilers do; with `quiet` errors, and old results."""
    faults = [
        fault
        for fault in outcome.faults
        if not quiet or fault.severity == "error" or fault.id in _SHOWN_ALWAYS
    ]
    if faults:
        say(compiler_style(outcome.deck, faults, outcome.lines))
        click.echo(annotations(named_model(outcome.deck)[0], faults), nl=False, err=True)
