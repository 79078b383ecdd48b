"""Faults collected while a model is built, each at the deck's number that causes it.

The order in which shares of a combination are reported: largest first, equal ones in the deck's order.

Singular vectors come from LAPACK, whose last digits depend on the processor: what symmetry makes equal must
not be ordered by them.
"""

from dataclasses import dataclass, field

import numpy as np

from ..errors import Fault, FaultList, Place

LARGEST_NUMBER = 1e50  # of a deck: products of four such numbers are still doubles


@dataclass
class Findings:
    """Errors and warnings found so far; nothing is thrown before all of it is known."""

    faults: list[Fault] = field(default_factory=FaultList)

    @property
    def in_order(self) -> list[Fault]:
        """The faults in the deck's order, those without a place first."""
        return sorted(self.faults, key=lambda fault: fault.place or (0, 0))

    def error(self, subject: str, message: str, place: Place | None, id: str = "") -> None:
        """Add a fault that forbids a model."""
        self.faults.append(Fault("error", message, place, subject, id=id))

    def warn(self, subject: str, message: str, place: Place | None, id: str = "") -> None:
        """Add a warning."""
        self.faults.append(Fault("warning", message, place, subject, id=id))

    def note(self, subject: str, message: str, place: Place | None, id: str = "") -> None:
        """Add what helps to understand the fault before."""
        self.faults.append(Fault("note", message, place, subject, id=id))


def no_such(what: str, number: int, count: int, lowest: int = 1) -> str:
    """Return why `number` names none of the things numbered from `lowest` to `count`; `what`: one of them."""
    if count < lowest:
        return f"{what} number {number} is not there: the deck has no {what}; add one, or remove this card"
    return f"{what} number {number} is outside {lowest}..{count}"


SAME_SHARE = 1e-6  # of a share: others as near to it are equal to it


def by_size(size: np.ndarray) -> list[int]:
    """Return the places of `size` (n,), largest first, those equal but for round-off as they stand."""
    order = np.argsort(-size, kind="stable").tolist()
    found, first = [], 0
    while first < len(order):
        last, least = first, (1.0 - SAME_SHARE) * size[order[first]]
        while last < len(order) and size[order[last]] >= least:
            last += 1
        last = max(last, first + 1)  # nan is equal to nothing
        found += sorted(order[first:last])
        first = last
    return found


def first_of_largest(size: np.ndarray) -> int:
    """Return the first place at which `size` (n,) is largest but for round-off."""
    return int(np.argmax(size >= (1.0 - SAME_SHARE) * size.max()))
