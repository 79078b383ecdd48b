"""Contacts that begin or end within a step: the step is made anew so that it ends there.

Within a step each contact stays apart or touching, so that the equations are smooth and no order is lost.
The answers of a contact keep its gap and rate at the start and at the end of the step; at the end of an
attempt Hermite's cubic through both estimates when the gap passes 0, and attempts of that length follow until
it does so at the end: each one squares the error.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from .._jit import kernel
from ..contact import (
    AT_START,
    BY_GAP,
    CHANGED,
    CONTACT,
    END,
    END_RATE,
    SEPARATE,
    START_RATE,
    STATE,
    TOUCHES,
    TOUCHING,
)
from ..laws import COORDINATE, SPEED
from .hermite import cubic

EXACT = 1e-12  # m: a gap as good as 0
MOST_ATTEMPTS = 30
PIECES, BISECTIONS = 16, 50  # of a step in which the cubic's zero is sought


def contact_events(attempt: Callable[..., Any], elements: Callable[..., Any] | None):
    """Return kernels of a method: (integration, *arrays) before a step, and (integration, factor, *arrays)
    behind an attempt, which returns the factor of the attempt that ends where the first contact changes.
    """

    @kernel
    def keep(integration: Any, *arrays: Any) -> None:
        """Leave contacts free: no step of the method ends for them."""

    @kernel
    def same(integration: Any, factor: float, *arrays: Any):
        return factor

    if elements is None:
        return keep, same

    @kernel
    def begin(integration: Any, *arrays: Any) -> None:
        records, answers = elements(*arrays)
        if answers.shape[1] > END_RATE and integration.clock[0]["rejected"] == 0:
            begin_step(records, answers, integration.clock[0]["t"])

    return begin, _landing(attempt, elements)


def _landing(attempt: Callable[..., Any], elements: Callable[..., Any]):
    @kernel
    def land(integration: Any, factor: float, *arrays: Any):
        clock = integration.clock[0]
        records, answers = elements(*arrays)
        if not answers.shape[1] > END_RATE:
            return factor
        low, high, target = 0.0, clock["length"], -1
        for _ in range(MOST_ATTEMPTS):
            h = clock["length"]
            k, x = first_change(records, answers, h)
            if k >= 0:
                high, target, x = h, k, x * h
            elif target < 0 or abs(answers[target, COORDINATE]) <= EXACT:
                break
            else:
                low, x = h, h - answers[target, COORDINATE] / answers[target, SPEED]
            if not low < x < high:
                x = 0.5 * (low + high)
            if not low < x < high:
                break
            clock["length"] = x
            factor = attempt(integration, x, *arrays)
            if not factor > 0.0:
                return factor
        end_step(records, answers)
        return factor

    return land


@kernel
def begin_step(records: np.ndarray, answers: np.ndarray, t: float) -> None:
    """Decide by the gaps in answers (E, 21) at t, the end of the last step, which of records (E,) touch."""
    for k in range(records.shape[0]):
        if records[k]["shape"] != CONTACT:
            continue
        a = answers[k]
        if a[STATE] == BY_GAP:
            a[END], a[END_RATE] = a[COORDINATE], a[SPEED]
        before, a[AT_START], a[START_RATE] = a[STATE], a[END], a[END_RATE]
        touches = a[AT_START] < -EXACT or (a[AT_START] <= EXACT and a[START_RATE] <= 0.0)
        a[STATE] = TOUCHING if touches else SEPARATE
        if before != BY_GAP and before != a[STATE]:
            a[CHANGED] = t
        if touches and before != TOUCHING:
            a[TOUCHES] += 1.0


@kernel
def end_step(records: np.ndarray, answers: np.ndarray) -> None:
    """Keep the gaps of records (E,) at the end of a step in their answers (E, 21)."""
    for k in range(records.shape[0]):
        if records[k]["shape"] == CONTACT:
            answers[k, END], answers[k, END_RATE] = answers[k, COORDINATE], answers[k, SPEED]


@kernel
def first_change(records: np.ndarray, answers: np.ndarray, h: float):
    """Return the first of records (E,) with answers (E, 21) that changes within a step, and its share of h.

    -1 and 2: none does.
    """
    first, share = -1, 2.0
    for k in range(records.shape[0]):
        if records[k]["shape"] == CONTACT:
            x = _change(answers[k], h)
            if x < share:
                first, share = k, x
    return first, share


@kernel
def _change(a: np.ndarray, h: float):
    """Share of a step of length h after which a contact with an answer (21,) changes, 2: it does not."""
    sign = 1.0 if a[STATE] == SEPARATE else -1.0
    start, end = sign * a[AT_START], sign * a[COORDINATE]
    leaving, arriving = sign * h * a[START_RATE], sign * h * a[SPEED]
    turns = sign > 0.0 and leaving < 0.0 < arriving
    if not (end < -EXACT or turns):
        return 2.0
    low = 0.0
    for piece in range(1, PIECES + 1):
        x = piece / PIECES
        if cubic(x, start, end, leaving, arriving) < -EXACT:
            return _zero(low, x, start, end, leaving, arriving)
        low = x
    return 2.0


@kernel
def _zero(low: float, high: float, start: float, end: float, leaving: float, arriving: float):
    """Return where Hermite's cubic, not negative at `low`, negative at `high`, passes 0."""
    for _ in range(BISECTIONS):
        x = 0.5 * (low + high)
        if cubic(x, start, end, leaving, arriving) < 0.0:
            high = x
        else:
            low = x
    return high
