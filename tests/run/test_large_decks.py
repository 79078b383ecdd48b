"""Large legal decks: `check` takes memory in proportion to the deck, whatever fills it."""

import sys
import tracemalloc
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts/bench"))
import large_decks
import large_element_kinds

from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.dialects.vsdf.reader import _MOST_CARDS
from flexmb_cli.dialects.young.dynamic_cards import MOST_LOADS
from flexmb_cli.model.arrays.tree import tree_arrays

# Besides what the deck may take; a small deck takes 40 to 50 MB, one of finite elements 70.
BESIDES = {"young": 90 * 10**6, "dafms": 90 * 10**6, "vsdf": 150 * 10**6}
MEGABYTES = 2

pytestmark = pytest.mark.processes


@pytest.mark.parametrize(
    "kind",
    [
        "young bodies",
        pytest.param("young points", marks=pytest.mark.campaign),
        "young blank lines",
        "young long comment",
        "young comment lines",
        "young words after",
        "young lines after",
        pytest.param("young eleven counts", marks=pytest.mark.campaign),
        pytest.param("young forces", marks=pytest.mark.campaign),
        pytest.param("young masses", marks=pytest.mark.campaign),
        "dafms full stiffness",
        "dafms tables",
        "vsdf table",
        "vsdf node sets",
    ],
)
def test_a_large_deck_takes_at_most_twelve_bytes_a_byte(kind, tmp_path):
    """Readers that kept lines, words and records as objects took 30 to 250 bytes a byte."""
    text = large_decks.kinds(MEGABYTES)[kind]()
    dialect = kind.split()[0]
    _, peak, fault = large_decks.measured(text, dialect, tmp_path)
    assert fault == ""
    assert peak <= large_decks.MOST_PER_BYTE * len(text.encode()) + BESIDES[dialect]


def test_a_chain_of_a_thousand_bodies_is_checked(tmp_path):
    """Singular values of 5000 equations took gigabytes."""
    text = large_element_kinds.vsdf_chain(131_000)
    _, peak, fault = large_decks.measured(text, "vsdf", tmp_path)
    assert fault == ""
    assert peak <= large_decks.MOST_PER_BYTE * len(text) + large_decks.MOST_BESIDES


def test_nodes_that_a_flexible_body_may_not_have_are_not_kept(tmp_path):
    """A record and a fault for each took 1833 MB for 8 MB of nodes."""
    nodes = "".join(f" 1,{k},1,0,0\n" for k in range(1, 150_000))
    text = large_decks.kinds(0)["vsdf blank lines"]().replace("\nEND", f"\nNODE\n{nodes}END", 1)
    _, peak, fault = large_decks.measured(text, "vsdf", tmp_path)
    assert "NODE is for RIGD bodies" in fault
    assert peak <= large_decks.MOST_PER_BYTE * len(text) + BESIDES["vsdf"]


@pytest.mark.parametrize("setting", [pytest.param("time.end=2", marks=pytest.mark.campaign), "body.3.x=2"])
def test_a_number_of_a_large_deck_is_set_in_place(setting, tmp_path):
    """A table of all names took 600 bytes a byte."""
    text = large_decks.kinds(MEGABYTES)["young bodies"]()
    _, peak, fault = large_decks.measured(text, "young", tmp_path, "--set", setting)
    assert fault == ""
    assert peak <= large_decks.MOST_PER_BYTE * len(text.encode()) + BESIDES["young"]


@pytest.mark.parametrize(
    ("card", "entry"), [("MOTR", f"{1:5d}{1:5d}{1.0:10.2f}"), ("DAMP", f"{1:5d}{1:5d}{1.0:10.2f}")]
)
def test_an_entry_of_a_hinge_takes_a_part_of_what_a_full_card_may(card, entry):
    """A full card has 99,999 entries of 21 bytes, 12 of which a byte and 200 MB are 2,250 an entry.

    With 50 MB for the program, 1,750 are left; a table of keys kept with every record made it 1,680.
    """
    head, end = (large_decks.kinds(0)["dafms blank lines"]()).rsplit("END ", 1)
    text = "".join([head, f"{card}\n{2000:5d}\n", 2000 * f"{entry}\n", "END ", end])
    source = DeckText("x.DAT", text, "")
    build_dafms(read_dafms(source))  # modules that it imports are no memory of entries
    tracemalloc.start()
    build_dafms(read_dafms(source))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1400 * 2000


def test_records_of_bushings_of_a_tree_take_hardly_more_than_themselves():
    """Six records and answers of 64 bytes a bushing; lists of single records took twice as much."""
    source = DeckText("x.DAT", large_decks.kinds(0.1)["dafms bushings"](), "")
    tree = build_dafms(read_dafms(source))[0]
    tracemalloc.start()
    arrays = tree_arrays(tree)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 700 * len(arrays.answers)


@pytest.mark.parametrize(
    ("kind", "card", "most"),
    [
        ("young forces", "\nFORCE", MOST_LOADS),
        ("young springs forward", "\nSPRING", MOST_LOADS),
        ("vsdf forces", "\n    1   51", _MOST_CARDS),
        ("vsdf rigid bodies", ",RIGD", _MOST_CARDS),
        ("vsdf chain", ",RIGD", _MOST_CARDS),
        ("vsdf balls", ",RIGD", _MOST_CARDS),
    ],
)
def test_a_large_deck_of_the_benchmark_stays_within_the_limits_of_its_format(kind, card, most):
    """13 kinds were refused at 62 MB, and nothing was measured.  Expected: more than half of the limit."""
    assert most / 2 < large_decks.kinds(62)[kind]().count(card) <= most


@pytest.mark.parametrize("kind", ["vsdf balls", "vsdf moving bodies", "vsdf loads at nodes", "dafms bodies"])
def test_a_deck_of_the_benchmark_is_legal(kind, tmp_path):
    _, _, fault = large_decks.measured(large_decks.kinds(0.004)[kind](), kind.split()[0], tmp_path)
    assert fault == ""
