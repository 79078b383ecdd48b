"""SDIRK4 on a sliding mass with spring and damper, in closed form (Rao, Mechanical Vibrations, 2.6)."""

import math

import numpy as np

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.integrators.clock import new_clock
from flexmb_cli.kernels.integrators.sdirk4 import _close_loops, implicit_work
from flexmb_cli.kernels.tree.implicit_matrix import factorise, renew
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import INERTIAL, TRANSLATION, Body, Hinge, Integration, Tree
from flexmb_cli.solvers.tree.state import initial_state
from tests.kernels.tree.test_kane_closures import closed_where_it_is, looped_tree
from tests.kernels.tree.test_kane_forward_dynamics import Recursion
from tests.naive.random_trees import sprung
from tests.solvers.tree.tree_runs import run

M, K, C, X0, V0 = 2.0, 50.0, 1.5, 0.3, 0.4


def damped_mass():
    """A mass that slides on a spring with a damper."""
    return Tree(
        (Body("body 1", M, np.eye(3)),),
        (Hinge(INERTIAL, translations=(1,)),),
        np.array([X0]),
        np.array([V0]),
        TimeGrid(0.0, 0.4, 0.05),
        gravity=(0.0, 0.0, 0.0),
        elements=sprung((0, TRANSLATION, 1, K, C)),
        integration=Integration("sdirk4", 1e-6, 1e-6),
    )


def test_a_damped_mass_swings_as_in_textbooks_within_and_at_the_ends_of_steps():
    rows = run(damped_mass())
    decay = C / (2.0 * M)
    omega = math.sqrt(K / M - decay**2)
    wave = X0 * np.cos(omega * rows.time) + (V0 + decay * X0) / omega * np.sin(omega * rows.time)
    np.testing.assert_allclose(rows.q[:, 0], np.exp(-decay * rows.time) * wave, rtol=0, atol=2e-5)


def test_a_step_that_leaves_its_loops_is_taken_back_and_begun_anew_with_another_matrix():
    """Closing the loops moves the end of the step by far more than its tolerance of 1e-9."""
    recursion = Recursion(closed_where_it_is(looped_tree(1)))
    start = initial_state(recursion.tree)
    arrays = recursion.arrays
    clock = new_clock(start.size - 1 - len(arrays.answers))
    s = implicit_work(clock, start + 1e-3, len(recursion.tree.q), arrays.closures, len(arrays.answers))
    s.old[:] = start
    s.clock["step_start"], s.clock["t"], s.clock["steps"] = 0.2, 0.25, 7
    s.clock["atol"] = s.clock["rtol"] = 1e-9
    s.memory["stale"] = 0
    with interpreting():
        renew(recursion.arrays, recursion.work, recursion.coordinates, start, s.stiff)
        assert factorise(recursion.arrays, 0.3, s.stiff)
        _close_loops(recursion.arrays, recursion.work, recursion.coordinates, 0.05, s)
    assert (s.clock["t"][0], s.clock["step"][0], s.clock["steps"][0]) == (0.2, 0.0125, 6)
    assert (s.clock["rejections"][0], s.memory["stale"][0]) == (1, 1)
    np.testing.assert_array_equal(s.z, start)
