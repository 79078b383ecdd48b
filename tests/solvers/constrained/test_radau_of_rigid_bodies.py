"""Radau's method of order 5 for rigid mechanisms: closed forms, its order, its rows, where it must stop."""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.errors import AnalysisError
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.loads import DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Driver, Joint, Mechanism, Simplified, TimeGrid
from flexmb_cli.solvers.constrained import analysis as constrained_motion
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.solvers.constrained import squeezer
from tests.solvers.constrained.body_balances import worst_balance
from tests.solvers.constrained.dynamic_runs import AT_REST, DECKS, GROUND, body, joined, run
from tests.solvers.constrained.test_alpha_of_rigid_bodies import (
    angle_from_vertical,
    bar_angles,
    swinging_bar,
    timed,
)
from tests.solvers.constrained.test_forward_dynamics import G, double_pendulum

Z = (0.0, 0.0, 1.0)


@pytest.fixture
def integration():
    """A run by Radau's method: all rows, and the analysis."""

    def rows_and_analysis(model, tolerance=1e-8):
        analysis = ForwardDynamics(replace(model, integrator=Integrator("RAD5", tolerance=tolerance)))
        return joined(list(analysis.rows())), analysis

    return rows_and_analysis


@pytest.mark.long_motion
def test_a_bar_swings_by_elliptic_functions_with_order_five(integration):
    """rate² = m g l / J about the hinge = 3 g / (2 L)."""
    model, errors, steps = swinging_bar(), [], []
    for tolerance in (1e-5, 1e-7, 1e-9):
        rows, analysis = integration(model, tolerance)
        exact = angle_from_vertical(rows.time, math.sqrt(1.5 * G))
        errors.append(np.max(np.abs(bar_angles(rows) - exact)))
        steps.append(analysis.clock["steps"][0])
        assert rows.constraint_residual.max() < 1e-14
        assert rows.velocity_residual.max() < 1e-14
        assert worst_balance(model, rows) < 1e-11
        assert np.ptp(rows.total) < 10.0 * tolerance * rows.kinetic.max()
    order = -np.diff(np.log(errors)) / np.diff(np.log(steps))
    assert errors[2] < 1e-10
    assert np.all((order > 4.5) & (order < 7.5))


def test_speeds_and_accelerations_of_rows_inside_steps_are_those_of_the_motion(integration):
    """Against DOP853 with 1e-12; rows every 7 ms fall anywhere in the steps."""
    model = timed(double_pendulum(), 0.3, 0.007)
    exact = run(replace(model, integrator=Integrator(tolerance=1e-12)))
    rows, _ = integration(model)
    for name in ("position", "velocity", "angular_velocity", "acceleration"):
        np.testing.assert_allclose(getattr(rows, name), getattr(exact, name), rtol=0, atol=1e-6, err_msg=name)
    assert rows.constraint_residual.max() < 1e-14
    assert rows.velocity_residual.max() < 1e-14


@pytest.mark.long_motion
def test_rows_do_not_depend_on_how_the_run_is_cut_into_calls(integration, monkeypatch):
    model = timed(double_pendulum(), 0.3, 0.007)
    whole, _ = integration(model)
    monkeypatch.setattr(constrained_motion, "CALL_EVALUATIONS", 7)
    monkeypatch.setattr(constrained_motion, "LARGEST_BLOCK", 3)
    pieces, _ = integration(model)
    for name in ("position", "velocity", "acceleration", "reaction_force", "total"):
        assert np.array_equal(getattr(whole, name), getattr(pieces, name)), name


def test_bricards_linkage_with_its_repeated_equation_comes_to_the_explicit_solution(integration):
    model = build_young_dynamics(read_deck(read_text(str(DECKS / "dynamics/IN-BRICARD.dat"))))[0]
    model = timed(model, 0.4, 0.1)
    rows, analysis = integration(model)
    exact = run(replace(model, integrator=Integrator(tolerance=1e-11)))
    np.testing.assert_allclose(rows.position, exact.position, rtol=0, atol=1e-9)
    assert rows.constraint_residual.max() < 1e-14
    assert worst_balance(model, rows) < 1e-10
    assert [fault.message.split(",")[0] for fault in analysis.warnings] == ["1 equation repeats others"]


@pytest.mark.long_motion
def test_the_squeezer_comes_to_its_published_angles(integration):
    rows, _ = integration(squeezer.model(0.03, 0.015))
    p = rows.euler_parameters[-1, 1:]
    found = 2.0 * np.arctan2(p[:, 3], p[:, 0])
    off = np.angle(np.exp(1j * (found - squeezer.absolute(squeezer.END))))
    assert np.abs(off).max() < 1e-8


def turned_about_z(number, x, y, angle):
    return body(number, (x, y, 0.0), (math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle)))


def locking_four_bar():
    """Ground 4, crank 2, coupler 1.5, rocker 2.2 m, the crank driven at 1 rad/s from 0.3 rad."""
    x, y = 2.0 * math.cos(0.3) - 4.0, 2.0 * math.sin(0.3)
    reach = math.hypot(x, y)
    rocker = math.atan2(y, x) - math.acos((reach**2 + 2.2**2 - 1.5**2) / (2.0 * reach * 2.2))
    end = (2.2 * math.cos(rocker), 2.2 * math.sin(rocker))
    bodies = (
        GROUND,
        turned_about_z(2, 0.0, 0.0, 0.3),
        turned_about_z(3, 4.0 + x, y, math.atan2(end[1] - y, end[0] - x)),
        turned_about_z(4, 4.0, 0.0, rocker),
    )
    held = tuple(Simplified(f"simplified {k}", 1, k, 0.0) for k in range(1, 6))
    joints = (
        Joint("spherical", "spherical 1", 1, 2, (2.0, 0.0, 0.0), (0.0,) * 3),
        Joint("universal", "universal 1", 2, 3, (1.5, 0.0, 0.0), (2.2, 0.0, 0.0), (0.0, 1.0, 0.0), Z),
        Joint("revolute", "revolute 1", 0, 3, (4.0, 0.0, 0.0), (0.0,) * 3, Z, Z),
    )
    drivers = (Driver("driver 1", 1, 6, 0.3, 1.0, 0.0),)
    grid = TimeGrid(0.0, 2.0, 0.1)
    mechanism = Mechanism(bodies, grid, joints, held, drivers=drivers, grounds=(AT_REST,))
    inertia = (0.1, 0.1, 0.1, 0.0, 0.0, 0.0)
    masses = tuple(MassProperties(f"mass {k}", k, 1.0, inertia=inertia) for k in (1, 2, 3))
    return DynamicModel(mechanism, "forward", masses)


@pytest.mark.long_motion
def test_a_crank_driven_beyond_its_reach_stops_there_and_names_the_joints(integration):
    """cos φ = (4² + 2² - 3.7²) / (2 · 4 · 2) where coupler and rocker are in line."""
    with pytest.raises(AnalysisError, match=r"a singular position of [a-z]+ 1") as caught:
        integration(locking_four_bar())
    locked = math.acos((16.0 + 4.0 - 3.7**2) / 16.0) - 0.3
    assert caught.value.norms["reached"] == pytest.approx(locked, abs=1e-4)


def test_a_motion_without_inertia_is_refused(integration):
    model = swinging_bar()
    light = replace(model.masses[0], mass=0.0, inertia=(0.0,) * 6)
    with pytest.raises(AnalysisError, match="body 2 can move without any mass or inertia"):
        integration(replace(model, masses=(light,)))
