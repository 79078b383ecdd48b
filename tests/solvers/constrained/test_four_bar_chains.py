"""Chains of N four-bars through singular positions: the N-four-bar benchmark of the IFToMM library.

González, Kövecses and others, Multibody System Dynamics 36 (2016).  All cranks turn alike: a pendulum with
(J₀ + ...) θ̈ = -g (...) cos θ of one degree of freedom, which DOP853 of SciPy integrates.  An earlier version
stopped at 1e-10 for N = 2 (t = 6.54 s) and N = 5 (t = 3.19 s), and by RAD5 at 1e-9 for N = 1 (t = 0.71 s).
"""

import math
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts/bench"))
from four_bars import deck_of, energy_error, run

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.dialects.young.dynamic_cards import read_young_deck
from flexmb_cli.kernels.constrained.accelerations import accelerations, choose_order, evaluate_jacobian
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics

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
    times = np.concatenate([block.time for block in blocks])
    speed = np.concatenate([block.angular_velocity[:, 1, 2] for block in blocks])
    assert speed == pytest.approx(cranks(count, times)[1], abs=1e5 * tolerance)


@pytest.mark.parametrize(("count", "tolerance"), [(1, 1e-6), (1, 1e-9), (1, 1e-11), (2, 1e-10)])
def test_radaus_method_passes_at_every_tolerance(count, tolerance):
    held(count, "RAD5", tolerance)


def turned(count, angle):
    """Coordinates of the chain's bodies with all cranks at an angle from the ground."""
    q = np.zeros((2 * count + 2, 7))
    q[0, 3] = 1.0
    for k in range(count + 1):
        q[2 * k + 1] = [k, 0.0, 0.0, math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle)]
        if k < count:
            q[2 * k + 2] = [k + math.cos(angle), math.sin(angle), 0.0, 1.0, 0.0, 0.0, 0.0]
    return q.ravel()


def time_of_accelerations(count, tmp_path):
    """The least time, s, of many evaluations of the accelerations of a chain."""
    path = tmp_path / f"IN{count}.dat"
    path.write_text(deck_of(count, "DOP853", 1e-6))
    analysis = ForwardDynamics(build_young_dynamics(read_young_deck(read_text(str(path))))[0])
    system, work, q = analysis.system, analysis.work, turned(count, 1.3)
    evaluate_jacobian(system, work, q)
    choose_order(work, len(analysis.arrays.equations))
    u, found = np.zeros((2, work.motions.shape[0])), []
    for _ in range(30):
        begin = time.perf_counter()
        accelerations(system, work, q, u[0], 0.0, u[1])
        found.append(time.perf_counter() - begin)
    return min(found)


def test_an_evaluation_costs_as_many_times_more_as_there_are_more_bars(tmp_path):
    """Dense elimination took 10 times longer for 20 four-bars than for 5; it is to be about 4, or less."""
    assert time_of_accelerations(20, tmp_path) < 6.0 * time_of_accelerations(5, tmp_path)


@pytest.mark.parametrize("tolerance", [1e-5, 1e-6])
def test_generalised_alpha_passes_with_steps_of_its_choice(tolerance):
    held(1, "GALF", tolerance)


def inline(count):
    """Time of the first passage of all bars through a line."""

    def level(_, y):
        return y[0]

    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count
    found = solve_ivp(
        lambda _, y: [y[1], -G * arm * math.cos(y[0]) / inertia],
        (0.0, 2.0), (0.5 * math.pi, -1.0), "DOP853", events=level, rtol=1e-13, atol=1e-13,
    )  # fmt: skip
    return found.t_events[0][0]


@pytest.mark.parametrize(
    ("count", "method", "tolerance", "beside", "within"),
    [
        (1, "DOP853", 1e-9, 0.0, 1e-6),
        (1, "DOP853", 1e-9, 3e-6, 1e-6),
        (1, "DOP853", 1e-9, 1e-4, 1e-6),
        (2, "RAD5", 1e-8, 0.0, 1e-4),
        (1, "RAD5", 1e-10, -3e-6, 1e-4),
        (1, "GALF", 1e-4, 2e-6, 0.02),
        (6, "DOP853", 1e-9, 1e-6, 1e-5),
        (10, "DOP853", 1e-7, 1e-6, 1e-3),
        (10, "RAD5", 1e-7, 2e-6, 1e-3),
        (40, "DOP853", 1e-7, 3e-6, 1e-3),
    ],
)
def test_a_row_in_line_has_the_accelerations_of_the_motion(count, method, tolerance, beside, within):
    """The twentieth row stands `beside` seconds after the line: J θ̈ = -g m cos θ, reactions as of no row.

    An earlier version had accelerations 10 times as large and reactions of 5e7 N in such rows, without a
    word, and stopped at them by RAD5.
    """
    interval = (inline(count) + beside) / 20.0
    _, blocks, stopped = run(deck_of(count, method, tolerance, 22.5 * interval, interval))
    assert not stopped
    times = np.concatenate([block.time for block in blocks])
    speed = np.concatenate([block.angular_velocity[:, 1, 2] for block in blocks])
    found = np.concatenate([block.angular_acceleration[:, 1, 2] for block in blocks])
    force = np.concatenate([block.reaction_force for block in blocks])
    angle, rate = cranks(count, times)
    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count
    assert found == pytest.approx(-G * arm * np.cos(angle) / inertia, abs=within)
    assert speed == pytest.approx(rate, abs=within)
    assert np.flatnonzero(np.isnan(force).any(axis=(1, 2))).tolist() == [20]


def row_in_line(deck, count):
    """Accelerations of the bodies in row 20, the first crank's last speed, and both by the closed form."""
    _, blocks, stopped = run(deck)
    assert not stopped
    times = np.concatenate([block.time for block in blocks])
    found = np.concatenate([block.angular_acceleration for block in blocks])[20, :, 2]
    speed = np.concatenate([block.angular_velocity for block in blocks])[-1, 1, 2]
    angle, rate = cranks(count, times)
    inertia, arm = (count + 1) / 3.0 + count, (count + 1) / 2.0 + count
    return found, speed, -G * arm * math.cos(angle[20]) / inertia, rate[-1]


def test_no_step_of_given_length_ends_where_round_off_rules():
    """Step 1000 would end in line: its acceleration was 2000 1/s² off, and all speeds after it 0.08 1/s."""
    interval = inline(1) / 20.0
    deck = deck_of(1, "GALF", 1e-9, 22.5 * interval, interval)
    found, speed, acceleration, rate = row_in_line(deck.replace("GALF 0 ", f"GALF {interval / 50.0} "), 1)
    assert found[1] == pytest.approx(acceleration, abs=1e-3)
    assert speed == pytest.approx(rate, abs=2e-5)


def test_the_ground_is_at_rest_in_a_last_row_in_line():
    """No step leads over the end of a run, so that nothing tells the others' accelerations."""
    interval = inline(1) / 20.0
    found = row_in_line(deck_of(1, "DOP853", 1e-9, 20.0 * interval, interval), 1)[0]
    assert np.isnan(found).tolist() == [False, True, True, True]
    assert found[0] == 0.0


def test_accelerations_at_the_edge_of_where_round_off_rules_are_as_good_as_others():
    """Round-off grows with the inverse cube of the time from the line; 9e-7 of ω² passed unnoticed."""
    for beside in (7e-5, 8.7e-5, 1.1e-4, 1.4e-4, 1.8e-4):
        interval = (inline(1) + beside) / 20.0
        found, _, acceleration, rate = row_in_line(deck_of(1, "RAD5", 1e-8, 22.5 * interval, interval), 1)
        assert found[1:] == pytest.approx([acceleration, 0.0, acceleration], abs=3e-7 * rate**2)
