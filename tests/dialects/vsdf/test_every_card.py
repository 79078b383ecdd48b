"""Every card of functions and elements: driven runs against runs by their effort, by all integrators.

The motion is a polynomial given in advance: no run is compared with itself.
"""

import functools
import re

import numpy as np
import pytest

from flexmb_cli.dialects.elements_block.old_cards import LINES
from flexmb_cli.dialects.elements_block.writer import spline_block
from flexmb_cli.dialects.vsdf.cards.joints_and_loads import JOINT_AND_LOAD_CARDS
from tests.dialects.vsdf.element_cases import CASES, CASES_OF_COUPLINGS, CASES_OF_FRICTION, POWERS, without
from tests.dialects.vsdf.test_elements import rows_of

pytestmark = pytest.mark.long_motion
ALL = CASES | CASES_OF_COUPLINGS | CASES_OF_FRICTION
END, STEP = 0.2, 0.001  # s
METHODS = ["RK45", "RAD5", "GALF"]
GIVEN = {"LSPR": 5e-6, "SPRI": 5e-6, "CABL": 5e-6, "BUSH": 5e-6}  # s, steps of GALF; 20 µs of the others
NEAR = 1e-8  # rad, m, rad/s, m/s, and N or N m relative to the largest
# What only starts or reports a motion.
SILENT = {"RATE", "OUTJ"}
# What constrains a motion, and what the cases have beside their own card.
OTHERS = {"PINN", "JOIN", "MOTN", "TABL", "GRAV"}


def motion(t, powers):
    """The driven coordinate, and its rate."""
    a, b, c = powers
    return t * (a + t * (b + t * c)), a + t * (2 * b + t * 3 * c)


def test_every_card_has_a_case():
    assert set(CASES) == {*(card.word for card in JOINT_AND_LOAD_CARDS), *LINES["vsdf"]} - OTHERS


def with_idle(case, cards):
    """The cards and a spring that pushes nothing: with elements, results hold coordinates."""
    at = re.search(r"at=\S+", case.motor)[0]
    return f"{cards}\nELEMENTS\n  SPRING idle {at}\n"


@functools.cache
def driven(word):
    case = ALL[word]
    return rows_of(case.mechanism, END, STEP, f"{with_idle(case, case.cards)}{case.driver}")


@pytest.mark.parametrize("word", CASES)
def test_the_card_acts_on_the_driver(word):
    """Without its block the effort is another one."""
    case, given = CASES[word], driven(word)
    if word in SILENT:
        return
    cards = without(word, case).replace("TORQ\n 1,0,0,3,0,7", "TORQ\n 1,0,0,3")
    bare = rows_of(case.mechanism, END, END / 4, f"{with_idle(case, cards)}{case.driver}")
    same = np.searchsorted(given.time, bare.time - 1e-9)
    assert np.max(np.abs(bare.driver_effort[:, 0] - given.driver_effort[same, 0])) > 1e-3


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("word", ALL)
def test_the_effort_of_a_driven_run_gives_the_motion_back(word, method):
    case, given = ALL[word], driven(word)
    points = list(zip(given.time.tolist(), given.driver_effort[:, 0].tolist(), strict=True))
    cards = f"{with_idle(case, case.cards)}{spline_block([(99, 'effort', points)])}{case.motor}"
    steps = f",{GIVEN.get(word, 2e-5)}" if method == "GALF" else ""
    found = rows_of(case.mechanism, END, f"{END / 4}{steps}", cards, method)
    same = np.searchsorted(given.time, found.time - 1e-9)
    angle, rate = motion(found.time, case.powers)
    assert found.joint_coordinate[:, 0] == pytest.approx(angle, abs=NEAR)
    assert found.joint_rate[:, 0] == pytest.approx(rate, abs=NEAR)
    assert found.joint_coordinate == pytest.approx(given.joint_coordinate[same], abs=NEAR)
    assert found.joint_rate == pytest.approx(given.joint_rate[same], abs=NEAR)
    efforts = given.element_effort[same]
    # The motor stands after all others.
    others, scale = found.element_effort[:, : efforts.shape[1]], np.abs(efforts).max(initial=1.0)
    assert others == pytest.approx(efforts, abs=10 * NEAR * scale)


def test_a_motion_by_its_rate_needs_the_same_effort_as_by_itself():
    """Law 6 with the derivative of the polynomial of law 5."""
    a, b, c = POWERS
    by_rate = f"ELEMENTS\n  FUNCTION 90 polynomial {a} {2 * b} {3 * c}\nMOTN\n 1,ANGL,1,6,90"
    found = rows_of(CASES["TSPR"].mechanism, END, END / 4, CASES["TSPR"].cards + by_rate)
    given = driven("TSPR")
    same = np.searchsorted(given.time, found.time - 1e-9)
    assert found.driver_effort == pytest.approx(given.driver_effort[same], abs=1e-8)
