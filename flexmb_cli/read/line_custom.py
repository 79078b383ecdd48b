"""The custom of one record a line, and the lines that seem to break it by a lost or surplus number.

YOUNG decks are free format, so a lost zero shifts every later number.  When a deck keeps the custom
almost everywhere, a line that holds neither its record nor a fair part of one is the likely slip.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, islice

from ..errors import Fault, Place
from .card import LONGEST_CARET, Word


def slips(read_words: Sequence[Word], records: Sequence[tuple[str, int]]) -> tuple[Fault, ...]:
    """Warnings for the lines that seem to have lost or gained numbers.

    `records` are (subject, numbers needed) in the deck's order.  Lines and records are walked side by
    side.  A line that fits no record is a slip when the line after it fits the next record again and
    the custom is kept more often than broken; a deck wrapped at some width satisfies neither.
    """
    lines = list(Counter(word.line for word in read_words).items())
    slipped, fitting = _walk([held for _, held in lines], [needed for _, needed in records])
    if not slipped or len(slipped) > fitting:
        return ()
    spans = _spans(read_words)
    return tuple(_warning(spans, *lines[line], *records[record]) for line, record in slipped)


def with_slip_named(faults: Sequence[Fault], slipped: Sequence[Fault]) -> list[Fault]:
    """`faults`, the first error at or after a slip saying that the slip may be its cause."""
    if not slipped:
        return list(faults)
    cause = slipped[0]
    named = list(faults)
    for index, fault in enumerate(named):
        if fault.severity == "error" and _may_follow(fault, cause):
            message = (
                f"{fault.message} (look first at line {cause.place.line}: {cause.subject} {cause.message})"
            )
            named[index] = replace(fault, message=message)
            break
    return named


def _walk(held, needed):
    """Pairs (line, record) that do not fit, all but those at the very end, and how many records do."""
    line = record = fitting = 0
    slipped, unconfirmed = [], []
    while line < len(held) and record < len(needed):
        step = _step(held, needed, line, record)
        if step:
            slipped, unconfirmed = slipped + unconfirmed, []
            fitting += step[1]
        else:
            unconfirmed.append((line, record))
            if len(slipped) + len(unconfirmed) > fitting + 1:
                return [], 0
        lines, records = step or (1, 1)
        line, record = line + lines, record + records
    return slipped, fitting


def _step(held, needed, line, record):
    """How many (lines, records) go together from here: one and one, or one broken, or several joined."""
    here, wanted = held[line], needed[record]
    if here == wanted or (here > wanted and record == len(needed) - 1):
        return 1, 1
    if here < wanted:
        lines = _reach(held, line, wanted)
        return lines and (lines, 1)
    records = _reach(needed, record, here)
    return records and (1, records)


def _reach(sizes, start, total):
    """How many of `sizes` from `start` on add up to `total`; 0 when none do."""
    for count, reached in enumerate(accumulate(islice(sizes, start, None)), start=1):
        if reached >= total:
            return count if reached == total else 0
    return 0


def _spans(read_words):
    spans = {}
    for word in read_words:
        first = spans.setdefault(word.line, (word.column, 0))[0]
        spans[word.line] = first, word.column + len(word.text) - first
    return spans


def _warning(spans, line, held, subject, needed):
    column, width = spans[line]
    place = Place(line, column, min(width, 2 * LONGEST_CARET))
    return Fault("warning", f"needs {needed} numbers; line {line} has {held}", place, subject)


def _may_follow(fault, cause):
    return fault.place is None or fault.subject == "counts" or fault.place.line >= cause.place.line
