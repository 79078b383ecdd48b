"""Eigenfrequencies, damping and equilibrium of small motions against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model import laws
from flexmb_cli.model.loads import DynamicModel, InitialVelocity, MassProperties
from flexmb_cli.model.mechanism import Joint, Mechanism, Simplified, TimeGrid
from flexmb_cli.model.tree import INERTIAL, Hinge, Tree
from flexmb_cli.model.tree import Body as Part
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from flexmb_cli.solvers.linearisation.constrained import ConstrainedLinearised, bring_to, modes
from flexmb_cli.solvers.linearisation.equilibrium import find_equilibrium
from flexmb_cli.solvers.linearisation.tree import TreeLinearised, start_tree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body

G = 9.81
DOWN = (math.cos(math.pi / 4), 0.0, math.sin(math.pi / 4), 0.0)  # x axis turned to -z


def pendulum(p):
    mechanism = Mechanism(
        (GROUND, body(2, p=p)),
        TimeGrid(0.0, 1.0, 0.5),
        (Joint("revolute", "revolute 1", 0, 1, (0.0,) * 3, (0.0,) * 3, (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)),),
        grounds=(AT_REST,),
    )
    mass = MassProperties("mass 1", 1, 2.0, (0.5, 0.0, 0.0), (0.1, 0.1, 0.1, 0.0, 0.0, 0.0))
    return DynamicModel(mechanism, "forward", (mass,), gravity=(0.0, 0.0, -G))


def started(model):
    analysis = ForwardDynamics(model)
    analysis.start()
    return analysis


def test_a_hanging_pendulum_swings_at_the_root_of_weight_over_inertia():
    found = modes(started(pendulum(DOWN)))
    expected = math.sqrt(2.0 * G * 0.5 / (0.1 + 2.0 * 0.25)) / (2.0 * math.pi)
    assert found.frequency == pytest.approx([expected], rel=1e-9)
    assert np.abs(found.damping).max() < 1e-9


def test_a_standing_pendulum_falls_at_that_rate():
    up = (DOWN[0], 0.0, -DOWN[2], 0.0)
    found = modes(started(pendulum(up)))
    assert found.frequency.size == 0
    assert found.growing == pytest.approx([math.sqrt(2.0 * G * 0.5 / 0.6)], rel=1e-9)


def oscillator(stiffness=80.0, damping=4.0):
    """2 kg on a spring and damper along z, guided."""
    mechanism = Mechanism(
        (GROUND, body(2, (0.0, 0.0, 1.0))),
        TimeGrid(0.0, 1.0, 0.5),
        simplified=tuple(Simplified(f"simplified {k}", 1, k, 0.0) for k in (1, 2, 4, 5, 6)),
        grounds=(AT_REST,),
    )
    mass = MassProperties("mass 1", 1, 2.0, inertia=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    spring = laws.spring("spring 1", laws.Line(0, 1, (0.0,) * 3, (0.0,) * 3), stiffness, 1.0, damping)
    return DynamicModel(mechanism, "forward", (mass,), springs=(spring,))


def test_a_damped_oscillator_has_its_textbook_frequency_and_damping_ratio():
    found = modes(started(oscillator()))
    natural = math.sqrt(80.0 / 2.0)
    ratio = 4.0 / (2.0 * 2.0 * natural)
    assert found.damping == pytest.approx([ratio], rel=1e-8)
    assert found.frequency == pytest.approx([natural * math.sqrt(1.0 - ratio**2) / (2.0 * math.pi)], rel=1e-8)


def test_a_weight_settles_where_its_spring_carries_it():
    analysis = started(replace(oscillator(), gravity=(0.0, 0.0, -G)))
    find_equilibrium(analysis, ConstrainedLinearised)
    assert analysis.integration.z[9] == pytest.approx(1.0 - 2.0 * G / 80.0, rel=1e-10)


def test_a_pendulum_let_go_at_an_angle_settles_hanging():
    half = 0.5 * (math.pi / 2 - 1.0)
    analysis = started(pendulum((math.cos(half), 0.0, math.sin(half), 0.0)))
    find_equilibrium(analysis, ConstrainedLinearised)
    assert analysis.integration.z[10:14] == pytest.approx(DOWN, abs=1e-9)


def test_a_double_pendulum_has_the_two_frequencies_of_its_normal_modes():
    """Equal masses on equal threads: omega² = (2 -+ sqrt 2) g/l; the bobs are points but for 1e-9 of m l²."""
    down = math.radians(90.0)
    p = (math.cos(down / 2), 0.0, math.sin(down / 2), 0.0)
    axis = {"P": (0.0, 0.0, 0.0), "Q": (0.0, 1.0, 0.0)}
    mechanism = Mechanism(
        (GROUND, body(2, p=p), body(3, (0.0, 0.0, -0.7), p)),
        TimeGrid(0.0, 1.0, 0.5),
        (
            Joint("revolute", "revolute 1", 0, 1, axis["P"], axis["P"], axis["Q"], axis["Q"]),
            Joint("revolute", "revolute 2", 1, 2, (0.7, 0.0, 0.0), axis["P"], axis["Q"], axis["Q"]),
        ),
        grounds=(AT_REST,),
    )
    bob = (1e-9,) * 3 + (0.0,) * 3
    masses = tuple(MassProperties(f"mass {k}", k, 1.5, (0.7, 0.0, 0.0), bob) for k in (1, 2))
    found = modes(started(DynamicModel(mechanism, "forward", masses, gravity=(0.0, 0.0, -G))))
    expected = [math.sqrt((2.0 + s * math.sqrt(2.0)) * G / 0.7) / (2.0 * math.pi) for s in (-1.0, 1.0)]
    assert found.frequency == pytest.approx(expected, rel=1e-7)
    assert found.unheld == 0


def chain(masses, free_ends=True):
    """Masses along z, springs of 50 N/m between them, each held to its line."""
    count = len(masses)
    bodies = (GROUND, *(body(k + 2, (0.0, 0.0, 1.0 + k)) for k in range(count)))
    held = tuple(
        Simplified(f"simplified {b}.{k}", b, k, 0.0) for b in range(1, count + 1) for k in (1, 2, 4, 5, 6)
    )
    points = (0.0,) * 3
    first = 1 if free_ends else 0
    springs = tuple(
        laws.spring(f"spring {b}", laws.Line(b, b + 1, points, points), 50.0, 1.0)
        for b in range(first, count)
    )
    given = tuple(
        MassProperties(f"mass {b}", b, m, inertia=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
        for b, m in enumerate(masses, 1)
    )
    mechanism = Mechanism(bodies, TimeGrid(0.0, 1.0, 0.5), simplified=held, grounds=(AT_REST,))
    return DynamicModel(mechanism, "forward", given, springs=springs)


def test_a_fixed_chain_of_equal_masses_has_sine_frequencies():
    """omega_j = 2 sqrt(k/m) sin((2 j - 1) pi / (2 (2 n + 1))), one end fixed, one free."""
    found = modes(started(chain((2.0, 2.0, 2.0), free_ends=False)))
    expected = [
        2.0 * math.sqrt(25.0) * math.sin((2 * j - 1) * math.pi / 14.0) / (2.0 * math.pi) for j in (1, 2, 3)
    ]
    assert found.frequency == pytest.approx(expected, rel=1e-8)


def test_a_free_chain_has_two_eigenvalues_that_nothing_holds():
    """Two masses swing at sqrt(k (1/m + 1/M)); their centre drifts."""
    found = modes(started(chain((1.0, 4.0))))
    assert found.frequency == pytest.approx([math.sqrt(50.0 * 1.25) / (2.0 * math.pi)], rel=1e-8)
    assert found.unheld == 2
    assert found.growing.size == found.decaying.size == 0


def test_a_pendulum_let_go_above_the_horizontal_falls_and_one_that_stands_stays():
    """Newton's method alone would go to the nearest position without force, which is the upper one."""
    half = 0.5 * (math.pi / 2 - 2.6)
    analysis = started(pendulum((math.cos(half), 0.0, math.sin(half), 0.0)))
    find_equilibrium(analysis, ConstrainedLinearised)
    assert modes(analysis).growing.size == 0
    up = (DOWN[0], 0.0, -DOWN[2], 0.0)
    analysis = started(pendulum(up))
    find_equilibrium(analysis, ConstrainedLinearised)
    assert analysis.integration.z[10:14] == pytest.approx(up, abs=1e-12)


def test_an_overdamped_oscillator_only_fades():
    """s² m + s c + k = 0 with c = 40: s = -10 -+ sqrt(100 - 40)."""
    found = modes(started(oscillator(damping=40.0)))
    assert found.frequency.size == 0
    assert sorted(found.decaying) == pytest.approx(
        [-10.0 - math.sqrt(60.0), -10.0 + math.sqrt(60.0)], rel=1e-8
    )


def test_a_linear_system_keeps_its_frequency_while_it_moves():
    analysis = ForwardDynamics(replace(oscillator(), gravity=(0.0, 0.0, -G)))
    bring_to(analysis, 0.3)
    assert analysis.clock["t"][0] == pytest.approx(0.3, rel=1e-12)
    assert abs(analysis.integration.z[9] - 1.0) > 0.05
    natural = math.sqrt(40.0)
    assert modes(analysis).frequency == pytest.approx(
        [natural * math.sqrt(1.0 - (1.0 / natural) ** 2) / (2.0 * math.pi)], rel=1e-7
    )


TOP_MASS, TOP_ARM, TOP_ACROSS, TOP_ALONG = 2.0, 0.3, 0.25, 0.1


def spinning_top(spin):
    """A symmetric top that stands on its tip, axis z; inertia about the tip is TOP_ACROSS, TOP_ALONG."""
    at_tip = (0.0,) * 3
    mechanism = Mechanism(
        (GROUND, body(2)),
        TimeGrid(0.0, 1.0, 0.5),
        (Joint("spherical", "spherical 1", 0, 1, at_tip, at_tip),),
        grounds=(AT_REST,),
    )
    across = TOP_ACROSS - TOP_MASS * TOP_ARM**2
    mass = MassProperties(
        "mass 1", 1, TOP_MASS, (0.0, 0.0, TOP_ARM), (across, across, TOP_ALONG, 0.0, 0.0, 0.0)
    )
    first = InitialVelocity("velocity 1", 1, (0.0,) * 3, (0.0, 0.0, spin))
    return DynamicModel(mechanism, "forward", (mass,), gravity=(0.0, 0.0, -G), velocities=(first,))


@pytest.mark.parametrize("spin", [40.0, 90.0])
def test_a_sleeping_top_nutates_and_precesses_as_seen_from_its_body(spin):
    """I1 x'' - i I3 w x' - m g l x = 0 for a small tilt x in space; body axes see each root less w.

    The spin itself turns by nothing held: two more eigenvalues are zero.
    """
    weight = TOP_MASS * G * TOP_ARM
    root = math.sqrt((TOP_ALONG * spin) ** 2 - 4.0 * TOP_ACROSS * weight)
    seen = [abs((TOP_ALONG * spin + sign * root) / (2.0 * TOP_ACROSS) - spin) for sign in (-1.0, 1.0)]
    found = modes(started(spinning_top(spin)))
    assert found.frequency * 2.0 * math.pi == pytest.approx(sorted(seen), rel=1e-7)
    assert found.damping == pytest.approx([0.0, 0.0], abs=1e-7)
    assert found.unheld == 2


def test_a_top_that_spins_too_slowly_falls():
    """Below (I3 w)² = 4 I1 m g l the tilt grows by sqrt(4 I1 m g l - (I3 w)²)/(2 I1)."""
    spin, weight = 20.0, TOP_MASS * G * TOP_ARM
    found = modes(started(spinning_top(spin)))
    rate = math.sqrt(4.0 * TOP_ACROSS * weight - (TOP_ALONG * spin) ** 2) / (2.0 * TOP_ACROSS)
    assert found.eigenvalues.real.max() == pytest.approx(rate, rel=1e-7)


def test_a_top_of_a_tree_is_seen_from_space():
    """Speeds of a hinge with three rotations are about axes of the parent, which stands still here."""
    spin, weight = 40.0, TOP_MASS * G * TOP_ARM
    tree = Tree(
        (Part("body 1", TOP_MASS, np.diag([TOP_ACROSS, TOP_ACROSS, TOP_ALONG]), (0.0, 0.0, TOP_ARM)),),
        (Hinge(INERTIAL, rotations=(1, 2, 3)),),
        np.zeros(3),
        np.array([0.0, 0.0, spin]),
        TimeGrid(0.0, 1.0, 0.5),
        gravity=(0.0, 0.0, -G),
    )
    analysis = TreeAnalysis(tree)
    start_tree(analysis, 0.0)
    root = math.sqrt((TOP_ALONG * spin) ** 2 - 4.0 * TOP_ACROSS * weight)
    expected = [(TOP_ALONG * spin + sign * root) / (2.0 * TOP_ACROSS) for sign in (-1.0, 1.0)]
    found = modes(analysis, TreeLinearised)
    assert found.frequency * 2.0 * math.pi == pytest.approx(expected, rel=1e-7)
    assert found.unheld == 2
