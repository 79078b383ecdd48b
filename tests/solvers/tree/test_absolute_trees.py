"""Trees in absolute coordinates: the same accelerations by another way, and what is not carried over."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError, ModelError
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import ELASTIC, INERTIAL, ROTATION, Body, Closure, Hinge, Tree
from flexmb_cli.solvers.constrained.tree import AbsoluteTree
from tests.naive.particle_tree import equations
from tests.naive.random_trees import motored, random_tree, sprung, where
from tests.solvers.tree.tree_runs import deck_tree


def first_row(tree):
    """The first report row, accelerations included."""
    return next(AbsoluteTree(replace(tree, time=TimeGrid(0.0, 1e-6, 1e-6))).rows())


@pytest.mark.parametrize("seed", range(12))
def test_accelerations_are_those_of_particles(seed):
    """Random trees with all kinds of hinges, every second one with hinges that turn with slopes."""
    tree = random_tree(seed, bodies=4, tilted=seed % 2 == 0)
    rows = first_row(tree)
    attitudes = [hinge.attitude for hinge in tree.hinges if len(hinge.rotations) == 3]
    b, remainder, F = equations(tree, tree.q, tree.y, attitudes)
    expected = np.linalg.solve(b, F - remainder)
    assert np.max(np.abs(rows.y_rate[0] - expected)) < 1e-11 * np.max(np.abs(expected))


@pytest.mark.parametrize("seed", range(12))
def test_hinge_coordinates_are_read_off_the_bodies(seed):
    tree = random_tree(seed, bodies=4, tilted=seed % 2 == 0)
    rows = first_row(tree)
    ball = [c.motion == ROTATION and len(tree.hinges[c.body].rotations) == 3 for c in tree.coordinates]
    assert np.array_equal(np.isnan(rows.q[0]), ball)
    assert np.nanmax(np.abs(rows.q[0] - tree.q), initial=0.0) < 1e-12
    assert np.max(np.abs(rows.y[0] - tree.y)) < 1e-12


def refused(tree):
    with pytest.raises(ModelError) as stopped:
        AbsoluteTree(tree)
    return [fault.sentence for fault in stopped.value.faults]


def test_the_one_way_assumption_is_refused():
    (sentence,) = refused(deck_tree("two_link_n2_unco"))
    assert "UNCO" in sentence
    assert "--formulation kane" in sentence


def test_stiffening_by_weight_is_refused():
    (sentence,) = refused(deck_tree("spinning_beams", gravity=(0.0, 9.8, 0.0)))
    assert sentence.startswith("body 2: GSTF with gravity")


def test_dampers_of_three_free_rotations_are_refused():
    tree = deck_tree("spatial_rigid", elements=sprung((0, ROTATION, 1, 0.0, 1.0)))
    assert len(tree.hinges[0].rotations) == 3
    (sentence,) = refused(tree)
    assert sentence.startswith("spring: a damper in a hinge with three free rotations")


def carried(tree, k, motion):
    """Whether a motor in hinge k acts along a coordinate of a position."""
    return motion != ROTATION or len(tree.hinges[k].rotations) < 3


def random_motors(tree):
    """A motor for each coordinate of a hinge; those that are carried over, and the others."""
    kinds = {True: [], False: []}
    for n, c in enumerate(tree.coordinates):
        if c.motion != ELASTIC:
            (motor,) = motored(c.body, c.motion, c.axis, (0.0, 3.0 + n)).forces
            kinds[carried(tree, c.body, c.motion)].append(motor)
    return kinds[True], kinds[False]


@pytest.mark.parametrize("seed", [20, 21, 23, 24, 26, 27, 28, 29, 30, 31])
def test_motors_act_along_their_coordinates(seed):
    tree = random_tree(seed, bodies=5)
    motors, _ = random_motors(tree)
    assert motors
    forces = (*tree.elements.forces, *motors)
    rows = first_row(replace(tree, elements=replace(tree.elements, forces=forces)))
    attitudes = [hinge.attitude for hinge in tree.hinges if len(hinge.rotations) == 3]
    b, remainder, F = equations(tree, tree.q, tree.y, attitudes)
    index = {(c.body, c.motion, c.axis): m for m, c in enumerate(tree.coordinates)}
    for motor in motors:
        F[index[where(motor)]] += motor["function"].values[0]
    expected = np.linalg.solve(b, F - remainder)
    assert np.max(np.abs(rows.y_rate[0] - expected)) < 1e-11 * np.max(np.abs(expected))


def test_motors_in_three_rotations_are_refused():
    """Their angular velocities are no rates of coordinates."""
    trees = (random_tree(seed, bodies=5) for seed in range(20, 60))
    tree, foreign = next((tree, found) for tree in trees if (found := random_motors(tree)[1]))
    sentences = refused(
        replace(tree, elements=replace(tree.elements, forces=(*tree.elements.forces, *foreign)))
    )
    assert len(sentences) == len(foreign)
    assert all("a motor in a hinge with three free rotations" in each for each in sentences)


def spherical_loop(reach):
    """Two rods of 1 m on spherical hinges, the end of the second held `reach` m from the first's root."""
    rod = Body("rod", 1.0, np.diag([0.4, 0.1, 0.4]), (0.0, 0.5, 0.0))
    hinges = Hinge(INERTIAL, rotations=(1, 2, 3)), Hinge(0, (0.0, 1.0, 0.0), rotations=(1, 2, 3))
    closure = Closure("end", 1, INERTIAL, (1, 2, 3), a_point=(0.0, 1.0, 0.0), b_point=(0.0, 0.0, reach))
    grid = TimeGrid(0.0, 1e-6, 1e-6)
    return Tree((rod, rod), hinges, np.zeros(6), np.array([0.3, 1, 0, 0, 0, 2.0]), grid, closures=(closure,))


def test_loops_close_by_turning_spherical_hinges():
    """The ends lie on a line at first; gap and its rate go to round-off by turning both rods."""
    tree = spherical_loop(1.2)
    tilted = replace(tree, hinges=(tree.hinges[0], replace(tree.hinges[1], attitude=(0.9, 0.3, 0.1, 0.2))))
    rows = next(AbsoluteTree(tilted).rows())
    assert rows.constraint_residual[0] < 1e-12
    assert rows.velocity_residual[0] < 1e-12
    root, elbow = rows.position[0]
    assert np.linalg.norm(elbow - root) == pytest.approx(1.0, abs=1e-12)
    assert np.linalg.norm(elbow - [0.0, 0.0, 1.2]) == pytest.approx(1.0, abs=1e-9)


def test_loops_that_cannot_close_are_refused_with_their_gap():
    """Rods of 2 m together cannot reach 2.5 m."""
    with pytest.raises(AnalysisError, match=r"cannot be closed: the two points stay 0\.5 m apart") as stopped:
        AbsoluteTree(spherical_loop(2.5))
    assert stopped.value.time == 0.0
