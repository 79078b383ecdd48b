"""The page of proved elements names a test for every card, and every test that it names is there."""

import re
from pathlib import Path

import pytest

from tests.solvers.constrained.elements.element_cases import KEYWORDS

TOP = Path(__file__).resolve().parents[2]
PAGE = (TOP / "docs/verification/elements.md").read_text(encoding="utf-8")
CLOSED, OTHERS = re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:3]
# In these the other programs have no element of their own.
ALONE = {
    *("FORCE", "TORQUE", "SPLINE", "RAMP", "STEP", "PRODUCT", "SUM", "TABLE", "POLYNOMIAL", "SINE"),
    *("REVCYL", "REVSPH", "RATE", "JOINTS"),
}


def cards_of(section):
    cells = re.findall(r"^\|([^|]*)\|", section, re.MULTILINE)
    return {word for cell in cells for word in re.findall(r"`([A-Z0-9]+)`", cell)}


def test_every_card_has_a_closed_form():
    assert cards_of(CLOSED) == set(KEYWORDS)


def test_every_card_that_another_program_has_is_compared():
    assert cards_of(OTHERS) == set(KEYWORDS) - ALONE


@pytest.mark.parametrize("named", re.findall(r"`([\w/]+\.py::\w+)`", PAGE))
def test_the_tests_that_the_page_names_are_there(named):
    path, _, function = named.partition("::")
    text = (TOP / "tests/solvers/constrained" / path).read_text(encoding="utf-8")
    assert f"def {function}(" in text
