"""Numbers as FORTRAN and Pascal programs print them: Iw, Fw.d, Ew.d and Pascal's `x:w:d`.

Two layouts.  "safe": a number that rounds to zero never prints a minus sign, and a field that is full
widens, so that at least one blank keeps it from its left neighbour.  "historic": signs of zero are
kept, and a full field does what the old compilers did: Pascal's runs into its neighbour, FORTRAN's
prints stars.  The two give the same bytes wherever a field has room.
"""

import math
from dataclasses import dataclass
from functools import cache
from itertools import chain
from typing import Any

import numpy as np

from .pictures.field_columns import MOST_DECIMALS, picture, runs_of

SAFE, HISTORIC = "safe", "historic"
LAYOUTS = (SAFE, HISTORIC)
NUMBERS_A_PICTURE = 2**17  # of which a picture is made
NUMBERS_A_KIND = 400  # for fewer in equal fields, a picture does not repay
NUMBERS_A_RUN = 40  # the same for fewer in a run of fields


@dataclass(frozen=True)
class Edit:
    """One field: `kind` "d" (integer), "f" (fixed point), "e" (FORTRAN's 0.ddddE+ee) or "E" (d.ddddE+ee).

    `stars`: in the historic layout a number that does not fit prints as stars (FORTRAN), instead of
    widening its field (Pascal).
    """

    kind: str
    width: int
    decimals: int = 0
    stars: bool = False

    def text(self, value: float, layout: str = SAFE, separated: bool = True) -> str:
        """The field's characters; `separated`: the safe layout puts a blank in front of a full field."""
        text = self._digits(value, layout)
        if layout == HISTORIC and self.stars and len(text) > self.width:
            return "*" * self.width
        if layout == SAFE and separated:
            text = " " + text
        return text.rjust(self.width)

    def _digits(self, value: float, layout: str) -> str:
        if self.kind == "d":
            return str(int(value))
        if layout == SAFE and abs(value) <= self.zero_limit:
            value = 0.0
        if self.kind == "f" or not math.isfinite(value):
            return f"{value:.{self.decimals}f}"
        if self.kind == "E":
            return f"{value:.{self.decimals}E}"
        return _exponent_form(value, self.decimals)

    @property
    def zero_limit(self) -> float:
        """Largest magnitude that prints as zero."""
        return rounds_to_zero(self.decimals) if self.kind == "f" else 0.0


def I(width: int) -> Edit:  # noqa: E743
    """FORTRAN Iw."""
    return Edit("d", width, stars=True)


def F(width: int, decimals: int) -> Edit:
    """FORTRAN Fw.d."""
    return Edit("f", width, decimals, stars=True)


def E(width: int, decimals: int) -> Edit:
    """FORTRAN Ew.d without a scale factor: a zero stands before the point."""
    return Edit("e", width, decimals, stars=True)


def P(width: int, decimals: int) -> Edit:
    """FORTRAN 1PEw.d: a digit that is not zero stands before the point."""
    return Edit("E", width, decimals, stars=True)


def integer(width: int) -> Edit:
    """Pascal `i:w`; width 0 is `i` alone."""
    return Edit("d", width)


def fixed(width: int, decimals: int) -> Edit:
    """Pascal `x:w:d`."""
    return Edit("f", width, decimals)


@cache
def rounds_to_zero(decimals: int) -> float:
    """Largest double that prints as zero with `decimals` decimals."""
    half = float(f"5e-{decimals + 1}")
    # The double next to 0.0005 may lie on either side of it; the printed digits are correctly rounded.
    return half if float(f"{half:.{decimals}f}") == 0.0 else math.nextafter(half, 0.0)


def _exponent_form(value: float, digits: int) -> str:
    """Return 0.ddddE+ee of a finite number."""
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    figures = mantissa.replace(".", "")
    head = f"-0.{figures[1:]}" if figures[0] == "-" else f"0.{figures}"
    return head + (_raised(int(exponent) + 1) if value else "E+00")


def _raised(power: int) -> str:
    """Return a power of ten as FORTRAN prints it: it gives up the letter, not a digit, for three figures."""
    return f"E{power:+03d}" if abs(power) < 100 else f"{power:+04d}"


class Layout:
    """A piece of a listing: literal text and fields in the order of the page.

    `parts` are strings (line ends included) and `Edit`s; `lines` prints the piece once for every row
    of values.
    """

    def __init__(self, *parts: Any, layout: str = SAFE):
        if layout not in LAYOUTS:
            raise ValueError(f"layout must be one of {LAYOUTS}, not {layout!r}")
        self.layout = layout
        self.fields = tuple(part for part in parts if isinstance(part, Edit))
        self._separated = _separated(parts)
        self._runs = runs_of(parts, self._separated)
        self._least = max(NUMBERS_A_KIND * len(set(self.fields)), NUMBERS_A_RUN * len(self._runs))
        self._as_text = [self._needs_text(field) for field in self.fields]
        self._template = self._percent_template(parts)
        self._limits = np.array([field.zero_limit for field in self.fields])
        decimals = max((field.decimals for field in self.fields), default=0)
        self._has_pictures = layout == SAFE and decimals < MOST_DECIMALS

    def lines(self, values: list[Any] | np.ndarray) -> str:
        """Text of the piece for `values`, shape (rows, fields) or (fields,)."""
        values = np.atleast_2d(np.asarray(values, dtype=float))
        if values.shape[1] != len(self.fields):
            raise ValueError(f"{len(self.fields)} fields, {values.shape[1]} values in a row")
        rows = max(1, NUMBERS_A_PICTURE // max(1, len(self.fields)))
        return "".join(self._page(values[k : k + rows]) for k in range(0, len(values), rows))

    def _page(self, values: np.ndarray) -> str:
        """Text of the rows, of many from a picture; rows that it does not know are printed one by one."""
        if not self._has_pictures or values.size < self._least:
            return self._printed(values)
        text, unknown = picture(self._runs, values)
        if not unknown.any():
            return _without_nul(text)
        length = len(text) // len(values)
        pieces, start = [], 0
        for row in [*np.flatnonzero(unknown).tolist(), len(values)]:
            pieces += [
                _without_nul(text[start * length : row * length]),
                self._printed(values[row : row + 1]),
            ]
            start = row + 1
        return "".join(pieces)

    def _printed(self, values: np.ndarray) -> str:
        if self.layout == SAFE:
            values = np.where(np.abs(values) <= self._limits, 0.0, values)
        if any(self._as_text):
            columns = [self._column(k, column) for k, column in enumerate(values.T)]
            printed = tuple(chain.from_iterable(zip(*columns, strict=True)))
        else:
            printed = tuple(values.ravel().tolist())
        return self._template * len(values) % printed

    def _needs_text(self, field: Edit) -> bool:
        """Return whether C's `%` cannot print the field."""
        return field.kind == "e" or (field.stars and self.layout == HISTORIC)

    def _column(self, k: int, values: np.ndarray) -> list[Any]:
        """Return what the template takes for the values of field `k`."""
        if not self._as_text[k]:
            return list(values.tolist())
        field, separated = self.fields[k], self._separated[k]
        return [field.text(value, self.layout, separated) for value in values.tolist()]

    def _percent_template(self, parts: tuple[Edit | str, ...]) -> str:
        pieces, column = [], 0
        for part in parts:
            if isinstance(part, str):
                pieces.append(part.replace("%", "%%"))
            else:
                pieces.append(self._percent(part, column))
                column += 1
        return "".join(pieces)

    def _percent(self, field: Edit, column: int) -> str:
        if self._as_text[column]:
            return "%s"
        decimals = f".{field.decimals}" if field.kind in "fE" else ""
        if self.layout == SAFE and self._separated[column]:
            return f" %{max(field.width - 1, 0)}{decimals}{field.kind}"
        return f"%{field.width}{decimals}{field.kind}"


def _without_nul(text: bytearray) -> str:
    return text.translate(None, b"\0").decode()


def _separated(parts: tuple[Edit | str, ...]) -> list[bool]:
    """For every field: whether it has a left neighbour it must not touch."""
    flags, before = [], "\n"
    for part in parts:
        if isinstance(part, Edit):
            flags.append(before[-1] not in " \n")
            before = "0"
        elif part:
            before = part
    return flags
