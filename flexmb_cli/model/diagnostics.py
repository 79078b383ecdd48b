"""Faults collected while a model is built, each at the deck's number that causes it."""

from dataclasses import dataclass, field

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

    @property
    def has_errors(self) -> bool:
        """Return whether any fault forbids a model."""
        return any(fault.severity == "error" for fault in self.faults)

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
