"""Formulas: values as Python's own arithmetic gives them, and a fault for everything that is none."""

import math

import pytest

from flexmb_cli.deck.expansion.expressions import MOST_CHARACTERS, WrongFormula, evaluated, formula

VALUES = {"a": 0.3, "body.1.z": -2.0, "crank-pin.x": 4.0}
# By Python, of the same numbers.
KNOWN = {
    "-2^2": -(2.0**2),
    "2^-1": 0.5,
    "2**3^2": 2.0**9,
    "1 - 2 - 3": -4.0,
    "8/4/2": 1.0,
    "2*-a": -0.6,
    "1/3 + sin(pi/6)": 1 / 3 + math.sin(math.pi / 6),
    "max(1, a, 3) - min(4, 5)": -1.0,
    "atan2(1, -1)": math.atan2(1, -1),
    "hypot(3, 4)": 5.0,
    "1.5d3 + .5E-1": 1500.05,
    "abs(body.1.z)*$a": 0.6,
    '"crank-pin.x"/2': 2.0,
    "exp(log(7)) + log10(100)": 9.0,
}


@pytest.mark.parametrize("text", KNOWN)
def test_values_are_those_of_python(text):
    assert formula(text).value(VALUES.__getitem__) == pytest.approx(KNOWN[text], rel=1e-15)


def test_variables_are_defined_in_any_order():
    values = dict(evaluated({"b": formula("a/2"), "a": formula("c^2"), "c": formula("4")}, {}))
    assert values == {"b": 8.0, "a": 16.0, "c": 4.0}
    assert dict(evaluated({"b": formula("a/2"), "a": formula("16")}, {"a": 3.0})) == {"b": 1.5, "a": 3.0}


def test_circles_and_what_has_no_value_are_reported():
    values = dict(
        evaluated({"a": formula("b"), "b": formula("a+1"), "c": formula("d"), "e": formula("1/0")}, {})
    )
    assert values["b"] == "is defined by itself: a → b → a"
    assert "d, which no line SET defines" in values["c"]
    assert "is inf" in values["e"]


@pytest.mark.parametrize(
    ("text", "offset"),
    {
        "": 0, "1+": 2, "(1": 2, "1 2": 2, "sin 3": 4, "no(2)": 0, "1 ; 2": 2, "sqrt(1,2)": 0, "a)": 1,
        "__import__('os')": 0, "a.__class__()": 0, "max()": 4, "1" * (MOST_CHARACTERS + 1): 0,
        "(" * 60: 50, "2" + "^2" * 60: 99, "x[0]": 1, "lambda: 1": 6,
    }.items(),
)  # fmt: skip
def test_everything_else_is_a_fault_with_its_place(text, offset):
    with pytest.raises(WrongFormula) as failure:
        formula(text)
    assert failure.value.offset == offset
