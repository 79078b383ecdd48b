"""Hinges that turn with the slope of their node, against particles (thesis 2.7, 2.24, 2.27)."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.tree import Closure
from tests.kernels.tree.test_kane_closures import closed_where_it_is, closure_equations
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close
from tests.naive.random_trees import random_tree

SEEDS = range(12)


def turning_tree(seed, **options):
    """A random tree of which at least one hinge turns with its node."""
    for other in range(100):
        tree = random_tree(100 * seed + other, flexible=0.8, tilted=True, **options)
        if any(hinge.elastic_rotation is not None for hinge in tree.hinges):
            return tree
    raise AssertionError("no tree with a turning hinge")


@pytest.mark.parametrize("seed", SEEDS)
def test_accelerations_are_those_of_the_particles(seed):
    recursion = Recursion(turning_tree(seed))
    b, remainder, force = recursion.dense()
    close(recursion.forward(), np.linalg.solve(b, force - remainder), 1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_efforts_of_a_given_motion_are_those_of_the_particles(seed):
    recursion = Recursion(turning_tree(seed))
    rates = np.random.default_rng(seed).normal(size=len(recursion.tree.q))
    b, remainder, force = recursion.dense()
    close(recursion.inverse(rates), b @ rates + remainder - force, 1e-11)


@pytest.mark.parametrize("seed", range(4))
def test_one_way_motion_leaves_elastic_inertia_out_of_the_rigid_rows_only(seed):
    recursion = Recursion(turning_tree(seed, one_way=True))
    b, remainder, force = recursion.dense()
    elastic = recursion.arrays.elastic
    b[np.ix_(~elastic, elastic)] = 0.0
    close(recursion.forward(), np.linalg.solve(b, force - remainder), 1e-10)


def test_hinges_that_turn_and_hinges_that_do_not_share_a_node():
    """Two bodies on one node, one with the elastic rotation and one without, and a third elsewhere."""
    tree = random_tree(3, bodies=4, flexible=1.0, tilted=False)
    elastic = tree.bodies[0].elastic
    C = np.random.default_rng(1).normal(size=(3, elastic.coordinates)) * 0.5
    nodes = (0, 0, len(elastic.masses) - 1)
    hinges = [
        replace(
            hinge,
            parent=0,
            node=node,
            point=tuple(elastic.positions[node]),
            elastic_rotation=C if turns else None,
        )
        for hinge, node, turns in zip(tree.hinges[1:], nodes, (True, False, True), strict=True)
    ]
    recursion = Recursion(replace(tree, hinges=(tree.hinges[0], *hinges)))
    b, remainder, force = recursion.dense()
    close(recursion.forward(), np.linalg.solve(b, force - remainder), 1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_forces_in_closed_loops_account_for_what_the_open_tree_misses(seed):
    """A loop between the last two bodies: b y' = F - f* + Jᵀ force, J y' = -gamma."""
    ends = {"a_point": (0.3, -0.2, 0.4), "b_point": (0.1, 0.5, -0.3)}
    tree = turning_tree(seed, bodies=6)
    tree = closed_where_it_is(replace(tree, closures=(Closure("loop", 5, 1, (1, 2, 3), **ends),)))
    recursion = Recursion(tree)
    b, remainder, force = recursion.dense()
    J, gamma = closure_equations(tree, recursion.attitudes)
    rates = recursion.forward()
    close(J @ rates, -gamma, 1e-9)
    close(b @ rates + remainder - force, J.T @ recursion.arrays.closures["force"], 1e-9)
