"""A real number on the command line that is neither nan nor inf: in a range, or any."""

import math
import re
from typing import Any

import click

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
            self.fail(f"{value} is no finite number", param, ctx)
        return number

    def _describe_range(self) -> str:
        return "" if self.min is self.max is None else super()._describe_range()


class Millimetres(Finite):
    """A width on paper: mm, or with `cm` or `in` behind the number."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The width in mm, or a usage error."""
        if not isinstance(value, str):
            return super().convert(value, param, ctx)
        match = _WIDTH.fullmatch(value.strip())
        if _DECIMAL_COMMA.fullmatch(value.strip()):
            return super().convert(value, param, ctx)
        if match is None:
            self.fail(f"{value} is no width: give millimetres, such as 85, or 8.5cm, 3.5in", param, ctx)
        return super().convert(float(match[1]) * _MILLIMETRES[(match[2] or "mm").lower()], param, ctx)


ABSOLUTE_TOLERANCE = Finite(0, 1, min_open=True, max_open=True)
RELATIVE_TOLERANCE = Finite(1e-14, 1, max_open=True)  # `model.time_checks.FINEST`
