"""The matrix of an implicit step against dense linear algebra, b and J from particles."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels.integrators.clock import new_clock
from flexmb_cli.kernels.integrators.sdirk4 import DIAGONAL, _correct, implicit_work
from flexmb_cli.kernels.linalg.profile_ldl import factorise_profile, set_profile_times, substitute_profile
from flexmb_cli.kernels.tree.implicit_matrix import factorise, renew, set_mass_times, solve_stiff, stiff_work
from flexmb_cli.model.laws import SPRING
from flexmb_cli.model.tree import ELASTIC, ROTATION, Prescribed
from flexmb_cli.solvers.tree.state import initial_state
from tests.kernels.tree.test_elastic_rotation import turning_tree
from tests.kernels.tree.test_kane_closures import closed_where_it_is, closure_equations, looped_tree
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close
from tests.naive.random_trees import random_tree, where

F = 0.3  # s: no spring, damper or mass is negligible in b + F D + F² K


def profile(seed, n=9):
    """A random positive definite matrix (n, n) with rows of random length, and their ends."""
    rng = np.random.default_rng(seed)
    ends = np.array([rng.integers(i + 1, n + 1) for i in range(n)])
    upper = np.triu(rng.normal(size=(n, n)), 1)
    for i in range(n):
        upper[i, ends[i] :] = 0.0
    return upper + upper.T + n * np.eye(n), ends


@pytest.mark.parametrize("seed", range(4))
def test_factors_in_the_profile_solve_the_system(seed):
    A, ends = profile(seed)
    x = np.random.default_rng(seed).normal(size=len(A))
    product, factors = np.empty(len(A)), np.triu(A)
    set_profile_times(np.triu(A), ends, x, product)
    assert product == pytest.approx(A @ x, rel=1e-13)
    assert factorise_profile(factors, ends)
    assert [np.any(row[end:]) for row, end in zip(factors, ends, strict=True)] == [False] * len(A)
    substitute_profile(factors, ends, product)
    assert product == pytest.approx(x, rel=1e-12)


def test_matrix_that_is_not_positive_definite_is_not_factorised():
    A, ends = profile(1)
    assert not factorise_profile(np.triu(A - 2 * len(A) * np.eye(len(A))), ends)


def dense_parts(recursion):
    """b, D and K (NS, NS) of a tree without stiffening, coordinate by coordinate."""
    tree = recursion.tree
    mass, D, K = recursion.dense()[0], *np.zeros((2, len(tree.q), len(tree.q)))
    if tree.one_way:
        mass[np.ix_(~recursion.arrays.elastic, recursion.arrays.elastic)] = 0.0
    for k, body in enumerate(tree.bodies):
        own = [m for m, c in enumerate(tree.coordinates) if c.body == k and c.motion == ELASTIC]
        if own:
            K[np.ix_(own, own)] = body.elastic.stiffness
            D[np.ix_(own, own)] = body.elastic.damping
    place = {(c.body, c.motion, c.axis): m for m, c in enumerate(tree.coordinates)}
    for spring in tree.elements.of(SPRING):
        m = place[where(spring)]
        K[m, m] += spring["stiffness"]
        D[m, m] += spring["damping"]
    return mass, D, K


def solved(recursion, residual):
    """b times residual, and the solution that belongs to it."""
    arrays, n = recursion.arrays, len(residual)
    stiff = stiff_work(arrays.closures, n, len(arrays.answers))
    renew(arrays, recursion.work, recursion.coordinates, initial_state(recursion.tree), stiff)
    assert factorise(arrays, F, stiff)
    product = np.empty(n)
    set_mass_times(arrays, residual, stiff, product)
    x = product.copy()
    solve_stiff(arrays, residual, x, stiff)
    return product, x


@pytest.mark.parametrize("one_way", [False, True])
@pytest.mark.parametrize("make", [random_tree, turning_tree])
@pytest.mark.parametrize("seed", range(3))
def test_iteration_of_an_open_tree_solves_its_linear_system(make, seed, one_way):
    recursion = Recursion(make(seed, one_way=one_way))
    residual = np.random.default_rng(seed).normal(size=len(recursion.tree.q))
    mass, D, K = dense_parts(recursion)
    product, x = solved(recursion, residual)
    close(product, mass @ residual, 1e-11)
    close(x, np.linalg.solve(mass + F * D + F**2 * K, mass @ residual), 1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_correction_of_a_stage_is_that_of_newton_and_its_size_counts_tolerances(seed):
    """Slopes of speeds by the linear system, the others as they were evaluated.  The size is the norm of
    Hairer, Nørsett and Wanner I (II.4.11) of what moves speeds, coordinates and attitudes in the stage."""
    recursion = Recursion(random_tree(seed))
    arrays, z, n = recursion.arrays, initial_state(recursion.tree), len(recursion.tree.q)
    counted = len(z) - 1 - len(arrays.answers)
    clock, random = new_clock(counted), np.random.default_rng(seed)
    s = implicit_work(clock, z.copy(), n, arrays.closures, len(arrays.answers))
    clock["rtol"], clock["atol"] = 0.2, 0.1
    renew(arrays, recursion.work, recursion.coordinates, z, s.stiff)
    assert factorise(arrays, F, s.stiff)
    s.trial[:], s.rate[:], slope = z, random.normal(size=len(z)), random.normal(size=len(z))
    mass, D, K = dense_parts(recursion)
    x = np.linalg.solve(mass + F * D + F**2 * K, mass @ (s.rate - slope)[:n])
    rest = (s.rate - slope)[2 * n :]
    moved = np.concatenate([F * x, F**2 * x, F * rest])[:counted]  # works are the last
    found = _correct(arrays, F / DIAGONAL, slope, s)
    assert found == pytest.approx(
        np.sqrt(np.mean((moved / (0.1 + 0.2 * np.abs(z[:counted]))) ** 2)), rel=1e-9
    )
    close(slope[2 * n :], s.rate[2 * n :], 0.0)
    close(s.change, x, 1e-9)


@pytest.mark.parametrize("directions", [(1, 2, 3), (2,)])
@pytest.mark.parametrize("seed", [1, 3, 4])
def test_iteration_of_a_closed_loop_leaves_its_closures_to_unknown_forces(seed, directions):
    """(b + f D + f² K) x + Jᵀ force = b r with J x = J r."""
    recursion = Recursion(closed_where_it_is(looped_tree(seed, directions)))
    residual = np.random.default_rng(seed).normal(size=len(recursion.tree.q))
    mass, D, K = dense_parts(recursion)
    J, _ = closure_equations(recursion.tree, recursion.attitudes)
    whole = np.block([[mass + F * D + F**2 * K, J.T], [J, np.zeros((len(J), len(J)))]])
    expected = np.linalg.solve(whole, np.concatenate([mass @ residual, J @ residual]))
    close(solved(recursion, residual)[1], expected[: len(residual)], 1e-8)


def test_closure_that_repeats_another_changes_nothing():
    tree = closed_where_it_is(looped_tree(3))
    residual = np.random.default_rng(3).normal(size=len(tree.q))
    once = solved(Recursion(tree), residual)[1]
    twice = solved(Recursion(replace(tree, closures=tree.closures * 2)), residual)[1]
    close(twice, once, 1e-7)


def test_driven_hinge_of_a_closed_loop_leaves_the_closures_to_the_others():
    """It has the row and column of the unit matrix and no column of J: others close the loop."""
    tree = closed_where_it_is(looped_tree(3))
    axis = tree.hinges[0].rotations[0]
    m = next(i for i, c in enumerate(tree.coordinates) if (c.body, c.motion, c.axis) == (0, ROTATION, axis))
    tree = replace(tree, prescribed=(Prescribed(0, ROTATION, axis, tree.q[m], tree.y[m], 0.0),))
    recursion = Recursion(tree)
    residual = np.random.default_rng(3).normal(size=len(tree.q))
    residual[m] = 0.0
    x = solved(recursion, residual)[1]
    mass, D, K = dense_parts(recursion)
    J, _ = closure_equations(tree, recursion.attitudes)
    others = np.arange(len(residual)) != m
    A, J, r = (mass + F * D + F**2 * K)[np.ix_(others, others)], J[:, others], residual[others]
    whole = np.block([[A, J.T], [J, np.zeros((len(J), len(J)))]])
    right_side = np.concatenate([mass[np.ix_(others, others)] @ r, J @ r])
    close(x[others], np.linalg.solve(whole, right_side)[: len(r)], 1e-8)
    assert x[m] == 0.0
