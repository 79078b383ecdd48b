"""Lines of numbers in YOUNG's OUT tables: fields that run together, units of the last digits, faults."""

import re
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.number import hint
from ...deck.table_columns import OLD_DECIMALS, Columns
from ...errors import Fault, Place

if TYPE_CHECKING:
    from collections.abc import Sequence


INDEX = re.compile(r"\s*\d+(?=\s|$)")
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?|[-+]?(nan|inf)", re.IGNORECASE | re.ASCII)


def split_index(text: str) -> tuple[int, str, int]:
    """Number of the body or point (three columns wide), the rest of the line, and where that begins."""
    head = INDEX.match(text)
    end = head.end() if head else 3
    digits = text[:end].strip()
    is_number = digits.isdecimal() and digits.isascii() and len(digits) <= 9
    return (int(digits) if is_number else 0), text[end:], end


def split_row(rest: str, columns: Columns) -> "Sequence[Any] | None":
    """Spellings of the numbers of a line, separated by blanks or else by the decimals of their columns."""
    words = rest.split()
    if len(words) == len(columns.names) and all(NUMBER.fullmatch(word) for word in words):
        return words
    for decimals in (columns.decimals, len(columns.decimals) * (OLD_DECIMALS,)):
        match = _pattern(decimals).fullmatch(rest)
        if match:
            return match.groups()
    return None


def is_row_of(columns: Any, line: str) -> Any:
    """Return whether a line reads as a body or point and its numbers."""
    index, rest, _ = split_index(line)
    return index > 0 and split_row(rest, columns) is not None


@lru_cache(maxsize=64)
def _pattern(decimals: tuple[int, ...]) -> re.Pattern[str]:
    number = r"\s*([-+]?\d*\.\d{%d}|[-+]?nan|[-+]?inf)"
    return re.compile("".join(number % count for count in decimals) + r"\s*")


def row_fault(key: str, index: int, rest: str, number: int, offset: int, columns: Columns) -> Fault:
    """Fault of a line that does not have the numbers of its columns; `rest` of it begins at `offset`."""
    words = list(re.finditer(r"\S+", rest))
    bad = next((word for word in words if not NUMBER.fullmatch(word[0])), None)
    shown = bad or (words[0] if words else None)
    place = Place(number, offset + (shown.start() if shown else 0) + 1, len(shown[0]) if shown else 1)
    wanted = f"{len(columns.names)} numbers are expected ({columns.names[0]} … {columns.names[-1]})"
    read = f"{bad[0]!r} is no number of this table{hint(bad[0])}" if bad else f"{len(words)} are there"
    return Fault("error", f"{wanted}, {read}", place, f"{key} of {columns.item} {index}", id="YOUNG-031")


def units_of(text: str, columns: Columns) -> np.ndarray:
    """Units of the last digits (columns,) as a line prints them, else as the layout does."""
    words = split_row(split_index(text)[1], columns)
    if words is None:
        return 10.0 ** -np.array(columns.decimals)
    return np.array([unit_of(word) for word in words])


def unit_of(word: str) -> float:
    """One unit of the last digit of a number in fixed-point notation."""
    return float(f"1e-{len(word.partition('.')[2])}")


def echo_numbers(line: str) -> "tuple[tuple[Any, ...], tuple[Any, ...]] | None":
    """Values and units of a line of numbers; None when the line is text.  Echoes print two decimals."""
    if not re.fullmatch(r"[-+.\d\s]*\d[-+.\d\s]*", line):
        return None
    words = re.findall(r"[-+]?\d*\.\d\d|[-+]?\d+(?![.\d])", line)
    if "".join(words) != "".join(line.split()):
        words = line.split()
    if not all(NUMBER.fullmatch(word) for word in words):
        return None
    return tuple(map(float, words)), tuple(map(unit_of, words))
