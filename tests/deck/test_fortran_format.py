"""Edit descriptors: Pascal's as in the YOUNG listings, FORTRAN's as in the DAFMS thesis."""

import math
import random
from decimal import ROUND_HALF_EVEN, Decimal

import numpy as np
import pytest

from flexmb_cli.deck.edit import HISTORIC, SAFE, E, F, I, fixed, integer, rounds_to_zero
from flexmb_cli.deck.fortran_format import Layout


def historic(*parts):
    return Layout(*parts, layout=HISTORIC)


def test_a_number_stands_right_justified():
    assert Layout(fixed(10, 3), fixed(7, 2)).lines([0.5, -1.047]) == "     0.500  -1.05"


def test_full_pascal_fields_run_together_in_the_historic_layout():
    # OUT4-BAR, YOUNG dissertation, Appendix B.
    values = [24.430, -36.634, -56.813, 10.489, -100.734, -71.565, 76.328]
    assert historic(*7 * (fixed(7, 3),)).lines(values) == " 24.430-36.634-56.813 10.489-100.734-71.565 76.328"


def test_full_pascal_fields_keep_one_blank_in_the_safe_layout():
    values = [24.430, -36.634, -56.813, 10.489, -100.734]
    assert Layout(*5 * (fixed(7, 3),)).lines(values) == " 24.430 -36.634 -56.813 10.489 -100.734"


def test_the_first_field_of_a_line_needs_no_blank():
    assert Layout(fixed(6, 2), fixed(6, 2), "\n").lines([-10.5, -10.5]) == "-10.50 -10.50\n"


def test_a_field_behind_a_literal_blank_needs_no_further_one():
    assert Layout("TIME= ", fixed(5, 3)).lines([0.1]) == "TIME= 0.100"


def test_zero_has_no_sign_in_the_safe_layout_and_keeps_it_in_the_historic():
    values = [-0.0004, -0.0]
    assert Layout(*2 * (fixed(7, 3),)).lines(values) == "  0.000  0.000"
    assert historic(*2 * (fixed(7, 3),)).lines(values) == " -0.000 -0.000"


@pytest.mark.parametrize("decimals", range(8))
def test_the_largest_number_that_prints_as_zero_is_exact(decimals):
    limit = rounds_to_zero(decimals)
    unit = Decimal(1).scaleb(-decimals)
    assert Decimal(limit).quantize(unit, ROUND_HALF_EVEN) == 0
    assert Decimal(math.nextafter(limit, 1)).quantize(unit, ROUND_HALF_EVEN) == unit


def test_printed_digits_are_the_exact_value_rounded():
    chance = random.Random(7)
    for _ in range(500):
        value = chance.uniform(-1, 1) * 10.0 ** chance.randint(-6, 6)
        expected = Decimal(value).quantize(Decimal("0.001"), ROUND_HALF_EVEN)
        assert Decimal(Layout(fixed(7, 3)).lines([value])) == expected


def test_both_layouts_give_the_same_bytes_where_fields_have_room():
    values = np.random.default_rng(3).uniform(0.01, 9, (50, 6)) * [1, -1, 1, -1, 1, -1]
    parts = (fixed(8, 3), F(9, 4), E(15, 6), fixed(7, 2), F(12, 7), E(12, 4), "\n")
    assert Layout(*parts).lines(values) == historic(*parts).lines(values)


def test_integers_fill_their_width():
    assert Layout(integer(3), integer(3), I(5)).lines([2, 10, 7]) == "  2 10    7"


def test_an_integer_without_width_takes_its_digits_only():
    assert historic(integer(0), integer(0)).lines([1, 2]) == "12"


@pytest.mark.parametrize(
    ("value", "printed"),
    [
        (109700.0, "  0.1097E+06"),
        (0.0, "  0.0000E+00"),
        (-0.09999999, " -0.1000E+00"),
        (1.0, "  0.1000E+01"),
        (1e-100, "  0.1000E-99"),
        (-1.234e120, " -0.1234+121"),
        (math.inf, "         inf"),
    ],
)
def test_exponent_fields_have_a_zero_before_the_point(value, printed):
    assert Layout(" ", E(12, 4)).lines([value]) == " " + printed
    assert historic(" ", E(12, 4)).lines([value]) == " " + printed


def test_fortran_prints_stars_where_a_number_does_not_fit():
    assert historic(F(10, 5), F(10, 5)).lines([1234.5, 12345.0]) == "1234.50000**********"
    assert historic(I(3)).lines([1000]) == "***"
    assert historic(E(8, 4)).lines([1.0]) == "********"


def test_safe_fortran_fields_widen_instead():
    assert Layout(F(10, 5), F(10, 5)).lines([12345.0, -12345.0]) == "12345.00000 -12345.00000"
    assert Layout(I(3), E(10, 4)).lines([1000, -1.0]) == "1000 -0.1000E+01"


def test_a_field_alone_prints_as_in_a_line():
    for edit in (fixed(7, 3), F(7, 3), E(9, 3), I(4)):
        for layout in (SAFE, HISTORIC):
            assert edit.text(-4.0, layout, separated=False) == Layout(edit, layout=layout).lines([-4.0])


def test_percent_signs_in_literals_are_text():
    assert Layout("100% ", integer(2), "%d\n").lines([5]) == "100%  5%d\n"


def test_a_wrong_number_of_values_is_refused():
    with pytest.raises(ValueError, match="2 fields, 3 values in a row"):
        Layout(integer(2), integer(2)).lines([1, 2, 3])


def test_an_unknown_layout_is_refused():
    with pytest.raises(ValueError, match="'pretty'"):
        Layout(integer(2), layout="pretty")


def with_zero_before_the_point(value, digits):
    """0.ddddE+ee by the decimal module: the exact value, rounded to so many figures."""
    exact = Decimal(value)
    power = exact.adjusted() + 1 if exact else 0
    figures = (exact.scaleb(-power) if exact else exact).quantize(Decimal(1).scaleb(-digits), ROUND_HALF_EVEN)
    if abs(figures) >= 1:
        power, figures = power + 1, figures / 10
    figures = figures.quantize(Decimal(1).scaleb(-digits))
    return f"{figures:f}" + (f"E{power:+03d}" if abs(power) < 100 else f"{power:+04d}")


@pytest.mark.parametrize(("width", "decimals"), [(15, 6), (14, 6), (9, 2), (11, 4), (30, 16)])
@pytest.mark.parametrize("powers", [(-6, 6), (-99, 99), (-300, 300)])
def test_columns_of_exponent_fields_print_as_exact_numbers(width, decimals, powers):
    """Also where one field of the column widens, or an exponent has three figures."""
    chance = random.Random(3)
    values = [chance.uniform(-1, 1) * 10.0 ** chance.randint(*powers) for _ in range(300)]
    values += [0.0, -0.0, 9.9999996e5, -9.9999996e5, 9.9999999e98, 9.9999999e99, -9.9e99, 1e-99, 1e-100]
    printed = Layout(E(width, decimals), "|", E(width, decimals), "\n").lines(np.transpose([values, values]))
    for value, line in zip(values, printed.splitlines(), strict=True):
        expected = with_zero_before_the_point(value + 0.0 if value else 0.0, decimals)
        assert line == f"{expected.rjust(width)}|{(' ' + expected).rjust(width)}"
