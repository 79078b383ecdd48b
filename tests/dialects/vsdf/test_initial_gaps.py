"""Positions of a VSDF deck that leave joints apart are told: which joint, how far, and what was moved."""

import pytest

from flexmb_cli.fe.build_mechanism import flexible_mechanism
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.dialects.vsdf.vsdf_decks import DECKS, RIGID, build, changed, supplied

POSI = "POSI\n    2       1.0\n"


def warnings(text):
    """What is told of a deck's start, as "line: sentence"."""
    mechanism, _ = flexible_mechanism(build(text))
    analysis = FlexibleDynamics(mechanism)
    analysis.start()
    return [f"{w.place.line}: {w.sentence}" for w in analysis.warnings if w.severity == "warning"]


def test_a_joint_that_is_metres_apart_is_told_before_it_is_closed():
    """Body 2 belongs at x = 1 m, on the end of body 1, and stands at 3 m."""
    assert warnings(changed((POSI, "POSI\n    2       3.0\n"))) == [
        "24: where POSI and EULP put the bodies, more than a hundredth of the mechanism's size is open at "
        "joint 2 (x, line 24): 2.0e+00 m; to close it body 2 is moved by 2 m and turned by 0 rad: correct "
        "positions or nodes if that is not meant"
    ]


def test_axes_that_are_askew_are_told():
    """Turned by 2 atan 0.1 about x, the axis of body 2 is off that of body 1 by its sine, 0.198."""
    (reported,) = warnings(changed((POSI, POSI + "EULP\n    2  1.0       0.1\n")))
    assert "is open at joint 2 (axes parallel, 2nd, line 26): 2.0e-01; " in reported
    assert "body 2 is moved by 0 m and turned by 0.199 rad" in reported


@pytest.mark.parametrize(
    "change",
    [(POSI, "POSI\n    2     1.005\n"), ("GRAV\n", "MOTN\n    1 ANGL    1    1       0.5\nGRAV\n")],
    ids=["half a hundredth", "an angle that begins elsewhere"],
)
def test_what_is_near_or_meant_is_not_told(change):
    assert warnings(changed(change)) == []


def test_a_motion_of_a_coordinate_that_begins_elsewhere_is_told():
    text = supplied("pendulum", ("JOIN\n    1 REVO    0    0    0    1    1    5\n",
                                 "MOTN\n    1 TRAX    1    1       0.2\n"))  # fmt: skip
    (reported,) = warnings(text)
    assert "is open at motion 1 " in reported
    assert "body 1 is moved by 0.2 m and turned by 0 rad" in reported


def test_a_body_that_is_bent_to_meet_its_pins_is_told():
    """The rod's nodes 1 and 3 stay, node 5 is pinned a millimetre off."""
    text = supplied("pendulum_pinned", ("    1    5  111", "    1    5  111       0.0       0.0     0.016"))
    (bent,) = [reported for reported in warnings(text) if "is bent by up to" in reported]
    assert bent.startswith("3: body 1: ")


@pytest.mark.parametrize("path", sorted(DECKS.glob("*.vsdf")), ids=lambda path: path.stem)
def test_supplied_decks_stand_as_they_should(path):
    assert warnings(path.read_text()) == []


def test_a_velocity_that_does_not_fit_is_told_at_its_card():
    text = changed(("GRAV\n", "VELO\n    2       3.0\nGRAV\n"))
    assert warnings(text) == [
        "26: VELO of body 2: does not fit the joints and is changed to velocity (0, 0, 0) m/s, angular "
        "(0, 0, 0) rad/s"
    ]


def test_a_sound_deck_leaves_nothing_to_say():
    assert warnings(RIGID) == []
