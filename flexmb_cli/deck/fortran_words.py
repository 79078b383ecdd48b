"""The fields of a printed line: separated by blanks, or by their columns where they touch.

A field that is just full touches its left neighbour, and an overfull one is stars, so that a historic line
keeps its columns; flexmb's own lines keep a blank between fields and may lose their columns instead.
A number of which a typist could not read every digit holds question marks in their places, or is just one.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

from .edit import Edit

# Python makes no integer of thousands of digits; digits that only one part of a pattern can take are
# tried once, however many a damaged word has.
_FIXED = r"[-+]?(\d+(\.\d*)?|\.\d+)"
UNREADABLE = r"[-+.\d]*\?[-+.\d?ED]*"
_NO_NUMBER = rf"\*+|{UNREADABLE}|[-+]?(nan|inf(inity)?)"
_WORDS = {
    "d": re.compile(rf"[-+]?\d{{1,99}}|\*+|{UNREADABLE}"),
    "f": re.compile(rf"{_FIXED}|{_NO_NUMBER}", re.IGNORECASE | re.ASCII),
    "e": re.compile(rf"{_FIXED}(([ed][-+]?|[-+])\d{{1,9}})?|{_NO_NUMBER}", re.IGNORECASE | re.ASCII),
}
_WORDS["E"] = _WORDS["e"]
_BARE_EXPONENT = re.compile(r"([\d.])([-+]\d+)$")


def split_fields(text: str, edits: Sequence[Edit]) -> list[str] | None:
    """Spellings of the fields `edits`, which fill `text` from its first column; None when they do not."""
    words = text.split()
    if len(words) == len(edits) and all(map(_is_word, words, edits)):
        return words
    columns = _columns(text, edits)
    return columns if columns and len(columns) == len(edits) else None


def split_list(text: str, edit: Edit) -> list[str] | None:
    """Spellings of a list of any length under one edit; None when `text` is none."""
    words = text.split()
    columns = _columns(text, [edit] * (len(text.rstrip()) // edit.width))
    good = all(_is_word(word, edit) for word in words)
    return columns if columns and (not good or len(columns) > len(words)) else words if good else None


def value_of(word: str) -> float:
    """Number of a field; stars stand for a number too large for it: inf.  nan: it was unreadable."""
    if word.startswith("*"):
        return float("inf")
    if is_unreadable(word):
        return float("nan")
    return float(_BARE_EXPONENT.sub(r"\1E\2", word.upper().replace("D", "E")))


def unit_of(word: str) -> float:
    """One unit of the last printed digit; 1 where there are no digits, nan where a digit is unreadable."""
    if is_unreadable(word):
        return float("nan")
    mantissa, _, exponent = _BARE_EXPONENT.sub(r"\1E\2", word.upper().replace("D", "E")).partition("E")
    decimals = len(mantissa.partition(".")[2]) if mantissa[-1:].isdigit() or mantissa.endswith(".") else 0
    return float(f"1e{int(exponent or 0) - decimals}")


def is_unreadable(word: str) -> bool:
    """Return whether a question mark stands for a digit, or for the number."""
    return "?" in word


def overflows(value: float, edit: Edit) -> bool:
    """Return whether a number prints as stars."""
    text = replace(edit, stars=False).text(value, separated=False)
    return len(text.strip()) > edit.width


def _columns(text: str, edits: Sequence[Edit]) -> list[str] | None:
    """The fields by their columns, when each is right-justified there and nothing is left over."""
    words, start = [], 0
    text = text.rstrip()
    for edit in edits:
        field = text[start : start + edit.width]
        word = field.lstrip()
        if len(field) != edit.width or not _is_word(word, edit):
            return None
        words.append(word)
        start += edit.width
    return words if start == len(text) else None


def _is_word(word: str, edit: Edit) -> bool:
    return bool(_WORDS[edit.kind].fullmatch(word))
