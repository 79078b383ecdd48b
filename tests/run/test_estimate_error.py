"""`run --estimate-error`: the global error of every quantity, against what is known to be right."""

import math

import h5py
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.trouble.young_linkages import AT_REST, outcome, told, turned, young

ARM, INERTIA, GRAVITY = 0.5, 0.1, 9.81


def pendulum(cards, analysis="forward", drivers=()):
    """A bar of 1 kg about a hinge, let go level."""
    return young(
        (turned(0, 0, 0), turned(0, 0, 0)), (0, 2, 0.1),
        f"DYNAMICS {analysis}\nMASS 2 1 {ARM} 0 0 0.01 0.1 {INERTIA}\nGRAVITY 0 -{GRAVITY} 0\n{cards}END\n",
        drivers=drivers, revolute=[(1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1)], ground=[AT_REST],
    )  # fmt: skip


def speeds(times):
    """J φ̈ = -m g l cos φ, by DOP853 of SciPy."""
    rate = GRAVITY * ARM / (INERTIA + ARM**2)
    found = solve_ivp(
        lambda _, y: [y[1], -rate * math.cos(y[0])], (0, times[-1]), (0.0, 0.0), "DOP853", times,
        rtol=1e-13, atol=1e-13,
    )  # fmt: skip
    return found.y[1]


def test_the_estimate_is_the_error(tmp_path):
    found = outcome(tmp_path, pendulum("TOLERANCE 1e-5\n"), estimate_error=True)
    assert (found.exit_code, told(found)) == (0, [])
    with h5py.File(tmp_path / "OUT.h5") as result:
        time, speed = result["time"][:], result["body/angular_velocity"][:, 1, 2]
        estimate = result["audit/global_error/body/angular_velocity"][:]
        assert result["audit/global_error/body/angular_velocity"].attrs["units"] == "rad/s"
    error = np.abs(speed - speeds(time))
    assert error.max() > 1e-7
    assert estimate == pytest.approx(error, abs=0.05 * error.max())
    assert found.errors["body/angular_velocity"]["error"] == estimate.max()
    assert found.as_dict()["global_error"] == found.errors


def test_a_run_of_given_steps_says_that_nothing_can_be_estimated(tmp_path):
    found = outcome(tmp_path, pendulum("GALF 0.005 1\n"), estimate_error=True)
    assert found.exit_code == 0
    assert "--estimate-error has no effect: no step of this run is chosen by a tolerance" in told(found)[0]
    assert not found.errors
