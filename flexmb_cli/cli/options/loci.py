"""`flexmb modes --over`: modes over a number of a deck, as text, CSV or pictures."""

import json
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from ...results.files.replaced_file import write_whole
from ..terminal.screen import WrongCall, notify, show
from .deck_options import show_faults
from .output_file import refuse_inputs

if TYPE_CHECKING:
    from ...run.mechanism_modes import Wish
    from ...run.outcome import Listener, RunOptions
    from ...solvers.linearisation.loci import ModeLoci

MOST_POINTS_OF_LOCUS = 10_000


def refuse_loci(asked: dict[str, Any], decks: tuple[str, ...]) -> None:
    """Refuse options of modes over a number that do not go together."""
    over, file = asked["over"], asked["locus"]
    if not over and (file or asked["orders"]):
        raise WrongCall("--locus and --order belong to --over NAME FROM TO COUNT", id="CLI-170")
    if not over:
        return
    _, low, high, count = over
    if not (np.isfinite([low, high]).all() and low < high and 2 <= count <= MOST_POINTS_OF_LOCUS):
        message = f"--over NAME FROM TO COUNT: FROM < TO, and a COUNT from 2 to {MOST_POINTS_OF_LOCUS}"
        raise WrongCall(message, id="CLI-171")
    if asked["response"] or asked["bode"] or asked["psd"] or asked["out"]:
        message = "--over follows modes: ask for a response or a state space at one value, with --set"
        raise WrongCall(message, id="CLI-174")
    ends = asked["within"]
    if ends and not 0.0 <= ends[0] < ends[1]:
        raise WrongCall("--frequencies LOW HIGH: 0 <= LOW < HIGH, Hz", id="CLI-175")
    if len(decks) > 1:
        raise WrongCall("--over follows the modes of one deck; call modes for each deck", id="CLI-172")
    if file and PurePath(file).suffix.lower() not in (".csv", ".png", ".svg", ".pdf"):
        raise WrongCall(f"--locus {file}: end the name with .csv, .png, .svg or .pdf", id="CLI-173")
    if file:
        refuse_inputs(file, decks, "--locus")


def show_loci(
    deck: str, asked: dict[str, Any], wish: "Wish", choices: "RunOptions", listener: "Listener",
    *, as_json: bool, quiet: bool,
) -> int:  # fmt: skip
    """Follow the modes of a deck, and show or write them; returns the exit code."""
    from ...run.mode_loci import mode_loci

    name, low, high, count = asked["over"]
    outcome, loci = mode_loci(deck, name, np.linspace(low, high, count), wish, choices, listener)
    show_faults(outcome, quiet)
    if loci and asked["within"]:
        loci = loci.within(*asked["within"])
    if as_json:
        click.echo(json.dumps(outcome.as_dict() | {"loci": loci and loci.record(asked["orders"])}))
    elif loci and not quiet:
        show("".join(f"{line}\n" for line in _lines(loci, asked["orders"])))
    if loci and asked["locus"]:
        _write(asked["locus"], loci, asked["orders"])
        if not quiet:
            notify(f"{deck} → {asked['locus']}, modes over {name}")
    return outcome.exit_code


def _lines(loci: "ModeLoci", orders: tuple[float, ...]) -> list[str]:
    """Return the frequencies at each value, and where they meet orders of a speed."""
    heads = [f"mode {k + 1}" for k in range(loci.eigenvalues.shape[1])]
    lines = [f"  {loci.name:>13} " + " ".join(f"{head:>13}" for head in heads) + "  Hz"]
    for value, row in zip(loci.values, loci.frequency, strict=True):
        lines.append(f"  {value:13.6g} " + " ".join(f"{f:13.6f}" if f == f else f"{'':13}" for f in row))
    for order in orders:
        for k, value in loci.critical(order):
            lines.append(f"  {order:g} per turn meets mode {k + 1} at {loci.name} = {value:.6g}")
    return [line.rstrip() for line in lines]


def _write(path: str, loci: "ModeLoci", orders: tuple[float, ...]) -> None:
    from ...results.figures.campbell import loci_csv, loci_picture

    form = PurePath(path).suffix[1:].lower()
    write_whole(path, loci_csv(loci) if form == "csv" else loci_picture(loci, orders, form))
