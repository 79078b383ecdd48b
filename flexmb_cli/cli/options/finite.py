"""A real number on the command line that is neither nan nor inf: in a range, or any."""

import math
import re
from typing import Any

import click

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(e[-+]?\d+)?", re.IGNORECASE)


class Finite(click.FloatRange):
    """`click.FloatRange` for finite numbers."""

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """The number, or a usage error that names the option."""
        _refuse_comma(self, value, param, ctx)
        return _finite(self, super().convert(value, param, ctx), value, param, ctx)


class AnyFinite(click.types.FloatParamType):
    """`click.FLOAT` for finite numbers; the help of a `FloatRange` without limits shows an empty range."""

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """The number, or a usage error that names the option."""
        _refuse_comma(self, value, param, ctx)
        return _finite(self, super().convert(value, param, ctx), value, param, ctx)


def _refuse_comma(kind: "AnyFinite | Finite", value: float | str, param: Any, ctx: click.Context) -> None:
    if isinstance(value, str) and _DECIMAL_COMMA.fullmatch(value.strip()):
        kind.fail(f"{value} has a decimal comma; write {value.strip().replace(',', '.')}", param, ctx)


def _finite(
    kind: AnyFinite | Finite, number: float, value: float | str, param: Any, ctx: click.Context
) -> Any:
    if not math.isfinite(number):
        kind.fail(f"{value} is no finite number", param, ctx)
    return number


ABSOLUTE_TOLERANCE = Finite(0, 1, min_open=True, max_open=True)
RELATIVE_TOLERANCE = Finite(1e-14, 1, max_open=True)  # `model.time_checks.FINEST`
