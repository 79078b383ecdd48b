"""Lines of numbers in YOUNG's OUT tables: fields that run together, units of the last digits, faults."""

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ...deck.fortran_format import fixed
from ...deck.fortran_words import UNREADABLE, unit_of, value_of
from ...deck.listing import EchoLine, Section
from ...deck.number import hint
from ...deck.table_columns import OLD_DECIMALS, SECTIONS, Columns
from ...errors import Fault, Place

INDEX = re.compile(r"\s*\d+(?=\s|$)")
NUMBER = re.compile(
    rf"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?|[-+]?(nan|inf)|\*+|{UNREADABLE}", re.IGNORECASE | re.ASCII
)
# A number of the echo; its widths are those of the answers, its stars show the width themselves.
_ECHO_LINE = re.compile(r"[-+.\d?*\s]*[\d?][-+.\d?*\s]*")
_ECHO_DECIMALS = 2
MOST_REPEATED_ITEMS = 20  # faults
INDEX_WIDTH = 3  # columns of the number of a body or point


def split_index(text: str) -> tuple[int, str, int]:
    """Number of the body or point (three columns wide), the rest of the line, and where that begins."""
    head = INDEX.match(text)
    end = head.end() if head else 3
    digits = text[:end].strip()
    is_number = digits.isdecimal() and digits.isascii() and len(digits) <= 9
    return (int(digits) if is_number else 0), text[end:], end


def split_row(rest: str, columns: Columns) -> Sequence[Any] | None:
    """Spellings of the numbers of a line, separated by blanks or else by the decimals of their columns."""
    words = rest.split()
    if len(words) == len(columns.names) and all(NUMBER.fullmatch(word) for word in words):
        return words
    for decimals in (columns.decimals, len(columns.decimals) * (OLD_DECIMALS,)):
        match = _pattern(decimals, columns.width).fullmatch(rest)
        if match:
            return match.groups()
    return None


def is_row_of(columns: Columns, line: str) -> Any:
    """Return whether a line reads as a body or point and its numbers."""
    index, rest, _ = split_index(line)
    return index > 0 and split_row(rest, columns) is not None


@lru_cache(maxsize=64)
def _pattern(decimals: tuple[int, ...], width: int) -> re.Pattern[str]:
    # Stars of one field are as many as it is wide; "?++" takes all question marks and gives none back.
    number = r"\s*([-+]?[\d?]*\.[\d?]{%d}|[-+]?nan|[-+]?inf|\*{%d}|\?++)"
    return re.compile("".join(number % (count, width) for count in decimals) + r"\s*")


def row_fault(key: str, index: int, rest: str, number: int, offset: int, columns: Columns) -> Fault:
    """Fault of a line that does not have the numbers of its columns; `rest` of it begins at `offset`."""
    words = list(re.finditer(r"\S+", rest))
    bad = next((word for word in words if not NUMBER.fullmatch(word[0])), None)
    shown = bad or (words[0] if words else None)
    place = Place(number, offset + (shown.start() if shown else 0) + 1, len(shown[0]) if shown else 1)
    wanted = f"{len(columns.names)} numbers are expected ({columns.names[0]} … {columns.names[-1]})"
    there = f"{len(words)} are there{_other_block(len(words), columns)}"
    read = f"{bad[0]!r} is no number of this table{hint(bad[0])}" if bad else there
    return Fault("error", f"{wanted}, {read}", place, f"{key} of {columns.item} {index}", id="YOUNG-031")


def _other_block(words: int, columns: Columns) -> str:
    """Return which blocks have lines of so many numbers: the heading of one may be missing."""
    names = [key for key, one in SECTIONS.items() if one.item == columns.item and len(one.names) == words]
    return f", as many as of {' or '.join(names)}: is a heading missing above?" if names else ""


def repeated_items(key: str, section: Section) -> list[Fault]:
    """Return the faults of bodies or points that stand twice in the block of one report row."""
    _, first = np.unique(np.stack([section.step, section.index]), axis=1, return_index=True)
    faults = []
    for row in np.setdiff1d(np.arange(len(section.index)), first)[:MOST_REPEATED_ITEMS].tolist():
        message = f"{section.name_of(row)} stands twice in this block: is it another one?"
        place = Place(int(section.line[row]), 1, INDEX_WIDTH)
        faults.append(Fault("error", message, place, key, id="YOUNG-083"))
    return faults


def echo_numbers(number: int, title: str, line: str) -> EchoLine | None:
    """The line `number` of numbers below `title`; None when the line is text.  Echoes print two decimals."""
    if not _ECHO_LINE.fullmatch(line):
        return None
    words = re.findall(r"[-+]?\d*\.\d\d|[-+]?\d+(?![.\d])", line)
    if "".join(words) != "".join(line.split()):
        words = line.split()
    if not all(NUMBER.fullmatch(word) for word in words):
        return None
    edits = tuple(fixed(len(word), _ECHO_DECIMALS) for word in words) if "*" in line else ()
    values, units = tuple(map(value_of, words)), tuple(map(unit_of, words))
    return EchoLine(number, title, values, units, edits=edits)
