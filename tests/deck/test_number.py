"""Spellings of numbers: deck format of YOUNG (Pascal) and of FORTRAN 77, ANSI X3.9-1978, 13.5.9."""

import math

import pytest

from flexmb_cli.deck.number import Misspelt, integer, real

SPELLINGS = {
    "1": 1.0,
    "-.5": -0.5,
    "1.": 1.0,
    "+3.25": 3.25,
    "1e3": 1000.0,
    "1E-3": 0.001,
    "1.5D+03": 1500.0,
    "1.5d2": 150.0,
    "0.000000119": 1.19e-7,
    "1.190538140131129e-07": 1.190538140131129e-07,
    "-0": -0.0,
    "0e999": 0.0,
}


@pytest.mark.parametrize("word", SPELLINGS)
def test_pascal_and_fortran_spellings_are_read(word):
    value, warning = real(word)
    assert (value, warning) == (SPELLINGS[word], "")
    assert math.copysign(1.0, value) == math.copysign(1.0, SPELLINGS[word])


def test_an_exponent_without_letter_is_read_with_a_warn():
    assert real("1.5+3") == (1500.0, "'1.5+3' is taken for 1500; write the exponent with e")


def test_two_integers_that_lost_their_blank_are_no_number():
    with pytest.raises(
        Misspelt, match=r"^must be a number; read '2-1': two numbers without a blank between them\?$"
    ):
        real("2-1")


HINTS = {
    "1,5": "must be a number; read '1,5': decimal comma? write a point",
    "2,": "must be a number; read '2,': numbers are separated by blanks, not by commas",
    "1,2,3": "must be a number; read '1,2,3': numbers are separated by blanks, not by commas",
    "0x3": "must be a number; read '0x3': write it in plain decimal digits",
    "1_000": "must be a number; read '1_000': write it in plain decimal digits",
    "nan": "must be a number; read 'nan': a finite number is needed",
    "-Infinity": "must be a number; read '-Infinity': a finite number is needed",
    "12.O00": "must be a number; read '12.O00': letter O instead of zero?",
    "o.5e3": "must be a number; read 'o.5e3': letter O instead of zero?",
    "l.5": "must be a number; read 'l.5': letter l instead of one?",
    "−1": "must be a number; read '−1': is the minus sign a dash? write '-'",
    "3*0.0": "must be a number; read '3*0.0': write repeated numbers out",
    "1e": "must be a number; read '1e': digits of the exponent are missing",
    "#": "must be a number; read '#': comments are written in braces { }",
    "}": "must be a number; read '}': a comment ends here that was not opened",
    "1.5.2": "must be a number; read '1.5.2': two points: a slip, or two numbers without a blank?",
    "I": "must be a number; read 'I': letter I instead of one?",
    "1I.5": "must be a number; read '1I.5': letter I instead of one?",
    "-8.S001": "must be a number; read '-8.S001': letter S instead of five?",
    "-B.5": "must be a number; read '-B.5': letter B instead of eight?",
    "1Z": "must be a number; read '1Z': letter Z instead of two?",
    "B": "must be a number; read 'B'",
    "0;": "must be a number; read '0;': numbers are separated by blanks, not by semicolons",
    "-2*pi": "must be a number; read '-2*pi': write its digits: pi is 3.14159265358979",
    "-3.7?3": "must be a number; read '-3.7?3': a deck needs every digit; only listings may have ?",
    "(*": "must be a number; read '(*': comments are written in braces { }",
    "-": "must be a number; read '-': no blank may stand between a sign and its number",
    "-3.753-4.25": "must be a number; read '-3.753-4.25': two numbers without a blank between them?",
    "0-6.10": "must be a number; read '0-6.10': two numbers without a blank between them?",
    "-30deg": "must be a number; read '-30deg': angles are in rad; -30 degrees are -0.523598775598299",
    "90°": "must be a number; read '90°': angles are in rad; 90 degrees are 1.5707963267949",
    "1400RPM": "must be a number; read '1400RPM': rates are in rad/s; 1400 rpm are 146.607657167524",
    "2.5mm": "must be a number; read '2.5mm': write the number without its unit",
    "5.0N/m": "must be a number; read '5.0N/m': write the number without its unit",
    "3kg*m^2": "must be a number; read '3kg*m^2': write the number without its unit",
    "2Nms/rad": "must be a number; read '2Nms/rad': write the number without its unit",
    "2S": "must be a number; read '2S': letter S instead of five?",
    "٣": "must be a number; read '٣': write plain ASCII characters, not full-width or typographic ones",
    ".": "must be a number; read '.'",
    "1e999": "must be a number of at most 1.8e308 in size; read '1e999'",
    "-1e-999": "must be 0 or at least 5e-324 in size; read '-1e-999'",
    "\x1b[2J": r"must be a number; read '\x1b[2J'",
}


@pytest.mark.parametrize("word", HINTS)
def test_other_spellings_are_refused_with_what_may_be_meant(word):
    with pytest.raises(Misspelt) as refused:
        real(word)
    assert str(refused.value) == HINTS[word]


def test_a_word_too_long_for_a_number_is_shortened_in_the_message():
    with pytest.raises(Misspelt) as refused:
        real("1" * 100_000)
    assert str(refused.value) == f"must be a number; read '{29 * '1'}…', 100000 characters long"


@pytest.mark.parametrize(("word", "value"), [("2", 2), ("-7", -7), ("+12", 12), ("007", 7)])
def test_integers_are_read(word, value):
    assert integer(word) == (value, "")


@pytest.mark.parametrize(("word", "value"), [("2.0", 2), ("2.", 2), ("1e1", 10), ("-3.0D0", -3)])
def test_a_real_that_is_whole_is_taken_for_an_integer_with_a_warn(word, value):
    assert integer(word) == (value, f"should be an integer; '{word}' is taken for {value}")


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("2.5", "must be an integer; read '2.5'"),
        ("1O", "must be an integer; read '1O': letter O instead of zero?"),
        ("9999999999999999", "must be an integer of at most 15 digits; read '9999999999999999'"),
        ("1e300", "must be an integer of at most 15 digits; read '1e300'"),
    ],
)
def test_other_integers_are_refused(word, message):
    with pytest.raises(Misspelt) as refused:
        integer(word)
    assert str(refused.value) == message
