"""Options and arguments that several commands share, their completion, and where output may go."""

import os
from collections.abc import Sequence
from typing import Any

import click

from ..terminal.screen import WrongCall


def files(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[Any]:
    """Have the shell complete names of files."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(incomplete, type="file")]


STANDARD_OUTPUT = "-"
RESULT = click.argument("result", metavar="RESULT.h5", shell_complete=files)
AS_JSON = click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
QUIET = click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
VERBOSE = click.option(
    "-v", "--verbose", is_flag=True, help="Without a terminal, print the progress every ten seconds."
)
FORCE = click.option("--force", is_flag=True, help="Replace files that flexmb did not make, too.")


def refuse_inputs(output: str, inputs: Sequence[Any], option: str = "-o") -> None:
    """Raise UsageError when `output`, given with `option`, is one of the files that the command reads."""
    for path in inputs:
        if _are_one(output, path):
            raise WrongCall(
                f"{option} {output} would overwrite {path}, which is read; name another file", id="CLI-026"
            )


def refuse_standard_output(output: str, what: str, option: str = "-o") -> None:
    """Raise UsageError when `what`, which `option` writes, is to go to standard output."""
    if output == STANDARD_OUTPUT:
        raise WrongCall(f"{what} cannot go to standard output; {option} names a file", id="CLI-027")


def reported(output: str) -> str:
    """The place as a sentence names it."""
    return "standard output" if output == STANDARD_OUTPUT else output


def _are_one(output: str, path: str) -> bool:
    try:
        return os.path.samefile(output, path)
    except OSError:
        return False


class WrittenPlace(click.types.StringParamType):
    """A path; the empty one is what a variable of the shell leaves that was never set."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path, or a usage error that names the option."""
        if value == "":
            self.fail("an empty name; give a path", param, ctx)
        return super().convert(value, param, ctx)

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> Any:
        """Have the shell complete names of files."""
        return files(ctx, param, incomplete)


def quantities(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[str]:
    """Return the names in the result that the command line names; none where it cannot be read."""
    from ...errors import FlexmbError
    from ...results.quantities.quantities import names, open_result

    try:
        with open_result(context.params.get("result") or "") as file:
            known = [quantity.name for quantity in names(file)]
    except FlexmbError:
        return []
    return [name for name in known if name.startswith(incomplete)]


def example_names(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[str]:
    """Return the names of the supplied decks."""
    from ..examples import supplied

    return [name for name in supplied() if name.startswith(incomplete)]
