"""The generalised-α method for rigid mechanisms: closed forms, its order, its damping, its rows."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from flexmb_cli.kernels.integrators.generalised_alpha_step import parameters
from flexmb_cli.model import laws
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.loads import DynamicModel, InitialVelocity, MassProperties
from flexmb_cli.model.mechanism import Mechanism, TimeGrid
from flexmb_cli.solvers.constrained import analysis as constrained_motion
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.solvers.constrained.body_balances import worst_balance
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body, joined, run
from tests.solvers.constrained.test_forward_dynamics import G, double_pendulum, hinge


def integration(model, radius=0.9, step=0.0):
    """All rows, and the analysis."""
    analysis = ForwardDynamics(
        replace(model, integrator=Integrator("GALF", step, model.integrator.tolerance, radius))
    )
    return joined(list(analysis.rows())), analysis


def timed(model, end, step):
    return replace(model, mechanism=replace(model.mechanism, time=TimeGrid(0.0, end, step)))


@pytest.mark.parametrize(
    ("rho", "expected"),
    [(1.0, (0.5, 0.5, 0.25, 0.5)), (0.0, (-1.0, 0.0, 1.0, 1.5)), (0.5, (0.0, 1 / 3, 4 / 9, 5 / 6))],
)
def test_the_parameters_are_those_of_chung_and_hulbert(rho, expected):
    """Journal of Applied Mechanics 60 (1993), eqs. (14), (17), (25): the ends are the trapezoidal rule
    and the asymptotic annihilation."""
    assert parameters(rho) == pytest.approx(expected, abs=1e-15)


def swinging_bar():
    """A bar of 1 m and 2 kg about y, let go horizontally."""
    mass = MassProperties("mass 1", 1, 2.0, (0.5, 0.0, 0.0), (0.01, 2.0 / 12.0, 2.0 / 12.0, 0.0, 0.0, 0.0))
    mechanism = Mechanism(
        (GROUND, body(2)),
        TimeGrid(0.0, 1.0, 0.1),
        (hinge(1, 0, 1, (0.0,) * 3, (0.0,) * 3),),
        grounds=(AT_REST,),
    )
    return DynamicModel(mechanism, "forward", (mass,), gravity=(0.0, 0.0, -G))


def angle_from_vertical(times, rate):
    """sin(θ/2) = k sn(K + rate t, k) for a pendulum let go at rest at 90°, k = sin 45°."""
    k = math.sin(math.pi / 4)
    return 2.0 * np.arcsin(k * ellipj(ellipk(k * k) + rate * times, k * k)[0])


def bar_angles(rows):
    p = rows.euler_parameters[:, 1]
    return math.pi / 2 - 2.0 * np.unwrap(np.arctan2(p[:, 2], p[:, 0]) * 2.0) / 2.0


def test_a_bar_swings_by_elliptic_functions_with_order_two():
    """rate² = m g l / J about the hinge = 3 g / (2 L)."""
    model = swinging_bar()
    errors = []
    for step in (0.02, 0.01, 0.005):
        rows, _ = integration(model, step=step)
        exact = angle_from_vertical(rows.time, math.sqrt(1.5 * G))
        errors.append(np.max(np.abs(bar_angles(rows) - exact)))
        assert rows.constraint_residual.max() < 1e-14
        assert rows.velocity_residual.max() < 1e-14
        assert worst_balance(model, rows) < 1e-11
    assert errors[2] < 2e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.3)
    assert errors[1] / errors[2] == pytest.approx(4.0, abs=0.3)


@pytest.mark.long_motion
def test_a_double_pendulum_comes_to_the_explicit_solution_with_order_two():
    model = double_pendulum(damping=3.0)
    exact = run(model)
    found = [integration(model, step=step)[0] for step in (0.01, 0.005, 0.0025)]
    for field in ("position", "velocity", "acceleration", "reaction_force", "applied_work"):
        gaps = [np.max(np.abs(getattr(rows, field) - getattr(exact, field))) for rows in found]
        assert gaps[0] / gaps[1] == pytest.approx(4.0, abs=0.5)
        assert gaps[1] / gaps[2] == pytest.approx(4.0, abs=0.5)


@pytest.mark.long_motion
def test_chosen_steps_keep_the_tolerance():
    """The tolerance is that of a run: a hundredth of it takes 100^(1/2) times as many steps of order two."""
    model = swinging_bar()
    steps, errors = [], []
    for tolerance in (1e-5, 1e-7):
        rows, analysis = integration(replace(model, integrator=Integrator(tolerance=tolerance)))
        errors.append(np.max(np.abs(bar_angles(rows) - angle_from_vertical(rows.time, math.sqrt(1.5 * G)))))
        steps.append(analysis.clock["steps"][0])
    assert steps[1] / steps[0] == pytest.approx(10.0, rel=0.25)
    assert errors[0] < 1e-4
    assert errors[1] < 1e-6


def hanging_mass(stiffness):
    """1 kg at the end of a spring of 1 m, let go horizontally: a pendulum when the spring is stiff."""
    mass = MassProperties("mass 1", 1, 1.0, (0.0,) * 3, (0.01, 0.01, 0.01, 0.0, 0.0, 0.0))
    spring = laws.spring("spring 1", laws.Line(0, 1, (0.0,) * 3, (0.0,) * 3), stiffness, 1.0)
    mechanism = Mechanism((GROUND, body(2, (1.0, 0.0, 0.0))), TimeGrid(0.0, 1.0, 0.1), grounds=(AT_REST,))
    return DynamicModel(mechanism, "forward", (mass,), springs=(spring,), gravity=(0.0, 0.0, -G))


@pytest.mark.long_motion
def test_a_stiff_spring_does_not_shorten_the_steps():
    """k = 1e9 N/m, 1 kg: 3e4 rad/s, of which steps of 1 ms see nothing; the stretch is 3 m g / k at most."""
    rows, analysis = integration(hanging_mass(1e9), 0.6, 1e-3)
    angle = angle_from_vertical(rows.time, math.sqrt(G))
    exact = np.stack([np.sin(angle), 0.0 * angle, -np.cos(angle)], axis=1)
    assert np.max(np.abs(rows.position[:, 1] - exact)) < 2e-5
    assert analysis.clock["steps"][0] == 1000
    assert analysis.clock["evaluations"][0] < 10_000


def oscillator(radius, step):
    """1 kg on a spring of 1e4 N/m along x, 0.01 m from rest: 100 rad/s."""
    model = replace(hanging_mass(1e4), gravity=(0.0,) * 3)
    start = InitialVelocity("velocity 1", 1, (1.0, 0.0, 0.0), (0.0,) * 3)
    rows, _ = integration(timed(replace(model, velocities=(start,)), 50 * step, step), radius, step)
    return rows.total / rows.total[0]


def test_energy_leaves_only_where_the_spectral_radius_is_below_one():
    """Three radians a step lose half their size and more in each; slow motion keeps its energy."""
    assert oscillator(1.0, 0.03) == pytest.approx(np.ones(51), abs=1e-8)
    fast = oscillator(0.5, 0.03)
    assert fast[-1] < 1e-5
    slow = oscillator(0.5, 2e-4)
    assert slow[-1] == pytest.approx(1.0, abs=1e-3)
    assert slow[-1] < 1.0


def test_rows_do_not_depend_on_blocks_and_calls(monkeypatch):
    model = timed(double_pendulum(), 0.5, 0.03)
    whole, _ = integration(model, step=0.02)
    monkeypatch.setattr(constrained_motion, "LARGEST_BLOCK", 2)
    monkeypatch.setattr(constrained_motion, "CALL_EVALUATIONS", 7)
    pieces, _ = integration(model, step=0.02)
    for field in ("position", "velocity", "acceleration", "reaction_force", "total"):
        np.testing.assert_array_equal(getattr(pieces, field), getattr(whole, field))


def test_rows_within_steps_meet_constraints_and_equations():
    model = timed(double_pendulum(), 0.3, 0.007)
    rows, _ = integration(model, step=0.01)
    exact = run(model)
    assert np.max(np.abs(rows.position - exact.position)) < 2e-3
    assert rows.constraint_residual.max() < 1e-14
    assert worst_balance(model, rows) < 1e-11


def test_redundant_equations_do_not_hinder():
    """A parallelogram of spatial revolute joints: three equations repeat others."""
    joints = (
        hinge(1, 0, 1, (0.0,) * 3, (0.0,) * 3),
        hinge(2, 1, 2, (0.0, 0.0, 1.0), (0.0,) * 3),
        hinge(3, 2, 3, (2.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        hinge(4, 0, 3, (2.0, 0.0, 0.0), (0.0,) * 3),
    )
    bodies = (GROUND, body(2), body(3, (0.0, 0.0, 1.0)), body(4, (2.0, 0.0, 0.0)))
    inertia = (0.1, 0.1, 0.1, 0.0, 0.0, 0.0)
    masses = tuple(MassProperties(f"mass {k}", k, 1.0, inertia=inertia) for k in (1, 2, 3))
    start = InitialVelocity("velocity 1", 1, (0.0,) * 3, (0.0, 1.0, 0.0))
    mechanism = Mechanism(bodies, TimeGrid(0.0, 0.3, 0.1), joints, grounds=(AT_REST,))
    model = DynamicModel(mechanism, "forward", masses, velocities=(start,), gravity=(0.0, 0.0, -G))
    rows, analysis = integration(model, step=2e-3)
    reported = [(fault.severity, fault.message.split(":")[0]) for fault in analysis.warnings]
    assert reported == [("note", "planar mechanism of spatial joints")]
    exact = run(model)
    assert np.max(np.abs(rows.position - exact.position)) < 1e-4
    assert rows.constraint_residual.max() < 1e-14
    assert worst_balance(model, rows) < 1e-10


def test_a_step_that_is_too_long_is_divided_and_told():
    """Bars that turn by a radian and more a step and change their rate within it."""
    _, analysis = integration(double_pendulum(), step=0.5)
    assert any("take a smaller step" in fault.message for fault in analysis.warnings)
