"""Every card of loads, functions and elements: inverse runs against forward runs by all integrators.

The motion of the driven coordinate is a polynomial given in advance (`element_cases.motion`): no run is
compared with itself.
"""

import functools

import numpy as np
import pytest

from tests.solvers.constrained.elements.element_cases import CASES, KEYWORDS, forward, inverse, motion

# Cards of an integrator, and what the coordinate and its rate may be off.
METHODS = {
    "DOP853": ("TOLERANCE 1e-12\n", 1e-9, 1e-8),
    "RAD5": ("RAD5 1e-9\n", 1e-9, 1e-8),
    "GALF with chosen steps": ("GALF 0 0.9\nTOLERANCE 1e-8\n", 2e-7, 2e-6),
    "GALF with steps of 0.1 ms": ("GALF 1e-4 0.9\n", 2e-8, 5e-8),
}


def test_every_card_that_acts_has_a_case():
    assert set(CASES) == set(KEYWORDS)


@functools.cache
def driven(keyword):
    return inverse(CASES[keyword])


@pytest.mark.long_motion
@pytest.mark.parametrize("keyword", KEYWORDS)
def test_an_inverse_run_follows_the_motion(keyword):
    rows, place = driven(keyword), CASES[keyword].joint - 1
    angle, rate = motion(rows.time)
    assert rows.joint_coordinate[:, place] == pytest.approx(angle, abs=1e-12)
    assert rows.joint_rate[:, place] == pytest.approx(rate, abs=1e-11)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keyword", KEYWORDS)
def test_the_effort_of_an_inverse_run_gives_the_motion_back(keyword, method):
    case, given = CASES[keyword], driven(keyword)
    card, near, near_rate = METHODS[method]
    found, same = forward(case, given, card)
    angle, rate = motion(found.time)
    assert found.joint_coordinate[:, case.joint - 1] == pytest.approx(angle, abs=near)
    assert found.joint_rate[:, case.joint - 1] == pytest.approx(rate, abs=near_rate)
    # What moves along, and what all elements but the motor do.
    assert found.joint_coordinate == pytest.approx(given.joint_coordinate[same], abs=2 * near)
    assert found.joint_rate == pytest.approx(given.joint_rate[same], abs=2 * near_rate)
    assert found.position == pytest.approx(given.position[same], abs=2 * near)
    scale = max(1.0, np.abs(given.element_effort).max(initial=0.0))
    assert found.element_effort == pytest.approx(given.element_effort[same], abs=1e3 * near * scale)
