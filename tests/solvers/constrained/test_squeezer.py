"""Andrews' squeezer against its published reference solution at t = 0.03 s."""

from dataclasses import replace

import numpy as np
import pytest

from flexmb_cli.model.integrators import Integrator
from tests.solvers.constrained import squeezer
from tests.solvers.constrained.dynamic_runs import run

pytestmark = pytest.mark.long_motion


@pytest.fixture(scope="module")
def rows():
    return run(replace(squeezer.model(0.03, 0.015), integrator=Integrator(tolerance=1e-10)))


def test_the_accelerations_at_the_start_are_the_published_ones(rows):
    beta, theta = squeezer.START_ACCELERATIONS
    found = rows.angular_acceleration[0, 1:3, 2]
    assert found == pytest.approx([beta, beta + theta], rel=1e-9)


def test_the_angles_at_the_end_are_the_published_ones(rows):
    p = rows.euler_parameters[-1, 1:]
    found = 2.0 * np.arctan2(p[:, 3], p[:, 0])
    off = np.angle(np.exp(1j * (found - squeezer.absolute(squeezer.END))))
    assert np.abs(off).max() < 1e-7


def test_the_velocities_at_the_end_are_the_published_ones(rows):
    expected = squeezer.absolute(squeezer.END_RATES)
    assert rows.angular_velocity[-1, 1:, 2] == pytest.approx(expected, rel=1e-7, abs=1e-6)


def test_all_fifty_equations_are_met_and_the_energy_balance_closes(rows):
    assert rows.constraint_residual.max() < 1e-14
    assert rows.velocity_residual.max() < 1e-11
    assert np.abs(rows.total - rows.total[0]).max() < 1e-9 * rows.kinetic.max()
