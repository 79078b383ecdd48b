"""Times of tables at which steps end, and two of them that are too near to each other."""

from collections.abc import Iterable, Iterator
from itertools import pairwise

SAME_TIME_IN_RUN = 1e-12  # of a run: times this near to each other are one
JUMP_WITHIN = 1e-6  # of a time: points of a table nearer to each other may be too near for steps


def times_between(times: Iterable[float], start: float, end: float) -> list[float]:
    """Return the times inside (start, end), s, those that are as good as one once."""
    apart, times_there = SAME_TIME_IN_RUN * max(abs(start), abs(end)), [start]
    for t in sorted(set(times)):
        # A step between two numbers for one time would be shorter than any can be.
        if times_there[-1] + apart < t < end - apart:
            times_there.append(t)
    return times_there[1:]


def jump_at(tables: Iterable[Iterable[float]], t: float) -> str:
    """Return that a function changes near t, s, between two times as good as one; "" where none does."""
    near = JUMP_WITHIN * max(abs(t), 1.0)
    return next((_jump(*pair) for pair in _closer(tables, near) if pair[0] - near <= t <= pair[1] + near), "")


def jump_within_no_time(tables: Iterable[Iterable[float]], end: float) -> str:
    """Return that a function of a run to `end`, s, jumps between two times that count as one; else ""."""
    return next((_jump(*pair) for pair in _closer(tables, SAME_TIME_IN_RUN * max(abs(end), 1.0))), "")


def _closer(tables: Iterable[Iterable[float]], near: float) -> Iterator[tuple[float, float]]:
    return (pair for times in tables for pair in pairwise(times) if 0.0 < pair[1] - pair[0] < near)


def _jump(before: float, after: float) -> str:
    return (
        f"a function changes between {before!r} and {after!r} s; of a driver's rate that is a jump, an "
        f"impulse, which no steps resolve: move these two times apart, by "
        f"{JUMP_WITHIN * max(abs(before), 1.0):.0e} s or more, or use STEP"
    )
