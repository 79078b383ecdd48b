# ruff: noqa: E501
"""Cards of VSDF decks that runs seldom meet, each against a closed form or the same thing said otherwise.

The rigid body of 2 kg falls or slides along z; the rod is that of decks/vsdf (0.26 kg, clamped at its root).
"""

import numpy as np
import pytest

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.kernels.laws import COORDINATE
from flexmb_cli.run.solutions.flexible import as_asked
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.vsdf_decks import build, changed, reported, supplied

pytestmark = pytest.mark.long_motion

SLIDER = """\
VSDF A MASS ON AN AXIS
BODY
    1 RIGD
RIGI
    1       2.0
       0.1       0.1       0.1
NODE
    0    1       0.0       0.0       0.0
    0    2       0.0       0.0       1.0
    0    3       1.0       0.0       0.0
    1    1       0.0       0.0       0.0
    1    2       0.0       0.0       1.0
    1    3       1.0       0.0       0.0
JOIN
    1 TRAN    0    1    2    1    1    2    3    3
TIME
       1.0      0.05
INTG
 RK45   1.0E-10
OUTN
    1    1
END
STAR
STOP
"""
PULSE = "TABL\n    1       0.0       0.0\n    1       1.0       3.0\n    1       2.0      12.0\n"


def run(text):
    """Blocks of a deck's rows joined by field, and the analysis."""
    mechanism, _ = flexible_mechanism(build(text), cached=False)
    analysis = FlexibleDynamics(mechanism)
    blocks = list(analysis.rows())
    return lambda field: np.concatenate([getattr(block, field) for block in blocks]), mechanism, analysis


def with_cards(cards, text=SLIDER):
    return changed(("TIME\n", cards + "TIME\n"), text=text)


def test_a_force_by_a_table_accelerates_by_its_straight_pieces():
    """A triangle of 3 over the first half second, 0 after it; z = ∬ F f/m with F/m = 2, piece by piece."""
    cards = "TABL\n    1       0.0       0.0\n    1      0.25       3.0\n    1       0.5       0.0\n"
    rows, _, _ = run(with_cards(cards + "FORC\n    1    1       0.0       0.0       4.0    0    1\n"))
    t = rows("time")
    s = t - 0.25
    down = 0.0625 + 0.75 * s + 3.0 * s**2 - 4.0 * s**3
    expected = np.where(t <= 0.25, 4.0 * t**3, np.where(t <= 0.5, down, 0.375 + 1.5 * (t - 0.5)))
    assert rows("position")[:, 0, 2] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("steps", "error"), [("RK45   1.0E-10", 1e-8), ("RAD5   1.0E-10", 1e-8), ("GALF", 5e-5)]
)
def test_no_method_steps_over_a_pulse_of_a_table(steps, error):
    """4 N s within 2 ms at the mass of 2 kg, which rested: 2 m/s from then on, however steps grow after
    it.
    """
    cards = "".join(f"    1 {t:9.4f} {f:9.1f}\n" for t, f in ((0, 0), (0.7, 0), (0.701, 1000), (0.702, 0)))
    cards = f"TABL\n{cards}FORC\n    1    1       0.0       0.0       4.0    0    1\n"
    rows, _, _ = run(with_cards(cards).replace("RK45   1.0E-10", steps))
    t, z = rows("time"), rows("position")[:, 0, 2]
    assert z[t < 0.7] == pytest.approx(0.0, abs=1e-9)
    assert z[t > 0.71] == pytest.approx(2.0 * (t[t > 0.71] - 0.701), abs=error)


@pytest.mark.parametrize("steps", ["RK45   1.0E-10", "RAD5   1.0E-10", "GALF"])
@pytest.mark.parametrize("last", ["0.7", "0.70000000000000007", "0.69999999999999996"])
def test_points_of_a_table_at_the_times_of_rows_but_for_round_off_do_no_harm(steps, last):
    """A force of 4 N at 2 kg all the time: z = t².  Seven times 0.1 is no 0.7."""
    cards = f"TABL\n 1,0.0,1.0\n 1,0.3,1.0\n 1,0.30000000000000004,1.0\n 1,{last},1.0\n"
    text = with_cards(cards + "FORC\n    1    1       0.0       0.0       4.0    0    1\n")
    rows, _, _ = run(changed(("       1.0      0.05\n", " 0.7,0.1\n"), ("RK45   1.0E-10", steps), text=text))
    t = rows("time")
    assert len(t) == 8
    assert rows("position")[:, 0, 2] == pytest.approx(t**2, abs=1e-4 if steps == "GALF" else 1e-8)


def test_a_step_of_given_length_that_passes_over_points_of_a_table_is_warned_of():
    cards = "TABL\n 1,0.0,0.0\n 1,0.001,3.0\nFORC\n    1    1       0.0       0.0       4.0    0    1\n"
    steps = ("       1.0      0.05\n", " 1.0,0.05,0.01\n"), ("RK45   1.0E-10", "GALF")
    _, _, analysis = run(changed(*steps, text=with_cards(cards)))
    (warning,) = [fault.message for fault in analysis.warnings if fault.severity == "warning"]
    assert warning.startswith("a table has points 0.001 s apart, and steps of 0.01 s may pass over them")


def test_a_motion_by_a_table_follows_its_spline():
    rows, _, analysis = run(with_cards(PULSE + "MOTN\n    1 STRK    1    4       1.0\n"))
    t = rows("time")
    assert rows("position")[:, 0, 2] == pytest.approx(1.5 * t + 1.5 * t**3, abs=1e-12)
    # 2 kg accelerated by 9 t m/s².
    assert rows("driver_effort")[:, 0] == pytest.approx(18.0 * t, abs=1e-9)
    assert not [fault for fault in analysis.warnings if fault.severity == "warning"]


def test_a_spring_with_a_damper_rings_down_as_the_damped_oscillator():
    """2 kg on 200 N/m with 8 N s/m from 0.1 m: ω = 10, ζ = 0.2; z = 0.1 e^-ζωt (cos ω't + ζω/ω' sin ω't)."""
    cards = "JSPR\n    1     200.0       8.0       0.1\n"
    rows, _, analysis = run(with_cards(cards))
    t, decay, ringing = rows("time"), 2.0, 10.0 * np.sqrt(1.0 - 0.04)
    left = np.exp(-decay * t) * (np.cos(ringing * t) + decay / ringing * np.sin(ringing * t))
    assert rows("position")[:, 0, 2] == pytest.approx(0.1 * (1.0 - left), abs=1e-9)
    assert analysis.work.responses[0, COORDINATE] == pytest.approx(0.1 * (1.0 - left[-1]), abs=1e-9)


@pytest.mark.parametrize(
    ("card", "rtol"), [("GALF,0.9,,1e-8", None), ("GALF", 1e-8), ("RK45,1e-10", 1e-8)], ids=str
)
def test_generalised_alpha_keeps_the_tolerance_of_its_card_and_of_rtol(card, rtol):
    """The oscillator above without damper, z = 0.1 (1 - cos 10 t), within the ten tolerances of
    docs/theory/integrators.md; with the 1e-6 of a deck that gives none the error is 8e-7.
    """
    steps = (" RK45   1.0E-10", f" {card}"), ("       1.0      0.05\n", " 0.3,0.05\n")
    cards = "JSPR\n    1     200.0       0.0       0.1\n"
    mechanism, _ = flexible_mechanism(build(changed(*steps, text=with_cards(cards))), cached=False)
    options = {"method": "alpha", "rtol": rtol} if rtol else {}
    analysis = FlexibleDynamics(as_asked(mechanism, options))
    blocks = list(analysis.rows())
    t = np.concatenate([block.time for block in blocks])
    z = np.concatenate([block.position for block in blocks])[:, 0, 2]
    assert z == pytest.approx(0.1 * (1.0 - np.cos(10.0 * t)), abs=1e-7)
    assert analysis.clock["atol"] == 1e-8


CLAMPED = [
    ("    1 FLEX    9    1   13    9", "    1 FLEX    9"),
    ("JOIN\n    1 REVO    0    0    0    1    1    5\n", "CLMP\n    1    1    2    3    4    5    6\nMOTN\n"
     "    1 TRAX    1    1\n    2 TRAY    1    1\n    3 TRAZ    1    1\n"
     "    4 ROTX    1    1\n    5 ROTY    1    1\n    6 ROTZ    1    1\n"),
    ("       0.5    5.0E-4    5.0E-5", "       0.2     0.005       0.0"),
    (" GALF       0.9", " RK45   1.0E-10"),
]  # fmt: skip


def test_a_damped_mode_creeps_to_its_sag_as_the_damped_oscillator():
    """η'' + (α + β ω² + 2 ζ ω) η' + ω² η = g, the modal load of gravity, from rest."""
    rows, mechanism, _ = run(
        supplied("pendulum", *CLAMPED, ("GRAV\n", "DAMP\n    1       3.0     0.001      0.05\nGRAV\n"))
    )
    (body,) = mechanism.bodies
    omega = 2.0 * np.pi * body.flexible.frequencies
    load = body.flexible.S1.T @ [0.0, 0.0, -9.81]
    t, decay = rows("time")[:, None], 0.5 * (3.0 + 0.001 * omega**2) + 0.05 * omega
    ringing = np.emath.sqrt(omega**2 - decay**2)
    left = np.exp(-decay * t) * (np.cos(ringing * t) + decay / ringing * np.sin(ringing * t))
    wanted = (load / omega**2) * (1.0 - left.real)
    assert rows("amplitude")[0] == pytest.approx(wanted, abs=1e-8)


def test_a_node_set_is_the_mean_of_its_nodes():
    text = supplied(
        "pendulum",
        *CLAMPED,
        (
            "OUTN\n    1   51\n",
            "NSET\n    1  900   51   53   52   54\nOUTN\n    1  900   51   53   52   54\n",
        ),
    )
    rows, _, _ = run(text)
    points = rows("point_position")
    assert np.ptp(points[:, 0, 2]) > 1e-4
    assert points[:, 0] == pytest.approx(points[:, 1:].mean(axis=1), abs=1e-14)


def test_all_modes_sag_as_the_matrices_say():
    """No number of modes: all 144 that the clamp leaves, and each oscillates as (1 - cos ωt) about its
    sag.
    """
    text = supplied(
        "pendulum",
        *CLAMPED,
        ("    1 FLEX    9", "    1 FLEX    0"),
        ("       0.2     0.005", "     0.001    0.0005"),
    )
    rows, mechanism, _ = run(text)
    (body,) = mechanism.bodies
    assert body.modes == 3 * 54 - 18
    omega, load = 2.0 * np.pi * body.flexible.frequencies, body.flexible.S1.T @ [0.0, 0.0, -9.81]
    wanted = (load / omega**2) * (1.0 - np.cos(omega * rows("time")[:, None]))
    assert rows("amplitude")[0] == pytest.approx(wanted, abs=1e-12)


def test_attachment_modes_give_the_tip_its_static_sag():
    """A constant force at the tip, critically damped: two modes and the attachment modes sag as thirty do."""
    sags = []
    for modes in (2, 30):
        text = supplied("pendulum", *CLAMPED, ("    1 FLEX    9", f"    1 FLEX{modes:5d}"),
            ("GRAV\n       0.0       0.0     -9.81\n",
             "ATTM\n    1   51\nFORC\n    1   51       0.0       0.0    -0.001\nDAMP\n    1                           1.0\n"),
            ("       0.2     0.005", "       5.0       1.0"))  # fmt: skip
        rows, _, _ = run(text)
        sags.append(rows("point_position")[-1, 0, 2] - rows("point_position")[0, 0, 2])
    assert sags[0] < -1e-5
    assert sags[0] == pytest.approx(sags[1], rel=1e-6)


def test_a_table_with_a_fault_is_not_also_called_missing():
    cards = "TABL\n    1       0.0       0.0\nFORC\n    1    1       0.0       0.0       4.0    0    1\n"
    assert reported(with_cards(cards)) == ["17:5: error: table 1: a table needs two points at least"]


def test_numbers_behind_a_keyword_are_refused_and_words_are_a_comment():
    assert reported(with_cards("GRAV  0.0,-9.81,0.0\n")) == [
        "16:7: error: GRAV: '0.0,-9.81,0.0' stands after the keyword and is not read; data cards follow on lines of "
        "their own"
    ]
    assert reported(with_cards("GRAVITY in m/s^2\n       0.0     -9.81\n")) == []


def test_a_word_of_a_data_card_in_the_first_column_is_told_to_move():
    assert reported(changed((" RK45   1.0E-10", "RK45   1.0E-10"), text=SLIDER)) == [
        "19:1: error: there is no card 'RK45'; 'RK45' stands on a data card, after a blank"
    ]


def test_a_motion_that_contradicts_a_joint_is_not_called_a_repeated_equation():
    text = with_cards("MOTN\n    1 TRAX    1    1       0.0       1.0\n")
    mechanism, _ = flexible_mechanism(build(text), cached=False)
    analysis = FlexibleDynamics(mechanism)
    with pytest.raises(Exception, match="the drivers ask for velocities that the joints forbid"):
        next(analysis.rows())
    assert analysis.warnings == []
