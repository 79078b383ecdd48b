"""`flexmb convert`: a deck's model for another program."""

from pathlib import PurePath
from typing import Any

import click

from ..dialects.recognise import every_dialect
from ..errors import FlexmbError
from ..results.files.file_names import refuse_foreign
from ..results.files.replaced_file import write_whole
from ..run.outcome import Outcome
from .options.output_file import AS_JSON, FORCE, WrittenPlace, files
from .terminal.notices import Notices
from .terminal.screen import WrongCall, notify

PROGRAMS = {"mjcf": ".xml", "exudyn": ".py"}
DECKS = {each.name: each for each in every_dialect() if each.rigid_deck}
SUFFIX = PROGRAMS | {name: PurePath(each.new_name).suffix for name, each in DECKS.items()}
UNITS = ("m", "mm", "mm-kg", "cm", "in")


@click.command()
@click.argument("deck", shell_complete=files)
@click.option("--to", "form", type=click.Choice(list(SUFFIX)), required=True,
              help="mjcf: MuJoCo, rigid trees; exudyn: a Python script, rigid mechanisms; "
                   "else a deck of that dialect.")  # fmt: skip
@click.option("-o", "--output", type=WrittenPlace(), metavar="FILE",
              help="The file; - is standard output.  [default: the deck's name, another suffix]")  # fmt: skip
@click.option("--set", "changes", metavar="NAME=VALUE", multiple=True,
              help="Give a number of the deck another value, by its readable name.")  # fmt: skip
@click.option("--unit", type=click.Choice(UNITS), default="m",
              help="Units of DECK: m (kg), mm (t), mm-kg, cm (g), in (lbf).  [default: m]")  # fmt: skip
@click.option("--to-unit", type=click.Choice(UNITS), default="m",
              help="Units of the new deck, if its dialect prescribes none.  [default: m]")  # fmt: skip
@FORCE
@AS_JSON
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def convert(
    deck: str,
    form: str,
    output: str,
    changes: tuple[Any, ...],
    unit: str,
    to_unit: str,
    force: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Write the model of DECK, or of a URDF or MJCF file, for another program or dialect.

    Numbers are in SI units; a YOUNG deck may be in others. What the form cannot hold is refused, with its
    place in the deck.

    \b
    Example:
        flexmb convert decks/dafms/spatial_rigid.DAT --to mjcf
        flexmb convert decks/dafms/spatial_rigid.DAT --to vsdf
        flexmb convert robot.urdf --to young
        flexmb convert IN4-BAR.dat --to young --to-unit mm -o IN4-MM.dat
    """
    from ..run.convert import converted
    from ..run.earlier_results import set_conversion_aside
    from .options.output_file import STANDARD_OUTPUT, refuse_inputs, reported

    stem = "flexmb" if deck == "-" else PurePath(deck).stem
    force, output = force or bool(output), output or f"{stem}{SUFFIX[form]}"
    refuse_inputs(output, [deck])
    notices = Notices("deck", deck, quiet, as_json)
    notices.refuse_standard_output(output)
    _check_units(form, unit, to_unit)
    with notices.failures():
        outcome = Outcome(deck)
        try:
            text = converted(deck, form, changes, unit, to_unit, outcome)
        except FlexmbError:
            if stale := set_conversion_aside(output):
                notify(f"{output}: of an earlier call, now {stale}")
            raise
        if output == STANDARD_OUTPUT:
            click.echo(text, nl=False)
        else:
            if not force and (stale := set_conversion_aside(output, text)):
                notices.say(f"{output}: of an earlier call, now {stale}")
            refuse_foreign([output], force, "".join(text.splitlines(keepends=True)[:2]))
            write_whole(output, text.encode("utf-8"))
    notices.add_of_deck(tuple(dict.fromkeys(outcome.faults)), outcome.lines)
    notices.say(f"{deck} → {reported(output)}")
    notices.end(file=output)


def _check_units(form: str, unit: str, to_unit: str) -> None:
    """Other programs get SI units, as decks of most dialects do."""
    if unit != "m" and form in PROGRAMS:
        reported = (
            f"--unit is for conversion between decks: convert the deck to SI units first, then to {form}"
        )
        raise WrongCall(reported, id="CLI-016")
    if to_unit != "m" and not (form in DECKS and DECKS[form].any_units):
        free = ", ".join(name for name, each in DECKS.items() if each.any_units)
        raise WrongCall(f"--to-unit is for --to {free}; {form} is in SI units", id="CLI-017")
