"""Well-formed YOUNG decks become the mechanism they describe."""

import dataclasses
import math
from pathlib import Path

import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.settings import SettableDeck, apply_settings
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.dialects.young.reader import read_young
from flexmb_cli.errors import ModelError
from flexmb_cli.model.mechanism import Distance, Driver, Ground, Point, Simplified
from tests.dialects.young.young_decks import PENDULUM, faults, one_body, pendulum, read

DECKS = Path(__file__).parents[3] / "decks" / "young"


def mechanism(name):
    built, warnings = build_young(read_young(read_text(DECKS / f"{name}.dat")))
    assert warnings == []
    return built


def test_the_four_bar_deck_gives_its_joints_in_body_axes():
    """Dissertation, Appendix B, IN4-BAR: s = Q - P, bodies counted from 0 inside."""
    built = mechanism("IN4-BAR")
    spherical, universal, first, second = built.joints
    assert (spherical.kind, spherical.i, spherical.j) == ("spherical", 1, 2)
    assert (spherical.P_i, spherical.P_j) == ((0, -6.1, 0), (0, -3.7, 0))
    assert (universal.kind, universal.name) == ("universal", "universal joint 1")
    assert (universal.P_i, universal.s_i) == ((0, 0, 2), (0.75, -0.66, 0))
    assert (universal.P_j, universal.s_j) == ((0, 6.1, 0), (0, 0, 1))
    assert (first.s_i, first.s_j) == ((1, 0, 0), (1, 0, 0))
    assert (second.name, second.P_j, second.s_j) == ("revolute joint 2", (-4, -8.5, 0), (0, -1, 0))
    assert [body.name for body in built.bodies] == ["body 1", "body 2", "body 3", "body 4"]
    assert built.bodies[2].r == (-5.753, -8.5001, 3.2553)


def test_the_five_body_deck_gives_every_other_kind_of_item():
    """Dissertation, Appendix B, IN5BODY."""
    built = mechanism("IN5BODY")
    translational = built.joints[-1]
    assert translational.kind == "translational"
    assert (translational.s_i, translational.h_i) == ((1, 0, 0), (0, 1, 0))
    assert translational.P_j == (0.2, 0, 0)
    assert translational.s_j == pytest.approx((1.2, 0, 0), abs=1e-15)
    assert translational.h_j == (0, 0, 1)
    place = built.drivers[0].place
    assert built.drivers == (Driver("driver 1", 0, 4, 1.52, -6.2831852, 0, place),)
    assert built.distances == (Distance("distance constraint 1", 2, 3, 1, 0, built.distances[0].place),)
    assert built.grounds == (Ground("ground 1", 4, (0, 0, 0, 0, 0, 0), built.grounds[0].place),)
    assert built.points == (Point("point of interest 1", 3, (0, 0, 0), built.points[0].place),)
    assert (built.time.start, built.time.end, built.time.step, built.time.rows) == (0, 1, 0.05, 21)


def test_the_screw_has_its_pitch_and_simplified_constraints_their_directions():
    built = mechanism("IN2-6-1")
    (screw,) = built.joints
    assert (screw.kind, screw.pitch) == ("screw", 0.5)
    assert (screw.s_i, screw.s_j, screw.h_i, screw.h_j) == ((0, 1, 0), (0, 1, 0), (1, 0, 0), (1, 0, 0))


def test_simplified_constraints_keep_body_direction_and_value():
    built = mechanism("IN1-2-1")
    assert built.simplified[2] == Simplified("simplified constraint 3", 0, 3, 1.0, built.simplified[2].place)


@pytest.mark.parametrize("size", [1.0, 2.0, 1e-200, 1e200, 5e-324])
def test_euler_parameters_are_normalised_whatever_their_size(size):
    built, warnings = build_young(read(pendulum(2, f"0 0 0 {size!r} -{size!r} 0 0")))
    assert built.bodies[0].p == pytest.approx((math.sqrt(0.5), -math.sqrt(0.5), 0, 0), rel=1e-15)
    assert len(warnings) == 1


def test_a_length_off_by_less_than_a_thousandth_is_normalised_silently():
    built, warnings = build_young(read(pendulum(2, "0 0 0 1.0009 0 0 0")))
    assert warnings == []
    assert built.bodies[0].p == (1, 0, 0, 0)


def test_two_equal_grounds_are_redundant_and_two_fixed_bodies_may_be_joined():
    deck = "2 0 0 0 0 0 0 0 0 0 0 2\n0 0 0 1 0 0 0\n1 0 0 1 0 0 0\n1 0 0 0 0 0 0\n2 1 0 0 0 0 0\n0 1 1\n"
    assert faults(deck) == []


def test_a_redundant_joint_between_two_ground_bodies_is_counted_as_too_many():
    deck = (
        "2 0 0 1 0 0 0 0 0 0 0 2\n0 0 0 1 0 0 0\n0 0 0 1 0 0 0\n"
        "1 2 0 0 0 0 0 0\n1 0 0 0 0 0 0\n2 0 0 0 0 0 0\n0 1 1\n"
    )
    assert [fault.sentence for fault in faults(deck)] == [
        "counts: 2 bodies have 12 coordinates, but the constraints and drivers give 15 equations, 3 too many",
        "body 1: 6 coordinates, 9 equations, 3 too many",
    ]


def test_equations_are_not_counted_before_every_record_stands():
    deck = pendulum(4, "9 4 0 1.047 0")
    assert [fault.subject for fault in faults(deck)] == ["driver 1"]


def test_ten_million_rows_are_allowed_and_one_more_is_not():
    built, _ = build_young(read(pendulum(7, "0 9999999 1")))
    assert built.time.rows == 10_000_000
    assert "10000001 rows" in faults(pendulum(7, "0 10000000 1"))[0].message


@pytest.mark.parametrize(
    ("grid", "last"),
    [
        ("0 2.5 0.4", "the last within whole steps is at 2.4 s"),
        ("1 1.5 2", "the last within whole steps is at 1 s"),
        ("0 2.5 0.1", ""),
        # A third of 1.1, but for its last digit.
        ("0 1.1 0.36666666666666666", ""),
    ],
)
def test_an_end_that_no_row_meets_is_known(grid, last):
    time = build_young(read(pendulum(7, grid)))[0].time
    assert time.left_out.endswith(last) and bool(time.left_out) == bool(last)


def test_an_end_at_the_start_gives_one_row():
    built, _ = build_young(read(pendulum(7, "3 3 0.5")))
    assert built.time.rows == 1


@pytest.mark.parametrize("angle", [62, -62])
def test_ten_turns_are_no_suspicion_of_degrees(angle):
    assert faults(pendulum(6, f"1 0 0 0 {angle} 0 0")) == []


def test_many_groups_out_of_balance_are_counted_not_listed():
    bodies = 30
    deck = f"{bodies} 0 0 0 0 0 0 0 0 0 0 0\n" + "0 0 0 1 0 0 0\n" * bodies + "0 1 1\n"
    found = faults(deck)
    assert len(found) == 1 + 8 + 1
    assert found[-1].message == "22 more groups of bodies are not in balance"


def test_a_fault_of_a_number_set_from_outside_has_no_place():
    deck = apply_settings(read(PENDULUM), ["driver.1.body=7"])
    with pytest.raises(ModelError) as refused:
        build_young(deck)
    (fault,) = refused.value.faults
    assert (fault.sentence, fault.place) == ("driver 1: body number 7 is outside 1..2", None)


def test_angles_of_one_body_may_reach_a_half_turn():
    assert faults(one_body([], ["1 1 0", "1 2 0", "1 3 0", "1 4 3.141592653589793", "1 5 0", "1 6 0"])) == []


def test_variants_of_one_deck_are_those_of_decks_with_the_numbers_typed_in():
    """A study builds variant after variant from the records of one deck, good ones and bad ones."""
    settable = SettableDeck(read(PENDULUM))
    typed = {
        "driver.1.B=2.5": pendulum(4, "2 4 0 2.5 0"),
        "driver.1.body=3": pendulum(4, "3 4 0 1.047 0"),
        "body.1.e1=2.0": pendulum(2, "0 0 0 1 2.0 0 0"),
        "ground.1.x=1e60": pendulum(6, "1 1e60 0 0 0 0 0"),
        "driver.1.direction=5": pendulum(4, "2 5 0 1.047 0"),
    }
    for setting, text in (*typed.items(), *reversed(typed.items())):
        assert outcome(settable.with_settings([setting])) == outcome(read(text)), setting


def outcome(deck):
    """What is built of a deck and the warnings, or the faults; without places, which a number set has not."""
    try:
        built, reported = build_young(deck)
    except ModelError as failure:
        built, reported = None, failure.faults
    parts = built and [
        [dataclasses.replace(part, place=None) for part in group]
        for group in (built.bodies, built.joints, built.drivers, built.grounds)
    ]
    return parts, sorted((fault.severity, fault.subject, fault.message) for fault in reported)
