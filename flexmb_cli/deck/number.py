"""Spelling of numbers: the Pascal and Fortran forms, and the faults of every other form."""

import math
import re
from functools import lru_cache

LONGEST_NUMBER = 100
MOST_DIGITS = 15
CHARACTERS_SHOWN = 30

_REAL = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eEdD]([+-]?[0-9]+))?")
# Without a point, `2-1` is more likely two numbers that lost their blank than 0.2.
_BARE_EXPONENT = re.compile(r"([+-]?(?:[0-9]+\.[0-9]*|\.[0-9]+))([+-][0-9]+)")
_PLAIN_INTEGER = re.compile(r"[+-]?[0-9]+")

# A number and the unit that stands after it; the first three have a factor to the unit of decks.
_UNIT = "(?:°|deg|rpm|RPM|[mc]?m|in|rad|[mk]?g|s|kN|N)"
# A unit may be composed, as in N/m, N*s/m or kg*m^2; without a bound "mmm…" would be tried in every split.
_WITH_UNIT = re.compile(
    rf"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))({_UNIT}(?:\^?[2-4])?(?:[/*·]?{_UNIT}(?:\^?[2-4])?){{0,3}})"
)
_FACTORS = {
    "°": (math.pi / 180, "angles are in rad", "degrees"),
    "deg": (math.pi / 180, "angles are in rad", "degrees"),
    "rpm": (math.pi / 30, "rates are in rad/s", "rpm"),
}

# Tried in this order; the first pattern that is found in the word gives the hint.
_HINTS = (
    (re.compile(r"\}"), "a comment ends here that was not opened"),
    (re.compile(r"[−–—]"), "is the minus sign a dash? write '-'"),
    (re.compile(r"^[+-]?[0-9]*,[0-9]+$"), "decimal comma? write a point"),
    (re.compile(r"[^\x00-\x7f]"), "write plain ASCII characters, not full-width or typographic ones"),
    (re.compile(r"[0-9],|,[0-9]"), "numbers are separated by blanks, not by commas"),
    (re.compile(r"[0-9];|;[0-9]"), "numbers are separated by blanks, not by semicolons"),
    (re.compile(r"^[+-]?0[xXbB]|[0-9]_"), "write it in plain decimal digits"),
    (re.compile(r"^[+-]?(nan|inf|infinity)$", re.IGNORECASE), "a finite number is needed"),
    (re.compile(r"^[+-]?[0-9.]*[oO][0-9.oO]*([eEdD]|$)"), "letter O instead of zero?"),
    (re.compile(r"^[+-]?[0-9.I]*l[0-9.lI]*([eEdD]|$)"), "letter l instead of one?"),
    (re.compile(r"^[+-]?[0-9.]*I[0-9.I]*([eEdD]|$)"), "letter I instead of one?"),
    (re.compile(r"^[+-]?(?=.*[0-9])[0-9.]*S[0-9.]*$"), "letter S instead of five?"),
    (re.compile(r"^[+-]?(?=.*[0-9])[0-9.]*B[0-9.]*$"), "letter B instead of eight?"),
    (re.compile(r"^[+-]?(?=.*[0-9])[0-9.]*Z[0-9.]*$"), "letter Z instead of two?"),
    (re.compile(r"^[+-]?([0-9.]+\*?)?pi\b", re.IGNORECASE), "write its digits: pi is 3.14159265358979"),
    (re.compile(r"^[+-]?[0-9.]*\?[0-9.?]*$"), "a deck needs every digit; only listings may have ?"),
    (re.compile(r"[0-9]\*"), "write repeated numbers out"),
    (re.compile(r"^([!#;/%*]|\(\*)"), "comments are written in braces { }"),
    (re.compile(r"^[+-]$"), "no blank may stand between a sign and its number"),
    (re.compile(r"^[+-]?[0-9.]*[0-9][0-9.]*[+-][0-9.]+$"), "two numbers without a blank between them?"),
    (
        re.compile(r"^[+-]?[0-9]*\.[0-9]*\.[0-9.]*[0-9]$"),
        "two points: a slip, or two numbers without a blank?",
    ),
    (re.compile(r"[0-9.][eEdD][+-]?$"), "digits of the exponent are missing"),
)


class Misspelt(ValueError):
    """The word is not the wanted number; the text says what was read and what may be meant."""


@lru_cache(maxsize=4096)
def real(word: str) -> tuple[float, str]:
    """The finite double that `word` spells, and a warning, "" for none.

    Read are `1`, `-.5`, `1.`, `1e3`, `1.5D+03` and, with a warning, `1.5+3`.
    Raises Misspelt for any other spelling and for values that a double cannot hold.
    """
    if len(word) > LONGEST_NUMBER:
        raise Misspelt(f"must be a number; read {shown(word)}, {len(word)} characters long")
    bare = _BARE_EXPONENT.fullmatch(word)
    match = bare or _REAL.fullmatch(word)
    if match is None:
        raise Misspelt(f"must be a number; read {shown(word)}{hint(word)}")
    mantissa, exponent = match.groups()
    value = _double(word, mantissa, exponent)
    return value, f"{shown(word)} is taken for {value:.6g}; write the exponent with e" if bare else ""


@lru_cache(maxsize=4096)
def integer(word: str) -> tuple[int, str]:
    """The integer that `word` spells, and a warning, "" for none: `2.0` is taken for 2 with a warning."""
    if _PLAIN_INTEGER.fullmatch(word) and len(word) <= MOST_DIGITS:
        return int(word), ""
    try:
        value, _ = real(word)
    except Misspelt as fault:
        raise Misspelt(str(fault).replace("a number", "an integer", 1)) from None
    if not value.is_integer():
        raise Misspelt(f"must be an integer; read {shown(word)}")
    if abs(value) >= 10**MOST_DIGITS:
        raise Misspelt(f"must be an integer of at most {MOST_DIGITS} digits; read {shown(word)}")
    return int(value), f"should be an integer; {shown(word)} is taken for {int(value)}"


def _double(word: str, mantissa: str, exponent: str | None) -> float:
    value = float(f"{mantissa}e{exponent}" if exponent else mantissa)
    if math.isinf(value):
        raise Misspelt(f"must be a number of at most 1.8e308 in size; read {shown(word)}")
    if value == 0.0 and any(digit in "123456789" for digit in mantissa):
        raise Misspelt(f"must be 0 or at least 5e-324 in size; read {shown(word)}")
    return value


def shown(word: str) -> str:
    """`word` in quotes for a message, shortened when it is long, unprintable characters escaped."""
    short = word if len(word) <= CHARACTERS_SHOWN else word[: CHARACTERS_SHOWN - 1] + "…"
    return f"'{short}'" if short.isprintable() else ascii(short)


def hint(word: str) -> str:
    """Return what is wrong with the spelling of a number, and the remedy, after a colon; "" if unknown."""
    if remedy := unit_hint(word):
        return f": {remedy}"
    return next((f": {hint}" for pattern, hint in _HINTS if pattern.search(word)), "")


def unit_hint(word: str) -> str:
    """Return how to write a word that is a number with a unit after it; "" where it is not."""
    match = _WITH_UNIT.fullmatch(word)
    return _without_unit(*match.groups()) if match else ""


def _without_unit(number: str, unit: str) -> str:
    """Return how to write a number that has a unit after it: a deck has none."""
    factor, rule, name = _FACTORS.get(unit.lower(), (None, "", ""))
    if factor is None:
        return "write the number without its unit"
    return f"{rule}; {number} {name} are {float(number) * factor:.15g}"
