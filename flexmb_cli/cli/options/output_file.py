"""Options, arguments and types that several commands share, their completion, and where output may go."""

import math
import os
import re
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import click

from ...errors import FlexmbError
from ..terminal.screen import WrongCall


def files(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[Any]:
    """Have the shell complete names of files."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(incomplete, type="file")]


STANDARD_OUTPUT = "-"
RESULT = click.argument("result", metavar="RESULT.h5", shell_complete=files)
AS_JSON = click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
QUIET = click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
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
    from ...results.quantities.quantities import names, open_result

    try:
        with open_result(context.params.get("result") or "") as file:
            known = [quantity.name for quantity in names(file)]
    except FlexmbError:
        return []
    return [name for name in known if name.startswith(incomplete)]


Command = TypeVar("Command", bound=Callable[..., Any])
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(e[-+]?\d+)?", re.IGNORECASE)
_WIDTH = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))\s*(mm|cm|in)?", re.IGNORECASE | re.ASCII)
_MILLIMETRES = {"mm": 1.0, "cm": 10.0, "in": 25.4}


class Finite(click.FloatRange):
    """`click.FloatRange` for finite numbers; without limits any of them."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or a usage error that names the option."""
        if isinstance(value, str) and _DECIMAL_COMMA.fullmatch(value.strip()):
            self.fail(f"{value} has a decimal comma; write {value.strip().replace(',', '.')}", param, ctx)
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number", param, ctx)
        return number

    def _describe_range(self) -> str:
        return "" if self.min is self.max is None else super()._describe_range()


class Millimetres(Finite):
    """A width on paper: mm, or with `cm` or `in` after the number."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The width in mm, or a usage error."""
        if not isinstance(value, str):
            return super().convert(value, param, ctx)
        match = _WIDTH.fullmatch(value.strip())
        if _DECIMAL_COMMA.fullmatch(value.strip()):
            return super().convert(value, param, ctx)
        if match is None:
            self.fail(f"{value} is not a width: give millimetres, such as 85, or 8.5cm, 3.5in", param, ctx)
        return super().convert(float(match[1]) * _MILLIMETRES[(match[2] or "mm").lower()], param, ctx)


class UnitNames(click.ParamType):  # type: ignore[type-arg]
    """Units that are wanted, such as mm,MPa,deg,kN, by their SI units."""

    name = "units"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the units, or raise a usage error."""
        from ...deck.units import wishes_of

        try:
            return wishes_of(value.split(",")) if isinstance(value, str) else value
        except ValueError as error:
            self.fail(str(error), param, ctx)


def in_units(note: str = "") -> Callable[[Command], Command]:
    """Return the option for units; `note` ends its help."""
    meaning = f"Units of numbers, such as mm,MPa,deg,kN; the others stay as they are{note}."
    return click.option("--units", "wishes", type=UnitNames(), default={}, metavar="UNIT,...", help=meaning)


ABSOLUTE_TOLERANCE = Finite(0, 1, min_open=True, max_open=True)
RELATIVE_TOLERANCE = Finite(1e-14, 1, max_open=True)  # `model.time_checks.FINEST`
