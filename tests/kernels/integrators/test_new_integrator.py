"""An integrator is one file of kernels and a line in the table of methods: the classical one of order 4."""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreted
from flexmb_cli.model.integrators import METHODS, Integrator, IntegratorType
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.constrained import integrators
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.kernels.integrators import rk4
from tests.solvers.constrained.dynamic_runs import joined
from tests.solvers.constrained.test_alpha_of_rigid_bodies import angle_from_vertical, bar_angles, swinging_bar
from tests.solvers.constrained.test_forward_dynamics import G
from tests.solvers.singular.test_singular_positions import Parallelogram, turns

pytestmark = pytest.mark.skipif(
    not interpreted(), reason="the kernels of a test would be compiled in every pass"
)


@pytest.fixture(autouse=True)
def _known(monkeypatch):
    monkeypatch.setattr(integrators, "KERNELS", rk4.__name__.rpartition(".")[0])
    monkeypatch.setitem(METHODS, "RK4", IntegratorType("rk4", "Kutta", "rk4", 1e-8, given_step=True))


def test_a_method_of_one_file_swings_a_bar_with_its_order():
    """sin(θ/2) = k sn(K + rate t, k), rate² = m g l / J about the hinge = 3 g / (2 L)."""
    model, errors = swinging_bar(), []
    model = replace(model, mechanism=replace(model.mechanism, time=TimeGrid(0.0, 0.5, 0.125)))
    for step in (0.0625, 0.03125):
        analysis = ForwardDynamics(replace(model, integrator=Integrator("RK4", step)))
        rows = joined(list(analysis.rows()))
        assert analysis.clock["steps"][0] == round(0.5 / step)
        assert rows.constraint_residual.max() < 1e-14
        exact = angle_from_vertical(rows.time, math.sqrt(1.5 * G))
        errors.append(np.max(np.abs(bar_angles(rows) - exact)))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.5)


def test_steps_whose_sum_misses_the_end_reach_it():
    """Eight times 0.1 are 0.7999999999999999; the bar is where the elliptic function says."""
    model = swinging_bar()
    model = replace(model, mechanism=replace(model.mechanism, time=TimeGrid(0.0, 0.8, 0.1)))
    analysis = ForwardDynamics(replace(model, integrator=Integrator("RK4", 0.1)))
    rows = joined(list(analysis.rows()))
    assert rows.time.size == 9 and analysis.clock["steps"][0] == 8 and analysis.clock["t"][0] == 0.8
    exact = angle_from_vertical(rows.time, math.sqrt(1.5 * G))
    assert bar_angles(rows) == pytest.approx(exact, abs=0.02)


def test_rows_near_a_singular_position_are_filled():
    """Cranks without gravity keep their 1 rad/s through the positions in line with the coupler, at π - 0.5 s.

    Rows are 0.06 s apart, the nearest 1.6 ms before it.
    """
    swing = Parallelogram(0.5, 1.0, 1.0, 0.7, (1.0, 1.0, 1.0))
    mechanism = replace(swing.mechanism(Integrator("RK4", 0.02)), time=TimeGrid(0.0, 2.88, 0.06))
    rows = list(FlexibleDynamics(mechanism).rows())
    times = np.concatenate([block.time for block in rows])
    turned = np.unwrap(np.concatenate([turns(block, 0) for block in rows]))
    rates = np.concatenate([block.angular_acceleration[:, 0, 2] for block in rows])
    assert times.size == 49 and turned == pytest.approx(0.5 + times, abs=1e-6)
    assert rates[np.isfinite(rates)] == pytest.approx(0.0, abs=1e-4)
