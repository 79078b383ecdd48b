"""The compiled implicit method: its coefficients, its accuracy, what it walks over, how it resumes."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError
from flexmb_cli.kernels.integrators import sdirk4
from flexmb_cli.kernels.tree.composite_mass import set_mass
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import (
    ELASTIC,
    ROTATION,
    TRANSLATION,
    Body,
    Elasticity,
    Hinge,
    Integration,
    Prescribed,
    Tree,
)
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from flexmb_cli.solvers.tree.state import initial_state
from tests.kernels.tree.test_elastic_rotation import turning_tree
from tests.kernels.tree.test_kane_forward_dynamics import Recursion, close
from tests.naive.random_trees import random_tree, sprung
from tests.solvers.tree.tree_runs import deck_tree, joined, run

pytestmark = pytest.mark.long_motion

SHORT = TimeGrid(0.0, 0.2, 0.01)


def implicit(tree, tolerance):
    return replace(tree, integration=Integration("sdirk4", tolerance, tolerance))


def test_coefficients_fulfil_the_conditions_of_order_four_and_three():
    """Hairer, Nørsett and Wanner, volume I, table II.2.1: the eight conditions of order 4."""
    A, c = sdirk4.WEIGHTS, sdirk4.TIMES
    assert A.sum(axis=1) == pytest.approx(c, abs=1e-15)

    def conditions(b):
        third = [b.sum() - 1, b @ c - 1 / 2, b @ c**2 - 1 / 3, b @ A @ c - 1 / 6]
        fourth = [b @ c**3 - 1 / 4, b @ (c * (A @ c)) - 1 / 8, b @ A @ c**2 - 1 / 12, b @ A @ A @ c - 1 / 24]
        return np.array(third), np.array(fourth)

    assert np.concatenate(conditions(A[-1])) == pytest.approx(np.zeros(8), abs=1e-14)
    third, fourth = conditions(A[-1] - sdirk4.ERROR)
    assert third == pytest.approx(np.zeros(4), abs=1e-14)
    assert np.max(np.abs(fourth)) > 0.01


def test_method_damps_nothing_it_resolves_and_all_it_does_not():
    """|R(iw)| = |1 + iw bᵀ (1 - iw A)^-1 1|: at most 1 everywhere, 0 at infinity, 1 to 1e-4 up to w = 0.5."""
    A = sdirk4.WEIGHTS

    def growth(w):
        return abs(1 + 1j * w * A[-1] @ np.linalg.solve(np.eye(5) - 1j * w * A, np.ones(5)))

    assert max(growth(w) for w in np.logspace(-3, 6, 400)) <= 1 + 1e-12
    assert growth(1e9) < 1e-8
    assert growth(0.5) > 1 - 1e-4


@pytest.mark.parametrize("make", [random_tree, turning_tree])
@pytest.mark.parametrize("seed", range(3))
def test_mass_matrix_is_that_of_the_particles(make, seed):
    recursion = Recursion(make(seed))
    mass = np.zeros((len(recursion.tree.q),) * 2)
    set_mass(recursion.arrays, recursion.work, recursion.coordinates, initial_state(recursion.tree), mass)
    close(np.triu(mass), np.triu(recursion.dense()[0]), 1e-11)


@pytest.mark.parametrize("deck", ["shaft_beam_n2", "two_link_n2_unco", "spatial_flex"])
def test_motion_is_that_of_the_explicit_method(deck):
    """With pulses, one-way motion and Euler parameters; amplitudes are 0.01 to 1."""
    tree = deck_tree(deck, 1e-10)
    tree = replace(tree, time=TimeGrid(0.0, 20 * tree.time.step, tree.time.step))
    expected = run(tree)
    errors = [np.max(np.abs(run(implicit(tree, tol)).q - expected.q)) for tol in (1e-5, 1e-7)]
    assert errors[0] < 1e-4
    assert errors[1] < 1e-6


def test_springs_dampers_and_driven_hinges_of_a_random_tree():
    """Accelerations, Euler parameters and the energy audit are those of the explicit method."""
    tree = random_tree(5, bodies=4, time=SHORT)
    body, axis = next((k, h.rotations[0]) for k, h in enumerate(tree.hinges) if len(h.rotations) in (1, 2))
    tree = replace(tree, prescribed=(Prescribed(body, ROTATION, axis, 0.1, 0.5, -0.4),))
    expected = run(replace(tree, integration=Integration("dop853", 1e-11, 1e-11)))
    found = run(implicit(tree, 1e-8))
    assert np.array_equal(found.time, expected.time)
    for name in ("q", "y", "euler_parameters", "applied_work"):
        close(getattr(found, name), getattr(expected, name), 1e-6)
    close(found.y_rate, expected.y_rate, 1e-4)
    assert np.ptp(found.total) <= 1e-5 * np.max(np.abs(found.kinetic))


def test_vibrations_that_the_tolerance_does_not_ask_for_cost_nothing():
    """A node of 1 kg on a spring of 1e10 N/m, at rest but for gravity: 16 kHz that nothing excites."""
    elastic = Elasticity(
        np.array([[0.0, 1.0, 0.0]]), np.array([1.0]), (2,), np.array([[1e10]]), np.zeros((1, 3))
    )
    tree = Tree(
        (Body("rod", 1.0, np.diag([1.1, 0.1, 1.1]), elastic=elastic),),
        (Hinge(-1, rotations=(1,)),),
        np.array([1.0, 0.0]),
        np.zeros(2),
        TimeGrid(0.0, 0.2, 0.1),
    )
    stiff = TreeAnalysis(implicit(tree, 1e-6))
    rows = joined(list(stiff.rows()))
    assert stiff.clock["evaluations"][0] < 3000
    # A rigid rod: 1.1 kg m² about the hinge, 1 kg at 1 m; the energy is exact.
    energy = 9.8 * (np.cos(1.0) - np.cos(rows.q[-1, 0])) + 0.5 * 1.1 * rows.y[-1, 0] ** 2
    assert energy == pytest.approx(0.0, abs=1e-4)


def test_resumed_run_gives_the_numbers_of_an_uninterrupted_one():
    tree = implicit(deck_tree("shaft_beam_n2"), 1e-5)
    whole = run(tree)
    stopped = TreeAnalysis(tree)
    rows, first = stopped.rows(), []
    while sum(len(block.time) for block in first) < 130:
        first.append(next(rows))
    again = joined(first + list(TreeAnalysis(tree, stopped.checkpoint).rows()))
    assert np.array_equal(again.time, whole.time)
    assert np.array_equal(again.q, whole.q)


@pytest.mark.parametrize("deck", ["fourbar_rigid", "fourbar_flex", "slider_crank_flex"])
def test_closed_loops_move_as_by_the_explicit_method_and_stay_closed(deck):
    """Angles are of order 1, deflections 1e-3 and less."""
    tree = deck_tree(deck, 1e-10)
    tree = replace(tree, time=TimeGrid(0.0, 20 * tree.time.step, tree.time.step))
    expected = run(tree)
    for tolerance, allowed in ((1e-5, 1e-4), (1e-7, 1e-6)):
        found = run(implicit(tree, tolerance))
        assert np.max(np.abs(found.q - expected.q)) < allowed
        assert np.max(found.constraint_residual) < 2e-13
        assert np.max(found.velocity_residual) < 1e-12
    close(found.closure_force, expected.closure_force, 1e-3)


def test_stiff_links_in_a_closed_loop_move_as_rigid_ones_and_cost_less_than_soft_ones():
    """Links 1e8 times stiffer, at rest at first: deflections of 1e-12 m, which nothing excites.

    The rigid links have the same masses at the same places and are stepped explicitly.
    """
    tree = deck_tree("fourbar_flex", 1e-10)
    tree = replace(tree, time=TimeGrid(0.0, 10 * tree.time.step, tree.time.step))
    deflected = np.array([c.motion == ELASTIC for c in tree.coordinates])
    tree = replace(tree, q=np.where(deflected, 0.0, tree.q), y=np.where(deflected, 0.0, tree.y))
    stiff, soft = TreeAnalysis(implicit(stiffened(tree, 1e8), 1e-6)), TreeAnalysis(implicit(tree, 1e-6))
    rows, _ = joined(list(stiff.rows())), joined(list(soft.rows()))
    assert stiff.clock["evaluations"][0] < soft.clock["evaluations"][0]
    assert np.max(np.abs(rows.q[:, ~deflected] - run(rigid(tree)).q)) < 1e-4


def stiffened(tree, factor):
    """The tree with elastic bodies that many times stiffer."""
    bodies = list(tree.bodies)
    for k, body in enumerate(bodies):
        if body.elastic is not None:
            elastic = replace(body.elastic, stiffness=factor * body.elastic.stiffness)
            bodies[k] = replace(body, elastic=elastic)
    return replace(tree, bodies=tuple(bodies))


def rigid(tree):
    """The tree with rigid bodies of the same masses at the same undeflected places."""
    elastic = [body.elastic for body in tree.bodies]
    bodies = [
        body if e is None else replace(body, elastic=None, centre=tuple(e.masses @ e.positions / body.mass))
        for body, e in zip(tree.bodies, elastic, strict=True)
    ]
    hinges = [
        hinge
        if hinge.node is None
        else replace(hinge, node=None, point=elastic[hinge.parent].positions[hinge.node])
        for hinge in tree.hinges
    ]
    (closure,) = tree.closures
    if closure.a_node is not None:
        closure = replace(closure, a_node=None, a_point=elastic[closure.a].positions[closure.a_node])
    n = sum(c.motion != ELASTIC for c in tree.coordinates)
    return replace(
        tree, bodies=tuple(bodies), hinges=tuple(hinges), closures=(closure,), q=tree.q[:n], y=tree.y[:n]
    )


def test_motion_without_bound_is_reported_with_time_and_coordinate():
    """A spring that pushes (stiffness < 0 on a slide of 1 kg) grows as exp(1000 t) and overflows."""
    tree = Tree(
        (Body("slide", 1.0, np.eye(3)),),
        (Hinge(-1, translations=(2,)),),
        np.ones(1),
        np.zeros(1),
        TimeGrid(0.0, 2.0, 0.1),
        elements=sprung((0, TRANSLATION, 2, -1e6)),
    )
    with pytest.raises(AnalysisError, match="t = 0"):
        run(implicit(tree, 1e-6))
