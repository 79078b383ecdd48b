"""Splines through the rows of a result as cards of a YOUNG deck."""

from collections.abc import Sequence
from typing import Any


def spline_cards(functions: Sequence[tuple[int, str, list[Any]]]) -> str:
    """Return cards of functions, each a number, a heading and points (time, value)."""
    return "".join(
        f"{{ {heading} }}\nSPLINE {number}\n" + "".join(f"{t!r} {v!r}\n" for t, v in points)
        for number, heading, points in functions
    )
