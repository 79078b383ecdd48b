"""Radau's method of order 5: its table, agreement with DOP853 and GALF, stiff modes at long steps."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.constrained.report import NOW, TRIED, coordinates_and_speeds
from flexmb_cli.kernels.constrained.speeds import coordinate_accelerations, coordinate_rates, speeds_of_rates
from flexmb_cli.kernels.constrained.system import SOLVED
from flexmb_cli.kernels.integrators import radau5
from flexmb_cli.kernels.integrators.radau5 import _attempt, _bend, _spread_power
from flexmb_cli.kernels.integrators.radau5_step import COMPLEX, REAL, START, TIMES, WEIGHTS, place_stages
from flexmb_cli.kernels.laws import ANSWER_COLUMNS, DAMPING, STIFFNESS
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.constrained.young_dynamics import ForwardDynamics
from tests.dialects.vsdf.mechanisms import analysis_of, sample
from tests.dialects.vsdf.test_runs import Run, momenta
from tests.dialects.vsdf.vsdf_decks import build, supplied
from tests.kernels.integrators.test_generalised_alpha import GRID
from tests.solvers.constrained.element_decks import ROTOR, model_of
from tests.solvers.constrained.element_decks import analysis_of as young_analysis_of

METHOD = " GALF       0.9"
LAST_STEP, STEP = 0.2, 0.3  # s


def run(name, method, *changes, end=0.1, rows=0.01):
    return Run(supplied(name, (GRID, f"{end:10g}{rows:10g}{0:10g}"), (METHOD, method), *changes))


def test_the_table_meets_the_conditions_of_order_five():
    """Simplifying assumptions B(5) and C(3), which make collocation at three Radau points of order 5
    (Hairer and Wanner II, section IV.5); the eigenvalues are those that LAPACK finds."""
    for k in range(5):
        assert WEIGHTS[2] @ TIMES**k == pytest.approx(1 / (k + 1), rel=1e-14)
    for k in range(3):
        np.testing.assert_allclose(WEIGHTS @ TIMES**k, TIMES ** (k + 1) / (k + 1), rtol=1e-13)
    found = sorted(np.linalg.eigvals(WEIGHTS), key=lambda value: value.imag)
    np.testing.assert_allclose(found, [np.conj(COMPLEX), REAL, COMPLEX], rtol=1e-13)


def test_coordinate_accelerations_are_the_rates_of_coordinate_rates():
    """Against central differences along q(t), u(t) of second order."""
    random = np.random.default_rng(5)
    q, u, ud = random.normal(size=9), random.normal(size=8), random.normal(size=8)
    q[3:7] /= np.linalg.norm(q[3:7])
    qd, qdd = np.zeros(9), np.zeros(9)
    coordinate_rates(1, q, u, qd)
    coordinate_accelerations(1, q, u, ud, qdd)
    ends, h = [], 1e-5
    for step in (-h, h):
        end = np.zeros(9)
        coordinate_rates(1, q + step * qd, u + step * ud, end)
        ends.append(end)
    np.testing.assert_allclose((ends[1] - ends[0]) / (2 * h), qdd, atol=1e-8)
    back = np.zeros(8)
    speeds_of_rates(1, q, qd, back)
    np.testing.assert_allclose(back, u, atol=1e-14)


@pytest.fixture
def integration(tmp_path):
    """An integration over a singular position: the last step took 0.2 s, the next one takes 0.3 s."""
    found = radau5.new_integration(analysis_of(sample(tmp_path)).work, 0, 1)
    found.clock["step_length"] = LAST_STEP
    return found


def test_accelerations_found_at_the_end_of_a_singular_step_bend_those_of_its_stages(integration):
    """The cubic through the last step, expected, becomes the quartic that also goes through the end:
    accelerations along a quartic are met."""
    coefficients = np.random.default_rng(4).uniform(-1, 1, (integration.rates.shape[1], 5))
    at = lambda t: np.array([Polynomial(c)(t) for c in coefficients])  # noqa: E731
    nodes = LAST_STEP * np.array([0.0, *TIMES])
    cubic = np.polyfit(nodes, np.array([at(t) for t in nodes]), 3)
    new = LAST_STEP + STEP * TIMES
    integration.rates[START + 1 : START + 4] = [np.polyval(cubic, t) for t in new]
    expected = integration.rates[START + 3].copy()
    integration.rates[START + 3] = at(new[2])
    _bend(integration, expected, STEP)
    np.testing.assert_allclose(integration.rates[START + 1 : START + 4], [at(t) for t in new], atol=1e-11)


def test_a_rejected_step_leaves_the_slopes_of_the_state_to_stops_and_cables():
    """Both are slack in the state; the trial that failed met them."""
    cards = (
        "MASS 2 1 0 0 0 1 1 1\n"
        "ELEMENTS\n"
        "  STOP tstop-1 at=1.angle lower=-1 upper=0.1 stiffness=900 damping=0.2\n"
        "  CABLE cable-1 from=0(2,0,0) to=2(1,0,0) stiffness=80 rest=1.5\n"
        "RAD5\n"
    )
    analysis = ForwardDynamics(model_of(ROTOR, "0 1 0.1", cards))
    analysis.start()
    matrices = analysis.integration.matrices.copy()
    analysis.work.responses[:, [STIFFNESS, DAMPING]] = 70.0
    with interpreting():
        assert radau5._renew(analysis.system, analysis.work, analysis.integration) == SOLVED
    np.testing.assert_allclose(analysis.integration.matrices, matrices, atol=1e-14)


def test_the_power_of_a_singular_step_changes_evenly(integration):
    work = integration.newton._replace(responses=np.full((1, ANSWER_COLUMNS), -4.0))
    integration.memory["power"], integration.load_powers[NOW] = 2.0, -1.0
    assert _spread_power(integration, work, 5.0) == 3.0
    np.testing.assert_allclose(integration.powers, 2.0 + 3.0 * TIMES, rtol=1e-15)
    np.testing.assert_allclose(integration.load_powers[TRIED:, 0], -1.0 - 3.0 * TIMES, rtol=1e-15)


def test_work_of_a_constant_torque_grows_with_the_square_of_time_at_and_between_the_ends_of_steps():
    """I ω' = M: the work is M² t²/2 I.  Rows lie inside the steps, whose lengths the method chooses."""
    torque, inertia = 3.0, 0.5
    cards = f"MASS 2 1 0 0 0 1 1 {inertia}\nTORQUE 2 0 0 {torque}\nRAD5\n"
    with interpreting():
        blocks = list(young_analysis_of(model_of(ROTOR, "0 0.2 0.01", cards)).rows())
    time, work = (np.concatenate([getattr(b, name) for b in blocks]) for name in ("time", "applied_work"))
    np.testing.assert_allclose(work, torque**2 * time**2 / (2 * inertia), atol=1e-8)


def test_a_change_of_all_speeds_by_their_tolerances_and_of_no_shift_has_the_size_of_one_half_as_a_square():
    with interpreting():
        analysis = young_analysis_of(model_of(ROTOR, "0 1 1", "MASS 2 1 0 0 0 1 1 1\nRAD5"))
        analysis.start()
        integration, n = analysis.integration, analysis.system.speed_scale.shape[0]
        for _ in range(2):
            place_stages(analysis.system, integration, 1e-3)
        assert place_stages(analysis.system, integration, 1e-3) < 1e-6
        clock, u = integration.clock[0], coordinates_and_speeds(analysis.system, integration.z)[1]
        units = integration.units[clock["counted"] - n : clock["counted"]]
        integration.speeds[:] += clock["atol"] * units + clock["rtol"] * np.abs(u)
        assert place_stages(analysis.system, integration, 1e-3) == pytest.approx(0.5**0.5, rel=1e-6)


@pytest.mark.long_motion
def test_the_pendulum_comes_to_the_explicit_solution():
    """Rows lie inside the steps; DOP853 with 1e-10 is the other method."""
    exact = run("pendulum", " RK45   1.0E-10")
    gaps = []
    for tolerance in ("1.0E-4", "1.0E-6"):
        found = run("pendulum", f" RAD5    {tolerance}")
        gaps.append(np.abs(found.point_position - exact.point_position).max())
        assert found.constraint_residual.max() < 1e-14
        assert found.velocity_residual.max() < 1e-13
    assert gaps[0] < 1e-5
    assert gaps[1] < 1e-7


@pytest.mark.long_motion
def test_the_free_rod_keeps_momentum_and_energy():
    found = run("freeflying", " RAD5    1.0E-8", end=0.02, rows=0.002)
    P, H = momenta(found)
    for values in (P, H, found.total):
        assert np.abs(values - values[0]).max() < 1e-9


@pytest.mark.long_motion
def test_stiff_modes_do_not_shorten_the_steps():
    """Slider-crank with a flexible rod, whose modes reach 1.1 kHz: within 1e-8 m of DOP853 with a sixth of
    its evaluations."""
    grid = ("       0.5     0.005", "      0.25      0.05")
    places, evaluations = [], []
    for method in (" RK45    1.0E-9", " RAD5    1.0E-7"):
        text = supplied("slider_crank_flex", grid, (" RK45   1.0E-12", method))
        analysis = FlexibleDynamics(flexible_mechanism(build(text), cached=False)[0])
        places.append(np.concatenate([rows.point_position for rows in analysis.rows()]))
        evaluations.append(int(analysis.clock["evaluations"][0]))
    assert np.abs(places[1] - places[0]).max() < 1e-8
    assert 6 * evaluations[1] < evaluations[0]


def test_a_step_that_ends_where_a_pivot_has_vanished_is_tried_again_with_half_its_length():
    """A pivot below the threshold after a good step, with none at its start: nothing of it is accepted."""
    with interpreting():
        analysis = young_analysis_of(model_of(ROTOR, "0 1 1", "MASS 2 1 0 0 0 1 1 1\nRAD5"))
        analysis.start()
        integration, system, work = analysis.integration, analysis.system, analysis.work
        assert _attempt(integration, 1e-3, system, work) > 0.0
        integration.memory["branching"] = 2.0 * np.abs(work.diagonal[: work.rank[0]]).max()
        assert _attempt(integration, 1e-3, system, work) == -0.5
