"""`flexmb sensitivity`: derivatives of quantities of a run by numbers of its deck."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..dialects import DIALECTS
from ..model.integrators import METHOD_OPTIONS, TREE_METHODS
from ..results.files.file_names import refuse_foreign
from ..run.outcome import Listener, Outcome, RunOptions, ending_recorded
from .options.deck_options import LOOP_TOLERANCE, show_faults
from .options.output_file import FORCE, QUIET, RELATIVE_TOLERANCE, Finite, WrittenPlace, files, refuse_inputs
from .terminal.progress import Progress
from .terminal.screen import WrongCall, notify, show, wants_debug

if TYPE_CHECKING:
    from ..study.sensitivity import Sensitivity


@click.command()
@click.argument("deck", metavar="DECK", shell_complete=files)
@click.option("--of", "of", metavar="QUANTITY", multiple=True, required=True,
              help="Quantity of flexmb table, mode.N.frequency or mode.N.damping; repeatable.")  # fmt: skip
@click.option("--to", "to", metavar="NAME", multiple=True, required=True,
              help="Number of the deck, by its readable name (check --echo); repeatable.")  # fmt: skip
@click.option("--relative", is_flag=True, help="Print p/Q dQ/dp, the relative change of Q by that of p.")
@click.option("--equilibrium", is_flag=True, help="In the static equilibrium instead of along the motion.")
@click.option("--at", type=Finite(), metavar="TIME", help="Modes at TIME, s (default: the start).")
@click.option("--every", type=click.IntRange(1), default=1, metavar="N", help="Print every N-th row.")
@click.option("-f", "--format", "style", type=click.Choice(["csv", "tsv", "jsonl", "text"]), default="csv",
              show_default=True, help="csv, tsv, jsonl: JSON Lines, text: aligned.")  # fmt: skip
@click.option("-o", "--output", type=WrittenPlace(), metavar="FILE.h5",
              help="Write values and derivatives to a file that table, plot and export read.")  # fmt: skip
@click.option("--set", "changes", metavar="NAME=VALUE", multiple=True,
              help="Give a number of the deck another value first.")  # fmt: skip
@click.option("--dialect", type=click.Choice(["auto", *reversed(DIALECTS)]), default="auto",
              show_default=True, help="Dialect of the deck.")  # fmt: skip
@click.option("--method", type=click.Choice(list(dict.fromkeys((*METHOD_OPTIONS, *TREE_METHODS)))),
              help="Integrator, in place of the deck's.")  # fmt: skip
@click.option("--rtol", type=RELATIVE_TOLERANCE, help="Relative tolerance of a step, in place of the deck's.")
@LOOP_TOLERANCE
@FORCE
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
@QUIET
def sensitivity(
    deck: str, of: tuple[str, ...], to: tuple[str, ...], changes: tuple[str, ...], dialect: str,
    output: str | None, loop_tolerance: float | None, as_json: bool, quiet: bool, **options: Any,
) -> None:  # fmt: skip
    """Print the derivatives of quantities of a DECK's run by numbers of the deck, in every report row.

    Kinematics are differentiated directly, and a motion that is integrated costs two further runs for each
    number (four by implicit methods).  Modes and equilibria have one row.

    \b
    Example:
        flexmb sensitivity IN4-BAR.dat --of point.1.z --to spherical.1.P_i.y --every 5
        flexmb sensitivity pendulum.DAT --of mode.1.frequency --to gravity.g3 --equilibrium --relative
    """  # fmt: skip
    _refuse_output(deck, output, options["force"])
    steps = {name: options[name] for name in ("method", "rtol") if options[name] is not None}
    choices = RunOptions(
        debug=wants_debug(),
        dialect=dialect,
        changes=changes,
        integration=steps,
        loop_tolerance=loop_tolerance,
    )
    outcome, progress = Outcome(deck), Progress("sensitivity", "decks", quiet, False)
    listener = Listener(notice=progress.notice, status=progress.status)
    derivatives = None
    with ending_recorded(outcome, choices):
        derivatives = _differentiated(deck, of, to, choices, listener, outcome, options)
    progress.clear()
    show_faults(outcome, quiet)
    if derivatives is not None:
        _show(derivatives, options, as_json)
        if output:
            derivatives.result.save(output)
            if not quiet:
                notify(f"{deck} → {output}, sensitivities; flexmb plot {output} derivative")
    if as_json:
        click.echo(json.dumps(outcome.as_dict() | (_record(derivatives, options) if derivatives else {})))
    sys.exit(outcome.exit_code)


def _refuse_output(deck: str, output: str | None, force: bool) -> None:
    if output is None:
        return
    if Path(output).suffix != ".h5":
        raise WrongCall(f"-o {output}: end the name with .h5", id="CLI-090")
    refuse_inputs(output, [deck])
    refuse_foreign([output], force)


def _differentiated(
    deck: str, of: tuple[str, ...], to: tuple[str, ...], choices: RunOptions, listener: Listener,
    outcome: Outcome, options: dict[str, Any],
) -> "Sensitivity":  # fmt: skip
    from ..result import OpenDeck
    from ..run.model import open_deck
    from ..study.sensitivity import sensitivity

    opened = open_deck(deck, choices, outcome)
    given = OpenDeck(opened, deck, choices.changes, tuple(outcome.faults))
    derivatives = sensitivity(given, of, to, choices, listener, options["equilibrium"], options["at"])
    outcome.faults = list(derivatives.warnings)
    outcome.rows = len(derivatives.time)
    return derivatives


def _show(sensitivity_of_deck: "Sensitivity", options: dict[str, Any], as_json: bool) -> None:
    if as_json:
        return
    from ..results.quantities.quantities import resolve
    from ..results.quantities.table import chosen_rows, table_text

    with sensitivity_of_deck.result.stored() as file:
        names = ["value", "relative" if options["relative"] else "derivative"]
        rows = chosen_rows(file, None, None, options["every"])
        for piece in table_text(file, resolve(file, names), rows, options["style"]):
            if options["style"] == "text":
                show(piece, whole=True)
            else:
                click.echo(piece, nl=False)


def _record(sensitivity_of_deck: "Sensitivity", options: dict[str, Any]) -> dict[str, Any]:
    """Return the numbers for `--json`: names, and derivatives by row, quantity and number."""
    values = sensitivity_of_deck.relative if options["relative"] else sensitivity_of_deck.derivatives
    rows = slice(None, None, options["every"])
    return {
        "of": [{"name": one.name, "unit": one.unit} for one in sensitivity_of_deck.of],
        "to": [
            {"name": name, "unit": one.unit, "value": one.value}
            for name, one in sensitivity_of_deck.to.items()
        ],
        "times": sensitivity_of_deck.time[rows].tolist(),
        "values": sensitivity_of_deck.values[rows].tolist(),
        "relative" if options["relative"] else "derivatives": [
            [[one if one == one else None for one in line] for line in row] for row in values[rows].tolist()
        ],
    }
