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

SAFE, HISTORIC = "safe", "historic"
LAYOUTS = (SAFE, HISTORIC)


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


@cache
def _all_raised() -> np.ndarray:
    """Characters (199, 4) of the powers from -98 to 100."""
    return np.array([list(_raised(power).encode()) for power in range(-98, 101)], np.uint8)


def _aligned_exponent_forms(values: np.ndarray, digits: int, width: int, room: int) -> list[str] | None:
    """Return 0.ddddE+ee of an array, each at the right of its field; None where one of them may not fit.

    C prints all of them, +d.ddde+ee, and their characters are moved at once.
    """
    text = f"%+.{digits - 1}e" * len(values) % tuple(values.tolist())
    if digits < 2 or room < digits + 7 or len(text) != len(values) * (digits + 6):
        return None  # an exponent of three figures, or a field that widens
    c = np.frombuffer(text.encode(), np.uint8).reshape(len(values), digits + 6).astype(np.int16)
    power = (44 - c[:, -3]) * (10 * c[:, -2] + c[:, -1] - 11 * 48)  # 43 is "+", 45 "-", 48 "0"
    fields = np.full((len(values), width), ord(" "), np.uint8)
    own = fields[:, width - digits - 7 :]
    own[:, 0][c[:, 0] == ord("-")] = ord("-")
    own[:, 1:3] = tuple(b"0.")
    own[:, 3], own[:, 4 : digits + 3] = c[:, 1], c[:, 3 : digits + 2]
    own[:, -4:] = _all_raised()[np.where(values == 0.0, 98, power + 99)]
    return fields.view(f"S{width}").ravel().astype(f"U{width}").tolist()


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
        self._as_text = [self._needs_text(field) for field in self.fields]
        self._template = self._percent_template(parts)
        self._limits = np.array([field.zero_limit for field in self.fields])

    def lines(self, values: "list[Any] | np.ndarray") -> str:
        """Text of the piece for `values`, shape (rows, fields) or (fields,)."""
        values = np.atleast_2d(np.asarray(values, dtype=float))
        if values.shape[1] != len(self.fields):
            raise ValueError(f"{len(self.fields)} fields, {values.shape[1]} values in a row")
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

    def _column(self, k: int, values: np.ndarray) -> "list[Any]":
        """Return what the template takes for the values of field `k`."""
        if not self._as_text[k]:
            return list(values.tolist())
        field, separated = self.fields[k], self._separated[k]
        # Most of a long run's time would go into field after field.
        if field.kind == "e" and self.layout == SAFE and np.isfinite(values).all():
            room = field.width - separated
            forms = _aligned_exponent_forms(values, field.decimals, field.width, room)
            if forms is not None:
                return forms
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
