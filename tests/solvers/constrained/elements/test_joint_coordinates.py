"""Joint coordinates of decks without elements: results hold them, with all turns, in every analysis."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from flexmb_cli.solvers.kinematics.analysis import KinematicAnalysis
from flexmb_cli.solvers.kinematics.inverse_dynamics import InverseDynamics
from tests.dialects.vsdf.test_elements import METHODS as VSDF
from tests.dialects.vsdf.test_elements import TURNING
from tests.dialects.vsdf.vsdf_decks import read
from tests.solvers.constrained.element_decks import METHODS, ROTOR, analysis_of, model_of

MASS = "MASS 2 2 0 0 0 1 1 0.5\n"
BY_METHODS = ["DOP853", *(pytest.param(word, marks=pytest.mark.long_motion) for word in ("RAD5", "GALF"))]


def coordinates(blocks):
    """Times, joint coordinates and rates of blocks of rows."""
    names = "time", "joint_coordinate", "joint_rate"
    return (
        np.concatenate(parts) for parts in zip(*([getattr(b, n) for n in names] for b in blocks), strict=True)
    )


def forward(cards, times, mechanism=ROTOR):
    model = model_of(mechanism, times, cards)
    assert not model.elements
    return coordinates(analysis_of(model).rows())


@pytest.mark.parametrize("method", BY_METHODS)
def test_a_free_rotor_turns_many_times_between_rows(method):
    """Angle ω t, ω = 7 rad/s: 3.3 turns from row to row."""
    t, angle, rate = forward(f"{MASS}VELOCITY 2 0 0 0 0 0 7\n{METHODS[method]}", "0 12 3")
    assert angle[:, 0] == pytest.approx(7 * t, abs=1e-6) and t[-1] == 12
    assert rate[:, 0] == pytest.approx(np.full(5, 7.0), abs=1e-9)


def test_a_pendulum_that_goes_to_and_fro_between_rows_keeps_its_turns():
    """Rates at rows say nothing: θ'' = -(m g c / I) sin θ, by Dormand and Prince's method of scipy."""
    cards = "MASS 2 2 0.5 0 0 1 1 0.7\nGRAVITY 9.81 0 0\nVELOCITY 2 0 0 0 0 0 5\nTOLERANCE 1e-12\n"
    t, angle, rate = forward(cards, "0 60 7.3")
    k = 2 * 9.81 * 0.5 / (0.7 + 2 * 0.25)
    motion = solve_ivp(
        lambda _, y: (y[1], -k * math.sin(y[0])), (0, 60), (0.0, 5.0), "DOP853", t, rtol=1e-12, atol=1e-12
    )
    assert angle[:, 0] == pytest.approx(motion.y[0], abs=1e-7) and rate[:, 0] == pytest.approx(
        motion.y[1], abs=1e-7
    )
    assert np.abs(np.diff(t) * rate[1:, 0]).max() > 4 * math.pi and np.abs(angle).max() < math.pi


@pytest.mark.parametrize(
    "method", ["RK45", *(pytest.param(word, marks=pytest.mark.long_motion) for word in ("RAD5", "GALF"))]
)
def test_a_vsdf_rotor_has_its_angle_without_elements(method):
    """From rest under a torque of 3 N m about a moment of inertia of 0.5 kg m²: 3 t²."""
    text = f"{TURNING}TORQ\n 1,0,0,3\nINTG\n {VSDF[method]}\nTIME\n 4,1\nEND\nSTAR\nSTOP\n"
    model, _ = build_vsdf(read(text), Path())
    t, angle, rate = coordinates(FlexibleDynamics(flexible_mechanism(model)[0]).rows())
    near = {"RK45": 1e-8, "RAD5": 1e-5, "GALF": 1e-4}[method]
    assert angle[:, 0] == pytest.approx(3 * t**2, rel=near) and rate[:, 0] == pytest.approx(6 * t, rel=near)


DECKS = Path(__file__).resolve().parents[4] / "decks/young"


def four_bar(path, rows):
    """Rows of a four-bar whose crank turns at 31.4 rad/s."""
    text = (
        (DECKS / path)
        .read_text()
        .replace("0 3.14159265 0\n", "0 31.4 0\n")
        .replace("\n0 2.5 0.1\n", f"\n{rows}\n")
    )
    return read_deck(decode("IN.dat", text.encode()))


def test_a_crank_of_a_kinematic_deck_counts_its_turns_and_a_rocker_has_none():
    """The ground turns by -31.4 t against the crank, 4.5 turns a row; the rocker's angle as in fine rows."""
    t, angle, rate = coordinates(
        KinematicAnalysis(build_young(four_bar("IN4-BAR.dat", "0 2.7 0.9"))[0]).rows()
    )
    fine = coordinates(KinematicAnalysis(build_young(four_bar("IN4-BAR.dat", "0 2.7 0.01"))[0]).rows())
    _, every, its_rate = fine
    assert angle[:, 0] - angle[0, 0] == pytest.approx(-31.4 * t, abs=1e-9) and rate[:, 0] == pytest.approx(
        -31.4 + 0 * t
    )
    assert angle == pytest.approx(every[::90], abs=1e-9) and rate == pytest.approx(its_rate[::90], abs=1e-9)
    assert np.ptp(every[:, 1]) < math.pi
    assert np.gradient(every[:, 1], 0.01)[1:-1] == pytest.approx(
        its_rate[1:-1, 1], abs=0.05 * np.abs(its_rate[:, 1]).max()
    )


def test_inverse_dynamics_has_the_joint_coordinates_of_kinematics():
    model = build_young_dynamics(four_bar("dynamics/IN4-BAR-MASS.dat", "0 2.7 0.9"))[0]
    wanted = KinematicAnalysis(model.mechanism).rows()
    for one, other in zip(coordinates(InverseDynamics(model).rows()), coordinates(wanted), strict=True):
        assert one == pytest.approx(other, abs=1e-12)


def test_kinematics_and_dynamics_have_the_same_coordinates():
    """A deck with an element steps through time in constrained coordinates."""
    cards = "ELEMENTS\n SPRING idle at=3.angle stiffness=0\n"
    text = (DECKS / "dynamics/IN4-BAR-MASS.dat").read_text().replace("END\n", f"{cards}END\n")
    model = build_young_dynamics(read_deck(decode("IN.dat", text.encode())))[0]
    wanted = KinematicAnalysis(model.mechanism).rows()
    for one, other in zip(coordinates(analysis_of(model).rows()), coordinates(wanted), strict=True):
        assert one == pytest.approx(other, abs=1e-9)


def test_angles_go_on_counting_after_a_resumed_block():
    model = build_young(four_bar("IN4-BAR.dat", "0 2.7 0.9"))[0]
    whole = list(coordinates(KinematicAnalysis(model).rows()))
    first, again = KinematicAnalysis(model), KinematicAnalysis(model)
    next(first.rows())
    again.restore(first.checkpoint)
    for one, other in zip(coordinates(again.rows()), whole, strict=True):
        assert np.array_equal(one, other[1:])
