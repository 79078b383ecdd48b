"""The one search for singular positions, where the Jacobian is diag(1, cos t): singular at π/2 + k π."""

import itertools
import math

import numpy as np
import pytest

from flexmb_cli.errors import Place
from flexmb_cli.model.joints import Equation
from flexmb_cli.solvers.singular.conditioning import (
    MOST_NOTES,
    Passed,
    PassedSingularities,
    conditioning_of,
    least_by_thirds,
)

NAMES = tuple(Equation(f"spherical joint {k}", "x", Place(k + 6, 1), 1.0) for k in (1, 2))


class Swinging(PassedSingularities):
    """Rows at times; every interval is suspected, and what is below 1e-6 in it is singular."""

    def suspected(self, times):
        return itertools.pairwise(times)

    def located(self, interval):
        first, last = interval
        t = first + least_by_thirds(lambda x: abs(math.cos(first + x * (last - first)))) * (last - first)
        if abs(math.cos(t)) < 1e-6:
            yield Passed(np.zeros(2), t, np.zeros(0), True)

    def conditioning(self, passed):
        return conditioning_of(np.diag([1.0, math.cos(passed.t)]), 2)

    def sentence(self, passed, weak, owners):
        return f"t = {passed.t:.6f}, {owners[0].owner}"


@pytest.mark.parametrize("least", [0.013, 0.4, 0.98])
def test_a_minimum_is_found_by_thirds(least):
    """40 of them leave (2/3)^40 = 9e-8 of the interval."""
    assert least_by_thirds(lambda x: abs(x - least)) == pytest.approx(least, abs=1e-7)


def test_singular_positions_are_named_with_their_times_and_their_weakest_joint():
    warnings = []
    Swinging(warnings, NAMES, True).look(np.linspace(0.0, 6.0, 7))
    assert [note.message for note in warnings] == [
        f"t = {0.5 * math.pi:.6f}, spherical joint 2",
        f"t = {1.5 * math.pi:.6f}, spherical joint 2",
    ]
    assert {note.place for note in warnings} == {NAMES[1].place}


def test_notes_are_limited():
    warnings = []
    Swinging(warnings, NAMES, True).look(np.arange(40.0))
    assert len(warnings) == MOST_NOTES
