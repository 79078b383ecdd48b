"""The table of units: names, what they are in SI units, consistent systems of decks, and conversion.

An expression of units has factors with whole exponents, separated by blanks, and at most one stroke: "N m",
"m/s2".  Factors: BIPM, The International System of Units, 9th edition (2019), tables 4 and 8; NIST SP 811
(2008), appendix B, for inch, pound and their products.
"""

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

_INCH, _POUND_FORCE = 0.0254, 4.4482216152605
_POUND = _POUND_FORCE / _INCH  # lbf s²/in, kg


class Unit(NamedTuple):
    """A unit of a dimension, which is named by its SI unit."""

    dimension: str  # SI unit, such as "m" or "rad/s"
    factor: float  # of this unit in SI units


_PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1.0, "m": 1e-3, "u": 1e-6}
# Units that labels may have with a prefix, the largest first.
_PREFIXED = ("N", "Pa", "J", "W")
TABLE: dict[str, Unit] = {
    f"{prefix}{unit}": Unit(unit, factor) for unit in _PREFIXED for prefix, factor in _PREFIXES.items()
}
TABLE |= {
    "m": Unit("m", 1.0), "km": Unit("m", 1e3), "cm": Unit("m", 1e-2), "mm": Unit("m", 1e-3),
    "um": Unit("m", 1e-6), "in": Unit("m", _INCH), "ft": Unit("m", 12 * _INCH),
    "kg": Unit("kg", 1.0), "g": Unit("kg", 1e-3), "t": Unit("kg", 1e3), "slinch": Unit("kg", _POUND),
    "s": Unit("s", 1.0), "ms": Unit("s", 1e-3), "min": Unit("s", 60.0),
    "rad": Unit("rad", 1.0), "deg": Unit("rad", math.pi / 180), "rev": Unit("rad", 2 * math.pi),
    "rpm": Unit("rad/s", math.pi / 30), "km/h": Unit("m/s", 1 / 3.6),
    "dyn": Unit("N", 1e-5), "lbf": Unit("N", _POUND_FORCE),
    "bar": Unit("Pa", 1e5), "psi": Unit("Pa", _POUND_FORCE / _INCH**2), "barye": Unit("Pa", 0.1),
    "erg": Unit("J", 1e-7), "Hz": Unit("Hz", 1.0), "kHz": Unit("Hz", 1e3),
}  # fmt: skip
_FACTOR = re.compile(r"([A-Za-z]+)(\d*)")


@dataclass(frozen=True)
class Units:
    """A consistent system: its units of length, m, and mass, kg; times are in s.  `reported`: it in words."""

    name: str
    length: float
    mass: float
    reported: str

    @cached_property
    def names(self) -> "Wishes":
        """Return the names of its units by the SI units in whose place they stand."""
        force, energy = self.mass * self.length, self.mass * self.length**2
        sizes = {"m": self.length, "kg": self.mass, "N": force, "Pa": force / self.length**2, "J": energy}
        return {unit: name_of(unit, size) for unit, size in sizes.items()} | {
            "W": name_of("W", energy) or f"{name_of('J', energy)}/s"
        }


# Names of units by the SI units in whose place they stand.
Wishes = Mapping[str, str]
AS_STORED: Wishes = {}
_SYSTEMS = (
    Units("m", 1.0, 1.0, "m, kg, s, N"),
    Units("mm", 1e-3, 1e3, "mm, t, s, N"),
    Units("mm-kg", 1e-3, 1.0, "mm, kg, s, mN"),
    Units("cm", 1e-2, 1e-3, "cm, g, s, dyn"),
    Units("in", _INCH, _POUND, "in, lbf s^2/in, s, lbf"),
)
UNITS = {system.name: system for system in _SYSTEMS}


def name_of(dimension: str, factor: float) -> str:
    """Return the name of a unit by its size in SI units; "" if the table has none."""
    return next(
        (
            name
            for name, unit in TABLE.items()
            if unit.dimension == dimension and math.isclose(unit.factor, factor, rel_tol=1e-12)
        ),
        "lbf in" if dimension == "J" and math.isclose(factor, _POUND_FORCE * _INCH) else "",
    )


def wishes_of(names: Iterable[str]) -> Wishes:
    """Return the units that are wanted, by their SI units.

    Raises ValueError, with a sentence, for a name that the table lacks and for two units of one quantity.
    """
    wishes: dict[str, str] = {}
    for name in names:
        if name not in TABLE:
            raise ValueError(f"there is no unit {name!r}; there are {', '.join(TABLE)}")
        dimension = TABLE[name].dimension
        if wishes.setdefault(dimension, name) != name:
            raise ValueError(f"{wishes[dimension]} and {name} are units of one quantity; name one of them")
    return wishes


def converted(unit: str, wishes: Wishes) -> tuple[str, float]:
    """Return an expression of units in the units that are wanted, and the factor of its numbers.

    Seconds are those of times only: a velocity stays in m/s.
    """
    whole, size = in_si(unit)
    if whole in wishes:
        wished = wishes[whole]
        return wished, size / in_si(wished)[1]
    factor = 1.0

    def wanted_one(match: re.Match[str]) -> str:
        nonlocal factor
        old = TABLE.get(match[1])
        name = wishes.get(old.dimension, "") if old and old.dimension != "s" else ""
        if not old or not name:
            return match[0]
        power = int(match[2] or 1) * (-1 if "/" in unit[: match.start()] else 1)
        factor *= (old.factor / in_si(name)[1]) ** power
        return f"{name}{match[2]}"

    return _FACTOR.sub(wanted_one, unit), factor


def in_si(unit: str) -> tuple[str, float]:
    """Return an expression in SI units, and its size in them; what the table lacks stays as it is."""
    if unit in TABLE:
        return TABLE[unit]
    factor = 1.0

    def si(match: re.Match[str]) -> str:
        nonlocal factor
        dimension, size = TABLE.get(match[1], (match[1], 1.0))
        factor *= size ** (int(match[2] or 1) * (-1 if "/" in unit[: match.start()] else 1))
        return f"{dimension}{match[2]}"

    return _FACTOR.sub(si, unit), factor


def declared(unit: str, system: Units) -> str:
    """Return an SI expression, or several separated by " or ", with the names of a consistent system."""
    return " or ".join(converted(each, system.names)[0] for each in unit.split(" or "))


def with_prefix(unit: str, largest: float, wishes: Wishes = AS_STORED) -> tuple[str, float]:
    """Return a unit with the prefix that gives `largest` one to three digits, and the factor of numbers.

    Of forces, torques, stresses, energies and powers in SI units, and of lengths below a centimetre, unless
    their unit is one of those that are wanted.
    """
    head, blank, rest = unit.partition(" ")
    if head in wishes or in_si(unit) != (unit, 1.0):
        return unit, 1.0
    if head in _PREFIXED and "/" not in unit and math.isfinite(largest):
        for prefix, size in _PREFIXES.items():
            if size <= largest * (1 + 1e-9):
                return f"{prefix}{head}{blank}{rest}", 1 / size
    if unit == "m" and 1e-6 <= largest < 1e-2:
        name = "mm" if largest >= 1e-3 else "um"
        return name, 1 / TABLE[name].factor
    return unit, 1.0
