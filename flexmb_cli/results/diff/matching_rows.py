"""Rows and lines that two tables share."""

from typing import Any

import numpy as np

from ...deck.listing import Listing
from .report import Report


def matching_rows(report: Report, a: Listing, b: Listing) -> tuple[np.ndarray, np.ndarray]:
    """Row numbers of `a` and `b` that belong together: all in order, or by time when their numbers differ."""
    if len(a.time) == len(b.time):
        rows = np.arange(len(a.time))
        return rows, rows
    rows_a, rows_b = common_places(_occurrences(a.time), _occurrences(b.time))
    for listing, other, rows in ((a, b, rows_a), (b, a, rows_b)):
        alone = np.setdiff1d(np.arange(len(listing.time)), rows)
        if alone.size:
            times = few([f"{listing.time[row]:.10g}" for row in alone])
            count = counted(alone.size, "row")
            report.missing.append(
                f"{count} of {listing.name} {are(alone.size)} not in {other.name}: t = {times}"
            )
    return rows_a, rows_b


def _occurrences(time: np.ndarray) -> list[tuple[float, int]]:
    """Pairs (time, how often it came before), since three decimals print several rows alike."""
    seen: dict[float, int] = {}
    pairs = []
    for value in time.tolist():
        seen[value] = seen.get(value, -1) + 1
        pairs.append((value, seen[value]))
    return pairs


def common_places(keys_a: "list[Any]", keys_b: "list[Any]") -> tuple[Any, ...]:
    """Positions of the keys that both lists have, in the order of the first."""
    place = {key: row for row, key in enumerate(keys_b)}
    rows = [(row, place[key]) for row, key in enumerate(keys_a) if key in place]
    return tuple(
        np.array(column, dtype=np.int64) for column in (zip(*rows, strict=True) if rows else ((), ()))
    )


def counted(number: int, thing: str) -> str:
    """Return "1 row", "2 rows"."""
    return f"{number} {thing}{'s' * (number != 1)}"


def are(number: int) -> str:
    """Return the verb for a number of things."""
    return "is" if number == 1 else "are"


def few(words: list[str], most: int = 3) -> str:
    """Return the first words, and how many more there are."""
    return ", ".join(words[:most]) + (f" and {len(words) - most} more" if len(words) > most else "")
