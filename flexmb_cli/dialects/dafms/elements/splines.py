"""Splines through the rows of a result as a card of FMBD.DAT."""

from collections.abc import Sequence
from typing import Any

SPLINE = 2  # code of the card FUNC
ON_A_RECORD = 4


def spline_cards(functions: Sequence[tuple[int, str, list[Any]]]) -> str:
    """Return cards of functions, each a number, a heading and points (time, value)."""
    lines = ["FUNC", f"{len(functions):5d}"]
    for number, _, points in functions:
        values = [x for point in points for x in point]
        lines.append(f"{number:5d}{SPLINE:5d}{len(values):5d}")
        for first in range(0, len(values), ON_A_RECORD):
            lines.append("".join(f"{x:20.12E}" for x in values[first : first + ON_A_RECORD]))
    return "\n".join(lines) + "\n"
