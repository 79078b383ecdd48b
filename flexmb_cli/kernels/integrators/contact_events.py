"""Contacts that begin or end within a step: the step is made anew so that it ends there.

Within a step each contact stays apart or touching, so that the equations are smooth and no order is lost.
Records of pairs keep their gaps and rates at the start and at the end of the step; at the end of an
attempt Hermite's cubic through both estimates when the gap passes 0, and attempts of that length follow until
it does so at the end: each one squares the error.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .._jit import kernel
from ..contact import BY_GAP, SEPARATE, TOUCHING
from ..contact_sets import search_pairs
from .hermite import cubic

if TYPE_CHECKING:
    from ...model.arrays.contacts import Contacts

EXACT = 1e-12  # m: a gap as good as 0
MOST_ATTEMPTS = 30
# Of the way for which lists of pairs hold: that of a step which was too long, and that of another search.
SAFE, SOON = 0.9, 0.1
PIECES, BISECTIONS = 16, 50  # of a step in which the cubic's zero is sought


def contact_events(attempt: Callable[..., Any], contacts_of: Callable[..., Any] | None):
    """Return kernels of a method: (integration, *arrays) before a step, and (integration, factor, *arrays)
    behind an attempt, which returns the factor of the attempt that ends where the first contact changes.
    """

    @kernel
    def keep(integration: Any, *arrays: Any) -> None:
        """Leave contacts free: no step of the method ends for them."""

    @kernel
    def same(integration: Any, factor: float, *arrays: Any):
        return factor

    if contacts_of is None:
        return keep, same

    @kernel
    def begin(integration: Any, *arrays: Any) -> None:
        contacts = contacts_of(*arrays)
        if contacts.sets.shape[0] > 0 and integration.clock[0]["rejected"] == 0:
            begin_step(contacts, integration.clock[0]["t"])

    return begin, _landing(attempt, contacts_of)


def _landing(attempt: Callable[..., Any], contacts_of: Callable[..., Any]):
    @kernel
    def land(integration: Any, factor: float, *arrays: Any):
        clock = integration.clock[0]
        contacts = contacts_of(*arrays)
        if contacts.sets.shape[0] == 0:
            return factor
        low, high, target = 0.0, clock["length"], -1
        for _ in range(MOST_ATTEMPTS):
            h = clock["length"]
            k, x = first_change(contacts, h)
            way = longest_way(contacts)
            if way > 1.0:
                high, target, x = h, -1, SAFE * h / way
            elif k >= 0:
                high, target, x = h, k, x * h
            elif target < 0 or abs(contacts.touches[target]["gap"]) <= EXACT:
                break
            else:
                low, x = h, h - contacts.touches[target]["gap"] / contacts.touches[target]["rate"]
            if not low < x < high:
                x = 0.5 * (low + high)
            if not low < x < high:
                break
            clock["length"] = x
            factor = attempt(integration, x, *arrays)
            if not factor > 0.0:
                return factor
        end_step(contacts)
        return factor

    return land


@kernel
def begin_step(contacts: "Contacts", t: float) -> None:
    """Decide by the gaps at t, the end of the last step, which pairs touch."""
    for k in range(contacts.sets.shape[0]):
        s = contacts.sets[k]
        s["stepping"] = 1
        for n in range(s["first"], s["first"] + s["count"]):
            a = contacts.touches[n]
            if a["state"] == BY_GAP:
                a["at_end"], a["end_rate"] = a["gap"], a["rate"]
            before, a["at_start"], a["start_rate"] = a["state"], a["at_end"], a["end_rate"]
            touches = a["at_start"] < -EXACT or (a["at_start"] <= EXACT and a["start_rate"] <= 0.0)
            a["state"] = TOUCHING if touches else SEPARATE
            if before != BY_GAP and before != a["state"]:
                s["changed"] = t
            if touches and before != TOUCHING:
                s["begun"] += 1.0


@kernel
def end_step(contacts: "Contacts") -> None:
    """Keep the gaps at the end of a step, and search pairs there if shapes have moved."""
    for k in range(contacts.sets.shape[0]):
        s = contacts.sets[k]
        for n in range(s["first"], s["first"] + s["count"]):
            a = contacts.touches[n]
            a["at_end"], a["end_rate"] = a["gap"], a["rate"]
        if s["buckets"] > 0 and s["moved"] > SOON:
            search_pairs(contacts, s)


@kernel
def longest_way(contacts: "Contacts") -> float:
    """Return how far a shape has moved, as a share of the way for which lists of pairs hold."""
    way = 0.0
    for k in range(contacts.sets.shape[0]):
        way = max(way, contacts.sets[k]["moved"])
    return way


@kernel
def first_change(contacts: "Contacts", h: float):
    """Return the first pair that changes within a step of length h, and its share of h.

    -1 and 2: none does.
    """
    first, share = -1, 2.0
    for k in range(contacts.sets.shape[0]):
        s = contacts.sets[k]
        for n in range(s["first"], s["first"] + s["count"]):
            x = _change(contacts.touches[n], h)
            if x < share:
                first, share = n, x
    return first, share


@kernel
def _change(a: np.void, h: float):
    """Share of a step of length h after which a TOUCH changes, 2: it does not."""
    sign = 1.0 if a["state"] == SEPARATE else -1.0
    start, end = sign * a["at_start"], sign * a["gap"]
    leaving, arriving = sign * h * a["start_rate"], sign * h * a["rate"]
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
