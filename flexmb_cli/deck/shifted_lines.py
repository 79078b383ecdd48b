"""Lines of decks of one record a line that seem shifted by a lost or surplus number.

YOUNG decks are free format, so a lost zero shifts every later number.  When a deck has one record a line
almost everywhere, a line that holds neither its record nor a fair part of one is the likely slip.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..errors import Fault, Place
from .words import LONGEST_CARET, Word

KEPT_PER_SLIP = 2
FEWEST_LINES = 4  # fewer may be a deck of few, long lines rather than one with a line lost
MOST_NAMED = 4


def slips(
    read_words: Sequence[Word], records: Sequence[tuple[str, int]], kept_per_slip: int = KEPT_PER_SLIP
) -> tuple[Fault, ...]:
    """Warnings for the lines that seem to have lost or gained numbers.

    `records` are (subject, numbers needed) in the deck's order.  Lines and records are walked side by
    side.  A line that fits no record is a slip when the line after it fits the next record again and
    at least `kept_per_slip` lines hold one record for each that does not; a deck wrapped at some
    width seldom satisfies either.
    """
    lines = list(Counter(word.line for word in read_words).items())
    held, needed = [held for _, held in lines], [needed for _, needed in records]
    if lost := _lost_line(held, needed):
        first, last = lost
        names = _one_of([subject for subject, _ in records[first : last + 1]])
        slip = _warning(_extents(read_words), *lines[last], *records[last])
        return (replace(slip, message=f"{slip.message}: the line of {names} seems to be missing"),)
    slipped = _walk(held, needed, kept_per_slip)
    if not slipped:
        return ()
    extents = _extents(read_words)
    return tuple(_warning(extents, *lines[line], *records[record]) for line, record in slipped)


def with_slip_named(faults: Sequence[Fault], slipped: Sequence[Fault]) -> list[Fault]:
    """`faults`, the first error at or after a slip saying that the slip may be its cause."""
    if not slipped:
        return list(faults)
    cause = slipped[0]
    named = list(faults)
    for index, fault in enumerate(named):
        if fault.severity == "error" and _may_follow(fault, cause):
            assert cause.place is not None, "a slip is of a line"
            line = cause.place.line
            message = f"{fault.message} (look first at line {line}: {cause.subject} {cause.message})"
            named[index] = replace(fault, message=message)
            break
    return named


def _lost_line(held: list[int], needed: list[int]) -> tuple[int, int] | None:
    """Return the first and the last record that a lost line may have held, all of one size; None for none.

    Every other line then holds one record.  The line at the place of the last one is the first that does
    not fit.
    """
    if len(held) != len(needed) - 1 or len(held) < FEWEST_LINES:
        return None
    last = 0
    while last < len(held) and held[last] == needed[last]:
        last += 1
    if last == len(held) or held[-1] < needed[-1] or held[last:-1] != needed[last + 1 : -1]:
        return None
    first = last
    while first and needed[first - 1] == needed[last]:
        first -= 1
    return first, last


def _one_of(subjects: list[str]) -> str:
    """Return subjects as a choice, of many the first and the last."""
    if len(subjects) > MOST_NAMED:
        return f"one of {subjects[0]} to {subjects[-1]}"
    return " or ".join(filter(None, [", ".join(subjects[:-1]), subjects[-1]]))


def _walk(held: list[int], needed: list[int], kept_per_slip: int) -> list[tuple[int, int]]:
    """Pairs (line, record) that fit neither alone nor together with their neighbours, none when in doubt."""
    line = record = fitting = 0
    slipped: list[tuple[int, int]] = []
    unconfirmed: list[tuple[int, int]] = []
    while line < len(held) and record < len(needed):
        lines, records = _step(held, needed, line, record)
        if lines:
            slipped += unconfirmed
            unconfirmed = []
            fitting += lines == records == 1
        else:
            unconfirmed.append((line, record))
            lines = records = 1
        line, record = line + lines, record + records
    return slipped if kept_per_slip * len(slipped + unconfirmed) <= fitting else []


def _step(held: list[int], needed: list[int], line: int, record: int) -> tuple[int, int]:
    """Return the numbers of lines and records that go together from here; 0, 0 if none do."""
    here, need = held[line], needed[record]
    if here == need or (here > need and record == len(needed) - 1):
        return 1, 1
    if here < need:
        lines = _reach(held, line, need)
        return (lines, 1) if lines else (0, 0)
    records = _reach(needed, record, here)
    return (1, records) if records else (0, 0)


def _reach(sizes: list[int], start: int, total: int) -> int:
    """Return how many of `sizes` from `start` on add up to `total`; 0 when none do."""
    reached = 0
    # By places: a slice would walk through all that lies before `start`.
    for place in range(start, len(sizes)):
        reached += sizes[place]
        if reached >= total:
            return place - start + 1 if reached == total else 0
    return 0


def _extents(read_words: Sequence[Word]) -> dict[int, tuple[int, int]]:
    extents: dict[Any, Any] = {}
    for word in read_words:
        first = extents.setdefault(word.line, (word.column, 0))[0]
        extents[word.line] = first, word.column + len(word.text) - first
    return extents


def _warning(extents: dict[int, tuple[int, int]], line: int, held: int, subject: str, needed: int) -> Fault:
    column, width = extents[line]
    place = Place(line, column, min(width, 2 * LONGEST_CARET))
    return Fault("warning", f"needs {needed} numbers; line {line} has {held}", place, subject, id="DECK-008")


def _may_follow(fault: Any, cause: Any) -> bool:
    return fault.place is None or fault.subject == "counts" or fault.place.line >= cause.place.line
