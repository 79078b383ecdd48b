"""Reactions and efforts of driven mechanisms against the balances of every body and of energy."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model import laws
from flexmb_cli.model.loads import AppliedForce, AppliedTorque, DynamicModel, MassProperties
from flexmb_cli.model.mechanism import Driver, Mechanism, Simplified, TimeGrid
from tests.solvers.constrained.body_balances import worst_balance
from tests.solvers.constrained.dynamic_runs import AT_REST, GROUND, body, mechanism_of, run, uneven_masses

GRAVITY = (0.4, -0.7, -9.81)


def loaded(mechanism):
    """Inverse dynamics with a load of every kind."""
    return DynamicModel(
        mechanism,
        "inverse",
        uneven_masses(len(mechanism.bodies)),
        (
            AppliedForce("force 1", 1, (3.0, -2.0, 1.0), (0.2, 0.1, -0.3)),
            AppliedForce("force 2", 2, (-1.0, 2.5, 0.5), (0.1, 0.2, 0.3), following=True),
        ),
        (
            AppliedTorque("torque 1", 1, (0.3, 0.2, -0.1)),
            AppliedTorque("torque 2", 2, (0.4, -0.6, 0.2), following=True),
        ),
        (laws.spring("spring 1", laws.Line(1, 2, (0.0, 0.1, 0.2), (0.3, 0.1, -0.1)), 40.0, 0.3, 2.0),),
        GRAVITY,
    )


@pytest.mark.parametrize("deck", ["IN4-BAR", "IN-RSSR", "IN5BODY"])
def test_reactions_and_efforts_move_every_body_as_newton_and_euler_ask(deck):
    model = loaded(mechanism_of(deck))
    assert worst_balance(model, run(model)) < 1e-11


@pytest.mark.parametrize("deck", ["IN4-BAR", "IN-RSSR"])
def test_power_of_drivers_and_loads_is_the_rate_of_energy(deck):
    """Rate by central differences of fourth order at 1e-4 of the report step, good to 1e-7."""
    mechanism = mechanism_of(deck)
    middle = mechanism.time.time(3)
    step = 1e-3 * mechanism.time.step
    near = TimeGrid(middle - 2.0 * step, middle + 2.0 * step, step)
    rows = run(loaded(replace(mechanism, time=near)))
    energy = rows.kinetic + rows.potential
    rate = (energy[0] - 8.0 * energy[1] + 8.0 * energy[3] - energy[4]) / (12.0 * step)
    assert rows.applied_power[2] == pytest.approx(rate, rel=1e-6)


def test_turning_a_wheel_faster_takes_inertia_times_acceleration():
    """I = 0.7 kg m² about the axle plus 2 kg at 0.3 m; torque I α + m g c cos φ, φ = t²."""
    held = tuple(Simplified(f"simplified {k}", 1, k, 0.0) for k in (1, 2, 3, 4, 5))
    mechanism = Mechanism(
        (GROUND, body(2)),
        TimeGrid(0.0, 1.0, 0.25),
        simplified=held,
        drivers=(Driver("driver 1", 1, 6, 0.0, 0.0, 2.0),),
        grounds=(AT_REST,),
    )
    wheel = MassProperties("mass 1", 1, 2.0, (0.3, 0.0, 0.0), (0.4, 0.5, 0.7, 0.0, 0.0, 0.0))
    rows = run(DynamicModel(mechanism, "inverse", (wheel,), gravity=(0.0, -9.81, 0.0)))
    expected = (0.7 + 2.0 * 0.09) * 2.0 + 2.0 * 9.81 * 0.3 * np.cos(rows.time**2)
    assert rows.driver_effort[:, 0] == pytest.approx(expected, rel=1e-13)


def test_a_lifted_weight_takes_its_weight_and_its_acceleration():
    mechanism = Mechanism(
        (body(1),),
        TimeGrid(0.0, 1.0, 0.5),
        simplified=tuple(Simplified(f"simplified {k}", 0, k, 0.0) for k in (1, 2, 4, 5, 6)),
        drivers=(Driver("driver 1", 0, 3, 0.0, 1.0, 3.0),),
    )
    weight = MassProperties("mass 1", 0, 5.0, inertia=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    rows = run(DynamicModel(mechanism, "inverse", (weight,), gravity=(0.0, 0.0, -9.81)))
    assert rows.driver_effort[:, 0] == pytest.approx(np.full(3, 5.0 * (9.81 + 3.0)), rel=1e-14)
