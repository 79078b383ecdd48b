"""What `convert --to mjcf` refuses of the elements of DAFMS decks: every card but springs and dampers."""

import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.results.models.mjcf import mjcf
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, build, deck
from tests.dialects.dafms.test_every_card import CASES

HELD = ("SPRI", "DAMP")  # MJCF has stiffness and damping of joints
# Kinds of what MJCF could hold only in part: a spring with a function.
ELEMENTS = sorted(set(CASES) - {"FUNC", *HELD})


def identifiers(cards):
    try:
        mjcf(build(deck("\n".join(cards), TWO_LINKS))[0], "arm")
    except ModelError as refused:
        return [fault.id for fault in refused.faults]
    return []


@pytest.mark.parametrize("word", ELEMENTS)
def test_an_element_that_mjcf_does_not_hold_is_refused(word):
    assert identifiers(CASES[word]) == ["RESULT-032"]


@pytest.mark.parametrize("word", HELD)
def test_springs_and_dampers_of_hinges_convert(word):
    assert identifiers(CASES[word]) == []
