"""`flexmb modes`: frequencies of mechanisms, and of the flexible bodies in them."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .options.deck_options import DECK, deck_options, every_deck, show_faults
from .options.finite import AnyFinite
from .terminal.progress import Progress
from .terminal.screen import notify, show, wants_debug
from .terminal.written_place import WrittenPlace
from .terminal.wrong_call import WrongCall

if TYPE_CHECKING:
    from ..run.outcome import Outcome


@click.command()
@DECK
@deck_options
@click.option(
    "--at",
    "time",
    type=AnyFinite(),
    metavar="TIME",
    help="Linearise the mechanism about its motion at TIME, s (default: its start).",
)
@click.option(
    "--equilibrium",
    is_flag=True,
    help="Linearise it about the static equilibrium it can fall into, and print its position.",
)
@click.option(
    "--out",
    type=WrittenPlace(),
    metavar="FILE",
    help="Write the state space A, B, C, D: FILE.npz (NumPy), FILE.mat (MATLAB) or FILE.json.",
)
@click.option(
    "-v", "--verbose", is_flag=True, help="Without a terminal, print the progress every ten seconds."
)
def modes(
    decks: tuple[str, ...],
    changes: tuple[str, ...],
    echo: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    time: float | None,
    equilibrium: bool,
    out: Any,
    **options: Any,
) -> None:
    """List eigenfrequencies and damping of the mechanism of every DECK, and of its flexible bodies.

    A VSDF deck's flexible bodies are reduced, with effective masses and what is left out; its mechanism
    is looked at when --at, --equilibrium or --out is given, or where all bodies are rigid.

    \b
    Example:
        flexmb modes decks/vsdf/pendulum.vsdf --equilibrium
    """  # fmt: skip
    from ..run.mechanism_modes import Wish
    from ..run.modes import modes_of_deck
    from ..run.outcome import Listener, RunOptions

    _refuse_output(out, decks)
    progress = Progress("modes", "decks", quiet, verbose)
    listener = Listener(notice=progress.notice, status=progress.status)
    codes = []
    choices = RunOptions(changes=changes, debug=wants_debug(), **options)
    wish = Wish(time, equilibrium, state_space=as_json, out=out)
    for report in every_deck(decks, changes, lambda deck: modes_of_deck(deck, wish, choices, listener)):
        progress.clear()
        show_faults(report.outcome, quiet)
        if as_json:
            click.echo(json.dumps(report.as_dict()))
        elif report.deck:
            _print_modes(report, echo, quiet)
            _tell_output(report.outcome, out, quiet)
        codes.append(report.outcome.exit_code)
    sys.exit(max(codes))


def _refuse_output(out: None, decks: tuple[str, ...]) -> None:
    from ..results.files.state_space import FORMS
    from .options.output_file import refuse_inputs

    if out is None:
        return
    if Path(out).suffix.lower() not in FORMS:
        raise WrongCall(
            f"--out {out}: end the name with one of {', '.join(FORMS)}, which chooses the form", id="CLI-024"
        )
    if len(decks) > 1:
        raise WrongCall("--out takes the state space of one deck; call modes for each deck", id="CLI-025")
    refuse_inputs(out, decks, "--out")


def _print_modes(report: Any, with_echo: bool, quiet: bool) -> None:
    from ..results.texts.echo import echo
    from ..results.texts.modes_text import modes_text

    if with_echo:
        show(echo(report.deck))
    if not quiet:
        show(modes_text(report), prose=True)


def _tell_output(outcome: "Outcome", out: str | None, quiet: bool) -> None:
    """Name the file of the state space, which a deck that fails does not write."""
    if out is not None and not quiet and outcome.exit_code == 0:
        notify(f"{outcome.deck} → {out}, state space")
