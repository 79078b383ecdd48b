"""Decks for the cards that flexmb adds, against closed forms and equations written for the test.

Coordinates and speeds of a whole run are held to 1e-7 of the largest value of each.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

from tests.run.dafms_runs import loaded, run


def test_the_driven_arm_of_a_block_needs_the_torques_of_lagrange(tmp_path):
    """Planar arm of two links (Craig, Introduction to Robotics, section 6.7), inertias about its hinges."""
    assert run("arm_elements", tmp_path, no_out=True).exit_code == 0
    values, w = loaded(tmp_path, "arm_elements"), 3.0
    t = values["time"]
    p, v, a = (np.array([0.6 * np.sin(w * t), 0.6 - 0.6 * np.cos(w * t)]),
               0.6 * w * np.array([np.cos(w * t), np.sin(w * t)]),
               0.6 * w**2 * np.array([-np.sin(w * t), np.cos(w * t)]))  # fmt: skip
    J_1, J_2, g = 0.44 + 0.8 * 1.0**2, 0.172, 9.81
    mass_arm, weight = 0.8 * 1.0 * 0.3, 0.8 * 0.3 * g * np.cos(p[0] + p[1])
    forearm = J_2 * (a[0] + a[1]) + mass_arm * (np.cos(p[1]) * a[0] + np.sin(p[1]) * v[0] ** 2) + weight
    turned = np.cos(p[1]) * (2 * a[0] + a[1]) - np.sin(p[1]) * (2 * v[0] + v[1]) * v[1]
    arm = J_1 * a[0] + J_2 * (a[0] + a[1]) + mass_arm * turned + weight
    arm += (1.5 * 0.4 + 0.8 * 1.0) * g * np.cos(p[0])
    assert_same(values["coordinate/q"], p.T)
    assert_same(values["driver/effort"], np.column_stack([arm, forearm + 3 * (p[1] - 1) + 0.05 * v[1]]))


@pytest.fixture
def moved(tmp_path):
    """Times, coordinates and speeds of a deck's result."""

    def load(name):
        assert run(name, tmp_path, no_out=True).exit_code == 0
        values = loaded(tmp_path, name)
        return values["time"], values["coordinate/q"], values["coordinate/u"]

    return load


def assert_same(found, expected):
    """Columns agree to 1e-7 of their largest value."""
    assert np.all(np.max(np.abs(found - expected), axis=0) <= 1e-7 * np.max(np.abs(expected), axis=0))


# --- spinning_beams: PRES, GSTF, ELDA


def swinging(t, start, squared, decay):
    """u'' + 2 decay u' + squared u = 0 from rest at `start`."""
    w = np.sqrt(squared - decay**2)
    u = start * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    return u, -start * np.exp(-decay * t) * squared / w * np.sin(w * t)


def test_the_pull_of_its_tip_stiffens_one_beam_and_nothing_the_other(moved):
    """A massless beam with a mass m at its tip, x = 1.1 m from the axis: k = 3 EI/L³ = 30 N/m.

    Its deflection w = u (3 s² - s³)/2 shortens it by 6/5 u²/2L, so that the pull m x spin² adds
    6 m x spin²/5L to k when card GSTF is given.  Deflections along the axis of the spin feel nothing else.
    """
    time, q, u = moved("spinning_beams")
    k, m, x, spin, start = 30.0, 0.4, 1.1, 5.0, 0.02
    decay = (0.2 + 0.001 * k / m) / 2
    stiffened = swinging(time, start, k / m + 1.2 * x * spin**2, decay)
    plain = swinging(time, start, k / m, decay)
    assert_same(q, np.column_stack([spin * time, stiffened[0], plain[0]]))
    assert_same(u, np.column_stack([spin + 0 * time, stiffened[1], plain[1]]))


# --- motor_gear: TABM, TABL, MOTR, SPRI, DAMP


def torques(t):
    """Motor against the frame, load on the rotor: piece and slope at a time between the tables' points."""
    pieces = (0.0, 7.5), (1.5, 0.0), (-1.0, 0.0), (0.0, 0.0)
    motor = pieces[int(np.searchsorted((0.2, 0.5, 1.0), t))]
    loads = (0.0, -1.25), (-1.0, 1.25), (0.0, 0.0)
    return motor, loads[int(np.searchsorted((0.4, 0.8), t))]


def gear_motion(times, state):
    """Motor and rotor as one linear system; exact from one change of the torques to the next."""
    J = np.array([[0.02 + 0.3, 0.3], [0.3, 0.3]])  # the rotor's angle counts from the motor's
    inverse = np.linalg.inv(J)
    stiffness, damping = np.diag([0.0, 50.0]), np.diag([0.05, 0.2])
    rows = [state]
    marks = np.union1d(times, [0.2, 0.4, 0.5, 0.8, 1.0])
    for t, after in pairwise(marks):
        (motor, motor_rate), (load, load_rate) = torques((t + after) / 2)
        # A law is its value at 0 and its slope; the load acts on both angles, the motor on the first.
        constant = np.array([motor + load, load + 50.0 * 0.1 + 0.3])
        rate = np.array([motor_rate + load_rate, load_rate])
        A = np.zeros((6, 6))
        A[:2, 2:4] = np.eye(2)
        A[2:4, :2], A[2:4, 2:4] = -inverse @ stiffness, -inverse @ damping
        A[2:4, 4], A[2:4, 5] = inverse @ (constant + rate * t), inverse @ rate
        A[5, 4] = 1.0
        whole = expm(A * (after - t)) @ np.concatenate([state, [1.0, 0.0]])
        state = whole[:4]
        if np.any(times == after):
            rows.append(state)
    return np.array(rows)


def test_a_motor_drives_a_rotor_through_a_spring_and_a_damper(moved):
    time, q, u = moved("motor_gear")
    expected = gear_motion(time, np.array([0.2, -0.1, 0.0, 0.0]))
    assert_same(np.hstack([q, u]), expected)


# --- arm_nrot: NROT, PRES; stiff_arm: METH 4, MOTR, ELDA


class Arm:
    """A massless beam with masses m at stations x, turned by theta about axis 1, and a forearm at its tip.

    Points of the plane are complex numbers: z_j = (x_j + i w_j) exp(i theta); the forearm's centre is
    z_n + rho exp(i (theta + slope + beta)).  Between the stations the beam is the clamped cubic spline.
    """

    def __init__(self, x, masses, EI, root, forearm=(0.0, 0.0, 0.0)):
        self.x, self.masses, self.root = np.array(x), np.array(masses), root
        self.mass, self.rho, self.inertia = forearm  # the inertia is about its centre
        n = len(x)
        stations = np.concatenate([[0.0], x])
        spline = CubicSpline(stations, np.vstack([np.zeros(n), np.eye(n)]), bc_type=((1, 0 * x), (2, 0 * x)))
        self.slope = spline(x[-1], 1)
        bend, h = spline(stations, 2), np.diff(stations)[:, None, None]
        a, b = bend[:-1, :, None], bend[1:, :, None]
        a_, b_ = bend[:-1, None, :], bend[1:, None, :]
        self.K = EI * np.sum(h / 6 * (2 * a * a_ + 2 * b * b_ + a * b_ + b * a_), axis=0)

    def equations(self, q, y, weight):
        """M and the forces without those of springs, gravity `weight` along axis 2; q: theta, w, beta."""
        n = len(self.x)
        turn, arms = np.exp(1j * q[0]), self.x + 1j * q[1 : n + 1]
        J = np.zeros((n + 1, n + 2), complex)
        J[:n, 0], J[:n, 1 : n + 1] = 1j * arms * turn, 1j * turn * np.eye(n)
        rest = np.zeros(n + 1, complex)
        rest[:n] = (-arms * y[0] ** 2 - 2 * y[0] * y[1 : n + 1]) * turn
        angles = np.concatenate([[1.0], self.slope, [1.0]])
        out = self.rho * np.exp(1j * (angles @ q))
        J[n] = J[n - 1] + 1j * out * angles
        rest[n] = rest[n - 1] - out * (angles @ y) ** 2
        m = np.append(self.masses, self.mass)
        M = (J.conj().T * m @ J).real + self.inertia * np.outer(angles, angles)
        M[0, 0] += self.root
        return M, (J.conj().T @ (m * (weight - rest))).real


def marched(rate, times, state, method, tolerance):
    solved = solve_ivp(rate, (0, times[-1]), state, method, times, rtol=tolerance, atol=tolerance)
    return solved.y.T


@pytest.mark.long_motion
def test_a_forearm_sprung_against_the_slope_of_a_flexible_arm(moved):
    time, q, u = moved("arm_nrot")
    x, masses = np.array([0.4, 0.8]), [0.2, 0.4]
    arm = Arm(x, masses, 60.0, 0.28933 - np.dot(masses, x**2), (1.2, 0.25, 0.09 - 1.2 * 0.25**2))

    def rate(t, state):
        driven = np.array([0.4 + 0.5 * t - 0.75 * t**2, *state[:3]]), np.array([0.5 - 1.5 * t, *state[3:]])
        M, Q = arm.equations(*driven, 9.8)
        Q[1:3] -= arm.K @ state[:2]
        Q[3] -= 8.0 * (state[2] - 0.25) + 0.06 * state[5]
        return np.concatenate([state[3:], np.linalg.solve(M[1:, 1:], Q[1:] + 1.5 * M[1:, 0])])

    expected = marched(rate, time, [0.01, 0.03, -0.6, 0, 0, 0], "DOP853", 1e-11)
    # Coordinates of a deck: both rotations, then the nodes.
    root = 0.4 + 0.5 * time - 0.75 * time**2, 0.5 - 1.5 * time
    assert_same(q, np.column_stack([root[0], expected[:, [2, 0, 1]]]))
    assert_same(u, np.column_stack([root[1], expected[:, [5, 3, 4]]]))


@pytest.mark.long_motion
def test_the_implicit_method_follows_a_stiff_damped_beam(moved):
    time, q, u = moved("stiff_arm")
    x, masses = np.array([0.25, 0.5, 0.75, 1.0]), [0.2, 0.2, 0.2, 0.1]
    arm = Arm(x, masses, 2000.0, 0.2755208 - np.dot(masses, x**2))

    def rate(_t, state):
        M, Q = (
            part[..., :5] for part in arm.equations(np.append(state[:5], 0), np.append(state[5:], 0), 9.8)
        )
        Q[0] += 6.0
        Q[1:] -= arm.K @ (state[1:5] + 2e-4 * state[6:])
        return np.concatenate([state[5:], np.linalg.solve(M[:5, :5], Q)])

    expected = marched(rate, time, [0.3, *[0.0] * 9], "Radau", 1e-10)
    assert_same(q, expected[:, :5])
    assert_same(u, expected[:, 5:])
