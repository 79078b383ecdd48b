"""Stepping of trees: report times, jumps, tolerance, interruption and failure."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import DOP853, solve_ivp

from flexmb_cli.errors import AnalysisError
from flexmb_cli.kernels.integrators import dop853_table as table
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.piecewise_polynomials import linear_table
from flexmb_cli.model.time_functions import piecewise, pulse
from flexmb_cli.model.tree import TRANSLATION, Body, BodyTorque, Elasticity, Hinge, Integration, Tree
from flexmb_cli.solvers.tree import steps
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.naive.random_trees import random_tree, sprung
from tests.solvers.tree.tree_runs import deck_tree, joined, run

pytestmark = pytest.mark.long_motion


def wheel(function, end=1.0, step=0.1):
    """A disc of 2 kg m² about axis 1 that nothing but a torque law moves."""
    body = Body("wheel", 1.0, np.diag([2.0, 1.0, 1.0]))
    return Tree(
        (body,),
        (Hinge(-1, rotations=(1,)),),
        np.zeros(1),
        np.zeros(1),
        TimeGrid(0.0, end, step),
        gravity=(0.0, 0.0, 0.0),
        torques=(BodyTorque(0, 1, function),),
    )


def test_coefficients_are_those_of_scipys_dop853():
    weights = np.zeros((16, 16))
    weights[:12, :12], weights[12, :12] = DOP853.A[:12, :12], DOP853.B
    weights[13:, : DOP853.A_EXTRA.shape[1]] = DOP853.A_EXTRA
    assert np.array_equal(table.STAGE_WEIGHTS, weights)
    assert np.array_equal(table.STAGE_TIMES, np.concatenate([DOP853.C[:12], [1.0], DOP853.C_EXTRA]))
    assert np.array_equal(table.ERROR_3[: DOP853.E3.size], DOP853.E3)
    assert np.array_equal(table.ERROR_5[: DOP853.E5.size], DOP853.E5)
    assert np.array_equal(table.DENSE_WEIGHTS, DOP853.D)


def test_pulse_of_a_torque_leaves_the_wheel_at_rest_at_the_exact_angle():
    """+F for T, nothing, -F for T: the angle is 2 F T²/J, the speed exactly 0."""
    rows = run(wheel(pulse(3.0, 0.1)))
    assert rows.q[-1, 0] == pytest.approx(2 * 3.0 * 0.1**2 / 2.0, rel=1e-14)
    assert abs(rows.y[-1, 0]) < 1e-15


def test_table_is_linear_between_its_points_and_held_at_its_ends():
    """2 θ'' = 4 t up to 0.5, then 2: speed 0.25 at 0.5 and 0.75 at 1."""
    rows = run(wheel(piecewise(linear_table((0.0, 0.5), (0.0, 2.0)))))
    assert rows.y[[5, 10], 0] == pytest.approx([0.25, 0.75], rel=1e-13)


def test_report_rows_stand_at_multiples_of_the_step():
    rows = run(deck_tree("shaft_beam_n2", 1e-6))
    assert np.array_equal(rows.time, 0.001 * np.arange(501))


def test_dense_output_agrees_with_steps_that_end_at_the_report_time():
    """A breakpoint of a torque that is always 0 makes a step end at 0.37."""
    tree = deck_tree("two_link_n2", 1e-11)
    idle = replace(tree, torques=(BodyTorque(0, 1, piecewise(linear_table((0.0, 0.37), (0.0, 0.0)))),))
    assert np.max(np.abs(run(idle).q[37] - run(tree).q[37])) < 1e-11


def test_error_falls_with_the_tolerance():
    exact = run(deck_tree("spatial_flex", 1e-13)).q[-1]
    errors = [
        np.max(np.abs(run(deck_tree("spatial_flex", tol)).q[-1] - exact)) for tol in (1e-6, 1e-8, 1e-10)
    ]
    assert errors[0] > 10 * errors[1] > 100 * errors[2]


def test_rows_do_not_depend_on_how_the_run_is_cut_into_calls(monkeypatch):
    tree = deck_tree("shaft_beam_n2", 1e-8)
    whole = run(tree)
    monkeypatch.setattr(steps, "CALL_WORK", 100)
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 7)
    assert np.array_equal(run(tree).q, whole.q)


@pytest.mark.parametrize("block", [1, 3])
def test_resumed_run_gives_the_numbers_of_an_uninterrupted_one(monkeypatch, block):
    tree = replace(random_tree(8), time=TimeGrid(0.0, 1.0, 0.01))
    whole = run(tree)
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 13)
    stopped = TreeAnalysis(tree)
    first = [next(rows) for rows in [stopped.rows()] for _ in range(block)]
    rest = list(TreeAnalysis(tree, stopped.checkpoint).rows())
    again = joined(first + rest)
    assert np.array_equal(again.time, whole.time)
    for name in ("q", "y", "euler_parameters", "applied_work", "acceleration"):
        assert np.array_equal(getattr(again, name), getattr(whole, name)), name


def test_resume_inside_a_pulse_keeps_the_jumps(monkeypatch):
    tree = deck_tree("shaft_beam_n2", 1e-8)
    whole = run(tree)
    monkeypatch.setattr(steps, "LARGEST_BLOCK", 60)
    stopped = TreeAnalysis(tree)
    rows = stopped.rows()
    first = [next(rows), next(rows)]
    again = joined(first + list(TreeAnalysis(tree, stopped.checkpoint).rows()))
    assert np.array_equal(again.q, whole.q)


@pytest.mark.parametrize("method", ["radau", "lsoda"])
def test_resume_of_other_integrators_gives_the_same_numbers(method):
    tree = replace(deck_tree("shaft_beam_n2"), integration=Integration(method, 1e-6, 1e-6))
    whole = run(tree)
    stopped = TreeAnalysis(tree)
    rows = stopped.rows()
    first = []
    while sum(len(block.time) for block in first) < 130:
        first.append(next(rows))
    again = joined(first + list(TreeAnalysis(tree, stopped.checkpoint).rows()))
    assert np.array_equal(again.time, whole.time)
    assert np.array_equal(again.q, whole.q)


def test_body_with_nothing_that_resists_its_hinge_is_reported_with_time_and_name():
    tree = wheel(piecewise(linear_table((0.0,), (1.0,))))
    thin = replace(tree.bodies[0], inertia=np.diag([0.0, 1.0, 1.0]))
    with pytest.raises(AnalysisError) as caught:
        run(replace(tree, bodies=(thin,)))
    assert caught.value.time == 0.0
    assert "'wheel rotation 1'" in str(caught.value)


def test_motion_without_bound_keeps_the_rows_before_and_names_time_and_coordinate():
    """A spring that pushes (stiffness < 0 on a slide of 1 kg) grows as exp(1000 t) and overflows."""
    tree = Tree(
        (Body("slide", 1.0, np.eye(3)),),
        (Hinge(-1, translations=(2,)),),
        np.ones(1),
        np.zeros(1),
        TimeGrid(0.0, 2.0, 0.1),
        elements=sprung((0, TRANSLATION, 2, -1e6)),
    )
    kept = []
    with pytest.raises(AnalysisError, match="slide translation 2") as caught:
        kept.extend(TreeAnalysis(tree).rows())
    assert 0.6 < caught.value.time < 0.8
    assert joined(kept).time[-1] == pytest.approx(0.7, abs=0.11)


@pytest.mark.parametrize(("method", "allowed"), [("radau", 1e-7), ("lsoda", 1e-6)])
def test_other_integrators_give_the_motion_of_the_default_one(method, allowed):
    """Shaft and beam with the jumps of its pulse; tips move by 0.015 m."""
    tree = deck_tree("shaft_beam_n2", 1e-10)
    other = replace(tree, integration=Integration(method, 1e-8, 1e-8))
    found, expected = run(other), run(tree)
    assert np.array_equal(found.time, expected.time)
    assert np.max(np.abs(found.q - expected.q)) < allowed


def test_implicit_integrator_walks_over_vibrations_that_its_tolerance_does_not_ask_for():
    """A node of 1 kg on a spring of 1e10 N/m, at rest but for gravity: 16 kHz that nothing excites."""
    elastic = Elasticity(
        np.array([[0.0, 1.0, 0.0]]), np.array([1.0]), (2,), np.array([[1e10]]), np.zeros((1, 3))
    )
    body = Body("rod", 1.0, np.diag([1.1, 0.1, 1.1]), elastic=elastic)
    tree = Tree(
        (body,),
        (Hinge(-1, rotations=(1,)),),
        np.array([1.0, 0.0]),
        np.zeros(2),
        TimeGrid(0.0, 0.2, 0.1),
        integration=Integration("radau", 1e-6, 1e-6),
    )
    stiff = TreeAnalysis(tree)
    rows = joined(list(stiff.rows()))
    assert stiff.clock["evaluations"][0] < 3000
    # A rigid pendulum: 1.1 y' = -9.8 sin q.
    exact = solve_ivp(
        lambda t, z: [z[1], -9.8 / 1.1 * np.sin(z[0])], (0, 0.2), [1.0, 0.0], rtol=1e-10, atol=1e-10
    ).y[0, -1]
    assert rows.q[-1, 0] == pytest.approx(exact, abs=1e-6)
