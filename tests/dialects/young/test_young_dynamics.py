"""The cards after the last number of a YOUNG deck: what is read, and what is said of slips."""

from pathlib import Path

import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.dialects.young.build_dynamics import build_young_dynamics
from flexmb_cli.errors import DeckError, ModelError
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions

README = Path(__file__).parents[3] / "decks/young/README.md"
DECKS = Path(__file__).parents[3] / "decks/young/dynamics"
ONE_BODY = "1 0 0 0 0 0 0 0 0 0 0 0\n0 0 0 1 0 0 0\n0 1 0.5\n"


def read(cards):
    return read_deck(decode("test.dat", (ONE_BODY + cards).encode()))


def messages(cards):
    with pytest.raises(DeckError) as caught:
        build_young_dynamics(read(cards))
    return [f"{f.place.line}:{f.place.column}: {f.sentence}" for f in caught.value.faults]


def test_prose_behind_the_last_number_stays_prose():
    deck = read("the DYNAMICS forward of this mechanism\nMASS is not given\n")
    assert deck.section("dynamics") == []
    assert deck.section("mass") == []


NO_OPENING = [
    "DYNAMIC inverse",
    "DINAMICS inverse",
    "DINAMICA forward",
    "dynamics: inverse",
    "DYNAMICS = forward { motion }",
    "DYNAMICS inverse # masses below",
    "DYNAMICS foward",
    "DYNAMICS",
]


@pytest.mark.parametrize("line", NO_OPENING)
def test_a_line_near_dynamics_that_opens_no_cards_is_named(line):
    deck = read(f"END OF DATA\n  {line}\nMASS 1 1 0 0 0 1 1 1\n")
    assert deck.section("mass") == []
    (warning,) = deck.warnings
    assert (warning.severity, warning.place[:2]) == ("warning", (5, 3))
    assert "DYNAMICS inverse or DYNAMICS forward, alone on its line," in warning.message


@pytest.mark.parametrize("opening", ["", "masses follow\n"])
def test_a_card_that_nothing_opens_is_named(opening):
    deck = read(f"{opening}mass 1 2.5 0 0 0 1 1 1 {{ a rod }}\n{{ MASS 1\nMASS 2 1 }}\nforce 5 and 6\n")
    (warning,) = deck.warnings
    assert warning.place[:2] == (4 + opening.count("\n"), 1)
    assert warning.message.startswith("MASS is read as prose: a card needs the line DYNAMICS inverse")


def test_a_card_behind_end_is_named():
    deck = read("DYNAMICS forward\nMASS 1 2 0 0 0 1 1 1\nEND\nof MASS 1\n SPRING 0 1 0 0 0 1 0 0 5 1\n")
    (warning,) = deck.warnings
    assert warning.place[:2] == (8, 2)
    assert warning.message == "SPRING stands after END and is not read: put it before END"


@pytest.mark.parametrize(
    "prose", ["Dynamic analysis of a mechanism", "mechanics", "dynamo", "MASS in kg", "END 1"]
)
def test_prose_that_speaks_of_dynamics_is_no_slip(prose):
    assert read(f"{prose}\n").warnings == ()


def test_a_card_gives_its_numbers_names_and_places():
    deck = read("DYNAMICS forward\nmass 1 2.5 0.1 0.2 0.3 { slender }\n 1 2 2.5\nEND of cards\n")
    mass = deck.section("mass")[0]
    assert mass["m"] == 2.5
    assert mass.vector("centre") == (0.1, 0.2, 0.3)
    assert (mass["Izz"], mass["Izx"]) == (2.5, 0.0)
    assert mass.at("Ixx").place[:2] == (6, 2)


def test_a_number_of_a_card_can_be_set_by_its_name():
    deck = apply_settings(read("DYNAMICS forward\nMASS 1 2.5 0 0 0 1 1 1\n"), ["mass.1.m=4"])
    assert build_young_dynamics(deck)[0].masses[0].mass == 4.0


def test_radaus_method_has_the_tolerance_of_its_card_or_that_of_the_deck():
    mass = "DYNAMICS forward\nMASS 1 2.5 0 0 0 1 1 1\n"
    for cards, tolerance in (("RAD5", 1e-9), ("RAD5 1e-6", 1e-6), ("TOLERANCE 1e-7\nRAD5", 1e-7)):
        model, _ = build_young_dynamics(read(f"{mass}{cards}\n"))
        assert model.integrator == Integrator("RAD5", tolerance=tolerance)
    deck = apply_settings(read(f"{mass}RAD5 1e-6\n"), ["radau.1.tolerance=1e-5"])
    assert build_young_dynamics(deck)[0].integrator.tolerance == 1e-5


def test_an_unknown_card_is_told_with_the_nearest_known_one():
    assert messages("DYNAMICS forward\nMAS 1 2 0 0 0 1 1 1\n") == [
        "5:1: there is no card 'MAS'; is MASS meant?"
    ]


def test_a_card_with_too_few_numbers_names_those_it_takes():
    assert messages("DYNAMICS forward\nGRAVITY 0 -9.81\n") == [
        "5:1: gravity 1: GRAVITY takes 3 numbers (g.x g.y g.z); read 2"
    ]


def test_numbers_before_the_first_card_are_told():
    assert messages("DYNAMICS forward\n1 2 3\nMASS 1 2 0 0 0 1 1 1\n") == [
        "5:1: a card begins with a keyword, such as MASS, FORCE or GRAVITY"
    ]


@pytest.mark.parametrize(
    ("card", "message"),
    [
        ("MASS 2 1 0 0 0 1 1 1", "5:6: mass 1: body number 2 is outside 1..1"),
        ("MASS 1 -1 0 0 0 1 1 1", "5:8: mass 1: the mass must not be negative; read -1"),
        (
            "MASS 1 1 0 0 0 1 1 1 2 0 0",
            "5:16: mass 1: the inertia tensor must have no negative principal moment; they are -1, 1, 3 "
            "kg m^2",
        ),
        ("MASS 1 1 0 0 0 1 1 1\nMASS 1 1 0 0 0 1 1 1",
         "6:6: mass 2: body 1 already has mass 1; remove one of them"),
        ("MASS 1 1 0 0 0 1 1 2.O",
         "5:20: mass 1: Izz must be a number; read '2.O': letter O instead of zero?"),
        (
            "FORCE 1 0 0 0 1 2 3 2",
            "5:21: force 1: following must be 0 (global axes) or 1 (body axes); read 2",
        ),
        ("SPRING 1 1 0 0 0 1 1 1 5 1", "5:10: spring 1: I and J are both body 1; two bodies are needed"),
        ("GALF -1 1", "5:6: generalised-alpha 1: a step must not be negative; read -1"),
        ("GALF 0 1.5", "5:8: generalised-alpha 1: the spectral radius lies between 0 and 1; read 1.5"),
        ("MASS 1 nan 0 0 0 1 1 1",
         "5:8: mass 1: m must be a number; read 'nan': a finite number is needed"),
        ("MASS 1 1 0 0 0 1 1 Infinity",
         "5:20: mass 1: Izz must be a number; read 'Infinity': a finite number is needed"),
        ("GRAVITY 0 inf 0", "5:11: gravity 1: g.y must be a number; read 'inf': a finite number is needed"),
        ("RAD5 1", "5:6: radau: must lie between 1e-13 and 0.01; read 1"),
        ("GALF 0 1\nRAD5", "6:1: radau 1: the deck asks for GALF as well; remove one of them"),
        ("TOLERANCE 1", "5:11: tolerance: must lie between 1e-13 and 0.01; read 1"),
    ],
)  # fmt: skip
def test_what_no_body_can_have_is_refused_at_its_place(card, message):
    assert message in messages(f"DYNAMICS forward\n{card}\n")


def test_a_body_without_mass_is_told():
    _, warnings = build_young_dynamics(read("DYNAMICS forward\nGRAVITY 0 0 -9.81\n"))
    assert [fault.sentence for fault in warnings] == ["body 1: has no MASS card and is taken as massless"]


def test_a_given_motion_without_masses_and_weight_is_no_doubt(tmp_path):
    """Masses that nothing loads are left out for joint angles; under gravity three bodies lack theirs."""
    text = (DECKS.parent / "IN4-BAR.dat").read_text(encoding="utf-8") + "DYNAMICS inverse\n"
    deck = tmp_path / "angles.dat"
    for card, doubts in (("", set()), ("GRAVITY 0 0 -9.81\n", {"YOUNG-016", "MODEL-010"})):
        deck.write_text(text + card, encoding="utf-8")
        found = {fault.id for fault in check_deck(str(deck), RunOptions()).outcome.faults}
        assert found & {"YOUNG-016", "MODEL-010"} == doubts


def test_moments_of_inertia_that_no_body_has_are_doubted():
    _, warnings = build_young_dynamics(read("DYNAMICS forward\nMASS 1 1 0 0 0 1 1 2.5\n"))
    assert ["principal moments" in fault.message for fault in warnings] == [True]


def test_an_inverse_deck_must_balance_equations_and_coordinates():
    with pytest.raises(ModelError, match="6 too few"):
        build_young_dynamics(read("DYNAMICS inverse\nMASS 1 1 0 0 0 1 1 1\n"))


def test_every_dynamic_deck_stands_in_the_readme():
    text = README.read_text(encoding="utf-8")
    assert {path.stem for path in DECKS.glob("*.dat")} == {
        stem
        for stem in (
            "IN4-BAR-MASS",
            "IN-RSSR-MASS",
            "IN-BRICARD",
            "IN-ANDREWS",
            "IN-ARM",
            "IN-BALL",
            "IN-BREAK",
            "IN-CAM",
            "IN-ELEMENTS",
            "IN-HOLD",
            "IN-CATCH",
            "IN-LINK",
            "IN-MACHINE",
            "IN-PAIR",
            "IN-PATH",
            "IN-PID",
            "IN-RAIL",
            "IN-ROLL",
            "IN-SPRING",
        )
        if f"`{stem}`" in text
    }
