"""Slips of the typist that leave one joint wide open at the estimates, where assembly fails or goes far.

Expected gaps: the four-bar of the YOUNG dissertation (IN4-BAR) meets its joints within 3 mm at its printed
estimates.  Its ground has the global axes, so that a lost minus of a coordinate c there opens a gap of 2 c.
"""

import re
from pathlib import Path

import pytest

from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions

FOUR_BAR = (Path(__file__).resolve().parents[3] / "decks/young/IN4-BAR.dat").read_text(encoding="utf-8")
ASKED = "is a sign, a digit or a body number wrong there, or in an estimate?"


def faults_of(tmp_path, text):
    deck = tmp_path / "IN-SLIP.dat"
    deck.write_text(text, encoding="utf-8")
    return check_deck(str(deck), RunOptions()).outcome.faults


def slipped(old, new):
    assert FOUR_BAR.count(old) == 1
    return FOUR_BAR.replace(old, new)


def test_a_lost_minus_that_gives_another_mechanism_is_noted_at_its_joint(tmp_path):
    """P_j of revolute joint 2 lies on the ground at x = -4: without its minus the gap is 8 m."""
    note, moves = faults_of(tmp_path, slipped("0 -4.0 -8.50 0 1.0", "0 4.0 -8.50 0 1.0"))
    assert moves.message.startswith("assembly moves bodies from their estimates: body ")
    assert (note.severity, note.place.line) == ("note", 16)
    assert note.message == (
        "assembly had to move bodies far: the body estimates leave a gap at revolute joint 2 (x, line 16): "
        f"8.0e+00 m, elsewhere 2.9e-03 m at most: {ASKED}"
    )


def test_exchanged_digits_that_open_a_joint_a_little_are_noted_at_it(tmp_path):
    """6.01 for 6.10 along the y axis of body 2, whose largest component is y: 2 (e0² + e2²) - 1 = 0.697.

    The gap is 0.09 m times that, 0.063 m, within the 2.9 mm by which the printed deck misses its joints.
    """
    (note,) = faults_of(tmp_path, slipped("2 3 0 -6.10 0", "2 3 0 -6.01 0"))
    assert (note.severity, note.place.line) == ("note", 13)
    assert note.message.startswith("the body estimates leave a gap at spherical joint 1 (y, line 13)")
    gap, elsewhere = re.findall(r"(\S+) m\b[,\s]", note.message.partition(": ")[2])
    assert note.message.endswith(f" m at most: {ASKED}")
    assert float(gap) == pytest.approx(0.09 * 0.697, abs=2.9e-3) and float(elsewhere) <= 2.9e-3


def test_exchanged_digits_of_an_estimate_are_noted_at_both_joints_of_the_body(tmp_path):
    """4.5202 for 4.2502 moves body 2 by 0.27 m against both of its neighbours."""
    (note,) = faults_of(tmp_path, slipped("-3.753 -4.2502", "-3.753 -4.5202"))
    assert (
        "universal joint 1 (y, line 14): 2.7e-01 m; spherical joint 1 (y, line 13): 2.7e-01 m" in note.message
    )


def test_a_gap_ten_times_those_of_careful_estimates_is_no_slip_below_three_digits(tmp_path):
    """3.2255 for 3.2553: 0.03 m, less than the 0.005 of 8 m that estimates of three digits may leave."""
    assert not faults_of(tmp_path, slipped("-8.5001 3.2553", "-8.5001 3.2255"))


def test_a_mechanism_that_does_not_close_is_reported_at_the_joint_of_the_slip(tmp_path):
    """Exchanged digits: 1.60 for 6.10."""
    (fault,) = faults_of(tmp_path, slipped("2 3 0 -6.10 0", "2 3 0 -1.60 0"))
    assert (fault.severity, fault.place.line) == ("error", 13)
    assert "the body estimates leave a gap at spherical joint 1 (" in fault.message
    assert fault.message.endswith(f"elsewhere 2.4e-03 m at most: {ASKED}")


def test_rough_estimates_are_no_slip(tmp_path):
    """Bodies 2 and 3 both at the origin: all joints but that of the crank gape."""
    rough = slipped("-3.753 -4.2502 4.2553", "0 0 0").replace("-5.753 -8.5001 3.2553", "0 0 0")
    assert not [fault for fault in faults_of(tmp_path, rough) if ASKED in fault.message]


def test_the_printed_estimates_are_accepted_in_silence(tmp_path):
    assert not faults_of(tmp_path, FOUR_BAR)


def test_a_slip_in_a_deck_of_forward_dynamics_is_noted_as_well(tmp_path):
    masses = "".join(f"MASS {body} 1 0 0 0 1 1 1\n" for body in (1, 2, 3))
    text = slipped("0 -4.0 -8.50 0 1.0", "0 4.0 -8.50 0 1.0") + f"\nDYNAMICS forward\n{masses}END\n"
    assert any(ASKED in fault.message for fault in faults_of(tmp_path, text))
