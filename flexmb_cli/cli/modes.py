"""`flexmb modes`: frequencies of mechanisms, and of the flexible bodies in them."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import numpy as np

from ..deck.body_text import body_lines
from ..errors import visible
from ..model.by_size import by_size
from ..run.outcome import Listener, RunOptions
from .options.deck_options import DECK, deck_options, every_deck, show_faults
from .options.loci import refuse_loci, show_loci
from .options.output_file import VERBOSE, Finite, WrittenPlace, refuse_inputs
from .terminal.progress import Progress
from .terminal.screen import WrongCall, notify, show, wants_debug


@click.command()
@DECK
@deck_options
@click.option(
    "--at",
    "time",
    type=Finite(),
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
@click.option("--response", nargs=2, metavar="INPUT OUTPUT",
              help="Print the frequency response of an output of the state space to an input.")  # fmt: skip
@click.option("--frequencies", nargs=2, type=Finite(), metavar="LOW HIGH",
              help="Frequencies of the response, or of --over, Hz [default: of all modes].")  # fmt: skip
@click.option("--bode", type=WrittenPlace(), metavar="FILE",
              help="Write the response: FILE.csv, or Bode and Nyquist plots (.png, .svg, .pdf).")  # fmt: skip
@click.option("--psd", metavar="FILE.csv",
              help="Print the root mean square for this power spectral density of INPUT.")  # fmt: skip
@click.option("--over", type=(str, float, float, int), metavar="NAME FROM TO COUNT",
              help="Follow each mode over a number of the deck, as --set names it.")  # fmt: skip
@click.option("--locus", type=WrittenPlace(), metavar="FILE",
              help="Write the modes: FILE.csv, or Campbell and root-locus plots (.png, .svg).")  # fmt: skip
@click.option("--order", "orders", type=float, multiple=True, metavar="N",
              help="Print where frequencies are N times a speed NAME, rad/s; repeatable.")  # fmt: skip
@VERBOSE
def modes(
    decks: tuple[str, ...], echo: bool, as_json: bool, quiet: bool, verbose: bool, out: Any, **options: Any
) -> None:
    """List eigenfrequencies and damping of the mechanism of every DECK, and of its flexible bodies.

    A VSDF deck's flexible bodies are reduced, with effective masses and what is left out; its mechanism
    is linearised with --at, --equilibrium or --out, and if all bodies are rigid.

    \b
    Example:
        flexmb modes decks/vsdf/pendulum.vsdf --equilibrium
    """  # fmt: skip
    from ..run.mechanism_modes import Wish
    from ..run.modes import modes_of_deck

    _refuse_output(out, decks)
    asked = {name: options.pop(name) for name in ("response", "frequencies", "bode", "psd")}
    loci = {name: options.pop(name) for name in ("over", "locus", "orders")}
    loci["within"] = asked["frequencies"]
    if not loci["over"]:
        _refuse_response(asked, decks)
    refuse_loci(loci | asked | {"out": out}, decks)
    progress = Progress("modes", "decks", quiet, verbose)
    listener = Listener(notice=progress.notice, status=progress.status)
    codes: list[int] = []
    responds = bool(asked["response"])
    wish = Wish(
        options.pop("time"),
        options.pop("equilibrium"),
        state_space=(as_json and not loci["over"]) or responds,
        out=out,
        responds=responds,
    )
    choices = RunOptions(debug=wants_debug(), **options)
    if loci["over"]:
        sys.exit(show_loci(decks[0], loci, wish, choices, listener, as_json=as_json, quiet=quiet))
    for report in every_deck(
        decks, choices, quiet, lambda deck: modes_of_deck(deck, wish, choices, listener)
    ):
        progress.clear()
        show_faults(report.outcome, quiet)
        if as_json:
            click.echo(json.dumps(report.as_dict()))
        elif report.deck:
            _print_modes(report, echo, quiet)
            if asked["response"] and report.mechanism:
                _show_response(report.mechanism.space, asked, quiet)
            if out is not None and not quiet and report.outcome.exit_code == 0:
                notify(f"{report.outcome.deck} → {out}, state space")
        codes.append(report.outcome.exit_code)
    sys.exit(max(codes))


def _refuse_output(out: None, decks: tuple[str, ...]) -> None:
    from ..run.modes import FORMS

    if out is None:
        return
    if Path(out).suffix.lower() not in FORMS:
        raise WrongCall(
            f"--out {out}: end the name with one of {', '.join(FORMS)}, which chooses the form", id="CLI-024"
        )
    if len(decks) > 1:
        raise WrongCall("--out takes the state space of one deck; call modes for each deck", id="CLI-025")
    refuse_inputs(out, decks, "--out")


def _refuse_response(asked: dict[str, Any], decks: tuple[str, ...]) -> None:
    """Refuse options of a response that do not go together."""
    ends, bode = asked["frequencies"], asked["bode"]
    if not asked["response"] and any(asked.values()):
        raise WrongCall("--frequencies, --bode and --psd belong to --response INPUT OUTPUT", id="CLI-111")
    if ends and not 0.0 < ends[0] < ends[1]:
        raise WrongCall("--frequencies LOW HIGH: 0 < LOW < HIGH, Hz", id="CLI-115")
    if bode and Path(bode).suffix.lower() not in (".csv", ".png", ".svg", ".pdf"):
        raise WrongCall(f"--bode {bode}: end the name with .csv, .png, .svg or .pdf", id="CLI-116")
    if bode and len(decks) > 1:
        raise WrongCall("--bode takes the response of one deck; call modes for each deck", id="CLI-117")
    if bode:
        refuse_inputs(bode, decks, "--bode")


def _show_response(space: Any, asked: dict[str, Any], quiet: bool) -> None:
    from .options.response import random_line, response_lines, response_of, write_response

    response = response_of(space, asked["response"], asked["frequencies"])
    lines = response_lines(response)
    if asked["psd"]:
        lines.append(random_line(response, asked["psd"]))
    if not quiet:
        show("".join(f"{line}\n" for line in lines))
    if asked["bode"]:
        write_response(asked["bode"], response)


def _print_modes(report: Any, with_echo: bool, quiet: bool) -> None:
    from ..results.texts.echo import echo

    if with_echo:
        show(echo(report.deck))
    if not quiet:
        show(modes_text(report), prose=True)


SHOWN_PARTS = 3
NAMED_PART = 0.1  # of the largest part


def modes_text(report: Any) -> str:
    """Return what `flexmb modes` found (`run.modes.ModesReport`): flexible bodies, then the mechanism."""
    dialect = report.deck.dialect.upper()
    # Those of trees, which have no modes of their own here, are not counted.
    count = f", flexible bodies {len(report.bodies)}" if report.bodies else ""
    lines = [f"{visible(report.outcome.deck)}: {dialect} deck{count}"]
    for body in report.bodies:
        lines += body_lines(body, precision=True)
    if report.mechanism:
        lines += _mechanism_lines(report.mechanism)
    return "".join(f"{line.rstrip()}\n" for line in lines)


def _mechanism_lines(mechanism: Any) -> Iterator[Any]:
    modes = mechanism.modes
    where = "about the equilibrium" if mechanism.equilibrium else "of the mechanism"
    yield f"  linearised motion {where} at t = {mechanism.time:.6g} s: DOF {modes.degrees_of_freedom}"
    if not modes.constant:
        yield f"    frozen at t = {mechanism.time:.6g} s: the coefficients change along the motion"
    if mechanism.equilibrium:
        for name, values in mechanism.position:
            yield f"    {name}: " + " ".join(f"{value:.6g}" for value in np.array(values) + 0.0)
    if len(modes.frequency):
        yield f"    {'mode':>4} {'Hz':>13} {'damping ratio':>14}  moves most"
    for number, (frequency, damping, shape) in enumerate(
        zip(modes.frequency, modes.damping, modes.shapes, strict=True), start=1
    ):
        ratio = damping if abs(damping) > 1e-9 else 0.0
        yield f"    {number:4d} {frequency:13.6f} {ratio:14.6f}  {_parts(mechanism.names, shape)}"
    for values, what in ((modes.growing, "grows"), (modes.decaying, "fades")):
        for value in values:
            yield f"    {what} without oscillating: {abs(value):.6g} 1/s"
    if modes.unheld:
        yield f"    eigenvalues of motions that nothing holds: {modes.unheld}"


def _parts(names: Any, shape: Any) -> str:
    sizes = np.abs(shape)
    order = [k for k in by_size(sizes)[:SHOWN_PARTS] if sizes[k] >= NAMED_PART]
    return ", ".join(f"{names[k]} {sizes[k]:.2f}" for k in order)
