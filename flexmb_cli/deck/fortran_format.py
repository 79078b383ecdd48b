"""Numbers as FORTRAN and Pascal programs print them: Iw, Fw.d, Ew.d and Pascal's `x:w:d`.

Two layouts.  "safe": a number that rounds to zero never prints a minus sign, and a field that is full
widens, so that at least one blank keeps it from its left neighbour.  "historic": signs of zero are
kept, and a full field does what the old compilers did: Pascal's runs into its neighbour, FORTRAN's
prints stars.  The two give the same bytes wherever a field has room.
"""

import math
from functools import cache

import numpy as np

from ..quick_dataclass import dataclass

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

    def text(self, value, layout: str = SAFE, separated: bool = True) -> str:
        """The field's characters; `separated`: the safe layout puts a blank in front of a full field."""
        text = self._digits(value, layout)
        if layout == HISTORIC and self.stars and len(text) > self.width:
            return "*" * self.width
        if layout == SAFE and separated:
            text = " " + text
        return text.rjust(self.width)

    def _digits(self, value, layout):
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


def _exponent_form(value, digits):
    return _exponent_forms([value], digits)[0]


def _exponent_forms(values, digits):
    """Return 0.ddddE+ee of finite numbers."""
    pattern, forms = f"%.{digits - 1}e", []
    for value in values:
        mantissa, _, exponent = (pattern % value).partition("e")
        figures = mantissa.replace(".", "")
        head = f"-0.{figures[1:]}" if figures[0] == "-" else f"0.{figures}"
        forms.append(head + (_raised(exponent) if value else "E+00"))
    return forms


@cache
def _raised(exponent):
    """Return an exponent of C's, "+02", as FORTRAN prints it for a number ten times smaller."""
    power = int(exponent) + 1
    # FORTRAN gives up the letter, not a digit, when the exponent needs three figures.
    return f"E{power:+03d}" if abs(power) < 100 else f"{power:+04d}"


class Layout:
    """A piece of a listing: literal text and fields in the order of the page.

    `parts` are strings (line ends included) and `Edit`s; `lines` prints the piece once for every row
    of values.
    """

    def __init__(self, *parts, layout: str = SAFE):
        if layout not in LAYOUTS:
            raise ValueError(f"layout must be one of {LAYOUTS}, not {layout!r}")
        self.layout = layout
        self.fields = tuple(part for part in parts if isinstance(part, Edit))
        self._separated = _separated(parts)
        self._as_text = [self._needs_text(field) for field in self.fields]
        self._template = self._percent_template(parts)
        self._limits = np.array([field.zero_limit for field in self.fields])

    def lines(self, values) -> str:
        """Text of the piece for `values`, shape (rows, fields) or (fields,)."""
        values = np.atleast_2d(np.asarray(values, dtype=float))
        if values.shape[1] != len(self.fields):
            raise ValueError(f"{len(self.fields)} fields, {values.shape[1]} values in a row")
        if self.layout == SAFE:
            values = np.where(np.abs(values) <= self._limits, 0.0, values)
        if any(self._as_text):
            columns = [self._column(k, column) for k, column in enumerate(values.T.tolist())]
            rows = zip(*columns, strict=True)
        else:
            rows = values.tolist()
        template = self._template
        return "".join([template % tuple(row) for row in rows])

    def _needs_text(self, field):
        """Whether C's `%` cannot print the field."""
        return field.kind == "e" or (field.stars and self.layout == HISTORIC)

    def _column(self, k, values):
        """What the template takes for the values of field `k`."""
        if not self._as_text[k]:
            return values
        field, separated = self.fields[k], self._separated[k]
        # Most of a long run's time would go into field after field.
        if field.kind == "e" and self.layout == SAFE and all(map(math.isfinite, values)):
            blank = " " if separated else ""
            return [(blank + form).rjust(field.width) for form in _exponent_forms(values, field.decimals)]
        return [field.text(value, self.layout, separated) for value in values]

    def _percent_template(self, parts):
        pieces, column = [], 0
        for part in parts:
            if isinstance(part, str):
                pieces.append(part.replace("%", "%%"))
            else:
                pieces.append(self._percent(part, column))
                column += 1
        return "".join(pieces)

    def _percent(self, field, column):
        if self._as_text[column]:
            return "%s"
        decimals = f".{field.decimals}" if field.kind in "fE" else ""
        if self.layout == SAFE and self._separated[column]:
            return f" %{max(field.width - 1, 0)}{decimals}{field.kind}"
        return f"%{field.width}{decimals}{field.kind}"


def _separated(parts):
    """For every field: whether it has a left neighbour it must not touch."""
    flags, before = [], "\n"
    for part in parts:
        if isinstance(part, Edit):
            flags.append(before[-1] not in " \n")
            before = "0"
        elif part:
            before = part
    return flags
