"""Rigid bodies whose moments of inertia, or one of them, are 0: point masses and thin rods.

Expected: the pendulum phi'' = m g l cos(phi)/J of a body on a hinge along y, integrated by DOP853 of SciPy
from rest along x; a public report gives abs e0 = 0.129411179 and abs e2 = 0.991591018 of the point mass.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.errors import AnalysisError
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.vsdf_decks import read

PENDULUM = """\
VSDF A BODY ON A HINGE
BODY
    1 RIGD
RIGI
 1,3,0.5,0,0
 {moments}
NODE
 0,1,0,0,0
 0,2,0,1,0
 1,1,0,0,0
 1,2,0,1,0
JOIN
 1,{joint}
GRAV
 0,0,-9.81
TIME
 1,0.1
INTG
 {method}
END
STAR
STOP
"""
HINGE = "REVO,0,1,2,1,1,2"


def deck(moments="0,0,0", joint=HINGE, method="RK45,1e-11"):
    return PENDULUM.format(moments=moments, joint=joint, method=method)


def final_attitude(text):
    """Euler parameters of body 1 at 1 s."""
    mechanism = flexible_mechanism(build_vsdf(read(text), Path())[0])[0]
    return list(FlexibleDynamics(mechanism).rows())[-1].euler_parameters[-1, 0]


def half_angle(moment, inertia):
    """Half the angle about y after 1 s; `moment`: mass times distance, kg m; `inertia` about the hinge."""

    def rates(_, state):
        return [state[1], 9.81 * moment * np.cos(state[0]) / inertia]

    return solve_ivp(rates, (0.0, 1.0), [0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-12).y[0, -1] / 2


def assert_turned(p, angle):
    """Euler parameters p and -p are the same attitude."""
    wanted = np.array([np.cos(angle), 0.0, np.sin(angle), 0.0])
    assert p * np.sign(p @ wanted) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("method", ["RK45,1e-11", "RAD5,1e-9"])
def test_a_point_mass_swings_as_a_pendulum(method):
    p = abs(final_attitude(deck(method=method)))
    assert p == pytest.approx([0.129411179, 0.0, 0.991591018, 0.0], abs=2e-8)


@pytest.mark.parametrize("moments, inertia", [("0,0.2,0.2", 0.95), ("0.2,0.2,0", 0.95), ("0.2,0,0.2", 0.75)])
def test_a_thin_rod_along_each_axis_swings_as_its_inertia_says(moments, inertia):
    assert_turned(final_attitude(deck(moments)), half_angle(1.5, inertia))


WELDED = """\
 2,1,0,0,0
 0,0,0
POSI
 2,1.0
NODE
 1,3,1,0,0
 1,4,1,0,1
 1,5,1,1,0
 2,1,0,0,0
 2,2,0,0,1
 2,3,0,1,0
JOIN
 2,FIXD,1,3,4,2,1,2,5,3
"""


def test_a_point_mass_welded_to_a_rod_adds_m_r_squared():
    text = deck("0,0.2,0.2").replace("    1 RIGD\n", "    1 RIGD\n    2 RIGD\n")
    text = text.replace("GRAV\n", f"RIGI\n{WELDED}GRAV\n")
    assert_turned(final_attitude(text), half_angle(1.5 + 1.0, 0.95 + 1.0))


@pytest.mark.parametrize("moments, joint", [
    ("0,0,0", "SPHE,0,1,,1,1"), ("0,0.2,0.2", "SPHE,0,1,,1,1"), ("0,0,0", "DIST,0,1,,1,2"),
])  # fmt: skip
def test_a_turn_that_nothing_resists_is_refused(moments, joint):
    """About the line from a spherical joint to the mass centre, or of a point mass about any axis."""
    with pytest.raises(AnalysisError, match="body 1 can move without any mass or inertia resisting"):
        final_attitude(deck(moments, joint))
