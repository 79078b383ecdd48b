"""Every supplied deck over its whole run against equations of motion of another kind.

Planar decks: Lagrange's equations in the plane, loops by multipliers (`naive.planar_lagrange`).
Spatial decks: absolute coordinates with multipliers (`naive.natural_coordinates`).  Neither has Kane's
equations, a recursion over bodies, Euler parameters or the reduction to independent speeds.  Both
sides are integrated to 1e-12 or better, so that what is compared is the equations.
"""

import numpy as np
import pytest

from tests.naive.natural_coordinates import SpatialTree
from tests.naive.planar_lagrange import PlanarTree
from tests.run.dafms_runs import NAMES
from tests.solvers.tree.tree_runs import deck_tree, run

pytestmark = pytest.mark.long_motion

PLANAR = (
    "pendulum",
    "pendulum_strict",
    "shaft_beam_n2",
    "shaft_beam_n5",
    "shaft_beam_n10",
    "shaft_beam_n10_unco",
    "two_link_n2",
    "two_link_n4",
    "two_link_n2_unco",
    "fourbar_rigid",
    "fourbar_flex",
    "slider_crank_flex",
    "sliding_mass",
)
SPATIAL = ("spatial_rigid", "spatial_flex")
# Each with equations of its own in tests/dialects/dafms/test_dafms_cards.py.
OF_CARDS = ("arm_elements", "arm_nrot", "motor_gear", "spinning_beams", "stiff_arm")


def test_every_deck_has_equations_to_be_compared_with():
    assert sorted(PLANAR + SPATIAL + OF_CARDS) == NAMES


# The fast pass has shorter decks of the same kind.
LONGEST = ("two_link_n4", "shaft_beam_n10", "shaft_beam_n10_unco")


@pytest.mark.parametrize(
    "deck",
    [pytest.param(deck, marks=[pytest.mark.campaign] * (deck in LONGEST)) for deck in PLANAR + SPATIAL],
)
def test_deck_moves_over_its_whole_run_as_other_equations_say(deck):
    """Every coordinate and speed in every row, to 1e-7 of the range that it covers."""
    tree = deck_tree(deck, 1e-13)
    rows = run(tree)
    q, y = (SpatialTree if deck in SPATIAL else PlanarTree)(tree).run(rows.time, rtol=1e-12, atol=1e-14)
    assert np.max(np.abs(rows.q - q) / np.ptp(q, axis=0)) <= 1e-7
    assert np.max(np.abs(rows.y - y) / np.ptp(y, axis=0)) <= 1e-7


def test_one_way_shaft_has_the_moment_of_momentum_that_the_torque_gave_it():
    """One-way, what the beam's rates m x u' add is struck: (I + sum m u^2) w is the impulse so far."""
    tree = deck_tree("shaft_beam_n10_unco", 1e-12)
    rows, elastic = run(tree), tree.bodies[0].elastic
    moment = rows.y[:, 0] * (tree.bodies[0].inertia[0, 0] + rows.q[:, 1:] ** 2 @ elastic.masses)
    impulse = np.interp(rows.time, [0.0, 0.05, 0.10, 0.15, 0.5], [0.0, 0.05, 0.05, 0.0, 0.0])
    assert np.max(np.abs(moment - impulse)) <= 1e-12
