"""Large legal decks: `check` takes memory in proportion to the deck, whatever fills it."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts/bench"))
import large_decks

# Besides what the deck may take; a small deck takes 40 to 50 MB.
BESIDES = 90 * 10**6
MEGABYTES = 2

pytestmark = pytest.mark.processes


@pytest.mark.parametrize(
    "kind",
    [
        "young bodies",
        "young points",
        "young blank lines",
        "young long comment",
        "young comment lines",
        "young words behind",
        "young lines behind",
        "young eleven counts",
        "young simplified",
        "young forces",
        "young springs",
        "young masses",
        "dafms full stiffness",
        "dafms tables",
        "dafms models",
        "vsdf table",
        "vsdf forces",
    ],
)
def test_a_large_deck_takes_at_most_twelve_bytes_a_byte(kind, tmp_path):
    """Readers that kept lines, words and records as objects took 30 to 250 bytes a byte."""
    text = large_decks.kinds(MEGABYTES)[kind]()
    _, peak, fault = large_decks.measured(text, kind.split()[0], tmp_path)
    assert fault == ""
    assert peak <= large_decks.MOST_PER_BYTE * len(text.encode()) + BESIDES


@pytest.mark.parametrize("setting", ["time.end=2", "body.3.x=2"])
def test_a_number_of_a_large_deck_is_set_in_place(setting, tmp_path):
    """A table of all names took 600 bytes a byte."""
    text = large_decks.kinds(MEGABYTES)["young bodies"]()
    _, peak, fault = large_decks.measured(text, "young", tmp_path, "--set", setting)
    assert fault == ""
    assert peak <= large_decks.MOST_PER_BYTE * len(text.encode()) + BESIDES
