"""Linearised motion on turning frames against closed forms of steadily turning systems."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.model import laws
from flexmb_cli.model.loads import DynamicModel, InitialVelocity, MassProperties
from flexmb_cli.model.mechanism import Driver, Joint, Mechanism, Simplified, TimeGrid
from flexmb_cli.model.tree import INERTIAL, ROTATION, TRANSLATION, Closure, Hinge, Prescribed, Tree
from flexmb_cli.model.tree import Body as Part
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.linearisation.constrained import ConstrainedLinearised, bring_to, linearised, modes
from flexmb_cli.solvers.linearisation.equilibrium import find_equilibrium
from flexmb_cli.solvers.linearisation.tree import TreeLinearised, start_tree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.naive.random_trees import sprung
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body

OMEGA, MASS = 3.0, 2.0
O, X, Y, Z = (0.0,) * 3, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
HERE = (1.0, 0.0, 0.0, 0.0)


def rail(name, i, j, axis):
    across = {X: Y, Y: X}[axis]
    return Joint("translational", name, i, j, O, O, axis, axis, across, Z)


def springs(axis, stiffness, gap=0.0):
    """Two springs of 1 m on both sides of the mass, the one at the negative side longer by `gap`."""
    ends = (np.multiply(-1.0, axis), axis)
    return tuple(
        laws.spring(f"spring {axis} {k}", laws.Line(1, 2, tuple(end), O), stiffness, 1.0 + gap * (k == 0))
        for k, end in enumerate(ends)
    )


def turntable(rails, loads, driven=True, start=O):
    """A mass, body 3, on one or two perpendicular rails of a turntable, body 2, that turns about z."""
    bodies = [GROUND, body(2), body(3, start)]
    joints = [Joint("revolute", "revolute 1", 0, 1, O, O, Z, Z)]
    if rails == 1:
        joints.append(rail("translational 1", 1, 2, X))
    else:
        bodies.append(body(4))
        joints += [rail("translational 1", 1, 3, X), rail("translational 2", 3, 2, Y)]
    drivers = (Driver("driver 1", 1, 6, 0.0, OMEGA, 0.0),) if driven else ()
    grid = TimeGrid(0.0, 1.0, 0.5)
    mechanism = Mechanism(tuple(bodies), grid, tuple(joints), grounds=(AT_REST,), drivers=drivers)
    mass = MassProperties("mass 1", 2, MASS, O, (0.1, 0.1, 0.1, 0.0, 0.0, 0.0))
    return DynamicModel(mechanism, "forward", (mass,), springs=loads)


def found(model, time=0.0):
    analysis = ForwardDynamics(model)
    bring_to(analysis, time)
    return modes(analysis)


@pytest.mark.parametrize("time", [0.0, 0.3])
def test_a_mass_on_a_rail_of_a_turntable_swings_at_the_root_of_k_m_less_omega_squared(time):
    """r'' + (k/m - Omega²) r = 0, two springs of 100 N/m: 1.51824 Hz, undamped, at any time."""
    modes = found(turntable(1, springs(X, 100.0)), time)
    expected = math.sqrt(200.0 / MASS - OMEGA**2) / math.tau
    assert expected == pytest.approx(1.51824, abs=5e-6)
    assert modes.frequency == pytest.approx([expected], rel=1e-8)
    assert np.abs(modes.damping).max() < 1e-9
    assert modes.constant


@pytest.mark.parametrize("time", [0.0, 0.3])
def test_springs_too_soft_for_the_turntable_let_the_mass_fly_off(time):
    """r'' = (Omega² - k/m) r, k/m = 4: e^(2.236 t)."""
    modes = found(turntable(1, springs(X, 4.0)), time)
    assert modes.growing == pytest.approx([math.sqrt(5.0)], rel=1e-8)
    assert modes.decaying == pytest.approx([-math.sqrt(5.0)], rel=1e-8)


@pytest.mark.parametrize("time", [0.0, 0.3])
@pytest.mark.parametrize(("along", "across"), [(100.0, 100.0), (100.0, 36.0)])
def test_two_perpendicular_rails_couple_by_coriolis_forces(along, across, time):
    """(s² + kx/m - Omega²)(s² + ky/m - Omega²) + 4 Omega² s² = 0; equal springs: omega_0 -+ Omega."""
    modes = found(turntable(2, springs(X, along) + springs(Y, across)), time)
    a, b = (2.0 * k / MASS - OMEGA**2 for k in (along, across))
    squares = np.roots([1.0, a + b + 4.0 * OMEGA**2, a * b])
    assert modes.frequency * math.tau == pytest.approx(np.sort(np.sqrt(-squares)), rel=1e-8)
    assert np.abs(modes.damping).max() < 1e-9
    assert modes.constant


def test_a_mass_settles_where_centrifugal_force_and_springs_balance():
    """k (2 r - gap) = m Omega² r: the frame goes on turning while the mass stands in it."""
    analysis = ForwardDynamics(turntable(1, springs(X, 100.0, gap=0.05)))
    bring_to(analysis, 0.0)
    find_equilibrium(analysis, ConstrainedLinearised)
    assert analysis.integration.z[14] == pytest.approx(100.0 * 0.05 / (200.0 - MASS * OMEGA**2), rel=1e-9)
    z = analysis.integration.z[21:-1]
    assert z[6 + 5] == pytest.approx(OMEGA, rel=1e-12)
    assert modes(analysis).frequency[0] * math.tau == pytest.approx(math.sqrt(91.0), rel=1e-8)


def conical(angle):
    """A bob of 0.8 m hung from a yoke without mass that turns freely about z, hinged to it about y."""
    length = 0.8
    half = 0.5 * (0.5 * math.pi - angle)
    p = (math.cos(half), 0.0, math.sin(half), 0.0)
    turning = math.sqrt(9.81 / (length * math.cos(angle)))
    mechanism = Mechanism(
        (GROUND, body(2), body(3, p=p)),
        TimeGrid(0.0, 1.0, 0.5),
        (
            Joint("revolute", "revolute 1", 0, 1, O, O, Z, Z),
            Joint("revolute", "revolute 2", 1, 2, O, O, Y, Y),
        ),
        grounds=(AT_REST,),
    )
    bob = MassProperties("mass 1", 2, 1.5, (length, 0.0, 0.0))
    first = tuple(InitialVelocity(f"velocity {b}", b, O, (0.0, 0.0, turning)) for b in (1, 2))
    return DynamicModel(mechanism, "forward", (bob,), gravity=(0.0, 0.0, -9.81), velocities=first), turning


def test_a_conical_pendulum_nods_about_its_steady_circle():
    """omega² = Omega² (1 + 3 cos² angle) with Omega² = g/(l cos angle); nothing holds the azimuth.

    From l² x'' = p² cos x/(m² l² sin³ x) - g l sin x, the angular momentum p about the vertical being kept.
    """
    model, turning = conical(0.6)
    modes = found(model, 0.0)
    expected = turning * math.sqrt(1.0 + 3.0 * math.cos(0.6) ** 2)
    assert modes.frequency * math.tau == pytest.approx([expected], rel=1e-7)
    assert modes.unheld == 2
    assert modes.constant


def precessing_top(spin):
    """A symmetric top on three hinges (z, y, own axis) without mass, in steady slow precession at 0.7 rad."""
    angle, across, along, weight = 0.7, 0.25, 0.1, 2.0 * 9.81 * 0.3
    # A f² cos(angle) - C n f + m g l = 0 for the rate of precession f at the spin n about the own axis.
    rate = min(np.roots([across * math.cos(angle), -along * spin, weight]))
    half = 0.5 * angle
    tilted = (math.cos(half), 0.0, math.sin(half), 0.0)
    mechanism = Mechanism(
        (GROUND, body(2), body(3, p=tilted), body(4, p=tilted)),
        TimeGrid(0.0, 1.0, 0.5),
        (
            Joint("revolute", "revolute 1", 0, 1, O, O, Z, Z),
            Joint("revolute", "revolute 2", 1, 2, O, O, Y, Y),
            Joint("revolute", "revolute 3", 2, 3, O, O, Z, Z),
        ),
        grounds=(AT_REST,),
    )
    inertia = (across - 2.0 * 0.09, across - 2.0 * 0.09, along, 0.0, 0.0, 0.0)
    top = MassProperties("mass 1", 3, 2.0, (0.0, 0.0, 0.3), inertia)
    axis = np.array([math.sin(angle), 0.0, math.cos(angle)])
    frame = np.array([0.0, 0.0, rate])
    own = frame + (spin - rate * math.cos(angle)) * axis
    first = tuple(
        InitialVelocity(f"velocity {b}", b, O, tuple(w)) for b, w in ((1, frame), (2, frame), (3, own))
    )
    model = DynamicModel(mechanism, "forward", (top,), gravity=(0.0, 0.0, -9.81), velocities=first)
    return model, angle, across, along, weight, rate


def test_a_top_in_steady_precession_nutates():
    """A x'' = -V''(angle) x with V = (p_f - p_s cos x)²/(2 A sin² x) + m g l cos x, p_f, p_s kept.

    Goldstein, Classical Mechanics, the heavy symmetric top: its effective potential.
    """
    model, angle, A, C, weight, rate = precessing_top(80.0)
    p_s = C * 80.0
    p_f = A * rate * math.sin(angle) ** 2 + p_s * math.cos(angle)

    def potential(x):
        return (p_f - p_s * math.cos(x)) ** 2 / (2.0 * A * math.sin(x) ** 2) + weight * math.cos(x)

    h = 1e-3
    values = [potential(angle + k * h) for k in (-2, -1, 0, 1, 2)]
    slope = (values[0] - 8.0 * values[1] + 8.0 * values[3] - values[4]) / (12.0 * h)
    assert abs(slope) < 1e-8
    bend = np.dot([-1.0, 16.0, -30.0, 16.0, -1.0], values) / (12.0 * h * h)
    modes = found(model)
    assert modes.frequency * math.tau == pytest.approx([math.sqrt(bend / A)], rel=1e-6)
    assert modes.unheld == 4
    assert modes.constant


def test_a_spinning_disc_on_unequal_springs_is_seen_from_axes_at_rest():
    """x'' = -kx/m x, y'' = -ky/m y whatever the spin: coefficients along spinning axes would change."""
    held = tuple(Simplified(f"simplified {k}", 1, k, 0.0) for k in (3, 4, 5))
    mechanism = Mechanism((GROUND, body(2)), TimeGrid(0.0, 1.0, 0.5), simplified=held, grounds=(AT_REST,))
    mass = MassProperties("mass 1", 1, MASS, O, (0.1, 0.1, 0.2, 0.0, 0.0, 0.0))
    loads = tuple(
        replace(s, measure=s.measure._replace(i=0, j=1)) for s in springs(X, 100.0) + springs(Y, 36.0)
    )
    first = InitialVelocity("velocity 1", 1, O, (0.0, 0.0, 50.0))
    model = DynamicModel(mechanism, "forward", (mass,), springs=loads, velocities=(first,))
    modes = found(model)
    assert modes.frequency * math.tau == pytest.approx([6.0, 10.0], rel=1e-8)
    assert modes.constant


def test_a_swinging_pendulum_is_frozen_at_its_time():
    """phi'' = -(g/l) sin phi: let go at 1 rad its coefficient -(g/l) cos phi will change."""
    half = 0.5 * (0.5 * math.pi - 1.0)
    mechanism = Mechanism(
        (GROUND, body(2, p=(math.cos(half), 0.0, math.sin(half), 0.0))),
        TimeGrid(0.0, 1.0, 0.5),
        (Joint("revolute", "revolute 1", 0, 1, O, O, Y, Y),),
        grounds=(AT_REST,),
    )
    bob = MassProperties("mass 1", 1, 1.0, (0.8, 0.0, 0.0))
    modes = found(DynamicModel(mechanism, "forward", (bob,), gravity=(0.0, 0.0, -9.81)))
    assert not modes.constant
    assert modes.frequency * math.tau == pytest.approx([math.sqrt(9.81 / 0.8 * math.cos(1.0))], rel=1e-8)


def tree_table(closed):
    """The mass on a rail as a tree: one translation, or two and a closure across the rail."""
    inertia = np.diag([0.1, 0.1, 0.1])
    hinge = Hinge(0, translations=(1, 2) if closed else (1,))
    count = 3 if closed else 2
    closure = Closure("closure 1", 1, 0, (2,))
    return Tree(
        (Part("body 1", 1.0, inertia), Part("body 2", MASS, inertia)),
        (Hinge(INERTIAL, rotations=(3,)), hinge),
        np.zeros(count),
        np.eye(count)[0] * OMEGA,
        TimeGrid(0.0, 1.0, 0.5),
        gravity=O,
        elements=sprung((1, TRANSLATION, 1, 200.0)),
        prescribed=(Prescribed(0, ROTATION, 3, 0.0, OMEGA, 0.0),),
        closures=(closure,) if closed else (),
    )


@pytest.mark.parametrize("closed", [False, True])
def test_the_turntable_as_a_tree_with_open_and_closed_loops(closed):
    analysis = TreeAnalysis(tree_table(closed))
    start_tree(analysis, 0.0)
    _, A, constant = linearised(analysis, TreeLinearised)
    assert np.abs(A - [[0.0, 1.0], [-91.0, 0.0]]).max() < 1e-7
    assert constant


def test_a_closed_loop_that_turns_settles_where_its_forces_balance():
    """200 (r - 0.05) = m Omega² r on a rail that a closure makes."""
    tree = replace(tree_table(True), elements=sprung((1, TRANSLATION, 1, 200.0, 0.0, 0.05)))
    analysis = TreeAnalysis(tree)
    start_tree(analysis, 0.0)
    find_equilibrium(analysis, TreeLinearised)
    assert analysis.state[3 + 1] == pytest.approx(200.0 * 0.05 / (200.0 - MASS * OMEGA**2), rel=1e-9)
    assert analysis.state[0] == OMEGA


def test_a_stiff_slow_spin_up_is_frozen_and_a_linear_oscillator_is_not():
    """A torque will turn the shaft and soften its beam, whose own motion is far faster.

    The mass on the turntable starts off its place of balance, but its coefficients do not depend on that.
    """
    deck = Path(__file__).parents[3] / "decks/dafms/shaft_beam_n10.DAT"
    analysis = TreeAnalysis(build_dafms(read_deck(read_text(str(deck))))[0])
    start_tree(analysis, 0.0)
    assert not modes(analysis, TreeLinearised).constant
    loaded = turntable(1, springs(X, 100.0, gap=0.05))
    assert found(loaded).constant
