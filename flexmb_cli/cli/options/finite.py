"""A real number on the command line that is neither nan nor inf: in a range, or any."""

import math
import re
from typing import Any

import click

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(e[-+]?\d+)?", re.IGNORECASE)
_WIDTH = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+))\s*(mm|cm|in)?", re.IGNORECASE | re.ASCII)
_MILLIMETRES = {"mm": 1.0, "cm": 10.0, "in": 25.4}


class Finite(click.FloatRange):
    """`click.FloatRange` for finite numbers."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or a usage error that names the option."""
        _refuse_comma(self, value, param, ctx)
        return _finite(self, super().convert(value, param, ctx), value, param, ctx)


class AnyFinite(click.types.FloatParamType):
    """`click.FLOAT` for finite numbers; the help of a `FloatRange` without limits shows an empty range."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or a usage error that names the option."""
        _refuse_comma(self, value, param, ctx)
        return _finite(self, super().convert(value, param, ctx), value, param, ctx)


class Millimetres(Finite):
    """A width on paper: mm, or with `cm` or `in` behind the number."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The width in mm, or a usage error."""
        if not isinstance(value, str):
            return super().convert(value, param, ctx)
        _refuse_comma(self, value, param, ctx)
        match = _WIDTH.fullmatch(value.strip())
        if match is None:
            self.fail(f"{value} is no width: give millimetres, such as 85, or 8.5cm, 3.5in", param, ctx)
        return super().convert(float(match[1]) * _MILLIMETRES[(match[2] or "mm").lower()], param, ctx)


def _refuse_comma(
    kind: "AnyFinite | Finite", value: Any, param: click.Parameter | None, ctx: click.Context | None
) -> None:
    if isinstance(value, str) and _DECIMAL_COMMA.fullmatch(value.strip()):
        kind.fail(f"{value} has a decimal comma; write {value.strip().replace(',', '.')}", param, ctx)


def _finite(
    kind: AnyFinite | Finite,
    number: float,
    value: float | str,
    param: click.Parameter | None,
    ctx: click.Context | None,
) -> Any:
    if not math.isfinite(number):
        kind.fail(f"{value} is no finite number", param, ctx)
    return number


ABSOLUTE_TOLERANCE = Finite(0, 1, min_open=True, max_open=True)
RELATIVE_TOLERANCE = Finite(1e-14, 1, max_open=True)  # `model.time_checks.FINEST`
