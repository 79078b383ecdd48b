"""Flexible bodies by the generalised-α method: drift of order two, the order itself, stiff modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.test_runs import FREE_ROD, PENDULUM, Run, momenta, rotation
from tests.dialects.vsdf.vsdf_decks import build, supplied

pytestmark = pytest.mark.long_motion

GRID = "       0.5    5.0E-4    5.0E-5"


def run(name, *changes, step=1e-4, end=0.1, rows=0.01, radius=0.9):
    grid = (GRID, f"{end:10g}{rows:10g}{step:10g}")
    return Run(supplied(name, grid, (" GALF       0.9", f" GALF{radius:10g}"), *changes))


def drifts(found):
    """Largest drift of momentum, angular momentum and energy."""
    P, H = momenta(found)
    kept = (P, H, found.total[:, None])
    return np.array([np.abs(values - values[0]).max() for values in kept])


def test_the_drift_of_the_free_rod_falls_by_four_when_the_step_is_halved():
    """The reference computation of this project with radius 0.98 drifts by P 4.2e-7, H 4.8e-8, E 1.4e-7
    with 2e-4 s, and by a quarter of that with 1e-4 s."""
    coarse, fine = (run("freeflying", step=step, end=0.5, radius=0.98) for step in (2e-4, 1e-4))
    assert drifts(coarse) == pytest.approx([4.2e-7, 4.8e-8, 1.4e-7], rel=0.15)
    ratio = drifts(coarse) / drifts(fine)
    assert np.all((ratio > 3.5) & (ratio < 4.5))
    found = fine.at(list(FREE_ROD), "point_position")[:, 1]
    np.testing.assert_allclose(found, list(FREE_ROD.values()), rtol=0, atol=2.5e-6)


def test_the_pendulum_comes_to_the_explicit_solution_with_order_two():
    exact = run("pendulum", (" GALF       0.9", " RK45   1.0E-10"))
    gaps = []
    for step in (2e-4, 1e-4, 5e-5):
        found = run("pendulum", step=step)
        gaps.append(np.abs(found.point_position - exact.point_position).max())
        assert found.constraint_residual.max() < 1e-14
        assert found.velocity_residual.max() < 1e-13
    assert gaps[0] / gaps[1] == pytest.approx(4.0, abs=0.4)
    assert gaps[1] / gaps[2] == pytest.approx(4.0, abs=0.4)


def test_the_pendulum_swings_as_listed():
    found = run("pendulum", step=5e-5, end=0.5, rows=0.05)
    z, vz = np.array([values[0] for values in PENDULUM.values()]).T
    np.testing.assert_allclose(found.at(list(PENDULUM), "point_position")[:, 0, 2], z, rtol=0, atol=6e-6)
    np.testing.assert_allclose(found.at(list(PENDULUM), "point_velocity")[:, 0, 2], vz, rtol=0, atol=8e-4)


def test_stiff_modes_do_not_shorten_the_steps():
    """With a million times the stiffness, 5 to 124 kHz, steps of 1 ms see the rigid pendulum.

    sin(θ/2) = k sn(K + rate t, k), θ the angle of the mass centre from the vertical, rate² = g |s0| / J.
    """
    text = supplied(
        "pendulum", (GRID, "       0.3      0.05     0.001"), (" GALF       0.9", " GALF       0.6")
    )
    (body,) = flexible_mechanism(build(text), cached=False)[0].bodies
    flexible = replace(body.flexible, Kr=1e6 * body.flexible.Kr)
    found = Run(text, bodies=(replace(body, flexible=flexible),))
    start = np.arctan2(body.s0[0], -body.s0[2])
    k, rate = np.sin(start / 2), np.sqrt(9.81 * np.hypot(body.s0[0], body.s0[2]) / body.J0[1, 1])
    expected = 2 * np.arcsin(k * ellipj(ellipk(k * k) + rate * found.time, k * k)[0])
    axis = np.array([rotation(p)[:, 0] for p in found.euler_parameters[:, 0]])
    fallen = np.unwrap(np.arctan2(-axis[:, 2], axis[:, 0]))
    np.testing.assert_allclose(start - fallen, expected, rtol=0, atol=2e-4)


def test_gaps_that_drive_stiff_modes_do_not_divide_steps():
    """Slider-crank at full speed, steps of 0.5 ms: what closing a gap does to the
    modes shows in the second correction only, which is no sign that the iteration fails."""
    grid = ("       0.5     0.005", "       0.3       0.1    5.0E-4")
    text = supplied("slider_crank_flex", grid, (" RK45    1.0E-7", " GALF       0.9"))
    analysis = FlexibleDynamics(flexible_mechanism(build(text), cached=False)[0])
    list(analysis.rows())
    assert analysis.clock["steps"][0] == 600
    assert analysis.clock["rejections"][0] == 0
    assert not analysis.warnings
