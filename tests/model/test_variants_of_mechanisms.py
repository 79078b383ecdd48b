"""What variants of a mechanism share, and what each has for itself; expected are the numbers of the decks."""

from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.text import read_text
from flexmb_cli.dialects.recognise import read_deck
from flexmb_cli.dialects.settings import SettableDeck
from flexmb_cli.dialects.young.build import build_young
from flexmb_cli.model.arrays.kinematic import kinematic_arrays
from flexmb_cli.model.joints import DRIVER

RSSR = Path(__file__).parents[2] / "decks/young/IN-RSSR.dat"


@pytest.fixture(scope="module")
def deck():
    return SettableDeck(read_deck(read_text(str(RSSR)), "young"))


def arrays_of(deck, *settings):
    """Return the arrays of the deck with numbers set."""
    return kinematic_arrays(build_young(deck.with_settings(list(settings)))[0])


def test_variants_of_a_driver_share_all_but_its_function(deck):
    first = arrays_of(deck, "driver.1.B=100")
    second = arrays_of(deck, "driver.1.B=200", "driver.1.A=3", "point.1.x=0.1")
    assert second.q is first.q and second.of_variants is first.of_variants
    for arrays, function in ((first, (0.0, 100.0, 0.0)), (second, (0.0, 200.0, 3.0))):
        row = arrays.constraints[arrays.constraints["kind"] == DRIVER.code]
        assert [(c, b, a) for c, b, a in zip(row["C"], row["B"], row["A"], strict=True)] == [function]


def test_a_variant_of_a_body_has_its_own_estimates_down_to_the_sign_of_zero(deck):
    for text, value in (("0.25", 0.25), ("0.0", 0.0), ("-0.0", -0.0)):
        x = arrays_of(deck, f"body.3.x={text}").q[14]
        assert x == value and np.signbit(x) == np.signbit(value)


def test_a_driver_of_another_direction_is_another_mechanism(deck):
    about_y = arrays_of(deck)
    with_two = arrays_of(deck, "driver.1.direction=1", "driver.1.C=0")
    assert len(about_y.equations) == 28
    assert with_two.of_variants is not about_y.of_variants
