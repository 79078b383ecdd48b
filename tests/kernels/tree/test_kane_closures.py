"""Closed loops against the reduction to independent speeds (thesis 3.17-3.25), from particles."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

from flexmb_cli.kernels.tree.projection import respond_to_rows
from flexmb_cli.model.tree import INERTIAL, Closure
from flexmb_cli.solvers.tree.state import initial_state
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close
from tests.naive.particle_tree import Particles, second_derivative
from tests.naive.random_trees import random_tree

# A closure may hold a point along some axes only; its gap along the others is then not small.
DIRECTIONS = [(1, 2, 3), (1, 3), (2,)]


def gap(particles, closure, q, turned):
    """Components of p_a - p_b along the closed axes of body b."""
    frames = particles.frames(q, turned)
    p, S = frames[closure.a]
    origin, T = (np.zeros(3), np.eye(3)) if closure.b == INERTIAL else frames[closure.b]
    a = end(particles, closure.a, closure.a_node, closure.a_point, q)
    apart = p + S @ a - origin - T @ end(particles, closure.b, closure.b_node, closure.b_point, q)
    return (T.T @ apart)[[axis - 1 for axis in closure.directions]]


def end(particles, body, node, point, q):
    """Point of a body in its axes: a displaced node, or a fixed point."""
    if node is None:
        return np.array(point)
    return particles.tree.bodies[body].elastic.positions[node] + particles.displacement(body, node, q)


def closure_equations(tree, attitudes):
    """J (R, NS) and the remainder of the closures' accelerations (R,)."""
    particles = Particles(tree, attitudes)
    q, y, n = tree.q, tree.y, len(tree.q)
    steps = 1e-30j * np.eye(n)
    gaps = lambda q, turned: np.concatenate([gap(particles, c, q, turned) for c in tree.closures])  # noqa: E731
    J = np.stack([gaps(q + step, step).imag * 1e30 for step in steps], axis=1)
    return J, second_derivative(lambda t: gaps(q + t * y, t * y), y)


def looped_tree(seed, directions=(1, 2, 3), b=1, tilted=False):
    """A random tree whose last body is tied to another one; the gap itself need not be closed."""
    tree = random_tree(seed, bodies=6, tilted=tilted)
    ends = {"a_point": (0.3, -0.2, 0.4), "b_point": (0.1, 0.5, -0.3)}
    return replace(tree, closures=(Closure("loop", 5, b, directions, **ends),))


@pytest.mark.parametrize("b", [1, INERTIAL])
@pytest.mark.parametrize("directions", DIRECTIONS)
@pytest.mark.parametrize("seed", [1, 3, 4])
def test_accelerations_in_closed_loops_are_those_of_the_reduced_equations(seed, directions, b):
    """y' = A y_i' + c, (A' b A) y_i' = A' (F - f* - b c), with A a basis of J A = 0.

    Closed along some axes of body b only, a point may lie anywhere along the others; closed along
    all three, the gap is closed first by putting point b where point a is.
    """
    tree = looped_tree(seed, directions, b)
    tree = closed_where_it_is(tree)
    recursion = Recursion(tree)
    mass, remainder, force = recursion.dense()
    J, gamma = closure_equations(tree, recursion.attitudes)
    # The closures look at speeds that do not close; their relative velocity is then not zero.
    A = null_space(J)
    c = -np.linalg.pinv(J) @ gamma
    expected = A @ np.linalg.solve(A.T @ mass @ A, A.T @ (force - remainder - mass @ c)) + c
    close(recursion.forward(), expected, 1e-9)
    reaction = mass @ expected + remainder - force
    close(J.T @ recursion.arrays.closures["force"], reaction, 1e-9)


def closed_where_it_is(tree):
    """The tree with point b moved, along the closed axes, to where point a is."""
    recursion = Recursion(tree)
    closure = tree.closures[0]
    there = gap(Particles(tree, recursion.attitudes), closure, tree.q + 0j, 0 * tree.q)
    b_point = np.array(closure.b_point)
    b_point[[axis - 1 for axis in closure.directions]] += there.real
    return replace(tree, closures=(replace(closure, b_point=tuple(b_point)),))


@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("seed", [1, 3, 4, 6, 7])
def test_a_correction_that_closes_rows_is_the_least_in_the_measure_of_the_mass(seed, tilted):
    """x = -b⁻¹ Jᵀ (J b⁻¹ Jᵀ)⁻¹ gap: the minimum of x · b x for J x = -gap."""
    tree = closed_where_it_is(looped_tree(seed, tilted=tilted))
    recursion, gaps = Recursion(tree), np.array([0.3, -0.2, 0.1])
    recursion.forward()
    recursion.arrays.closures["force"] = -gaps
    respond_to_rows(recursion.arrays, recursion.work, recursion.coordinates, initial_state(tree))
    J, _ = closure_equations(tree, recursion.attitudes)
    yielding = np.linalg.solve(recursion.dense()[0], J.T)
    close(recursion.coordinates["response"], -yielding @ np.linalg.solve(J @ yielding, gaps), 1e-9)


def test_loop_answers_to_a_prescribed_acceleration_once():
    """The open and the closed solution both see it; b y' = F - f* + Jᵀ force in all other rows."""
    tree = closed_where_it_is(looped_tree(3))
    m = next(i for i, c in enumerate(tree.coordinates) if c.body == 0)
    recursion = Recursion(tree)
    recursion.coordinates["held"][m], recursion.coordinates["rate"][m] = 1, 3.0
    mass, remainder, force = recursion.dense()
    J, gamma = closure_equations(tree, recursion.attitudes)
    rates = recursion.forward()
    assert rates[m] == 3.0
    close(J @ rates, -gamma, 1e-9)
    missing = mass @ rates + remainder - force - J.T @ recursion.arrays.closures["force"]
    close(np.delete(missing, m), 0.0 * np.delete(missing, m), 1e-8)


def test_closure_that_repeats_another_carries_nothing_and_changes_nothing():
    tree = closed_where_it_is(looped_tree(3))
    twice = replace(tree, closures=tree.closures * 2)
    once, doubled = Recursion(tree), Recursion(twice)
    close(doubled.forward(), once.forward(), 1e-10)
    forces = doubled.arrays.closures["force"].reshape(2, 3)
    assert np.count_nonzero(forces) == 3
    close(forces.sum(axis=0), once.arrays.closures["force"], 1e-8)
