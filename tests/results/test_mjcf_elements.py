"""What `convert --to mjcf` refuses of the elements of DAFMS decks: what it holds in part."""

import pytest

from flexmb_cli.errors import ModelError
from flexmb_cli.results.models.mjcf import mjcf
from tests.dialects.dafms.test_dafms_elements import TWO_LINKS, build, deck
from tests.dialects.dafms.test_every_card import CASES

HELD = ("SPRI", "DAMP", "COUP", "MOTR")  # stiffness, damping, equalities and constant efforts of joints
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
def test_what_mjcf_has_of_joints_converts(word):
    assert identifiers(CASES[word]) == []
