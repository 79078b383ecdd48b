"""An integrator is one file of kernels and a line in the table of methods: the classical one of order 4."""

import math
from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreted
from flexmb_cli.model.integrators import METHODS, Integrator, IntegratorType
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.solvers.constrained import integrators
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.kernels.integrators import rk4
from tests.solvers.constrained.dynamic_runs import joined
from tests.solvers.constrained.test_alpha_of_rigid_bodies import angle_from_vertical, bar_angles, swinging_bar
from tests.solvers.constrained.test_forward_dynamics import G


@pytest.mark.skipif(not interpreted(), reason="the kernels of a test would be compiled in every pass")
def test_a_method_of_one_file_swings_a_bar_with_its_order(monkeypatch):
    """sin(θ/2) = k sn(K + rate t, k), rate² = m g l / J about the hinge = 3 g / (2 L)."""
    monkeypatch.setattr(integrators, "KERNELS", rk4.__name__.rpartition(".")[0])
    monkeypatch.setitem(METHODS, "RK4", IntegratorType("rk4", "Kutta", "rk4", 1e-8, given_step=True))
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
