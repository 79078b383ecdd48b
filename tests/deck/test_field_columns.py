"""Fields of many rows against Python's formats of each number, which round the exact value."""

import numpy as np
import pytest

from flexmb_cli.deck.edit import E, F, I, P, fixed, integer
from flexmb_cli.deck.fortran_format import Layout
from flexmb_cli.deck.pictures.field_columns import MOST_DECIMALS, picture

EDITS = {
    "d": (I(5), integer(3), I(10)),
    "f": tuple(fixed(w, d) for w, d in ((10, 3), (7, 3), (7, 2), (8, 4), (5, 3), (6, 0)))
    + (F(12, 7), F(10, 5)),
    "E": (P(13, 5), P(9, 2), P(14, MOST_DECIMALS - 1)),
    "e": (E(15, 6), E(12, 4), E(9, 2), E(7, 4)),
}


def hard_numbers(count: int, seed: int) -> np.ndarray:
    """Ties, powers of ten and neighbours of both, zeros of both signs, numbers too long for a field."""
    rng = np.random.default_rng(seed)
    ties = (rng.integers(0, 10**7, count) + 0.5) / 10.0 ** rng.integers(0, 9, count)
    powers = 10.0 ** rng.integers(-100, 101, count)
    even = rng.uniform(0.0, 10.0, count) * 10.0 ** rng.integers(-6, 7, count)
    found = np.choose(
        rng.integers(0, 8, count), [ties, ties, ties, powers, even, even, np.zeros(count), even**2]
    )
    for _ in range(2):
        found = np.nextafter(
            found, rng.choice([0.0, np.inf], count), where=rng.random(count) < 0.4, out=found
        )
    return np.copysign(found, rng.uniform(-1.0, 1.0, count))


def expected(edit, value: float) -> str:
    """The characters of a number by Python's `%` alone."""
    if edit.kind == "d":
        return str(int(value))
    if edit.kind == "f":
        text = f"{value:.{edit.decimals}f}"
    elif edit.kind == "E":
        text = f"{value:.{edit.decimals}E}"
    else:
        mantissa, _, power = f"{value:.{edit.decimals - 1}e}".partition("e")
        sign, figures = "-" * mantissa.startswith("-"), mantissa.lstrip("-").replace(".", "")
        shifted = int(power) + 1 if value else 0
        text = f"{sign}0.{figures}" + (f"E{shifted:+03d}" if abs(shifted) < 100 else f"{shifted:+04d}")
    is_zero = value == 0 or (edit.kind == "f" and not text.strip("-0."))
    return text.removeprefix("-") if is_zero else text


def compare(edit, values: np.ndarray) -> None:
    """Print the values in rows of four, side by side, and compare every character."""
    rows = values.reshape(-1, 4)
    printed = Layout("|", *4 * (edit,), "\n").lines(rows).splitlines()
    for row, line in zip(rows.tolist(), printed, strict=True):
        assert line == "|" + "".join(f" {expected(edit, value)}".rjust(edit.width) for value in row)


@pytest.mark.parametrize("kind", EDITS)
def test_hard_numbers_print_as_python_prints_each(kind):
    for seed, edit in enumerate(EDITS[kind]):
        compare(edit, hard_numbers(4000, seed))


@pytest.mark.campaign
@pytest.mark.parametrize("kind", EDITS)
def test_ten_million_hard_numbers_print_as_python_prints_each(kind):
    for edit in EDITS[kind]:
        for seed in range(7):
            compare(edit, hard_numbers(100_000, 100 + seed))


def test_lines_of_many_bodies_print_as_their_numbers_do():
    """Equal fields are taken together, runs at equal distances too; a wide line among them is not."""
    parts, edits = [], []
    for body in range(40):
        fields = (fixed(10, 3), fixed(10, 3), fixed(7, 2), fixed(10, 3)) + 3 * (P(13, 5),)
        parts += [f"{body:3d}" if body != 17 else "a longer name", *fields, "\n"]
        edits += fields
    values = hard_numbers(80 * len(edits), 5).reshape(80, -1)
    exponents = [edit.kind == "E" for edit in edits]
    # Ties in exponent form and numbers too long for a numeral are left to the other 20 rows.
    values[20:, exponents] = np.random.default_rng(6).normal(size=(60, sum(exponents)))
    values[20:] = np.fmod(values[20:], 1e4)
    layout = Layout(*parts, "*\n")
    assert picture(layout._runs, values)[1].sum() <= 20 < len(values) * len(edits) / layout._least * 20
    printed, at = layout.lines(values), 0
    for row in values:
        numbers = iter(zip(edits, row.tolist(), strict=True))
        for part in [*parts, "*\n"]:
            text = part if isinstance(part, str) else None
            if text is None:
                edit, value = next(numbers)
                text = expected(edit, value)
                text = text.rjust(edit.width) if len(text) < edit.width else " " + text
            assert printed[at : at + len(text)] == text
            at += len(text)
    assert at == len(printed)
