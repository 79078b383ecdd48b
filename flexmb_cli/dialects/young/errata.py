"""Errors in the listings of the historic program: `diff --explain` marks these differences.

Liang Yong, dissertation (1996), Appendix B; every cause was found by putting the slip into a re-computation,
and everything not listed here is reproduced to the printed digit.
"""

import os
from dataclasses import dataclass

import numpy as np

from ...solvers.as_printed.errors import OVERRUN, SCREW, TRANSPOSED, WRONG_INDEX

EARLIER = "listing of an earlier program: dde without the term of (4.64)"
DOUBLE_ROOT = "listing of an earlier program: e0 from the normalisation near its double root e0 = 0"
LOOSE_STOP = "listing of an earlier program: the iteration ended a digit short"


@dataclass(frozen=True)
class KnownError:
    """Cells of one body's or point's lines in every report row, or in the rows `steps` only, and the cause.

    Columns count from 1 behind the number of the body or point.
    """

    deck: str
    section: str
    index: int
    columns: tuple[int, ...]
    cause: str
    steps: tuple[int, ...] | None = None

    def holds(
        self, index: int | np.ndarray, column: int | np.ndarray, step: int | np.ndarray
    ) -> bool | np.ndarray:
        """Return whether it covers the cells; the arguments are numbers or arrays that broadcast."""
        here = np.equal(index, self.index) & np.isin(column, self.columns)
        return here if self.steps is None else here & np.isin(step, self.steps)


ALL_TEN = tuple(range(1, 11))

YOUNG_ERRORS = (
    # Angular velocity and Euler parameter rates of the coupler.
    KnownError("IN4-BAR", "velocity", 2, (4, 5, 6, 7, 8, 9, 10), OVERRUN),
    # The driven body turns about x only: its y and z parts must be zero.
    KnownError("IN4-BAR", "acceleration", 1, (6, 7, 9, 10), TRANSPOSED),
    KnownError("IN4-BAR", "acceleration", 2, ALL_TEN, f"{TRANSPOSED}; {OVERRUN}"),
    KnownError("IN4-BAR", "acceleration", 3, ALL_TEN, f"{TRANSPOSED}; {OVERRUN}"),
    KnownError("IN4-BAR", "point", 1, (7,), TRANSPOSED),
    KnownError("IN5BODY", "acceleration", 1, (6, 7, 9, 10), TRANSPOSED),
    KnownError("IN5BODY", "acceleration", 2, ALL_TEN, f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN5BODY", "acceleration", 3, ALL_TEN, f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN5BODY", "acceleration", 4, (1, 2, 3, 5, 6, 7, 8, 9, 10), f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN5BODY", "point", 1, (7, 8, 9), f"{TRANSPOSED}; {WRONG_INDEX}"),
    KnownError("IN2-6-1", "position", 2, (2,), SCREW, (2,)),
    KnownError("IN2-6-1", "velocity", 2, (2,), SCREW, (1, 2, 3)),
    KnownError("IN2-6-1", "acceleration", 2, (2,), SCREW),
    KnownError("IN2-6-1", "point", 1, (2,), SCREW, (2, 3)),
    KnownError("IN2-6-1", "point", 1, (5,), SCREW, (1, 2, 3)),
    KnownError("IN2-6-1", "point", 1, (8,), SCREW),
    KnownError("IN1-4-3", "acceleration", 1, (4,), EARLIER, (0, 1, 2)),
    KnownError("IN1-4-3", "acceleration", 1, (6,), EARLIER, (1, 2, 3)),
    KnownError("IN1-4-3", "position", 1, (4,), DOUBLE_ROOT, (3,)),
    KnownError("IN1-4-3", "velocity", 1, (6,), DOUBLE_ROOT, (3,)),
    KnownError("IN1-4-3", "point", 1, (1, 3, 4, 6, 7, 9), DOUBLE_ROOT, (3,)),
    KnownError("IN1-4-3", "position", 1, (6,), LOOSE_STOP, (2,)),
    KnownError("IN1-4-3", "point", 1, (3,), LOOSE_STOP, (1, 2)),
    KnownError("IN1-4-3", "point", 1, (6, 7), LOOSE_STOP, (2,)),
)


def young_errors(*listings: str) -> tuple[KnownError, ...]:
    """The errors of the published listing that one of the files is named after: OUT4-BAR.* for IN4-BAR."""
    stems = {os.path.basename(name).split(".")[0].upper() for name in listings}
    decks = {f"IN{stem[3:]}" for stem in stems if stem.startswith("OUT")}
    return tuple(error for error in YOUNG_ERRORS if error.deck in decks)
