"""Large legal decks: `check` takes memory in proportion to the deck, whatever fills it."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts/bench"))
import large_decks

MEGABYTES = 3
# Besides what the deck may take; a small deck takes 40 to 50 MB.
BESIDES = 90 * 10**6

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
    ],
)
def test_a_large_deck_takes_at_most_twelve_bytes_a_byte(kind, tmp_path):
    """Readers that kept lines and words as objects took 30 to 120 bytes a byte."""
    text = large_decks.kinds(MEGABYTES)[kind]()
    _, peak, fault = large_decks.measured(text, kind.split()[0], tmp_path)
    assert fault == ""
    assert peak <= large_decks.MOST_PER_BYTE * len(text.encode()) + BESIDES
