"""Eigenfrequencies, damping and equilibrium of small motions against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from dynamic_runs import AT_REST, GROUND, body

from flexmb_cli.model.dynamics import DynamicModel, MassProperties, SpringDamper
from flexmb_cli.model.mechanism import Joint, Mechanism, Simplified, TimeGrid
from flexmb_cli.solve.constrained_dynamics import ForwardDynamics
from flexmb_cli.solve.linearised import modes, settle

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
    spring = SpringDamper("spring 1", 0, 1, (0.0,) * 3, (0.0,) * 3, stiffness, 1.0, damping)
    return DynamicModel(mechanism, "forward", (mass,), springs=(spring,))


def test_a_damped_oscillator_has_its_textbook_frequency_and_damping_ratio():
    found = modes(started(oscillator()))
    natural = math.sqrt(80.0 / 2.0)
    ratio = 4.0 / (2.0 * 2.0 * natural)
    assert found.damping == pytest.approx([ratio], rel=1e-8)
    assert found.frequency == pytest.approx([natural * math.sqrt(1.0 - ratio**2) / (2.0 * math.pi)], rel=1e-8)


def test_a_weight_settles_where_its_spring_carries_it():
    analysis = started(replace(oscillator(), gravity=(0.0, 0.0, -G)))
    settle(analysis)
    assert analysis.march.z[9] == pytest.approx(1.0 - 2.0 * G / 80.0, rel=1e-10)


def test_a_pendulum_let_go_at_an_angle_settles_hanging():
    half = 0.5 * (math.pi / 2 - 1.0)
    analysis = started(pendulum((math.cos(half), 0.0, math.sin(half), 0.0)))
    settle(analysis)
    assert analysis.march.z[10:14] == pytest.approx(DOWN, abs=1e-9)
