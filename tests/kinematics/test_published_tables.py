"""Does it match the dissertation?  Every printed cell of Appendix B, to its printed digit.

Liang Yong, YOUNG dissertation (1996), Appendix B, the OUT listings of 18 decks.  `WRONG_IN_PRINT`
lists what the listings have wrong and why.  Half a unit of the last printed digit is all that
rounding allows, and no cell needs more.
"""

from collections import Counter
from dataclasses import dataclass

import pytest
from published_cells import Cell, cells_of
from solved import DECKS

PRINTED_DECKS = [deck for deck in DECKS if deck != "IN-RSSR-COELHO"]

TRANSPOSED = "QD[body, coordinate] is read as QD[coordinate, body]"
OVERRUN = "the fourth element of a three-element array is used in the universal joint's s_i · s_j row"
WRONG_INDEX = "components M for N in the cylindrical and translational right-hand sides"
SCREW = "the angle in the second quadrant, a factor 2 in the Jacobian, and eq. (4.50) where sin θ = 0"
EARLIER = "listing of an earlier program: dde without the term of (4.64)"
DOUBLE_ROOT = "listing of an earlier program: e0 from the normalisation near its double root e0 = 0"
LOOSE_STOP = "listing of an earlier program: the iteration ended a digit short"


@dataclass(frozen=True)
class Wrong:
    """Cells of one line in every step, or in `steps` only, and the cause of the error."""

    deck: str
    section: str
    index: int
    columns: tuple[int, ...]
    cause: str
    steps: tuple[int, ...] | None = None

    def holds(self, cell: Cell) -> bool:
        """Whether the cell is among them."""
        here = (cell.deck, cell.section, cell.index) == (self.deck, self.section, self.index)
        return here and cell.column in self.columns and (self.steps is None or cell.step in self.steps)


ALL_TEN = tuple(range(1, 11))

WRONG_IN_PRINT = (
    # Angular velocity and Euler parameter rates of the coupler.
    Wrong("IN4-BAR", "velocity", 2, (4, 5, 6, 7, 8, 9, 10), OVERRUN),
    # The driven body turns about x only: its y and z parts must be zero.
    Wrong("IN4-BAR", "acceleration", 1, (6, 7, 9, 10), TRANSPOSED),
    Wrong("IN4-BAR", "acceleration", 2, ALL_TEN, f"{TRANSPOSED}; {OVERRUN}"),
    Wrong("IN4-BAR", "acceleration", 3, ALL_TEN, f"{TRANSPOSED}; {OVERRUN}"),
    Wrong("IN4-BAR", "point", 1, (7,), TRANSPOSED),
    Wrong("IN5BODY", "acceleration", 1, (6, 7, 9, 10), TRANSPOSED),
    Wrong("IN5BODY", "acceleration", 2, ALL_TEN, f"{TRANSPOSED}; {WRONG_INDEX}"),
    Wrong("IN5BODY", "acceleration", 3, ALL_TEN, f"{TRANSPOSED}; {WRONG_INDEX}"),
    Wrong("IN5BODY", "acceleration", 4, (1, 2, 3, 5, 6, 7, 8, 9, 10), f"{TRANSPOSED}; {WRONG_INDEX}"),
    Wrong("IN5BODY", "point", 1, (7, 8, 9), f"{TRANSPOSED}; {WRONG_INDEX}"),
    Wrong("IN2-6-1", "position", 2, (2,), SCREW, (2,)),
    Wrong("IN2-6-1", "velocity", 2, (2,), SCREW, (1, 2, 3)),
    Wrong("IN2-6-1", "acceleration", 2, (2,), SCREW),
    Wrong("IN2-6-1", "point", 1, (2,), SCREW, (2, 3)),
    Wrong("IN2-6-1", "point", 1, (5,), SCREW, (1, 2, 3)),
    Wrong("IN2-6-1", "point", 1, (8,), SCREW),
    Wrong("IN1-4-3", "acceleration", 1, (4,), EARLIER, (0, 1, 2)),
    Wrong("IN1-4-3", "acceleration", 1, (6,), EARLIER, (1, 2, 3)),
    Wrong("IN1-4-3", "position", 1, (4,), DOUBLE_ROOT, (3,)),
    Wrong("IN1-4-3", "velocity", 1, (6,), DOUBLE_ROOT, (3,)),
    Wrong("IN1-4-3", "point", 1, (1, 3, 4, 6, 7, 9), DOUBLE_ROOT, (3,)),
    Wrong("IN1-4-3", "position", 1, (6,), LOOSE_STOP, (2,)),
    Wrong("IN1-4-3", "point", 1, (3,), LOOSE_STOP, (1, 2)),
    Wrong("IN1-4-3", "point", 1, (6, 7), LOOSE_STOP, (2,)),
)


@pytest.mark.parametrize("deck", PRINTED_DECKS)
def test_every_right_cell_is_reproduced_to_its_printed_digit(deck):
    right = [c for c in cells_of(deck) if not any(wrong.holds(c) for wrong in WRONG_IN_PRINT)]
    assert len(right) > 80
    assert [str(cell) for cell in right if not cell.agrees] == []


@pytest.mark.parametrize("wrong", WRONG_IN_PRINT, ids=lambda w: f"{w.deck}-{w.section}-{w.index}-{w.columns}")
def test_every_excluded_column_really_disagrees(wrong):
    """Where steps are named every cell differs; a column of many rows agrees by chance here and there."""
    excluded = [cell for cell in cells_of(wrong.deck) if wrong.holds(cell)]
    cells, off = (
        Counter(c.column for c in found) for found in (excluded, [c for c in excluded if not c.agrees])
    )
    assert set(cells) == set(wrong.columns)
    for column in wrong.columns:
        least = cells[column] if wrong.steps else 0.8 * cells[column]
        assert off[column] >= least, f"v{column}: {off[column]} of {cells[column]} cells differ"


def test_no_cell_is_excluded_twice():
    for deck in {wrong.deck for wrong in WRONG_IN_PRINT}:
        for cell in cells_of(deck):
            assert sum(wrong.holds(cell) for wrong in WRONG_IN_PRINT) <= 1, str(cell)


def test_all_readable_cells_of_the_listings_are_compared():
    """10,788 cells are readable, 8,642 of them in lines read without repair and not out of place."""
    cells = [cell for deck in PRINTED_DECKS for cell in cells_of(deck)]
    assert len(cells) == 10788
    assert sum(cell.reading == "ok" for cell in cells) == 8642
