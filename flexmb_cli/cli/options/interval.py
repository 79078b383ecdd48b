"""Two numbers of an option: LOW,HIGH."""

import math
from typing import Any

import click


# Generic in click's newer versions only, and 8.2 will do.
class Interval(click.ParamType):  # type: ignore[type-arg]
    """Two finite numbers, the first smaller than the second."""

    name = "interval"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Return both numbers."""
        if isinstance(value, tuple):
            return value
        parts = value.split(",")
        try:
            low, high = map(float, parts)
        except ValueError:
            self.fail(f"{value!r}: two numbers are wanted, such as 0,1e8", param, ctx)
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            self.fail(f"{value!r}: the first number must be smaller than the second", param, ctx)
        return low, high
