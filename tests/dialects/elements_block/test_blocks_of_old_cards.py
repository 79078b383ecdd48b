"""Each card of elements of earlier versions, and the line of the block for it, make the same model."""

import dataclasses
import importlib.machinery
import importlib.util
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.elements_block.old_cards import LINES
from flexmb_cli.dialects.recognise import dialect_named, read_deck
from tests.dialects.dafms import test_every_card as dafms
from tests.dialects.dafms.test_dafms_elements import deck as dafms_deck
from tests.dialects.vsdf import element_cases as vsdf
from tests.solvers.constrained.elements import element_cases as young

_PATH = Path(__file__).parents[3] / "scripts" / "elements_block"
_SPEC = importlib.util.spec_from_loader(
    "script_elements_block", importlib.machinery.SourceFileLoader("script_elements_block", str(_PATH))
)
SCRIPT = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(SCRIPT)


def plain(item):
    """A model as texts and lists, without names and places."""
    if isinstance(item, np.ndarray):
        return item.tolist()
    if hasattr(type(item), "_quick_fields") or dataclasses.is_dataclass(item):
        left = ("name", "place")
        return {one.name: plain(getattr(item, one.name)) for one in fields(item) if one.name not in left}
    if isinstance(item, (tuple, list)):
        return [plain(one) for one in item]
    return item


def model_of(text):
    deck = read_deck(decode("test.dat", text.encode()))
    return plain(dialect_named(deck.dialect).build(deck, Path())[0])


def young_deck(case):
    return f"{case.mechanism}0 0.1 0.1\nDYNAMICS forward\n{case.driver}{case.cards}END\n"


def vsdf_deck(case):
    return f"{case.mechanism.rstrip()}\n{case.driver}{case.cards}TIME\n 0.1,0.1\nEND\nSTAR\nSTOP\n"


DECKS = {
    **{f"young {word}": young_deck(young.CASES[word]) for word in LINES["young"]},
    **{f"vsdf {word}": vsdf_deck(vsdf.CASES[word]) for word in LINES["vsdf"]},
    **{f"dafms {word}": dafms_deck("\n".join(dafms.CASES[word])) for word in LINES["dafms"]},
}


@pytest.mark.parametrize("name", DECKS)
def test_a_block_makes_the_model_of_the_cards_that_it_replaces(name):
    """The expected model is that which the reader of the card makes, which shares no code with blocks."""
    text, word = DECKS[name], name.split()[1]
    new = SCRIPT.rewritten_deck(text)
    assert word not in [line.split()[0] for line in new.splitlines() if line[:1].isalpha()]
    one, other = model_of(text), model_of(new)
    one["elements"]["reported"] = False  # JOINTS and OUTJ have no line
    assert other == one
