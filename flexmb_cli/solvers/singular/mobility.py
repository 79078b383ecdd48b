"""Reasons that a mechanism cannot be assembled or moved: gaps, redundant equations and free motions."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.arrays.kinematic import KinematicArrays
from ...model.arrays.system import SystemArrays
from ...model.by_size import by_size, first_of_largest
from ...model.joints import DEPENDENT, Equation
from ..kinematics.position import Evaluator
from ..kinematics.rows import twice_g
from ..projection import RESIDUAL_MET, Corrections, Instant, project

NAMED = 1e-6  # of the largest component of a null vector
MOST_DENSE = 600  # coordinates or speeds; above, the rank is found by elimination
PROBE = 1e-3  # size of the trial motion that distinguishes a free motion from a stiff one
BACK = Corrections(met=1e-13, most=60, dependent=DEPENDENT)


@dataclass(frozen=True)
class Gap:
    """Residual of one owner's equations: its worst part and the residual there, in its unit."""

    equation: Equation
    value: float

    @property
    def unit(self) -> str:
        """ "m", or "1" of angles and Euler parameters."""
        return "m" if self.equation.is_length else "1"

    @property
    def text(self) -> str:
        """Readable, such as "universal joint 1 (x): 3.1e-04 m"."""
        unit = " m" if self.equation.is_length else ""
        line = f", line {self.equation.place.line}" if self.equation.place else ""
        return f"{self.equation.owner} ({self.equation.part}{line}): {abs(self.value):.1e}{unit}"


def about(severity: str, message: str, *owners: Equation, id: str) -> Fault:
    """A fault whose message names equations itself, at the place of the first; without any, at none."""
    if not owners:
        return Fault(severity, message, id=id)
    return Fault(severity, message, owners[0].place, about=owners[0].owner, id=id)


def worst_gaps(
    arrays: KinematicArrays | SystemArrays, scaled_residual: np.ndarray, most: int = 3
) -> list[Gap]:
    """The owners with the largest scaled residuals (m,), worst first; those that are met are left out."""
    worst: dict[str, Gap] = {}
    size = np.abs(scaled_residual)
    # Least squares share a gap out among joints: those alike to some percent stay in the deck's order.
    rank = np.round(np.log10(np.maximum(size, RESIDUAL_MET)), 2)
    for row in np.argsort(-rank, kind="stable"):
        equation = arrays.equations[row]
        if size[row] <= RESIDUAL_MET or len(worst) == most:
            break
        worst.setdefault(equation.owner, Gap(equation, scaled_residual[row] * arrays.row_scale[row]))
    return list(worst.values())


def gap_norms(worst: list[Gap]) -> dict[str, Any]:
    """The figures of the texts of `worst` for `--json`: of each, and `gap` with its `unit` of the first."""
    sizes, units = [float(abs(gap.value)) for gap in worst], [gap.unit for gap in worst]
    return {
        "gap": sizes[0] if worst else 0.0,
        "unit": units[0] if worst else "1",
        "worst": [gap.equation.name for gap in worst],
        "gaps": sizes,
        "units": units,
    }


@dataclass(frozen=True)
class Mobility:
    """Rank of the Jacobian at a position, and the names that a rank defect concerns.

    `redundant`: groups of equations, one group a dependency; any one of a group repeats the others.
    `free`: groups of coordinate names that can change together, largest share first.  `motions`:
    the unit null vectors (degrees of freedom, coordinates), scaled.  `pivots`: a coordinate for each of them
    that no other moves; `repeated`: a row for each group of `redundant` that no other has.
    """

    equations: int
    coordinates: int
    rank: int
    smallest: float
    redundant: tuple[tuple[Equation, ...], ...]
    free: tuple[tuple[str, ...], ...]
    motions: np.ndarray
    pivots: tuple[int, ...]
    repeated: tuple[int, ...] = ()

    @property
    def dofs(self) -> int:
        """Motions that the equations leave open at this position."""
        return self.coordinates - self.rank


def dense_mobility(
    J: np.ndarray, equations: tuple[Equation, ...], name: Callable[[int], str], dependent: float = DEPENDENT
) -> Mobility:
    """Return the mobility of a scaled Jacobian (m, n) by its singular values.

    `name`: that of a coordinate; `dependent`: singular values, of the largest, that count as 0.
    """
    left, values, right = np.linalg.svd(J)
    rank = int(np.sum(values > dependent * values[0])) if values.size else 0
    motions, pivots = sparse_basis(right[rank:])
    dependencies, repeated = sparse_basis(left[:, rank:].T)
    return Mobility(
        equations=len(equations),
        coordinates=J.shape[1],
        rank=rank,
        smallest=float(values[-1] / values[0]) if values.size else 1.0,
        redundant=tuple(tuple(equations[k] for k in involved(row)) for row in dependencies),
        free=tuple(tuple(name(k) for k in involved(row)) for row in motions),
        motions=motions,
        pivots=pivots,
        repeated=repeated,
    )


def sparse_basis(vectors: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Return vectors (k, n) of unit length that span the same space, and a coordinate of each: its pivot.

    Null vectors of a singular value decomposition mix unrelated motions; elimination separates them, so that
    each can be named.  Columns of the null space have lengths that no choice of its basis changes: pivots
    found by them are the same on every processor.
    """
    basis = np.array(vectors, dtype=float)
    left, pivots = basis.copy(), []
    for _ in range(len(basis)):
        pivots.append(first_of_largest(np.linalg.norm(left, axis=0)))
        direction = left[:, pivots[-1]] / np.linalg.norm(left[:, pivots[-1]])
        left -= np.outer(direction, direction @ left)
    pivots.sort()
    if pivots:
        basis = np.linalg.solve(basis[:, pivots], basis)
    return basis / np.linalg.norm(basis, axis=1, keepdims=True), tuple(pivots)


def involved(vector: np.ndarray) -> list[int]:
    """Places of a vector (n,) that are not zero, largest first."""
    size = np.abs(vector)
    least = NAMED * size.max()
    return [k for k in by_size(size) if size[k] > least]


def moves_freely(
    evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray, motion: np.ndarray
) -> bool:
    """Return whether the mechanism can really move along a null vector (7 n,), and not only to first order.

    A step along `motion` is brought back to the constraints by the shortest way; a stiff mechanism
    comes back to where it was.
    """
    scale = evaluator.arrays.column_scale
    moved = project(Instant(evaluator, t, expected), evaluator.moved(q, PROBE * motion), BACK)[0]
    return float(np.linalg.norm((moved - q) / scale)) > 0.3 * PROBE


def motion_text(evaluator: Evaluator, q: np.ndarray, motion: np.ndarray) -> str:
    """A null vector (7 n,) in words: which bodies turn about, or move along, which global direction."""
    bodies = (motion * evaluator.arrays.column_scale).reshape(-1, 7)
    size = np.linalg.norm(motion.reshape(-1, 7), axis=1)
    moving = involved(size)
    parts = [
        _body_motion(evaluator.arrays.body_names[k], q[7 * k + 3 : 7 * k + 7], bodies[k]) for k in moving[:3]
    ]
    return "; ".join(parts) + (f"; and {len(moving) - 3} more bodies" if len(moving) > 3 else "")


def _body_motion(name: str, p: np.ndarray, rates: np.ndarray) -> str:
    velocity, omega = rates[:3], twice_g(p, rates[3:])
    turning = np.linalg.norm(omega) > NAMED
    direction = omega if turning else velocity
    x, y, z = direction / np.linalg.norm(direction) + 0.0
    return f"{name} can {'turn about' if turning else 'move along'} ({x:.3g}, {y:.3g}, {z:.3g})"
