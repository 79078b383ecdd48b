"""Every card of loads, functions and elements: inverse runs against forward runs by all integrators.

The motion of the driven coordinate is a polynomial given in advance (`element_cases.motion`): no run is
compared with itself.
"""

import functools

import numpy as np
import pytest

from tests.solvers.constrained.elements.element_cases import (
    CASES,
    CASES_OF_COUPLINGS,
    CASES_OF_FRICTION,
    KEYWORDS,
    forward,
    free,
    inverse,
    motion,
)

ALL = CASES | CASES_OF_COUPLINGS | CASES_OF_FRICTION

# Cards of an integrator, and what coordinates may be off; rates may be off by `NEAR_RATE`.
METHODS = {
    "DOP853": ("TOLERANCE 1e-12\n", 1e-9),
    "RAD5": ("RAD5 1e-9\n", 1e-9),
    "GALF with chosen steps": ("GALF 0 0.9\nTOLERANCE 1e-10\n", 1e-8),
    "GALF with steps of 0.05 ms": ("GALF 5e-5 0.9\n", 1e-8),
}
NEAR_RATE = 1e-8


# The same where nothing but the method itself ends the steps.
FREE_STEPS = {
    "RAD5": ("RAD5 1e-9\n", 2e-9),
    "GALF with chosen steps": ("GALF 0 0.9\nTOLERANCE 1e-7\n", 2e-6),
    "GALF with steps of 0.1 ms": ("GALF 1e-4 0.9\n", 5e-7),
}


def test_every_card_that_acts_has_a_case():
    assert set(CASES) == set(KEYWORDS)


@functools.cache
def driven(keyword):
    return inverse(ALL[keyword])


@pytest.mark.long_motion
@pytest.mark.parametrize("keyword", ALL)
def test_an_inverse_run_follows_the_motion(keyword):
    rows, case = driven(keyword), ALL[keyword]
    place = case.joint - 1
    angle, rate = motion(rows.time, case.powers)
    assert rows.joint_coordinate[:, place] == pytest.approx(angle, abs=1e-12)
    assert rows.joint_rate[:, place] == pytest.approx(rate, abs=1e-11)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keyword", ALL)
def test_the_effort_of_an_inverse_run_gives_the_motion_back(keyword, method):
    case, given = ALL[keyword], driven(keyword)
    card, near = METHODS[method]
    found, same = forward(case, given, card)
    angle, rate = motion(found.time, case.powers)
    assert found.joint_coordinate[:, case.joint - 1] == pytest.approx(angle, abs=near)
    assert found.joint_rate[:, case.joint - 1] == pytest.approx(rate, abs=NEAR_RATE)
    # What moves along, and what all elements but the motor do, which is the last.
    assert found.joint_coordinate == pytest.approx(given.joint_coordinate[same], abs=near)
    assert found.joint_rate == pytest.approx(given.joint_rate[same], abs=NEAR_RATE)
    assert found.position == pytest.approx(given.position[same], abs=near)
    scale = max(1.0, np.abs(given.element_effort).max(initial=0.0))
    others = found.element_effort[:, :-1]
    assert others == pytest.approx(given.element_effort[same], abs=10 * near * scale)
    driven_rate = found.joint_rate[:, case.joint - 1]
    assert found.element_power[:, -1] == pytest.approx(found.element_effort[:, -1] * driven_rate, rel=1e-12)


@functools.cache
def free_by_an_explicit_method(keyword):
    return free(CASES[keyword], "TOLERANCE 1e-12\n")


@pytest.mark.long_motion
@pytest.mark.parametrize("method", FREE_STEPS)
@pytest.mark.parametrize("keyword", KEYWORDS)
def test_implicit_methods_move_a_free_mechanism_as_the_explicit_one(keyword, method):
    """Half a second without a motor; other tests compare the explicit method with other programs."""
    card, near = FREE_STEPS[method]
    found, wanted = free(CASES[keyword], card), free_by_an_explicit_method(keyword)
    assert found.joint_coordinate == pytest.approx(wanted.joint_coordinate, abs=near)
    assert found.joint_rate == pytest.approx(wanted.joint_rate, abs=10 * near)
    assert not keyword.endswith("STOP") or found.element_effort.any()
