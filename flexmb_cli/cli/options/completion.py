"""Shell completion of files, quantities and examples."""

from typing import Any

import click


def files(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[Any]:
    """Have the shell complete names of files."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(incomplete, type="file")]


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
