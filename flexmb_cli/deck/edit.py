"""Numbers as FORTRAN and Pascal programs print them: Iw, Fw.d, Ew.d and Pascal's `x:w:d`.

Two layouts.  "safe": a number that rounds to zero never prints a minus sign, and a field that is full
widens, so that at least one blank keeps it from its left neighbour.  "historic": signs of zero are
kept, and a full field does what the old compilers did: Pascal's runs into its neighbour, FORTRAN's
prints stars.  The two give the same bytes wherever a field has room.
"""

import math
from dataclasses import dataclass
from functools import cache

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
