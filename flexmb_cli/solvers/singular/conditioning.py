"""Conditioning of a position: its distance from a singular one, and what is weakest there, by name.

The same for kinematics, whose Jacobian is that of coordinates, and for dynamics, whose Jacobian is of speeds.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.by_size import by_size
from ...model.joints import Equation
from ..kinematics.position import Evaluator
from ..kinematics.rows import twice_g
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


MOST_WEAK_REPORTED = 3
SWEEPS = 6  # of inverse iteration: each gains the distance to the next singular value, squared
WORST_CONDITION = 1e12  # larger conditions have no digit that is more than round-off
REGULARISATION = 1e-14  # added to an exactly singular matrix, so that it has factors


def conditioning(evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray) -> Conditioning:
    """The conditioning at q, for any number of equations that equals that of the coordinates."""
    evaluator.residual(q, t, expected)
    return (
        _of_sparse(evaluator.sparse_matrix(q))
        if evaluator.is_large
        else conditioning_of(evaluator.jacobian(q), q.size)
    )


def _of_sparse(matrix: Any) -> Conditioning:
    """By inverse iteration: singular values of a thousand bodies would take minutes."""
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    matrix = matrix.tocsc()
    try:
        factors = splu(matrix)
    except RuntimeError:  # SuperLU: "Factor is exactly singular"
        factors = splu(matrix + REGULARISATION * identity(matrix.shape[0], format="csc"))
    start = np.random.default_rng(1996).standard_normal(matrix.shape[0])
    combination = motion = start / np.linalg.norm(start)
    for _ in range(SWEEPS):
        motion = factors.solve(combination)
        motion /= np.linalg.norm(motion)
        combination = factors.solve(motion, "T")
        size = np.linalg.norm(combination)
        combination /= size
    return Conditioning(_largest_value(matrix, start) * size, motion, combination)


def _largest_value(matrix: Any, vector: np.ndarray) -> Any:
    """The largest singular value to a few per cent, by power iteration."""
    for _ in range(20):
        vector = matrix.T @ (matrix @ vector)
        vector /= np.linalg.norm(vector)
    return float(np.linalg.norm(matrix @ vector))


def weakest_joints(evaluator: Evaluator, weak: Conditioning) -> list[Equation]:
    """The equations that are weakest, one a joint."""
    return weakest_owners(evaluator.arrays.equations, weak.combination, MOST_WEAK_REPORTED)


def conditioning_text(evaluator: Evaluator, q: np.ndarray, weak: Conditioning) -> str:
    """Joints with their lines, condition and the motion hardly determined at q (7 n,), in words."""
    owners = weakest_joints(evaluator, weak)
    joints = f" of {owners_text(owners)}" if owners else ""
    size = condition_text(weak.condition, WORST_CONDITION)
    return f"{joints} ({size}; {_motion(evaluator, q, weak.motion)} is least determined)"


def _motion(evaluator: Evaluator, q: np.ndarray, motion: np.ndarray) -> Any:
    """The bodies that take the largest part in a motion, and how."""
    rates = (motion * evaluator.arrays.column_scale).reshape(-1, 7)
    size = np.linalg.norm(motion.reshape(-1, 7), axis=1)
    moving = [k for k in by_size(size)[:MOST_WEAK_REPORTED] if size[k] > REPORTED_SHARE * size.max()]
    return ", ".join(
        _of_body(evaluator.arrays.body_names[k], q[7 * k + 3 : 7 * k + 7], rates[k]) for k in moving
    )


def _of_body(name: str, p: np.ndarray, rates: np.ndarray) -> str:
    omega = twice_g(p, rates[3:])
    turning = np.linalg.norm(omega) > REPORTED_SHARE * np.linalg.norm(rates[:3])
    direction = omega if turning else rates[:3]
    direction = direction / (direction[np.argmax(np.abs(direction))] or 1.0)
    x, y, z = np.round(direction / np.linalg.norm(direction), 3) + 0.0
    return f"{name} {'turning about' if turning else 'moving along'} ({x:g}, {y:g}, {z:g})"


MOST_THIRDS = 40  # by which an interval with a minimum is narrowed


@dataclass(frozen=True)
class Passed:
    """A position q (N,) passed at the time t, s, for the angles expected there, rad.

    `crosses`: two motions cross there; else it is the place where they come nearest.
    """

    q: np.ndarray
    t: float
    expected: np.ndarray
    crosses: bool


class PassedSingularities(ABC):
    """Looks for singular positions along the rows of a motion; notes go to `warnings`.

    Not active, it looks for nothing.  `names`: the equations; `most_reported`: how many of them a note names.
    """

    most_reported = 3

    def __init__(self, warnings: list[Fault], names: tuple[Equation, ...], active: bool):
        self.notes, self.names, self.active = SingularityNotes(warnings), names, active

    def look(self, *seen: Any) -> None:
        """Look at report rows, in order; `seen` is what `suspected` takes."""
        for interval in self.suspected(*seen):
            for passed in self.located(interval):
                self.report(passed)

    @abstractmethod
    def suspected(self, *seen: Any) -> Iterable[Any]:
        """Return the intervals in which a singular position may lie."""

    @abstractmethod
    def located(self, interval: Any) -> Iterable[Passed]:
        """Return the singular positions of an interval."""

    @abstractmethod
    def conditioning(self, passed: Passed) -> Conditioning:
        """Return the conditioning of the Jacobian there."""

    @abstractmethod
    def sentence(self, passed: Passed, weak: Conditioning, owners: list[Equation]) -> str:
        """Return what is said of a position, whose weakest equations belong to `owners`."""

    def report(self, passed: Passed) -> None:
        """Note a position, unless there are notes enough."""
        if self.notes.full:
            return
        weak = self.conditioning(passed)
        owners = weakest_owners(self.names, weak.combination, self.most_reported)
        self.notes.add(self.sentence(passed, weak, owners), owners)


def least_by_thirds(value: Callable[[float], float]) -> float:
    """Return where in (0, 1) a function with one minimum is least."""
    low, high = 0.0, 1.0
    for _ in range(MOST_THIRDS):
        thirds = low + (high - low) / 3.0, high - (high - low) / 3.0
        values = [value(x) for x in thirds]
        low, high = (low, thirds[1]) if values[0] < values[1] else (thirds[0], high)
    return 0.5 * (low + high)
