"""Euler parameters, angular velocities and rotation vectors against rotations of SciPy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flexmb_cli.kernels.constrained.speeds import (
    add_turning,
    coordinate_accelerations,
    coordinate_rates,
    move,
    speed_jacobian,
    speeds_of_rates,
)
from flexmb_cli.kernels.integrators.generalised_alpha_step import turn_exactly
from flexmb_cli.kernels.integrators.rotation_increments import largest_turn, set_slope, shift_between

BODIES, MODES = 2, 3
H = 1e-3  # s, of differences of fourth order
FIRST = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
SECOND = {-2: -1 / 12, -1: 4 / 3, 0: -5 / 2, 1: 4 / 3, 2: -1 / 12}


def parameters(rotation, near=None):
    """e0 e1 e2 e3, of the sign that is nearer."""
    p = rotation.as_quat()[[3, 0, 1, 2]]
    return -p if near is not None and p @ near < 0.0 else p


class Path:
    """Bodies in screw motions of steady speeds, modes at steady rates: v global, ω in body axes."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        self.u = random.uniform(-1, 1, 6 * BODIES + MODES)
        self.places = random.uniform(-1, 1, (BODIES, 3))
        self.attitudes = [Rotation.random(random_state=seed + k) for k in range(BODIES)]
        self.modes = random.uniform(-1, 1, MODES)

    def q(self, t, steady=None):
        u = self.u if steady is None else steady
        out = []
        for k in range(BODIES):
            v, w = u[6 * k : 6 * k + 3], u[6 * k + 3 : 6 * k + 6]
            turned = self.attitudes[k] * Rotation.from_rotvec(t * w)
            out += [self.places[k] + t * v, parameters(turned, parameters(self.attitudes[k]))]
        return np.concatenate([*out, self.modes + t * u[6 * BODIES :]])

    def difference(self, weights, power):
        return sum(w * self.q(k * H) for k, w in weights.items()) / H**power


@pytest.fixture(params=range(3))
def path(request):
    return Path(request.param)


def test_coordinates_and_speeds_have_each_others_rates(path):
    qd, u, qdd = np.empty(path.q(0.0).size), np.empty(path.u.size), np.empty(path.q(0.0).size)
    coordinate_rates(BODIES, path.q(0.0), path.u, qd)
    np.testing.assert_allclose(qd, path.difference(FIRST, 1), atol=1e-11)
    coordinate_accelerations(BODIES, path.q(0.0), path.u, np.zeros(path.u.size), qdd)
    np.testing.assert_allclose(qdd, path.difference(SECOND, 2), atol=1e-8)
    # Parameters that are not of length 1 are scaled first.
    scaled = path.q(0.0)
    for k in range(BODIES):
        scaled[7 * k + 3 : 7 * k + 7] *= 1.5
    speeds_of_rates(BODIES, scaled, qd, u)
    np.testing.assert_allclose(u, path.u, rtol=1e-14)
    np.testing.assert_allclose(scaled, path.q(0.0), atol=1e-15)


def test_rows_and_right_sides_on_speeds_follow_those_on_coordinates(path):
    """A row g of coordinates changes by g q' on the path, and g q'' is what no acceleration makes."""
    random = np.random.default_rng(7)
    rows, bodies = random.uniform(-1, 1, (4, 14)), np.array([[0, 1], [1, 0], [0, 1], [1, 0]])
    jacobian, gamma, q = np.zeros((4, path.u.size)), np.zeros(4), path.q(0.0)
    speed_jacobian(bodies, q, rows, np.ones_like(jacobian), jacobian)
    add_turning(bodies, q, path.u, rows, gamma)
    qd, qdd = path.difference(FIRST, 1), path.difference(SECOND, 2)
    for row, (a, b), found, turning in zip(rows, bodies, jacobian @ path.u, gamma, strict=True):
        places = [*range(7 * a, 7 * a + 7), *range(7 * b, 7 * b + 7)]
        assert found == pytest.approx(row @ qd[places], abs=1e-10)
        assert turning == pytest.approx(-row @ qdd[places], abs=1e-8)


def test_finite_turns_are_those_of_rotation_vectors(path):
    q = path.q(0.0)
    turn_exactly(BODIES, q, 2.5 * path.u)
    np.testing.assert_allclose(np.abs(q), np.abs(path.q(2.5)), atol=1e-14)
    for k in range(BODIES):
        p, exact = q[7 * k + 3 : 7 * k + 7], path.q(2.5)[7 * k + 3 : 7 * k + 7]
        assert abs(p @ exact) == pytest.approx(1.0, abs=1e-14)


def test_small_turns_are_right_to_first_order(path):
    """What is left falls with the square of the step."""
    gaps = []
    for size in (1e-3, 1e-4):
        q = path.q(0.0)
        move(BODIES, q, size * path.u)
        gaps.append(np.abs(q - path.q(size)).max())
    assert gaps[0] < 1e-6
    assert gaps[1] < 0.02 * gaps[0]


def turns_of(path):
    return path.u.reshape(-1)[: 6 * BODIES].reshape(BODIES, 6)[:, 3:]


@pytest.mark.parametrize("size", [1e-3, 0.3, 2.5])
def test_a_rotation_vector_changes_as_the_rotation_does(path, size):
    """The rate of log(exp(θ) exp(t ω)) at t = 0, by differences."""
    random = np.random.default_rng(11)
    shift, slope = random.uniform(-1, 1, path.u.size), np.empty(path.u.size)
    for k in range(BODIES):
        vector = shift[6 * k + 3 : 6 * k + 6]
        vector *= size / np.linalg.norm(vector)
    set_slope(BODIES, shift, path.u, slope)
    expected = path.u.copy()
    for k, w in enumerate(turns_of(path)):
        start = Rotation.from_rotvec(shift[6 * k + 3 : 6 * k + 6])
        moved = {j: (start * Rotation.from_rotvec(j * H * w)).as_rotvec() for j in FIRST}
        expected[6 * k + 3 : 6 * k + 6] = sum(FIRST[j] * moved[j] for j in FIRST) / H
    np.testing.assert_allclose(slope, expected, atol=1e-9)


def test_the_series_for_small_turns_goes_over_into_the_closed_form():
    """At 0.0099 rad, by 80-bit numbers where there are such: θ̇ = ω + share θ × (θ × ω) for ω across θ."""
    angle = np.longdouble(0.0099)
    share = 1 / angle**2 - np.longdouble(0.5) / (angle * np.tan(angle / 2))
    shift, u, slope = np.zeros(6), np.zeros(6), np.empty(6)
    shift[3], u[4] = angle, 1.0
    set_slope(1, shift, u, slope)
    assert 1.0 - slope[4] == pytest.approx(float(share * angle**2), abs=2e-15)
    assert slope[5] == pytest.approx(0.5 * 0.0099, rel=1e-14)


@pytest.mark.parametrize("laps", [0, 1, -2])
def test_the_shift_between_two_positions_counts_the_turns_of_its_mean(path, laps):
    """exp(θ) leads from one attitude to the other; the mean tells how many laps belong to it."""
    old, new, shift = path.q(0.0), path.q(1.2), np.empty(path.u.size)
    expected = 1.2 * path.u
    for k, w in enumerate(turns_of(path)):
        expected[6 * k + 3 : 6 * k + 6] += 2.0 * math.pi * laps * w / np.linalg.norm(w)
    shift_between(BODIES, old, new, expected + 0.1, shift)
    np.testing.assert_allclose(shift, expected, atol=1e-12)


def test_whole_turns_keep_the_axis_of_their_mean(path):
    old, shift, mean = path.q(0.0), np.empty(path.u.size), 0.0 * path.u
    mean[3:6] = 2.0 * math.pi * np.array([0.48, 0.36, 0.8])
    shift_between(BODIES, old, old, mean, shift)
    np.testing.assert_allclose(shift, mean, atol=1e-12)
    assert largest_turn(BODIES, shift) == pytest.approx(2.0 * math.pi)
