"""Splines through the rows of a result as cards of a VSDF deck."""

from collections.abc import Sequence
from typing import Any


def spline_cards(functions: Sequence[tuple[int, str, list[Any]]]) -> str:
    """Return cards of functions, each a number, a heading and points (time, value)."""
    return "".join(
        f"* {heading}\nFUNC\n {number},SPLI," + ",".join(f"{t!r},{v!r}" for t, v in points) + "\n"
        for number, heading, points in functions
    )
