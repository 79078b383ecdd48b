"""FORTRAN formatted input: a card is cut by column, never by white space, and its fields decoded.

Rules of FORTRAN 77 (ANSI X3.9-1978, 13.5) with blanks ignored in numbers: a blank field is zero, a
field without a decimal point has it `d` digits from its right end, an exponent may be E, D or a bare
sign, a short line is as if padded with blanks, a list longer than the FORMAT continues on the next line.
"""

import re
from dataclasses import dataclass
from functools import lru_cache

from .number import unit_hint

_EDIT = re.compile(r"(\d*)([IFE])(\d+)(?:\.(\d+))?")
_PLAIN = re.compile(r"[+-]?(?:[0-9]+\.[0-9]*|\.[0-9]+)")
_INTEGER = re.compile(r"[+-]?[0-9]+")
_REAL = re.compile(r"([+-]?)([0-9]*)(\.?)([0-9]*)(?:[ED]?([+-][0-9]+)|[ED]([0-9]+))?", re.IGNORECASE)


@dataclass(frozen=True)
class Edit:
    """One field of a FORMAT: its letter (I, F or E), width, decimals, first and last column."""

    letter: str
    width: int
    decimals: int
    column: int
    last: int

    @property
    def descriptor(self) -> str:
        """The edit descriptor as FORTRAN writes it."""
        return f"I{self.width}" if self.letter == "I" else f"{self.letter}{self.width}.{self.decimals}"

    @property
    def picture(self) -> str:
        """The field drawn in its own columns: [F10.5---]."""
        return "[" + self.descriptor[: self.width - 2].ljust(self.width - 2, "-") + "]"


@dataclass(frozen=True)
class Format:
    """A FORMAT: its text without brackets and its fields from column 1 on."""

    text: str
    edits: tuple[Edit, ...]

    def guide(self, fields: int) -> tuple[str, str]:
        """Two lines to set above a card: its first `fields` fields and a ruler of their columns."""
        width = self.edits[fields - 1].last
        ruler = "".join(f"----+----{tens}" for tens in range(1, width // 10 + 2))
        return "".join(edit.picture for edit in self.edits[:fields]), ruler[:width]


@lru_cache
def fortran_format(text: str) -> Format:
    """The FORMAT written as `text`, a list such as "I5,3F10.5"."""
    edits, column = [], 1
    for part in text.split(","):
        match = _EDIT.fullmatch(part)
        assert match is not None, part
        repeat, letter, width, decimals = match.groups()
        for _ in range(int(repeat or 1)):
            last = column + int(width) - 1
            edits.append(Edit(letter, int(width), int(decimals or 0), column, last))
            column = last + 1
    return Format(text, tuple(edits))


class Field:
    """Content of the columns of one edit descriptor.

    `raw` has the field's width; `spelled` is it without the blanks around; `column` is that of the
    first character that is not blank, the field's first when all are.
    """

    __slots__ = ("column", "edit", "raw", "spelled")

    def __init__(self, edit: Edit, raw: str):
        self.edit = edit
        self.raw = raw
        self.spelled = raw.strip(" ")
        self.column = edit.column + (len(raw) - len(raw.lstrip(" ")) if self.spelled else 0)

    @property
    def span(self) -> str:
        """Return where the field stands, in words."""
        first, last = self.edit.column, self.edit.last
        return f"column {first}" if first == last else f"columns {first}-{last}"

    def value(self) -> int | float | None:
        """The number read, or None when the field holds none."""
        if self.edit.letter != "I" and _PLAIN.fullmatch(self.spelled):
            return float(self.spelled)
        digits = self.raw.replace(" ", "")
        if not digits:
            return 0 if self.edit.letter == "I" else 0.0
        if self.edit.letter == "I":
            return int(digits) if _INTEGER.fullmatch(digits) else None
        return _real(digits, self.edit.decimals)

    @property
    def implied_point(self) -> bool:
        """Return whether digits were read with the decimal point that the FORMAT implies."""
        if self.edit.letter == "I" or "." in self.spelled:
            return False
        return bool(re.split("[EeDd]", self.spelled)[0].strip("+-0 "))


def cut(line: str, edit: Edit) -> Field:
    """The field of `line` that `edit` prescribes; beyond the line's end there are blanks."""
    return Field(edit, line[edit.column - 1 : edit.last].ljust(edit.width))


def _real(digits: str, decimals: int) -> float | None:
    match = _REAL.fullmatch(digits)
    if match is None or not (match[2] or match[4]):
        return None
    sign, whole, point, fraction, signed, plain = match.groups()
    exponent = int(signed or plain or 0)
    if not point:
        exponent -= decimals
    value = float(f"{sign}{whole or 0}.{fraction or 0}E{exponent}")
    return None if value in (float("inf"), float("-inf")) else value


def hint(field: Field, line: str) -> str:
    """Return the probable cause of a field without a number, as a question or a rule; "" if unknown."""
    text = field.raw
    if "\t" in text:
        return "a tab counts as one column: use blanks"
    if "," in text:
        return "a comma ends no field: cards are cut by column"
    if _crosses_edge(field, line):
        return "the number runs over the edge of its field"
    if re.search("[Oo]", text) and re.fullmatch(r"[-+0-9.OoEeDd ]+", text):
        return "letter O instead of zero?"
    if re.search("[lI]", text) and re.fullmatch(r"[-+0-9.lIEeDd ]+", text):
        return "letter l or I instead of one?"
    if field.edit.letter == "I" and _real(text.replace(" ", ""), 0) is not None:
        return "write it without point and exponent"
    if len(text.split()) > 1:
        return "two numbers in one field?"
    return unit_hint(text.strip())


def _crosses_edge(field: Field, line: str) -> bool:
    """Return whether a word lies over the field's left or right edge without filling the field."""
    before = line[field.edit.column - 2 : field.edit.column - 1] if field.edit.column > 1 else ""
    after = line[field.edit.last : field.edit.last + 1]
    left = before.strip() and field.raw[0] != " "
    right = after.strip() and field.raw[-1] != " "
    return bool(left or right) and " " in field.raw
