"""A mechanism is assembled on the branch that its estimates mean, and the integration never leaves it.

Expected: closed forms of linkages.py; the four-bar of the YOUNG dissertation (1996), Appendix B.
"""

import numpy as np
import pytest

from flexmb_cli.model.mechanism import Body, Mechanism, TimeGrid
from tests.solvers.kinematics.geometry import unit
from tests.solvers.kinematics.linkages import FourBar, SliderCrank
from tests.solvers.kinematics.solved import coordinates, mechanism_of, rows_of_deck, solved


@pytest.mark.parametrize("gap", [1e-2, 1e-3])
def test_a_nearly_flat_four_bar_stays_on_its_branch(gap):
    """Crank angle 0 and π bring all four joints near to one line, where its other branch is near."""
    linkage = FourBar(4.0, 1.0, 4.0 + 0.5 * gap, 1.0 + gap)
    rows = solved(linkage.mechanism((0.3, 1.0, 0.0), TimeGrid(0.0, 12.0, 0.5)))
    expected = linkage.rocker_end(0.3 + rows.time)
    assert np.max(np.abs(rows.position[:, 3, :2] - expected)) <= 1e-12


@pytest.mark.long_motion
@pytest.mark.parametrize("step", [0.1, 0.5, 3.0])
def test_a_very_nearly_flat_four_bar_stays_on_its_branch(step):
    """The narrow place is 0.003 rad wide; beyond it the other branch goes on more smoothly."""
    linkage = FourBar(4.0, 1.0, 4.0 + 0.5e-5, 1.0 + 1e-5)
    rows = solved(linkage.mechanism((0.3, 1.0, 0.0), TimeGrid(0.0, 12.0, step)))
    expected = linkage.rocker_end(0.3 + rows.time)
    assert np.max(np.abs(rows.position[:, 3, :2] - expected)) <= 1e-10


@pytest.mark.long_motion
def test_steps_grow_again_behind_a_narrow_place():
    """Ten places 3e-4 rad wide.  Halving a step to a 2**20th of a radian and doubling it again takes 40 steps
    of three iterations; steps that stayed so short would take millions."""
    linkage = FourBar(4.0, 1.0, 4.0 + 0.5e-7, 1.0 + 1e-7)
    rows = solved(linkage.mechanism((0.3, 1.0, 0.0), TimeGrid(0.0, 30.1, 30.1)))
    assert rows.newton_iterations[-1] < 10 * 40 * 3


@pytest.mark.parametrize("step", [0.1, 0.5])
def test_a_slider_crank_with_nearly_equal_arms_turns_back_at_its_fold(step):
    """x = r cos φ + √(l² - r² sin² φ) is never negative for l > r, however little."""
    linkage = SliderCrank(1.0, 1.0001)
    rows = solved(linkage.mechanism((0.3, 1.0, 0.0), TimeGrid(0.0, 10.0, step)))
    assert np.max(np.abs(rows.position[:, 3, 0] - linkage.slide(0.3 + rows.time))) <= 1e-10


def test_the_four_bar_assembles_to_the_published_branch_from_its_rough_estimates():
    """IN4-BAR at t = 0, body 2: (-3.746, -4.250, 4.262), ±(0.919, -0.177, 0.067, -0.347), Appendix B."""
    q = coordinates(rows_of_deck("IN4-BAR"))[0, 1]
    assert np.round(q[:3], 3).tolist() == [-3.746, -4.250, 4.262]
    assert np.round(q[3:] * np.sign(q[3]), 3).tolist() == [0.919, -0.177, 0.067, -0.347]


def test_the_four_bar_from_estimates_moved_by_a_twentieth_assembles_to_the_same_branch():
    mechanism, random = mechanism_of("IN4-BAR"), np.random.default_rng(1996)
    expected = coordinates(rows_of_deck("IN4-BAR"))[0]
    for _ in range(10):
        bodies = tuple(
            Body(b.name, tuple(b.r + 0.2 * random.standard_normal(3)), moved_attitude(b.p, random))
            for b in mechanism.bodies
        )
        rows = solved(Mechanism(**{**vars(mechanism), "bodies": bodies, "time": TimeGrid(0.0, 0.0, 1.0)}))
        assert np.max(np.abs(coordinates(rows)[0] - expected)) <= 1e-12


def moved_attitude(p, random):
    return tuple(unit(p + 0.05 * random.standard_normal(4)))
