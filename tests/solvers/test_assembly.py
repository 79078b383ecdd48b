"""What counts as closed, and how far bodies move: closed forms of translations and turns."""

import numpy as np
import pytest

from flexmb_cli.solvers.assembly import displacements
from tests.solvers.kinematics.geometry import euler_parameters, product, unit


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 3.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_displacements_are_the_distance_and_the_angle_of_the_turn_between_two_positions(angle, sign):
    """Turned by `angle` about any axis from any attitude; p and -p are the same attitude."""
    random = np.random.default_rng(5)
    before, after = np.zeros(14), np.zeros(14)
    before[3] = after[3] = 1.0
    p, axis = unit(random.standard_normal(4)), unit(random.standard_normal(3))
    before[7:] = [1.0, 2.0, 3.0, *p]
    after[7:] = [1.0, 5.0, 7.0, *(sign * product(p, euler_parameters(axis, angle)))]
    way, turn = displacements(before, after, 2)
    assert way.tolist() == [0.0, 5.0]
    assert turn[0] == 0.0
    assert turn[1] == pytest.approx(angle, rel=1e-12, abs=1e-15)
