"""Weakest equations at a position, by name, and the notes of the singular positions that a motion passes.

The same for kinematics, whose Jacobian is that of coordinates, and for dynamics, whose Jacobian is of speeds.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.by_size import by_size
from ...model.equations import Equation
from .mobility import about

NEARLY_SINGULAR = 100.0  # condition, as a multiple of that of the start
REPORTED_SHARE = 0.2  # of the largest part of a combination: what is reported
MOST_NOTES = 5
OWNERS_OF_JOINTS = ("joint", "distance", "hinge")


@dataclass(frozen=True)
class Conditioning:
    """The smallest singular value of the scaled Jacobian at a position, of those that count in its rank.

    `condition`: the largest over the smallest.  `motion` (coordinates,): the unit motion that the
    equations resist least; `combination` (equations,): that of the equations which is nearest to nothing.
    """

    condition: float
    motion: np.ndarray
    combination: np.ndarray


def conditioning_of(matrix: np.ndarray, rank: int) -> Conditioning:
    """Return the conditioning of a dense Jacobian (m, n) of this rank, at least 1."""
    left, values, right = np.linalg.svd(matrix)
    smallest = max(float(values[rank - 1]), np.finfo(float).tiny)
    return Conditioning(float(values[0]) / smallest, right[rank - 1], left[:, rank - 1])


def weakest_owners(equations: tuple[Equation, ...], combination: np.ndarray, most: int) -> list[Equation]:
    """Return the equations with the largest shares of a combination (m,), one an owner: joints if any.

    Equations that have no place in the deck are named only where none has.
    """
    size = np.abs(combination)
    owners: dict[Any, Any] = {}
    for row in by_size(size):
        if size[row] < REPORTED_SHARE * size.max():
            break
        owners.setdefault(equations[row].owner, equations[row])
    placed = [one for one in owners.values() if one.place is not None] or list(owners.values())
    joints = [one for one in placed if any(word in one.owner for word in OWNERS_OF_JOINTS)]
    # Shares that symmetry makes equal differ by round-off: the deck's order is the same everywhere.
    return sorted((joints or placed)[:most], key=lambda one: one.place or (0, 0))


def owners_text(equations: Sequence[Equation]) -> str:
    """Return the owners of equations with their lines, as in "joint 1 (line 7), joint 2 (line 8)"."""
    return ", ".join(f"{one.owner} (line {one.place.line})" if one.place else one.owner for one in equations)


def condition_text(condition: float, largest: float) -> str:
    """Return a condition in words; above `largest` its digits are round-off."""
    return f"condition {condition:.0e}" if condition < largest else f"condition above {largest:.0e}"


class SingularityNotes:
    """Notes of the singular positions that a motion passes, which go to `warnings`: MOST_NOTES at most."""

    def __init__(self, warnings: list[Fault]):
        self.warnings, self.count = warnings, 0

    @property
    def full(self) -> bool:
        """Return whether no more are taken."""
        return self.count >= MOST_NOTES

    def add(self, sentence: str, owners: list[Equation]) -> None:
        """Note a position, about the equations that are weakest there."""
        self.count += 1
        last = "; later ones are not looked for" if self.full else ""
        self.warnings.append(about("note", f"{sentence}{last}", *owners, id="SOLVE-059"))
