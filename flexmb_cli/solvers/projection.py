"""Positions brought onto the constraints by corrections of least norm, all in scaled units (Gauss-Newton).

The one iteration for searches between and before the steps of every formulation: in coordinates (kinematics)
and in speeds (rigid and flexible mechanisms).  Equations may repeat others, and degrees of freedom may be
left open.  What differs is handed in: the equations, when to end, and how much of a correction is made.

Steps of integrators are projected by the kernels, in the metric of the mass matrix or of the step
(`kernels.constrained.projection`, `kernels.tree.projection`).  The second formulations that `verify` compares
with, natural coordinates and the poses of a tree, share nothing with the first, and keep an iteration of
their own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import SuperLU


RESIDUAL_MET = 1e-9  # scaled residual that counts as met
Position = tuple[np.ndarray, np.ndarray]  # coordinates (N,) and their scaled residual (m,)
LARGEST_STEP = 0.3  # scaled: of the length scale, rad
HALVINGS = 10  # of a correction that widens the gaps
REFINEMENTS = 6  # of a correction
SMALLEST_COMPLIANCE = 1e-15  # of a constraint, of the largest entry: what keeps pivots from being 0


class Equations(Protocol):
    """The constraint equations of a mechanism at any position."""

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Return the scaled residual (m,) at q and t; expected: the angles expected, rad."""

    def jacobian(self, q: np.ndarray) -> "np.ndarray | csr_matrix":
        """Return the scaled Jacobian (m, n) at the q of the last `residual`, sparse where it is large."""

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the position after a scaled step (n,)."""


@dataclass(frozen=True)
class Corrections:
    """Correction of a position.

    `met`: the largest scaled residual that ends the corrections; `most` is their number.  `dependent`:
    singular values, of the largest, along which nothing is corrected.  `hopeless`: the largest residual
    from which no correction is tried.
    """

    met: float
    most: int
    dependent: float
    hopeless: float = np.inf


class Instant:
    """Equations at a time, for the angles expected there: what a step needs to try another position."""

    def __init__(self, equations: Equations, t: float, expected: np.ndarray):
        self.equations, self.t, self.expected = equations, t, expected

    def at(self, q: np.ndarray) -> Position:
        """Return q with its residual."""
        return q, self.equations.residual(q, self.t, self.expected)

    def after(self, q: np.ndarray, step: np.ndarray) -> Position:
        """Return the position after a scaled step from q, with its residual."""
        return self.at(self.equations.moved(q, step))


def largest(gap: np.ndarray) -> float:
    """Return the largest magnitude of gaps (m,), 0 of nothing, infinity where one is no number."""
    size = float(np.max(np.abs(gap), initial=0.0))
    return np.inf if np.isnan(size) else size


def whole(instant: Instant, q: np.ndarray, gap: np.ndarray, step: np.ndarray) -> Position | None:
    """Return the position after the whole step (n,), scaled, from q (n,) with scaled gaps (m,)."""
    return instant.after(q, step)


def improving(instant: Instant, q: np.ndarray, gap: np.ndarray, step: np.ndarray) -> Position | None:
    """Return the same as `whole`, (q, gap), None if the largest gap does not get smaller."""
    after = instant.after(q, step)
    return after if largest(after[1]) < largest(gap) else None


def shortened(instant: Instant, q: np.ndarray, gap: np.ndarray, step: np.ndarray) -> Position | None:
    """Return (q, gap) after so much of the step that the gaps get smaller, None if no part does."""
    size = np.linalg.norm(gap)
    factor = min(1.0, LARGEST_STEP / max(largest(step), 1e-300))
    for _ in range(HALVINGS):
        after = instant.after(q, factor * step)
        if np.linalg.norm(after[1]) < size:
            return after
        factor *= 0.5
    return None


def project(
    instant: Instant,
    q: np.ndarray,
    corrections: Corrections,
    advance: Callable[[Instant, np.ndarray, np.ndarray, np.ndarray], Position | None] = whole,
    columns: np.ndarray | None = None,
) -> Position:
    """Return a position near q (N,) that meets the equations as `corrections` say, and its residual (m,).

    `advance`: `whole`, `improving` or `shortened`; the corrections end where it returns None.
    `columns` (n,): the changes that are allowed, all by default.
    """
    q, gap = instant.at(q)
    for _ in range(corrections.most):
        if not corrections.met < largest(gap) < corrections.hopeless:
            break
        step = _least_step(instant.equations.jacobian(q), gap, corrections.dependent, columns)
        after = advance(instant, q, gap, step)
        if after is None:
            break
        q, gap = after
    return q, gap


def _least_step(
    J: "np.ndarray | csr_matrix", gap: np.ndarray, dependent: float, columns: np.ndarray | None
) -> np.ndarray:
    """Return the shortest step (n,) that takes the gap away to first order, 0 where there is none."""
    step, part = np.zeros(J.shape[1]), J if columns is None else J[:, columns]
    if not isinstance(J, np.ndarray):
        step[slice(None) if columns is None else columns] = -shortest_correction(part, gap)
    elif np.isfinite(J).all():  # an angle of a vector along its axis has no rate; LAPACK never returns
        step[slice(None) if columns is None else columns] = -np.linalg.lstsq(part, gap, rcond=dependent)[0]
    return step


def shortest_correction(
    matrix: "csr_matrix", gap: np.ndarray, weights: "csr_matrix | None" = None
) -> np.ndarray:
    """Return the x (n,) with J x = gap that makes xᵀ W x smallest, W the identity by default.

    The solution is refined, so that equations that repeat others need not be known.
    """
    from scipy.sparse import identity

    n = matrix.shape[1]
    W = identity(n) if weights is None else weights
    factors = saddle_point(matrix, weights)
    x, multipliers = np.zeros(n), np.zeros(gap.size)
    for _ in range(REFINEMENTS):
        rest = np.concatenate([-(W @ x) - matrix.T @ multipliers, gap - matrix @ x])
        change = factors.solve(rest)
        x += change[:n]
        multipliers += change[n:]
    return x


def saddle_point(J: "csr_matrix", weights: "csr_matrix | None") -> "SuperLU":
    """Return the factors of [[W, Jᵀ], [J, -δ]], δ so small that only repeated equations notice it."""
    from scipy.sparse import bmat, identity
    from scipy.sparse.linalg import splu

    m, n = J.shape
    delta = SMALLEST_COMPLIANCE * max(abs(J).max(), 1.0)
    W = identity(n) if weights is None else weights
    return splu(bmat([[W, J.T], [J, -delta * identity(m)]], format="csc"))
