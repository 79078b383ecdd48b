"""Loops closed in a metric of one's own: unit masses of all coordinates instead of the tree's."""

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.tree.motion import parts
from flexmb_cli.kernels.tree.projection import CLOSED_LOOP_GAP, Metric, evaluate_gaps, largest_gap, projection
from flexmb_cli.solvers.tree.state import initial_state
from tests.kernels.tree.test_kane_closures import closed_where_it_is, closure_equations, looped_tree
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close

APART = 1e-3  # rad and m: by how much the coordinates are off the closed loop


def projected(tree, shift):
    """(state before, state after, Recursion), the loop opened by a shift of the coordinates."""
    recursion, state = Recursion(tree), initial_state(tree)
    parts(recursion.arrays, state)[1][:] += shift
    J = closure_equations(tree, recursion.attitudes)[0]

    def nothing(tree, work, coordinates):
        pass

    def least_norm(tree, work, coordinates, z):
        coordinates["response"] = np.linalg.pinv(J) @ tree.closures["force"]

    after = state.copy()
    with interpreting():
        project = projection(Metric(nothing, least_norm, 3))
        project(recursion.arrays, recursion.work, recursion.coordinates, after)
        evaluate_gaps(recursion.arrays, recursion.work, recursion.coordinates, after)
    return state, after, recursion, J


@pytest.mark.parametrize("seed", [1, 4])
def test_corrections_follow_the_metric_that_is_handed_in(seed):
    """They lie in the row space of J, as those of least norm do; those by mass do not."""
    tree = closed_where_it_is(looped_tree(seed))
    shift = APART * np.random.default_rng(seed).uniform(-1.0, 1.0, len(tree.q))
    before, after, recursion, J = projected(tree, shift)
    # J stays that of the closed loop: each of the five corrections leaves a thousandth of the gap.
    assert largest_gap(recursion.arrays.closures) <= CLOSED_LOOP_GAP
    outside = np.eye(len(tree.q)) - np.linalg.pinv(J) @ J
    for place in (0, 1):
        change = parts(recursion.arrays, after)[place] - parts(recursion.arrays, before)[place]
        assert np.abs(change).max() > 0.1 * APART
        close(outside @ change, 0.0 * change, 1e-12)
    by_mass = np.linalg.solve(recursion.dense()[0], J.T)
    assert np.abs(outside @ by_mass).max() > 0.1 * np.abs(by_mass).max()
