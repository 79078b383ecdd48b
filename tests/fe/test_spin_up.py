"""Spin-up of a cantilever with and without centrifugal stiffening (Simo and Vu-Quoc's data).

The nonlinear column is that of 40 geometrically exact beam elements; the others are this project's
reference computation with three in-plane modes and a step of 0.01 s.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.kernels.constrained.floating_frame import (
    add_elastic_forces,
    first_moment,
    moving_inertia,
    velocity_forces,
)
from tests.dialects.vsdf.vsdf_decks import build, supplied

# t: u2 nonlinear, with K_G, without.
TIP = {
    1.0: (-0.02054, -0.02051, -0.0205),
    2.0: (-0.10239, -0.10195, -0.1020),
    4.0: (-0.34232, -0.34109, -0.3515),
    5.0: (-0.46855, -0.46701, -0.5197),
    6.0: (-0.54371, -0.54218, -0.7232),
    6.75: (-0.57402, -0.57207, -0.9812),
    8.0: (-0.54313, -0.54119, -2.105),
    9.0: (-0.46062, -0.45862, -7.31),
    10.0: (-0.36320, -0.36093, np.nan),
    12.0: (-0.15107, -0.15035, np.nan),
    14.0: (-0.02034, -0.01998, np.nan),
    15.0: (0.00139, 0.00077, np.nan),
}


def tip_deflections(times, stiffened):
    """u2 of the tip while the frame turns about z by the deck's law."""
    mechanism, _ = flexible_mechanism(build(supplied("spinup")), cached=False)
    body = mechanism.bodies[0].flexible
    function = mechanism.motions[2].function
    N = body.modes
    KG = body.KG if stiffened else np.zeros((0, 0, N, N))

    def rate(t, y):
        eta, etad = y[:N], y[N:]
        _, speed, acceleration = function.at(t)
        w, alpha = np.array([0.0, 0.0, speed]), np.array([0.0, 0.0, acceleration])
        s, S_tt, S_tf, T = np.empty(3), np.empty((3, 3)), np.empty((3, N)), np.empty((N, 3, 3))
        f = np.empty(6 + N)
        first_moment(eta, body.s0, body.S1, s)
        moving_inertia(eta, body.J0, body.J1, body.J2, body.C0, body.C1, T, S_tt, S_tf)
        velocity_forces(np.eye(3), w, etad, s, body.S1, S_tt, S_tf, body.J1, T, body.C1, f)
        add_elastic_forces(w, eta, etad, body.Kr, body.Dr, KG, f)
        return np.concatenate([etad, np.linalg.solve(body.Mff, f[6:] + S_tf.T @ alpha)])

    moved = solve_ivp(rate, (0.0, max(times)), np.zeros(2 * N), "DOP853", times, rtol=1e-7, atol=1e-10)
    (tip,) = mechanism.outputs
    return tip.shape[1] @ moved.y[:N]


@pytest.mark.long_motion
def test_the_stiffened_cantilever_stays_within_3_mm_of_the_nonlinear_beam():
    nonlinear, stiffened, _ = np.array(list(TIP.values())).T
    found = tip_deflections(list(TIP), stiffened=True)
    assert np.abs(found - nonlinear).max() < 3e-3
    assert np.abs(found - stiffened).max() < 2e-4


@pytest.mark.long_motion
def test_without_stiffening_the_cantilever_diverges():
    """First bending 3.8 rad/s, spin 6 rad/s: the centrifugal softening wins."""
    times = [time for time in TIP if time <= 9.0]
    found = tip_deflections(times, stiffened=False)
    assert found == pytest.approx([TIP[time][2] for time in times], rel=0.02)
    assert abs(found[-1]) > 5.0
