"""Does it match the dissertation?  Every printed cell of Appendix B, to its printed digit.

Liang Yong, YOUNG dissertation (1996), Appendix B, the OUT listings of 18 decks.  `YOUNG_ERRORS`
lists what the listings have wrong and why; `flexmb diff --explain` uses it too.  Half a unit of the
last printed digit is all that rounding allows, and no cell needs more.
"""

from collections import Counter

import pytest

from flexmb_cli.dialects.young.listing_reader import YOUNG_ERRORS, KnownError
from tests.dialects.young.published_cells import cells_of
from tests.solvers.kinematics.solved import DECKS

PRINTED_DECKS = [deck for deck in DECKS if deck != "IN-RSSR-COELHO"]


def holds(wrong: KnownError, cell) -> bool:
    """Whether the cell is among those that the error spoils."""
    here = (cell.deck, cell.section) == (wrong.deck, wrong.section)
    return here and bool(wrong.holds(cell.index, cell.column, cell.step))


@pytest.mark.parametrize("deck", PRINTED_DECKS)
def test_every_right_cell_is_reproduced_to_its_printed_digit(deck):
    right = [c for c in cells_of(deck) if not any(holds(wrong, c) for wrong in YOUNG_ERRORS)]
    assert len(right) > 80
    assert [str(cell) for cell in right if not cell.agrees] == []


@pytest.mark.parametrize("wrong", YOUNG_ERRORS, ids=lambda w: f"{w.deck}-{w.section}-{w.index}-{w.columns}")
def test_every_excluded_column_really_disagrees(wrong):
    """Where steps are named every cell differs; a column of many rows agrees by chance here and there."""
    excluded = [cell for cell in cells_of(wrong.deck) if holds(wrong, cell)]
    cells, off = (
        Counter(c.column for c in found) for found in (excluded, [c for c in excluded if not c.agrees])
    )
    assert set(cells) == set(wrong.columns)
    for column in wrong.columns:
        least = cells[column] if wrong.steps else 0.8 * cells[column]
        assert off[column] >= least, f"v{column}: {off[column]} of {cells[column]} cells differ"


def test_no_cell_is_excluded_twice():
    for deck in {wrong.deck for wrong in YOUNG_ERRORS}:
        for cell in cells_of(deck):
            assert sum(holds(wrong, cell) for wrong in YOUNG_ERRORS) <= 1, str(cell)


def test_all_readable_cells_of_the_listings_are_compared():
    """10,788 cells are readable, 8,642 of them in lines read without repair and not out of place."""
    cells = [cell for deck in PRINTED_DECKS for cell in cells_of(deck)]
    assert len(cells) == 10788
    assert sum(cell.reading == "ok" for cell in cells) == 8642
