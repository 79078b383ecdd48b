"""Lines DRIVE of a VSDF deck move its joints; a YOUNG and a DAFMS deck are solved elsewhere."""

import numpy as np
import pytest

from flexmb_cli.interface import solve

ROTOR = """\
VSDF a rotor about z
BODY
    1,RIGD
RIGI
    1,2.0,0.3,0.0,0.0
    0.02,0.3,0.3,0.0,0.0,0.0
NODE
    0,1,0,0,0
    0,2,0,0,1
    1,1,0,0,0
    1,2,0,0,1
JOIN
    1,REVO,0,1,2,1,1,2,,
TIME
    0.5,0.05
ELEMENTS
  FUNCTION swing sine 0.1 0.4 3
  DRIVE crank at=1.angle {key}=swing
END
STAR
STOP
"""


@pytest.mark.parametrize("key", ["value", "rate"])
def test_the_joint_of_a_vsdf_deck_follows_its_function(tmp_path, key):
    """The angle is 0.1 + 0.4 sin 3t, less what it begins with, or the integral of that as a rate."""
    path = tmp_path / "rotor.vsdf"
    path.write_text(ROTOR.format(key=key))
    values = solve(path)
    t = values["time"]
    angle = 0.1 + 0.4 * np.sin(3 * t) if key == "value" else 0.1 * t + 0.4 / 3 * (1 - np.cos(3 * t))
    e0, e3 = values["body/euler_parameters"][:, 0, [0, 3]].T
    assert 2 * np.arctan2(e3, e0) == pytest.approx(angle, abs=1e-9)
    inertia = 0.3 + 2.0 * 0.3**2  # about the axis, by Steiner
    alpha = -3.6 * np.sin(3 * t) if key == "value" else 1.2 * np.cos(3 * t)
    assert values["driver/effort"][:, 0] == pytest.approx(inertia * alpha, abs=1e-8)
