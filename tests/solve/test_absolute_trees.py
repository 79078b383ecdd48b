"""Trees in absolute coordinates: the same accelerations by another way, and what is not carried over."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import ROTATION, TRANSLATION, Motor, Spring, constant
from flexmb_cli.solve.absolute_tree import AbsoluteTree
from tests.naive.particle_tree import equations
from tests.naive.random_trees import random_tree
from tests.solve.tree_runs import deck_tree


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


def test_motors_and_dampers_that_turn_no_single_axis_are_refused():
    tree = deck_tree("spatial_rigid")
    assert len(tree.hinges[0].rotations) == 3
    items = {
        "motors": (Motor(0, ROTATION, 1, constant(1.0)),),
        "springs": (Spring(0, ROTATION, 1, damping=1.0),),
    }
    assert [sentence.split(" is not")[0] for sentence in refused(replace(tree, **items))] == [
        "damper of body 1: a damper in a hinge with three free rotations",
        "motor of body 1: a motor in a hinge with more than one free rotation",
    ]


def test_a_motor_along_a_slide_is_refused():
    tree = deck_tree("sliding_mass")
    slide = next(c for c in tree.coordinates if c.motion == TRANSLATION)
    (sentence,) = refused(replace(tree, motors=(Motor(slide.body, TRANSLATION, slide.axis, constant(1.0)),)))
    assert "a motor along a translation" in sentence
