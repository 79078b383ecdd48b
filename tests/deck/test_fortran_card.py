"""FORTRAN formatted input: what a field of given columns holds (ANSI X3.9-1978, 13.5)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexmb_cli.deck.fortran_card import cut, fortran_format
from flexmb_cli.deck.fortran_fields import filled

F10 = fortran_format("F10.5").edits[0]
E13 = fortran_format("E13.5").edits[0]
I5 = fortran_format("I5").edits[0]


@pytest.mark.parametrize(
    ("spelled", "value"),
    [
        (".043619387", 0.043619387),
        ("-1.5607963", -1.5607963),
        ("  1.25E-04", 1.25e-4),
        ("     12345", 0.12345),
        ("    100000", 1.0),
        ("         1", 0.00001),
        ("   12345E2", 12.345),
        ("      1.D0", 1.0),
        ("      1.d2", 100.0),
        ("     1.2+3", 1200.0),
        ("     1.2-3", 0.0012),
        ("  1.5E 05 ", 150000.0),
        ("1.5       ", 1.5),
        ("  -     .5", -0.5),
        ("          ", 0.0),
        ("", 0.0),
        ("       +.0", 0.0),
    ],
)
def test_a_real_field_is_read_as_fortran_reads_it(spelled, value):
    assert cut(spelled, F10).value() == value


@pytest.mark.parametrize(
    "spelled", [".", "-", "E5", "1.0E", "1..0", "1,0", "0x1", "nan", "1.E999", "--1", "٣"]
)
def test_a_field_that_fortran_cannot_read_has_no_value(spelled):
    assert cut(spelled.rjust(10), F10).value() is None


@pytest.mark.parametrize(
    ("spelled", "value"), [("    7", 7), ("7    ", 7), ("   -7", -7), ("     ", 0), ("1 2", 12)]
)
def test_an_integer_field_ignores_its_blanks(spelled, value):
    assert cut(spelled, I5).value() == value


@pytest.mark.parametrize("spelled", ["  1.0", "  1E2", "    A", "    +"])
def test_an_integer_field_holds_digits_only(spelled):
    assert cut(spelled, I5).value() is None


def test_touching_fields_are_split_by_column():
    index, value = (cut("    2.043619387", edit).value() for edit in fortran_format("I5,F10.5").edits)
    assert (index, value) == (2, 0.043619387)


def test_more_decimals_than_digits_move_the_implied_point_past_them():
    assert cut("7", E13).value() == 0.00007


def test_a_format_lists_its_fields_by_column():
    edits = fortran_format("2I5,4F10.5").edits
    assert [(edit.descriptor, edit.column, edit.last) for edit in edits] == [
        ("I5", 1, 5),
        ("I5", 6, 10),
        ("F10.5", 11, 20),
        ("F10.5", 21, 30),
        ("F10.5", 31, 40),
        ("F10.5", 41, 50),
    ]


def test_the_guide_shows_fields_over_a_ruler():
    assert fortran_format("I5,3F10.5").guide(2) == ("[I5-][F10.5---]", "----+----1----+")


@given(st.floats(-1e9, 1e9), st.sampled_from([F10, E13]))
def test_a_filled_field_reads_back_to_the_digits_its_columns_hold(value, edit):
    """Sign, point, three exponent columns: at least width - 6 significant digits remain."""
    spelled = filled(value, edit.width)
    assert len(spelled) <= edit.width
    assert "." in spelled
    smallest = 10.0 ** -(edit.width - 2)
    assert cut(spelled, edit).value() == pytest.approx(value, rel=10.0 ** -(edit.width - 6), abs=smallest)
