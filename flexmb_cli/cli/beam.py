"""`flexmb beam`: a straight uniform beam as the finite-element block of a DAFMS deck."""

import sys
from collections.abc import Sequence
from typing import Any

import click

from ..errors import FlexmbError, compiler_style
from .options.output_file import Finite
from .terminal.screen import say, standard_output

# Powers and quotients of these are still numbers.
ABOVE_ZERO = Finite(1e-50, 1e50)


@click.command()
@click.option("--length", type=ABOVE_ZERO, required=True, help="Length, m.")
@click.option(
    "--nodes", type=click.IntRange(1, 1000), required=True, help="Elements, each with a node at its end."
)
@click.option(
    "--ei", "EI", type=ABOVE_ZERO, required=True, help="Bending stiffness for deflection along axis 3, N m^2."
)
@click.option("--rho", type=ABOVE_ZERO, required=True, help="Mass per length, kg/m.")
@click.option(
    "--offset",
    type=Finite(-1e50, 1e50),
    default=0.0,
    show_default=True,
    help="Clamped end from O_k along axis 2, m.",
)
@click.option("--ea", "EA", type=ABOVE_ZERO, help="Axial stiffness, N; adds displacement along axis 2.")
@click.option(
    "--ei1", "EI_1", type=ABOVE_ZERO, help="Bending stiffness for deflection along axis 1, N m^2; needs --ea."
)
@click.option("--tip-mass", type=Finite(0, 1e50), default=0.0, help="Mass added to the last node, kg.")
@click.option("--ndm", type=click.Choice(["2", "3"]), help="NDM of the deck [default: as the axes need].")
@click.option(
    "--deck", "whole", is_flag=True, help="A whole deck: the beam turning about axis 1 of its root."
)
@click.option("--title", default="uniform beam", help="Heading of the whole deck.")
@click.option("--into", metavar="DECK", help="Write DECK with the beam as the block of body --body.")
@click.option("--body", type=click.IntRange(1), help="Body of --into that becomes the beam.")
def beam(ndm: str | None, whole: bool, title: str, into: str | None, body: int | None, **sizes: Any) -> None:
    """Write the finite-element block of a beam to standard output.

    The beam lies along axis 2 of its body, clamped at its first end: Hermite elements, rotations
    condensed, lumped masses.

    \b
    Example:
        flexmb beam --length 1 --nodes 4 --ei 1000 --rho 5 --into decks/dafms/two_link_n4.DAT --body 1
    """
    from ..dialects.dafms.beam import Beam

    _check_choice(whole, into, body)
    member = Beam(**sizes)
    standard_output().write(_text(member, ndm, whole, title, into, body))
    click.echo(f"beam: its share of MASS {member.mass:.9g} kg, of INER {member.inertia:.9g} kg m^2", err=True)


def _check_choice(whole: bool, into: str | None, body: int | None) -> None:
    if whole and into:
        raise click.UsageError("--deck and --into exclude each other")
    if (into is None) != (body is None):
        raise click.UsageError("--into DECK and --body K go together")


def _text(beam: Any, ndm: Any, whole: bool, title: str, into: str | None, body: int | None) -> str:
    from ..dialects.dafms.beam_cards import beam_block, beam_deck

    if whole:
        return beam_deck(beam, title)
    if into is None:
        return beam_block(beam, int(ndm) if ndm else 3 if 1 in beam.axes else 2)
    return _deck_with(beam, into, body)


def _deck_with(beam: Any, path: str, body: Any) -> str:
    """The deck at `path` with the beam in it; its faults are shown like those of `check`."""
    from ..dialects.dafms import DIALECT
    from ..dialects.dafms.beam_cards import with_beam
    from ..dialects.recognise import open_text, read_deck

    lines: Sequence[str] = ()
    try:
        source = open_text(path, DIALECT.name)
        lines = source.lines
        return with_beam(read_deck(source, DIALECT.name), body, beam)
    except FlexmbError as failure:
        say(compiler_style(path, failure.faults, lines))
        sys.exit(failure.exit_code)
