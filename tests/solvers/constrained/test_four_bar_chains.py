"""Chains of N four-bars through singular positions: the N-four-bar benchmark of the IFToMM library.

González, Kövecses and others, Multibody System Dynamics 36 (2016).  All cranks turn alike: a pendulum with
(J₀ + ...) θ̈ = -g (...) cos θ of one degree of freedom, which DOP853 of SciPy integrates.  An earlier version
stopped at 1e-10 for N = 2 (t = 6.54 s) and N = 5 (t = 3.19 s), and by RAD5 at 1e-9 for N = 1 (t = 0.71 s).
"""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
from four_bars import deck_of, energy_error, run

pytestmark = pytest.mark.long_motion

G = 9.81


def cranks(count, times):
    """Angle and speed of all cranks: of 1 m and 1 kg, J = 1/3 about their pins; couplers only shift."""
    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count

    def slope(_, y):
        return [y[1], -G * arm * math.cos(y[0]) / inertia]

    found = solve_ivp(slope, (0.0, times[-1]), (0.5 * math.pi, -1.0), "DOP853", times, rtol=1e-12, atol=1e-12)
    return found.y


def held(count, method, tolerance, end=10.0):
    """Run the chain; speeds and energy keep to what the issue asks for."""
    _, blocks, stopped = run(deck_of(count, method, tolerance, end))
    assert not stopped
    assert energy_error(blocks) < 100.0 * tolerance
    return blocks


@pytest.mark.parametrize(("count", "tolerance"), [(1, 1e-6), (1, 1e-11), (2, 1e-10), (5, 1e-10), (5, 1e-11)])
def test_the_explicit_method_passes_at_every_tolerance(count, tolerance):
    blocks = held(count, "DOP853", tolerance)
    time = np.concatenate([block.time for block in blocks])
    speed = np.concatenate([block.angular_velocity[:, 1, 2] for block in blocks])
    assert speed == pytest.approx(cranks(count, time)[1], abs=1e5 * tolerance)


@pytest.mark.parametrize(("count", "tolerance"), [(1, 1e-6), (1, 1e-9), (1, 1e-11), (2, 1e-10)])
def test_radaus_method_passes_at_every_tolerance(count, tolerance):
    held(count, "RAD5", tolerance)


@pytest.mark.parametrize("tolerance", [1e-5, 1e-6])
def test_generalised_alpha_passes_with_steps_of_its_choice(tolerance):
    held(1, "GALF", tolerance)
