"""Every card of functions and elements of DAFMS decks: driven runs against runs by their effort.

The driven coordinate follows a polynomial given in advance: no run is compared with itself.
"""

import functools

import numpy as np
import pytest

from flexmb_cli.dialects.dafms.elements.cards import ELEMENT_CARDS
from flexmb_cli.dialects.dafms.elements.splines import spline_cards
from tests.dialects.dafms.test_dafms_elements import (
    ENDS,
    HELD,
    TWO_LINKS,
    card,
    function,
    integers,
    reals,
    rows_of,
)

pytestmark = pytest.mark.long_motion
POWERS = (1.2, 0.9, -0.7)
MODEL = TWO_LINKS.replace("    5\n       0.1\n", "  100\n     0.002\n")
SPARSE = TWO_LINKS.replace("    5\n       0.1\n", "    4\n      0.05\n")
SLOPES = function(5, 3, 0, 0, 0, 40)
CASES = {
    "FUNC": [function(5, 2, 0, 0.3, 0.1, 1.1, 0.2, 0.8, 0.3, 0.4), card("MOTF", integers(2, 3, 5))],
    "MOTF": [function(5, 4, 0, 3, 5), card("MOTF", integers(2, 3, 5))],
    "PREF": [function(5, 4, 0, 0.7, 3), card("PREF", integers(2, 3, 5, 0))],
    "HSPR": [SLOPES, card("HSPR", integers(1, 3) + reals(8, 0.1, 0.4, 1.6) + integers(5, 0))],
    "HSTO": [card("HSTO", integers(1, 3) + reals(-1, -0.2, 60, 0.3))],
    "LSPR": [SLOPES, card("LSPR", ENDS + integers(5, 0), HELD, reals(30, 1.2, 0.5, 2))],
    "CABL": [card("CABL", integers(0, 0, 1, 0), HELD, reals(80, 1.2, 0.1))],
    "BUSH": [card("BUSH", ENDS, HELD, reals(9, 16, 25, 0.6, 0.9, 1.6), reals(0.5, 0.6, 0.7, 0.2, 0.3, 0.4))],
    "COUP": ["\n".join(["COUP", integers(2), integers(1, 1, 3) + reals(2), integers(1, 2, 3) + reals(3)])],
    "FRIC": [card("FRIC", integers(1) + reals(0.2, 0.3, 0.1, 0.01, 0.05, 3))],
}
NEAR = {"dop853": 1e-8, "radau": 1e-8, "sdirk4": 1e-8}
SECOND = -0.8  # rad/s, of the second link where gears couple it: 2 y1 + 3 y2 = 0


def motion(t):
    a, b, c = POWERS
    return t * (a + t * (b + t * c)), a + t * (2 * b + t * 3 * c)


def joined(*lists):
    """Cards as one text, entries of functions and of equal words in one block each."""
    blocks: dict[str, list[str]] = {}
    for text in (each for cards in lists for each in cards):
        word, count, *lines = text.rstrip("\n").split("\n")
        entry = blocks.setdefault(word, [])
        entry.append((int(count), lines))  # type: ignore[arg-type]
    return "\n".join(
        "\n".join([word, integers(sum(n for n, _ in found)), *(line for _, lines in found for line in lines)])
        for word, found in blocks.items()
    )


DRIVER = [function(90, 3, 0, *POWERS), card("PREF", integers(1, 3, 90, 0))]


def starting(word):
    """The model with the first speeds of the motion, those of the second link as gears ask."""
    second = SECOND if word == "COUP" else 0.0
    return f"{POWERS[0]:10.3f}{second:10.3f}       0.0       0.0"


def run(word, model, *cards, method="dop853"):
    text = model.replace("       0.0       0.0       0.0       0.0\nRC(K", f"{starting(word)}\nRC(K")
    return rows_of(joined(*cards), method, text)


def test_every_card_has_a_case():
    assert set(CASES) == {card.word for card in ELEMENT_CARDS}


@functools.cache
def driven(word):
    return run(word, MODEL, CASES[word], DRIVER)


@pytest.mark.parametrize("word", CASES)
def test_the_card_acts_on_the_driver(word):
    bare = run(word, SPARSE, [function(8, 3, 0), card("MOTF", integers(2, 3, 8))], DRIVER)
    given = driven(word)
    same = np.searchsorted(given.time, bare.time - 1e-9)
    assert np.max(np.abs(bare.driver_effort[:, -1] - given.driver_effort[same, -1])) > 1e-3


@pytest.mark.parametrize("method", NEAR)
@pytest.mark.parametrize("word", CASES)
def test_the_effort_of_a_driven_run_gives_the_motion_back(word, method):
    given, near = driven(word), NEAR[method]
    points = list(zip(given.time.tolist(), given.driver_effort[:, -1].tolist(), strict=True))
    motor = [spline_cards([(99, "effort", points)]), card("MOTF", integers(1, 3, 99))]
    found = run(word, SPARSE, CASES[word], motor, method=method)
    same = np.searchsorted(given.time, found.time - 1e-9)
    angle, rate = motion(found.time)
    assert found.q[:, 0] == pytest.approx(angle, abs=near)
    assert found.y[:, 0] == pytest.approx(rate, abs=10 * near)
    assert found.q == pytest.approx(given.q[same], abs=2 * near)
    efforts = given.element_effort[same]
    # The motor stands behind all others.
    assert found.element_effort[:, : efforts.shape[1]] == pytest.approx(efforts, abs=1e3 * near)
