"""Drivers whose angles are none: refused, or doubted, before a run follows turn after turn."""

from pathlib import Path

import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.vsdf.joints import check_motion_functions
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.dialects.young.reader import read_young
from flexmb_cli.errors import ModelError
from flexmb_cli.model.diagnostics import Findings
from flexmb_cli.model.driver_angles import check_driver_angles
from flexmb_cli.model.mechanism import Driver, Mechanism, TimeGrid
from flexmb_cli.model.time_functions import POLYNOMIAL, SINE, Motion, MotionFunction, table_function

DECK = Path(__file__).resolve().parents[2] / "decks/young/IN4-BAR.dat"


def built(*changes):
    return build_young(apply_settings(read_young(read_text(str(DECK))), list(changes)))


@pytest.mark.parametrize(
    ("changes", "reached"),
    [
        (["driver.1.C=1e30"], "1e+30"),
        (["driver.1.B=-1e12"], "2.5e+12"),  # the deck ends at 2.5 s
        (["driver.1.A=1e10"], "3.13e+10"),  # A t²/2 = 3.125e10, and B t = 2.5 pi of the deck
        # Turns back in the midst: B t + A t²/2 is -B²/(2 A) at t = -B/A = 1.25 s.
        (["driver.1.B=2.5e9", "driver.1.A=-2e9", "driver.1.C=0"], "1.56e+09"),
    ],
)
def test_an_angle_that_is_none_is_refused(changes, reached):
    with pytest.raises(ModelError) as refused:
        built(*changes)
    assert f"driver 1: its angle reaches {reached} rad; beyond 1e+09 rad" in str(refused.value)


def test_many_turns_between_two_report_times_are_doubted():
    """1e5 rad/s for 0.1 s are 1e4 rad, 1592 turns."""
    (note,) = built("driver.1.B=1e5")[1]
    assert (note.severity, note.subject) == ("note", "driver 1")
    assert note.message.startswith("it turns 1.59e+03 times between two report times")


def test_a_constant_in_degrees_is_doubted_and_given_in_rad():
    """90 rad are 90/(2 pi) = 14.32 turns; 90 degrees are pi/2 = 1.570796327."""
    (note,) = built("driver.1.C=90")[1]
    assert (note.severity, note.subject) == ("note", "driver 1")
    assert note.message == "its C of 90 rad is 14.3 turns; 90 degrees would be 1.570796327 rad"
    assert built("driver.1.C=-6.28")[1] == []  # within a turn


def warnings_of(kind, function, end=2.0):
    findings = Findings()
    check_motion_functions((Motion("motion 1", kind, 0, function),), TimeGrid(0.0, end, 0.1), findings)
    return [(fault.severity, fault.message[: fault.message.index(";")]) for fault in findings.faults]


@pytest.mark.parametrize(
    ("function", "reached"),
    [
        (MotionFunction(POLYNOMIAL, (0.0, 1e30, 0.0, 0.0)), "2e+30"),
        (MotionFunction(POLYNOMIAL, (0.0, 0.0, 0.0, 1e9)), "8e+09"),  # c3 t³ at 2 s
        (MotionFunction(SINE, (2e9, 1.0, 1.0, 0.0)), "2e+09"),
        (table_function([0.0, 1.0, 2.0], [0.0, 3e12, 0.0]), "3e+12"),
    ],
)
def test_an_angle_by_a_law_that_is_none_is_refused(function, reached):
    assert warnings_of("ANGL", function) == [("error", f"its angle reaches {reached} rad")]
    assert warnings_of("TRAX", function) == []


def test_many_turns_by_a_law_are_doubted():
    """The sine of 1e8 rad/s and 1 rad moves at up to 1e8 rad/s: 1.6e6 turns in 0.1 s."""
    findings = Findings()
    motion = Motion("motion 1", "ROTZ", 0, MotionFunction(SINE, (0.0, 1.0, 1e8, 0.0)))
    check_motion_functions((motion,), TimeGrid(0.0, 2.0, 0.1), findings)
    (note,) = findings.faults
    assert note.severity == "note" and note.message.startswith("it turns 1.59e+06 times between")


@pytest.mark.parametrize(
    "function",
    [
        MotionFunction(POLYNOMIAL, (0.0, 0.0, 0.0, 1e308)),
        MotionFunction(SINE, (0.0, 1.0, 1e308, 0.0)),
        table_function([0.0, 1e-300, 1.0], [0.0, 1.0, 1.0]),  # a slope of 1e300
    ],
)
def test_a_law_without_finite_rates_is_refused(function):
    assert warnings_of("TRAX", function) == [
        ("error", "its law or a derivative is beyond 1e+100, or no number")
    ]


@pytest.mark.parametrize(("direction", "warnings"), [(1, 0), (3, 0), (4, 1), (6, 1)])
def test_only_angles_are_looked_at(direction, warnings):
    driver = Driver("driver 1", 0, direction, 1e30, 0.0, 0.0)
    findings = Findings()
    check_driver_angles(Mechanism((), TimeGrid(0.0, 1.0, 0.1), drivers=(driver,)), findings)
    assert len(findings.faults) == warnings
