"""What is said of a name that the deck lacks: each slip leads to its own card, or to no name at all.

`time.end` of a DAFMS deck gave `time.H, attitude.1.e4`, `gravity.g3` gave `attitude.2.e3`.
"""

from pathlib import Path

import pytest

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.near_names import ALL
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import SettableDeck

DECKS = Path(__file__).resolve().parents[2] / "decks"
FOUR_BAR, BRICARD = "young/IN4-BAR.dat", "young/dynamics/IN-BRICARD.dat"
ARM = "young/dynamics/IN-ARM.dat"
TREE, SLIDER_CRANK = "dafms/spatial_rigid.DAT", "vsdf/slider_crank_flex.vsdf"
DRIVER = "driver.1 holds body, direction, C, B, A"
RIGID = "rigid.1 holds body, mass, c.x, c.y, c.z, Jxx, Jyy, Jzz, Jxy, Jyz, Jzx"
SPRING = "elbow holds at, stiffness, rest, damping, preload"
STEPS = "time holds IT (number of integration steps), H (length of a step)"


def said(deck, name):
    text = (DECKS / deck).read_text("latin-1")
    message = SettableDeck(read_deck(DeckText(deck, text, ""))).unknown(name)
    head, _, tail = message.partition(f"the deck has no number {name!r}; ")
    assert not head and tail.endswith(ALL)
    return tail.removesuffix(ALL).removesuffix("; ")


@pytest.mark.parametrize(
    ("deck", "name", "expected"),
    [
        # Capitals, a number that is left out or out of range, a component by its last letter.
        (FOUR_BAR, "driver.1.b", "near it is driver.1.B"),
        (FOUR_BAR, "driver.B", "near it is driver.1.B"),
        (FOUR_BAR, "driver.9.B", "near it is driver.1.B; the deck has driver.1"),
        (FOUR_BAR, "revolute.1.z", "near it are revolute.1.P_i.z, revolute.1.P_j.z, revolute.1.Q_i.z"),
        (BRICARD, "gravity.z", "near it is gravity.1.g.z"),
        (
            TREE,
            "attitude.3.e1",
            "near it are attitude.1.e1, attitude.2.e1; the deck has attitude.1, attitude.2",
        ),
        # A slip in the name of the card.
        (FOUR_BAR, "drivr.1.B", "near it is driver.1.B"),
        (BRICARD, "masss.1.m", "near it is mass.1.m"),
        # The card is right: a word of a meaning or a like word if there is one, and what it holds.
        (FOUR_BAR, "driver.1.velocity", f"near it is driver.1.B; {DRIVER}"),
        (TREE, "time.step", f"near it is time.H; {STEPS}"),
        (TREE, "mass.1.m", "near it is mass.1.BM; mass.1 holds BM (mass of the body)"),
        (FOUR_BAR, "body.2.e4", "body.2 holds x, y, z, e0, e1, e2, e3"),
        (TREE, "time.end", STEPS),
        (TREE, "attitude.1.e0", "attitude.1 holds e1, e2, e3, e4"),
        # A symbol of textbooks: the field that it stands for, and all fields of a card with few.
        (SLIDER_CRANK, "rigid.1.m", f"near it is rigid.1.mass; {RIGID}"),
        (ARM, "elbow.k", f"near it is elbow.stiffness; {SPRING}"),
        (ARM, "elbow.c", f"near it is elbow.damping; {SPRING}"),
        (ARM, "elbow.q", SPRING),
        (FOUR_BAR, "driver", DRIVER),
        # Neither the card nor its number is there.
        (FOUR_BAR, "driver.2.w", f"the deck has driver.1; {DRIVER}"),
        # Another card has a field of that name; the number given comes first.
        (FOUR_BAR, "end", "near it is time.end"),
        (FOUR_BAR, "integrator.step", "near it is time.step"),
        (FOUR_BAR, "attitude.2.e3", "near it are body.2.e3, body.1.e3, body.3.e3"),
        # Nothing is near.
        (FOUR_BAR, "gravity.g3", ""),
        (TREE, "gravity.g3", ""),
        (TREE, "driver.1.B", ""),
        (SLIDER_CRANK, "driver.1.B", ""),
        (FOUR_BAR, "", ""),
    ],
)
def test_a_slip_leads_to_its_card_or_nowhere(deck, name, expected):
    assert said(deck, name) == expected


@pytest.mark.parametrize(
    "card",
    [
        "ELEMENTS\n"
        "  FRICTION friction-1 joint=1 dynamic=0.1 static=0.12 stribeck=0.02 creep=0.01 "
        "radius=0.02",
        "ELEMENTS\n  FRICTION friction-1 joint=1 dynamic=0.1 static=0.12 stribeck=0.02 creep=0.01",
    ],
)
def test_the_symbol_of_friction_leads_to_both_coefficients(card):
    """The field is called neither mu nor friction; its meanings are coefficients."""
    text = (DECKS / ARM).read_text("latin-1").replace("GRAVITY", f"{card}\nGRAVITY", 1)
    message = SettableDeck(read_deck(DeckText("IN-ARM.dat", text, ""))).unknown("friction-1.mu")
    fields = "joint, dynamic, static, stribeck, creep, radius, preload"  # and those of bristles
    assert f"near it are friction-1.dynamic, friction-1.static; friction-1 holds {fields}" in message
