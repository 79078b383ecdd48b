"""Recognition of DAFMS decks by their first lines."""

from collections.abc import Sequence
from itertools import islice

_MACROS = ("DFMB", "STAR", "STOP")


def begins_dafms(lines: Sequence[str]) -> bool:
    """A line of integers, and a macro among the next cards."""
    # Cards before the first macro are skipped by the historic program, but they are never many.
    # Blank lines stand in the place of a deck's other models.
    beginning = islice((line for line in islice(lines, 1, None) if line.strip()), 19)
    macro = any(line[:4].upper() in _MACROS for line in beginning)
    return macro and not lines[0].strip(" 0123456789+-")
