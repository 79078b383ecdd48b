"""Cards of functions and of elements at joints: what is said of slips."""

import re
from pathlib import Path

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.errors import DeckError, ModelError
from flexmb_cli.results.texts.echo import echo

# Line 6 is the first card: a ground, and a body on a revolute joint (1) that carries one on a ball (2).
DECK = """3 0 0 1 0 1 0 0 0 1 0 1
0 0 0 1 0 0 0  0 0 0 1 0 0 0  1 0 0 1 0 0 0
2 3 1 0 0 0 0 0  1 2 0 0 0 0 0 0 0 0 1 0 0 1
3 4 0  1 0 0 0 0 0 0  0 1 0.1
DYNAMICS forward
"""


def read(cards):
    return read_deck(decode("test.dat", f"{DECK}{cards}\nEND\n".encode()))


def messages(cards):
    with pytest.raises((DeckError, ModelError)) as caught:
        build_young_dynamics(read(cards))
    return [
        f"{f.place.line}:{f.place.column}: {f.sentence}" for f in caught.value.faults if f.severity == "error"
    ]


@pytest.mark.parametrize(
    ("cards", "wanted"),
    [
        ("  FUNCTION 1 table 0 1 2", "7:3: 1: table takes two points t v or more; read 3 numbers"),
        (
            "  FUNCTION 1 sine 0 1 2\n  FUNCTION 1 sine 0 1 3",
            "8:12: FUNCTION: 1 on line 7 has this name; take another",
        ),
        (
            "  FUNCTION 1 sine 0 1 2\n  DRIVE angle-1 at=1.angle value=1",
            "8:20: angle-1: joint 1 (spherical joint 1) turns by three angles, not by one; take a "
            "joint that turns about one axis, such as revolute joints with bodies between them",
        ),
        (
            "  FUNCTION 1 ramp 0 0 1 2\n  DRIVE angle-1 at=2.angle value=1",
            "8:34: angle-1: the rate of a coordinate cannot jump, but that of function 1 does; "
            "use spline or step",
        ),
        (
            "  FUNCTION 1 sine 0 1 2\n  FUNCTION 2 product 1 1\n  DRIVE angle-1 at=2.angle rate=2",
            "9:33: angle-1: flexmb has no integral of a product or periodic function; give the coordinate "
            "itself, in place of its rate",
        ),
        ("  FUNCTION 1 sum 2 3", "7:18: 1: function 2 must be given on a line above"),
        (
            "  FUNCTION 1 sine 0 1 2\n  SUPPORT support-1 simplified=1 value=1",
            "8:32: support-1: simplified constraint 1 holds an angle; x, y, z (directions 1 to 3) "
            "can be moved",
        ),
        (
            "  FUNCTION 1 sine 0 1 2\n  DRIVE drive-1 driver=1 value=1",
            "8:24: drive-1: driver number 1 is not there: the deck has no driver; add one, or "
            "remove this card",
        ),
        ("  COUPLING coupling-1 2.angle=1 2.angle=3", "7:33: coupling-1: 2.angle is given twice; remove one"),
        (
            "  FRICTION friction-1 joint=2 dynamic=0.1 static=0.1 stribeck=0 creep=1e-4 radius=0.1",
            "7:63: friction-1: stribeck must be larger than 1e-100; read 0",
        ),
        (
            "  FRICTION friction-1 joint=2 dynamic=0.1 static=0.1 stribeck=1e-300 creep=1e-4 radius=0.1",
            "7:63: friction-1: stribeck must be larger than 1e-100; read 1e-300",
        ),
        (
            "  FUNCTION 1 sine 0 1 2\n"
            "  SPRING tspring-1 at=2.angle stiffness=5\n"
            "  START at=2.angle rate=1\n"
            "  START at=2.angle rate=2",
            "10:3: start-2: start-1 already gives this; remove one of them",
        ),
    ],
)
def test_a_slip_is_told_with_place_object_and_remedy(cards, wanted):
    assert wanted in messages(f"ELEMENTS\n{cards}")


SHORTER = "rest -0.1 is negative, and lengths are not: is its sign meant?"
NOTHING = "does nothing: its coefficients are 0"


@pytest.mark.parametrize(
    ("card", "severity", "wanted"),
    [
        (
            "ELEMENTS\n  SPRING tspring-1 at=2.angle stiffness=-5",
            "warning",
            "7:41: tspring-1: stiffness -5 is negative, which drives a motion on",
        ),
        (
            "ELEMENTS\n  SPRING lspring-1 from=0(1,0,0) to=2(0,0,0) stiffness=5 rest=1 damping=-2",
            "warning",
            "7:73: lspring-1: damping -2 is negative, which drives a motion on",
        ),
        (
            "ELEMENTS\n  SPRING lspring-1 from=0(1,0,0) to=2(0,0,0) stiffness=5 rest=-0.1",
            "note",
            f"7:63: lspring-1: {SHORTER}",
        ),
        (
            "ELEMENTS\n  STOP tstop-1 at=2.angle lower=-1 upper=1 stiffness=0",
            "note",
            f"7:3: tstop-1: {NOTHING}",
        ),
        (
            "ELEMENTS\n  CABLE cable-1 from=0(1,0,0) to=2(0,0,0) stiffness=0 rest=1",
            "note",
            f"7:3: cable-1: {NOTHING}",
        ),
        (
            "ELEMENTS\n  BUSHING bushing-1 from=0(0,0,0) to=2(0,0,0) k=(0,0,0) kr=(0,0,0)",
            "note",
            f"7:3: bushing-1: {NOTHING}",
        ),
        (
            "ELEMENTS\n  FRICTION friction-1 joint=2 dynamic=0 static=0 stribeck=0.1 creep=1e-4 radius=0.1",
            "note",
            f"7:3: friction-1: {NOTHING}",
        ),
    ],
)
def test_an_element_that_does_nothing_or_drives_is_told(card, severity, wanted):
    _, faults = build_young_dynamics(read(f"MASS 2 1 0 0 0 1 1 1\nMASS 3 1 0 0 0 1 1 1\n{card}"))
    (told,) = [fault for fault in faults if fault.place and fault.place.line > 7]
    found = f"{told.place.line - 2}:{told.place.column}: {told.sentence}"
    assert (told.severity, found) == (severity, wanted)


def test_a_function_of_a_refused_card_is_not_called_unused():
    with pytest.raises(ModelError) as caught:
        build_young_dynamics(read("ELEMENTS\n  FUNCTION 1 sine 0 1 2\n  DRIVE angle-1 at=3.angle value=1"))
    assert [fault.severity for fault in caught.value.faults if "function" in fault.sentence] == []


@pytest.mark.parametrize(
    ("card", "wanted"),
    [
        (
            "ELEMENTS\n  START at=2.stroke rate=1",
            "7:12: start-1: joint 2 (revolute joint 1) has an angle, not a stroke; take 2.angle",
        ),
        ("FORCE 0 0 0 0 1 0 0", "6:7: force 1: body 0 is the ground, which does not move; name one of 1..3"),
        ("SPRING 0 0 0 0 0 1 0 0 5 1", "6:10: spring 1: I and J are both body 0; two bodies are needed"),
    ],
)
def test_a_slip_is_one_message(card, wanted):
    with pytest.raises(ModelError) as caught:
        build_young_dynamics(read(card))
    about = [fault for fault in caught.value.faults if not fault.sentence.startswith("body ")]
    assert [f"{f.place.line}:{f.place.column}: {f.sentence}" for f in about] == [wanted]


def test_a_number_of_a_table_can_be_set_by_its_name():
    cards = "MASS 2 1 0 0 0 1 1 1\nELEMENTS\n  FUNCTION rise table 0 1 2 3\nTORQUE 2 0 0 1 0 rise"
    model = build_young_dynamics(apply_settings(read(cards), ["rise.v2=7"]))[0]
    assert model.torques[0].factor.at(1.0)[0] == 4.0


def test_the_echo_lists_every_number_of_a_coupling_with_its_meaning():
    cards = "ELEMENTS\n  COUPLING gears 2.angle=0.5 2.stroke=-1"
    lines = [line for line in echo(read(cards)).splitlines() if "gears." in line]
    assert [line.split()[1:3] for line in lines] == [["gears.2.angle", "0.5"], ["gears.2.stroke", "-1"]]
    assert "factor of this coordinate in the sum" in lines[1]


def test_a_function_that_nothing_uses_is_noted():
    _, faults = build_young_dynamics(read("ELEMENTS\n  FUNCTION idle sine 0 1 2"))
    assert "idle: nothing uses function idle" in [fault.sentence for fault in faults]


def test_more_elements_than_memory_allows_are_refused(monkeypatch):
    monkeypatch.setattr("flexmb_cli.dialects.elements_block.reader.MOST_ELEMENTS", 2)
    lines = "".join(f"\n  SPRING s{k} at=2.angle stiffness=1" for k in range(3))
    assert "a deck has at most 2 functions and elements" in messages(f"ELEMENTS{lines}")[0]


def test_more_numbers_in_blocks_than_memory_allows_are_refused(monkeypatch):
    monkeypatch.setattr("flexmb_cli.dialects.elements_block.reader.MOST_NUMBERS_OF_BLOCKS", 5)
    lines = "\n  FUNCTION a table 0 0 1 1 2 2\n  FUNCTION b sine 0 1 2"
    assert (
        "the deck has more than 5 numbers in blocks; long tables stand in file="
        in messages(f"ELEMENTS{lines}")[0]
    )


@pytest.mark.parametrize(("upper", "noted"), [("90", True), ("1.5", False)])
def test_a_limit_that_may_be_in_degrees_is_noted(upper, noted):
    """90 rad are 90/2π = 14.3 turns; 90 degrees are π/2 rad."""
    _, faults = build_young_dynamics(read(f"ELEMENTS\n  STOP s at=2.angle lower=0 upper={upper} stiffness=5"))
    wanted = "upper of 90 rad is 14.3 turns; 90 degrees would be 1.5708 rad"
    assert any(wanted in fault.sentence for fault in faults) == noted


def test_functions_of_more_numbers_than_memory_allows_are_refused(monkeypatch):
    monkeypatch.setattr("flexmb_cli.dialects.elements_block.functions.LARGEST_TABLES", 6)
    assert messages("ELEMENTS\n  FUNCTION a polynomial 1 2 3 4\n  FUNCTION b polynomial 1 2 3") == [
        "8:3: b: the functions of a deck have at most 6 numbers together"
    ]


def test_numbers_of_a_long_line_are_found_by_their_keys():
    points = " ".join(f"{k} {k % 7}" for k in range(60_000))
    record = read(f"ELEMENTS\n  FUNCTION 1 table {points}\nFORCE 2 0 0 0 1 0 0 0 1").section("elements")[0]
    assert (record["t2"], record["v7"], record["t60000"]) == (1, 6, 59_999)
    assert record.at("v7").value == 6
    assert "t60001" not in record
    assert "t0" not in record


def test_products_that_grow_with_every_line_are_refused_before_they_are_multiplied_out():
    """Forty lines that square the one above had 2^40 factors, five factors of 1000 terms 10^15 terms."""
    squares = "".join(f"  FUNCTION {k} product {k - 1} {k - 1}\n" for k in range(2, 41))
    found = messages(f"ELEMENTS\n  FUNCTION 1 sine 0 1 2\n{squares}")
    assert found[0] == (
        "17:3: 11: multiplied out it has 1 terms of 1024 factors, more than 1000; use fewer products"
    )
    sums = f"  FUNCTION 2 sum {'1 ' * 1000}\n  FUNCTION 3 product 2 2 2 2 2"
    found = messages(f"ELEMENTS\n  FUNCTION 1 sine 0 1 2\n{sums}")
    assert "it has 1000000000000000 terms of 5 factors" in found[0]


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        (
            "table 0 0 1e-320 1",
            "7:24: f: 9.99989e-321 follows 0 by less than 1e-50, too short to compute with",
        ),
        ("step 0 0 1e-320 1", "7:23: f: the end 9.99989e-321 s must be later than the start 0 s"),
    ],
)
def test_points_too_near_for_a_slope_are_refused(line, wanted):
    """The slope of a table was infinite, and flexmb ended with a fault of its own."""
    assert messages(f"ELEMENTS\n  FUNCTION f {line}") == [wanted]


@pytest.mark.parametrize(("static", "warned"), [(0.1, True), (0.3, False)])
def test_sticking_friction_below_sliding_friction_is_warned_of(static, warned):
    cards = (
        "".join(f"MASS {k} 1 0 0 0 1 1 1\n" for k in (2, 3)) + "ELEMENTS\n"
        f"  FRICTION friction-1 joint=2 dynamic=0.3 static={static} stribeck=0.1 creep=1e-3 "
        "radius=0.05"
    )
    faults = build_young_dynamics(read(cards))[1]
    found = [fault for fault in faults if "less than it slides with" in fault.message]
    assert [fault.severity for fault in found] == ["warning"] * warned


@pytest.mark.parametrize(
    "card",
    [
        "STOP s at=1.angle lower=-0.5 upper=0.5 stiffness=500",
        "SPRING s at=1.angle stiffness=5",
        "SPRING s at=1.stroke stiffness=5",
    ],
)
def test_element_on_a_universal_joint_is_refused_for_its_two_angles(card):
    """A universal joint leaves two rotations: four equations of six (Young, universal joint)."""
    deck = (Path(__file__).parents[2] / "solvers/constrained/steps/universal_stop.dat").read_text()
    deck = re.sub("STOP tstop-1 .*", card, deck)
    deck = read_deck(decode("test.dat", deck.encode()))
    with pytest.raises(
        (DeckError, ModelError), match=r"\(universal joint 1\) turns by two angles, 1.angle1 and 1.angle2"
    ):
        build_young_dynamics(deck)
