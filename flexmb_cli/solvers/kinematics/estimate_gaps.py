"""Joints that a deck's body estimates leave wide open while they nearly close the others: likely a slip.

A lost minus sign or exchanged digits often give another mechanism, which assembly closes without complaint.
"""

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault
from ..singular.mobility import Gap, about
from .position import Evaluator

if TYPE_CHECKING:
    from ..constrained.position import PositionGaps


WIDE_ESTIMATE = 0.05  # of the length scale
OPEN_ESTIMATE = 0.005  # of the length scale: more than estimates of three digits leave
OPEN_BY_OTHERS = 10.0  # of the widest gap elsewhere
CLOSE_ESTIMATE = 0.01  # of the length scale
FEWEST_CLOSE = 3  # owners that show that the estimates are careful
MOST_GAPS_NAMED = 3


def wide_estimates(
    evaluator: "Evaluator | PositionGaps", q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[list[Gap], float]:
    """Return the widest gaps that the estimates q leave, widest first, and the largest of the others, m.

    `expected`: angles of screws, rad.  There are none where gaps are wide as a rule, or small: then the
    estimates are rough, or right.  Angles and Euler parameters are left out: attitudes may be far off.
    """
    return _wide(*_widest_lengths(evaluator, evaluator.residual(q, t, expected)))


def open_estimates(
    evaluator: "Evaluator | PositionGaps", q: np.ndarray, t: float, expected: np.ndarray
) -> tuple[list[Gap], float, bool]:
    """Return gaps as `wide_estimates` does and True; where there are none, those far wider than all others.

    6.01 typed for 6.10 opens a joint by a hundredth of the size, where three digits leave a thousandth.
    """
    widest, length = _widest_lengths(evaluator, evaluator.residual(q, t, expected))
    wide, rest = _wide(widest, length)
    return (wide, rest, True) if wide else (*_outstanding(widest, length), False)


def _wide(widest: list[Gap], length: float) -> tuple[list[Gap], float]:
    return _parted(widest, sum(abs(gap.value) > WIDE_ESTIMATE * length for gap in widest), length)


def _outstanding(widest: list[Gap], length: float) -> tuple[list[Gap], float]:
    sizes = [abs(gap.value) for gap in widest]
    count = 0
    for k, (size, following) in enumerate(pairwise(sizes), start=1):
        if size > max(OPEN_ESTIMATE * length, OPEN_BY_OTHERS * following):
            count = k
    return _parted(widest, count, length)


def _parted(widest: list[Gap], count: int, length: float) -> tuple[list[Gap], float]:
    """Return the first `count` gaps and the size of the next, m; none where the others are not close."""
    rest = [abs(gap.value) for gap in widest[count:]]
    careful = sum(size <= CLOSE_ESTIMATE * length for size in rest)
    if not count or careful < max(FEWEST_CLOSE, len(widest) - careful):
        return [], 0.0
    return widest[:count], rest[0]


def slip_note(wide: list[Gap], rest: float, *, far: bool) -> Fault:
    """Return the note of `check` on joints that assembly closed; `far`: bodies moved far."""
    message = f"{'assembly had to move bodies far: ' * far}{slip_sentence(wide, rest)}"
    return about("note", message, *(gap.equation for gap in wide), id="SOLVE-055")


def slip_sentence(wide: list[Gap], rest: float) -> str:
    """Return which joints the estimates leave open, and what may be wrong."""
    named = "; ".join(gap.text for gap in wide[:MOST_GAPS_NAMED])
    more = f" and {len(wide) - MOST_GAPS_NAMED} more" if len(wide) > MOST_GAPS_NAMED else ""
    return (
        f"the body estimates leave a gap at {named}{more}, elsewhere {rest:.1e} m at most: is a sign, a "
        "digit or a body number wrong there, or in an estimate?"
    )


def _widest_lengths(evaluator: "Evaluator | PositionGaps", scaled: np.ndarray) -> tuple[list[Gap], float]:
    """Return the widest gap in m of every owner that has equations of length, the widest first, and the
    length scale.
    """
    found: dict[str, Gap] = {}
    sizes = scaled * evaluator.arrays.row_scale
    for equation, size in zip(evaluator.arrays.equations, sizes, strict=True):
        known = found.get(equation.owner)
        if equation.is_length and (known is None or abs(size) > abs(known.value)):
            found[equation.owner] = Gap(equation, float(size))
    length = max((gap.equation.scale for gap in found.values()), default=1.0)
    return sorted(found.values(), key=lambda gap: -abs(gap.value)), length
