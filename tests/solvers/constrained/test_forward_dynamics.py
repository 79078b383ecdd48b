"""Motion under forces against closed forms, conservation laws and independent equations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.errors import FlexmbError
from flexmb_cli.model import laws
from flexmb_cli.model.loads import AppliedTorque, DynamicModel, InitialVelocity, MassProperties
from flexmb_cli.model.mechanism import Driver, Joint, Mechanism, TimeGrid
from flexmb_cli.model.piecewise_polynomials import spline_table
from flexmb_cli.model.time_functions import piecewise
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from tests.solvers.constrained.body_balances import rotation, tensor, worst_balance
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body, mechanism_of, run, uneven_masses

G = 9.81
Y = (0.0, 1.0, 0.0)


def hinge(number, i, j, P_i, P_j, s=Y):
    return Joint("revolute", f"revolute {number}", i, j, P_i, P_j, s, s)


def test_a_free_body_keeps_momentum_spin_and_energy():
    mass = MassProperties("mass 1", 0, 2.0, (0.1, 0.2, 0.3), (1.0, 2.0, 2.5, 0.1, 0.05, -0.2))
    start = InitialVelocity("velocity 1", 0, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    mechanism = Mechanism((body(1),), TimeGrid(0.0, 2.0, 0.25))
    rows = run(DynamicModel(mechanism, "forward", (mass,), velocities=(start,)))
    spins, momenta = [], []
    for k in range(len(rows.time)):
        A, w = rotation(rows.euler_parameters[k, 0]), rows.angular_velocity[k, 0]
        c = A @ mass.centre
        momentum = mass.mass * (rows.velocity[k, 0] + np.cross(w, c))
        spins.append(A @ tensor(mass.inertia) @ A.T @ w + np.cross(rows.position[k, 0] + c, momentum))
        momenta.append(momentum)
    assert np.ptp(spins, axis=0).max() < 1e-7
    assert np.ptp(momenta, axis=0).max() < 1e-8
    assert np.ptp(rows.total) < 1e-7


def test_a_top_precesses_steadily_where_its_moments_balance():
    """I3 ω3 Ω - I1 Ω² cos θ = m g l holds the tilt θ; the axis goes round the vertical at Ω."""
    tilt, rate, m, length = 0.5, 2.0, 2.0, 0.4
    I1, I3 = 0.5, 0.3
    spin = (m * G * length + I1 * rate**2 * math.cos(tilt)) / (I3 * rate)
    axis = np.array([0.0, -math.sin(tilt), math.cos(tilt)])
    omega = spin * axis + rate * (np.array([0.0, 0.0, 1.0]) - math.cos(tilt) * axis)
    about_centre = I1 - m * length**2
    mass = MassProperties("mass 1", 1, m, (0.0, 0.0, length), (about_centre, about_centre, I3, 0.0, 0.0, 0.0))
    p = (math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0)
    mechanism = Mechanism(
        (GROUND, body(2, p=p)),
        TimeGrid(0.0, 1.0, 0.25),
        (Joint("spherical", "spherical 1", 0, 1, (0.0,) * 3, (0.0,) * 3),),
        grounds=(AT_REST,),
    )
    start = InitialVelocity("velocity 1", 1, (0.0,) * 3, tuple(omega))
    model = DynamicModel(mechanism, "forward", (mass,), gravity=(0.0, 0.0, -G), velocities=(start,))
    rows = run(model)
    found = np.array([rotation(p)[:, 2] for p in rows.euler_parameters[:, 1]])
    turned = rate * rows.time
    expected = [np.sin(tilt) * np.sin(turned), -np.sin(tilt) * np.cos(turned), np.full(5, np.cos(tilt))]
    assert found == pytest.approx(np.transpose(expected), abs=1e-8)
    assert worst_balance(model, rows) < 1e-11


def double_pendulum(damping=0.0):
    """Two bars of 1 m about y; x along the first, hanging angle from the horizontal."""
    joints = (hinge(1, 0, 1, (0.0,) * 3, (0.0,) * 3), hinge(2, 1, 2, (1.0, 0.0, 0.0), (0.0,) * 3))
    masses = tuple(
        MassProperties(f"mass {k}", k, float(k), (0.5, 0.0, 0.0), (0.01, 0.1 * k, 0.1 * k, 0.0, 0.0, 0.0))
        for k in (1, 2)
    )
    spring = laws.spring("spring 1", laws.Line(0, 2, (1.5, 0.0, 0.5), (1.0, 0.0, 0.0)), 30.0, 0.4, damping)
    mechanism = Mechanism(
        (GROUND, body(2), body(3, (1.0, 0.0, 0.0))), TimeGrid(0.0, 1.0, 0.5), joints, grounds=(AT_REST,)
    )
    return DynamicModel(mechanism, "forward", masses, springs=(spring,), gravity=(0.0, 0.0, -G))


def test_a_double_pendulum_with_a_spring_moves_as_lagrange_has_it():
    """Angles a, b about y (x axis turns to -z); Lagrange's equations by hand, integrated by SciPy."""

    def rates(_, s):
        a, b, ad, bd = s
        M11 = 1.0 * 0.25 + 0.1 + 2.0 * 1.0
        M22 = 2.0 * 0.25 + 0.2
        M12 = 2.0 * 0.5 * np.cos(a - b)
        end = np.array([np.cos(a) + np.cos(b), -np.sin(a) - np.sin(b)])
        to_end = end - np.array([1.5, 0.5])
        length = np.linalg.norm(to_end)
        F = -30.0 * (length - 0.4) * to_end / length
        Qa = (1.0 * 0.5 + 2.0) * G * np.cos(a) + F @ [-np.sin(a), -np.cos(a)]
        Qb = 2.0 * 0.5 * G * np.cos(b) + F @ [-np.sin(b), -np.cos(b)]
        Qa -= 2.0 * 0.5 * np.sin(a - b) * bd**2
        Qb += 2.0 * 0.5 * np.sin(a - b) * ad**2
        return [ad, bd, *np.linalg.solve([[M11, M12], [M12, M22]], [Qa, Qb])]

    expected = solve_ivp(rates, (0.0, 1.0), [0.0] * 4, "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    rows = run(double_pendulum())
    axes = [rotation(p)[:, 0] for p in rows.euler_parameters[-1, 1:]]
    angles = [math.atan2(-axis[2], axis[0]) for axis in axes]
    assert np.cos(angles) == pytest.approx(np.cos(expected[:2]), abs=1e-7)
    assert np.sin(angles) == pytest.approx(np.sin(expected[:2]), abs=1e-7)
    assert rows.angular_velocity[-1, 1:, 1] == pytest.approx(expected[2:], abs=1e-6)


def test_what_a_damper_takes_leaves_the_energy():
    rows = run(double_pendulum(damping=3.0))
    assert rows.applied_work[-1] < -0.1
    assert rows.total == pytest.approx(np.full(3, rows.total[0]), abs=1e-6)


@pytest.mark.long_motion
@pytest.mark.parametrize(("deck", "span"), [("IN4-BAR", 0.2), ("IN-RSSR", 0.004)])
def test_the_effort_of_inverse_dynamics_drives_the_same_motion_forward(deck, span):
    """The driver gives way to a table of its torque, 100 knots, whose spline is good to 1e-6."""
    mechanism = mechanism_of(deck)
    grid = TimeGrid(mechanism.time.start, mechanism.time.start + span, span / 100)
    masses = uneven_masses(len(mechanism.bodies))
    inverse = DynamicModel(replace(mechanism, time=grid), "inverse", masses, gravity=(0.4, -0.7, -G))
    wanted = run(inverse)
    driver = mechanism.drivers[0]
    torque = [0.0, 0.0, 0.0]
    torque[driver.direction - 4] = 1.0
    table = piecewise(spline_table(wanted.time, wanted.driver_effort[:, 0]))
    estimates = tuple(
        replace(b, r=tuple(r), p=tuple(p))
        for b, r, p in zip(mechanism.bodies, wanted.position[0], wanted.euler_parameters[0], strict=True)
    )
    free = replace(mechanism, bodies=estimates, drivers=(), time=replace(grid, step=span / 2))
    velocities = InitialVelocity(
        "velocity 1", driver.body, tuple(wanted.velocity[0, driver.body]),
        tuple(wanted.angular_velocity[0, driver.body]),
    )  # fmt: skip
    forward = replace(
        inverse,
        mechanism=free,
        analysis="forward",
        torques=(AppliedTorque("torque 1", driver.body, tuple(torque), factor=table),),
        velocities=(velocities,),
    )
    found = run(forward)
    assert found.position == pytest.approx(wanted.position[::50], abs=1e-6)
    scale = np.abs(wanted.reaction_force).max()
    assert np.abs(found.reaction_force - wanted.reaction_force[::50]).max() < 1e-4 * scale


def test_drivers_that_ask_for_what_joints_forbid_are_refused():
    mechanism = Mechanism(
        (GROUND, body(2)),
        TimeGrid(0.0, 1.0, 0.5),
        (hinge(1, 0, 1, (0.0,) * 3, (0.0,) * 3),),
        drivers=(Driver("driver 1", 1, 1, 0.0, 1.0, 0.0),),
        grounds=(AT_REST,),
    )
    mass = MassProperties("mass 1", 1, 1.0, inertia=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    with pytest.raises(FlexmbError, match="velocities that the joints forbid"):
        run(DynamicModel(mechanism, "forward", (mass,)))


def test_a_motion_without_inertia_is_refused_by_the_name_of_the_body():
    mechanism = Mechanism((body(1), body(2)), TimeGrid(0.0, 1.0, 0.5))
    mass = MassProperties("mass 1", 0, 1.0, inertia=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    with pytest.raises(FlexmbError, match="body 2 can move without any mass or inertia"):
        run(DynamicModel(mechanism, "forward", (mass,)))


def test_a_first_velocity_that_the_joints_forbid_is_changed_and_told():
    model = replace(
        double_pendulum(), velocities=(InitialVelocity("velocity 1", 1, (0.0, 1.0, 0.0), (0.0, 3.0, 0.0)),)
    )
    analysis = ForwardDynamics(model)
    rows = next(analysis.rows())
    assert rows.angular_velocity[0, 1] == pytest.approx([0.0, 3.0, 0.0], abs=1e-12)
    assert rows.velocity[0, 2] == pytest.approx([0.0, 0.0, -3.0], abs=1e-12)
    assert ["does not fit the joints" in fault.message for fault in analysis.warnings] == [True]


def test_a_nut_on_a_steep_screw_turns_with_its_effective_inertia():
    """θ'' (I + m α²) = T - m g α over eleven turns, the advance being α θ."""
    pitch, torque, m, inertia = 0.05, 0.5, 3.0, 0.1
    thread = Joint(
        "screw", "screw 1", 0, 1, (0.0,) * 3, (0.0, 0.0, 0.5), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0),
        (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), pitch,
    )  # fmt: skip
    mechanism = Mechanism(
        (GROUND, body(2, (0.0, 0.0, 0.5))), TimeGrid(0.0, 4.0, 0.5), (thread,), grounds=(AT_REST,)
    )
    mass = MassProperties("mass 1", 1, m, inertia=(inertia,) * 3 + (0.0,) * 3)
    turning = AppliedTorque("torque 1", 1, (0.0, 0.0, torque))
    model = DynamicModel(mechanism, "forward", (mass,), torques=(turning,), gravity=(0.0, 0.0, -G))
    rows = run(model)
    turned = 0.5 * (torque - m * G * pitch) / (inertia + m * pitch**2) * rows.time**2
    assert abs(turned[-1]) > 22.0 * math.pi
    assert rows.position[:, 1, 2] == pytest.approx(0.5 + pitch * turned, abs=1e-8)


@pytest.mark.parametrize("deck", ["IN4-BAR", "IN-RSSR"])
def test_a_forward_run_starts_where_kinematics_does_from_the_decks_own_estimates(deck):
    """Both decks' estimates are rough: the four-bar's nearest position leaves a gap of 0.24 m."""
    mechanism = mechanism_of(deck)
    model = DynamicModel(mechanism, "forward", uneven_masses(len(mechanism.bodies)))
    start = mechanism.time.start
    q = ForwardDynamics(model).assembled(start).reshape(-1, 7)
    first = next(iter(KinematicAnalysis(mechanism).rows()))
    assert np.max(np.abs(q[:, :3] - first.position[0])) < 1e-9
    attitudes = np.abs(np.sum(q[:, 3:] * first.euler_parameters[0], axis=1))
    assert attitudes == pytest.approx(1.0, abs=1e-9)
