"""Along the run of every supplied deck the accelerations obey equations made from particles alone."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.arrays.tree_frames import rotation_matrix
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import ROTATION
from tests.kernels.tree.test_kane_closures import closure_equations
from tests.naive.particle_tree import equations
from tests.naive.random_trees import random_tree
from tests.solvers.tree.tree_runs import deck_tree, run

pytestmark = pytest.mark.long_motion

TREES = (
    "pendulum",
    "pendulum_strict",
    "shaft_beam_n5",
    "two_link_n2",
    "two_link_n4",
    "spatial_rigid",
    "spatial_flex",
    "sliding_mass",
)
LOOPS = ("fourbar_rigid", "fourbar_flex", "slider_crank_flex")


def relative_attitudes(tree, rows, i):
    """Euler parameters of the hinges with three rotations on the inertial frame, from the body's."""
    return [
        rows.euler_parameters[i, k]
        for k, hinge in enumerate(tree.hinges)
        if len(hinge.rotations) == 3 and np.allclose(rotation_matrix(hinge.frame), np.eye(3))
    ]


def sampled(tree, rows):
    """Trees standing at every tenth of the run, with the row's number; no laws in these rows."""
    for i in np.linspace(0, len(rows.time) - 1, 11).astype(int):
        yield i, replace(tree, q=rows.q[i], y=rows.y[i]), relative_attitudes(tree, rows, i)


def missing_force(tree, attitudes, rates):
    """b y' + f* - F and the size of its terms."""
    b, remainder, force = equations(tree, tree.q, tree.y, attitudes)
    return b @ rates + remainder - force, np.max(np.abs(b) @ np.abs(rates)) + np.max(np.abs(force))


@pytest.mark.parametrize("deck", TREES)
def test_accelerations_of_a_tree_deck_obey_the_equations_of_its_particles(deck):
    tree = replace(deck_tree(deck), torques=())
    tree = replace(tree, y=tree.y + 0.5 * np.array([c.motion == ROTATION for c in tree.coordinates]))
    rows = run(tree)
    for i, there, attitudes in sampled(tree, rows):
        missing, size = missing_force(there, attitudes, rows.y_rate[i])
        assert np.max(np.abs(missing)) <= 1e-11 * size + 1e-14


@pytest.mark.parametrize("deck", LOOPS)
def test_loop_forces_of_a_deck_account_for_what_its_open_tree_misses(deck):
    tree = deck_tree(deck, 1e-9)
    rows = run(tree)
    for i, there, attitudes in sampled(tree, rows):
        missing, size = missing_force(there, attitudes, rows.y_rate[i])
        J, gamma = closure_equations(there, attitudes)
        along = [axis - 1 for axis in tree.closures[0].directions]
        assert np.max(np.abs(missing - J.T @ rows.closure_force[i, 0, along])) <= 1e-10 * size
        assert np.max(np.abs(J @ rows.y_rate[i] + gamma)) <= 1e-10 * np.max(np.abs(gamma))


def test_rows_hold_the_derivatives_of_positions_and_speeds():
    """Central differences over 1e-4 s of rows that are good to 1e-12: about 1e-6."""
    tree = random_tree(7, time=TimeGrid(0.0, 0.002, 1e-4))
    tree = replace(tree, integration=replace(tree.integration, rtol=1e-13, atol=1e-13))
    rows = run(tree)
    for position, velocity in (("position", "velocity"), ("velocity", "acceleration"), ("y", "y_rate")):
        values, rates = getattr(rows, position), getattr(rows, velocity)
        change = (values[2:] - values[:-2]) / 2e-4
        assert np.max(np.abs(change - rates[1:-1])) <= 1e-5 * np.max(np.abs(rates))
