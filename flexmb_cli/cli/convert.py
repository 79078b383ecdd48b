"""`flexmb convert`: a deck's model for another program."""

import click

from .options.completion import files
from .terminal.screen import tell
from .terminal.written_place import WrittenPlace

SUFFIX = {"mjcf": ".xml", "exudyn": ".py"}


@click.command()
@click.argument("deck", shell_complete=files)
@click.option("--to", "form", type=click.Choice(list(SUFFIX)), required=True,
              help="mjcf: MuJoCo, rigid trees; exudyn: a Python script, rigid mechanisms.")  # fmt: skip
@click.option("-o", "--output", type=WrittenPlace(), metavar="FILE",
              help="The file; - is standard output.  [default: the deck's name, .xml or .py]")  # fmt: skip
@click.option("--set", "changes", metavar="NAME=VALUE", multiple=True,
              help="Give a number of the deck another value, by its readable name.")  # fmt: skip
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
def convert(deck, form, output, changes, quiet):
    """Write the model of DECK for another program, in SI units.

    What that program cannot hold is refused, with its place in the deck.

    \b
    Example:
        flexmb convert decks/dafms/spatial_rigid.DAT --to mjcf
    """
    from pathlib import PurePath

    from ..results.files.replaced_file import write_whole
    from ..run.convert import converted
    from .options.output_file import STANDARD_OUTPUT, refuse_inputs, reported

    stem = "flexmb" if deck == "-" else PurePath(deck).stem
    output = output or f"{stem}{SUFFIX[form]}"
    refuse_inputs(output, [deck])
    text = converted(deck, form, changes)
    if output == STANDARD_OUTPUT:
        click.echo(text, nl=False)
    else:
        write_whole(output, text.encode("utf-8"))
    if not quiet:
        tell(f"{deck} → {reported(output)}")
