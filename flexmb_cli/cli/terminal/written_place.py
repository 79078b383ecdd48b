"""Place of an output, as the command line names it."""

from typing import Any

import click

from ..options.completion import files


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
