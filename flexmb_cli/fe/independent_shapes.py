"""A basis from eigenmodes and static shapes, independent in strain energy.

K measures independence, not the mass matrix: static shapes of neighbouring nodes differ by what hardly moves
any mass, and that difference is the local deformation under a load at either.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .massless_shapes import NO_STRAIN, IndefiniteMass

# A shape is dropped when less than this share of its strain energy is independent of the others; round-off
# leaves about 1e-14 of a shape that is a sum of others.
DEPENDENT_SHAPE = 1e-12
# Shares of strain energy closer than this are equal but for round-off; the first of them is taken.
EQUAL_SHARE = 1e-9
# Below this share of the largest mass per strain energy, 1/ω², the mass of a shape is round-off.
ROUND_OFF_MASS = 1e-14


@dataclass(frozen=True)
class ReducedBasis:
    """Eigenvalues ω² (N,), rad²/s², and modes (3 n, N) of unit modal mass; `kept`: the shapes they span.

    The last `massless` modes have no mass: they have the eigenvalue of the highest that has, and the
    strain energy that goes with it.
    """

    values: np.ndarray
    shapes: np.ndarray
    kept: np.ndarray
    massless: int


def reduced_basis(shapes: np.ndarray, forces: np.ndarray, S: Any, first: int) -> ReducedBasis:
    """Return the basis that `shapes` (3 n, k) span, the `first` of them kept before any other.

    `forces` (3 n, k) are those that bend the body into the shapes: work done on the shapes is their strain
    energy, without the cancellation in φ' K φ.  Raises IndefiniteMass.
    """
    kept, orthogonal = _independent(shapes, forces, first)
    mass = orthogonal.T @ (S @ orthogonal)
    inverse, mixing = np.linalg.eigh((mass + mass.T) / 2)
    # Ascending 1/ω² would begin with the highest frequency.
    inverse, modes = inverse[::-1], orthogonal @ mixing[:, ::-1]
    heavy = inverse > ROUND_OFF_MASS * inverse.max(initial=0.0)
    if not heavy.any():
        raise IndefiniteMass
    values = 1.0 / np.where(heavy, inverse, inverse[heavy][-1])
    return ReducedBasis(values, modes * np.sqrt(values), kept, int(np.count_nonzero(~heavy)))


def _independent(shapes: np.ndarray, forces: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the shapes kept, and a basis of their span with φ_k' K φ_l = 1 for k = l, else 0."""
    energy = np.einsum("ij,ij->j", shapes, forces)
    terms = np.einsum("ij,ij->j", np.abs(shapes), np.abs(forces))
    strained = np.flatnonzero(energy > NO_STRAIN * terms)
    scale = np.sqrt(energy[strained])
    basis, loads = shapes[:, strained] / scale, forces[:, strained] / scale
    order = _pivots(_symmetric(basis.T @ loads), np.count_nonzero(strained < first))
    basis, loads = basis[:, order], loads[:, order]
    # Twice, since the first pass leaves the round-off of nearly dependent shapes.
    for _ in range(2):
        factor = np.linalg.cholesky(_symmetric(basis.T @ loads))
        basis, loads = np.linalg.solve(factor, basis.T).T, np.linalg.solve(factor, loads.T).T
    return strained[order], basis


def _symmetric(gram: np.ndarray) -> np.ndarray:
    found: np.ndarray = (gram + gram.T) / 2
    return found


def _pivots(gram: np.ndarray, first: Any) -> np.ndarray:
    """Columns in the order of elimination: the `first`, then always the one with the largest remainder."""
    remainder = np.diag(gram).copy()
    rows = np.zeros((len(gram), len(gram)))
    order: list[int] = []
    for k in range(len(gram)):
        pivot = k if k < first else _largest(remainder)
        if remainder[pivot] < DEPENDENT_SHAPE:
            if k < first:
                continue
            break
        rows[len(order)] = (gram[pivot] - rows[: len(order), pivot] @ rows[: len(order)]) / np.sqrt(
            remainder[pivot]
        )
        remainder = remainder - rows[len(order)] ** 2
        remainder[pivot] = 0.0
        order.append(pivot)
    return np.array(order, dtype=np.int64)


def _largest(remainder: np.ndarray) -> int:
    """The largest; of those that are equal but for round-off, the first."""
    return int(np.flatnonzero(remainder >= (1 - EQUAL_SHARE) * remainder.max())[0])
