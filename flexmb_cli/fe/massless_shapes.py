"""Motions without strain and shapes without mass: what a body that is held must not have, and what it may.

Shapes without mass move at no finite frequency and follow the loads as in statics.  Reduced integration
(C3D20R, C3D10, C3D4 of CalculiX) leaves mass matrices that are only semidefinite.  Such shapes z have
S z = 0: inertia does not see them, and K alone decides how concentrated forces bend them.

A shape z that moves the nodes of the frame is, in this frame, a deformation d = z - R a, which has mass.
But the body can move by d and R a at once: the Schur complement of Mff in the body's mass matrix is singular.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

# A shape whose strain energy is less than this share of its terms' sum is free of strain.
NO_STRAIN = 2e-15
# Share below zero that is more than round-off.
NEGATIVE = 1e-9


class FreeMotion(Exception):
    """The body can move without strain although its frame holds it; `shape` (3 n,) shows how."""

    def __init__(self, shape: np.ndarray):
        super().__init__("free motion")
        self.shape = shape


class NegativeStrain(FreeMotion):
    """The stiffness gives energy away in the deformation `shape`: it is not positive semidefinite."""


def check_strain(K: np.ndarray, shape: np.ndarray) -> None:
    """Compare the strain energy of `shape` (3 n,) with the sum of its terms.

    Raises NegativeStrain and FreeMotion.
    """
    terms, energy = np.abs(shape) @ (abs(K) @ np.abs(shape)), shape @ (K @ shape)
    if energy < -NEGATIVE * terms:
        raise NegativeStrain(shape)
    if not energy > NO_STRAIN * terms:
        raise FreeMotion(shape)


# Eigenvalues of the mass matrix below this share of the largest are those of shapes without mass.
MASSLESS_SHAPE = 1e-10


class IndefiniteMass(Exception):
    """The mass matrix has negative eigenvalues."""


@dataclass(frozen=True)
class MassSplit:
    """Eigenvectors of a mass matrix: `heavy` (size, rank) with the `masses` (rank,), and `light` ones."""

    heavy: np.ndarray
    masses: np.ndarray
    light: np.ndarray

    @property
    def factor(self) -> np.ndarray:
        """F (size, rank) with F F' = S and orthogonal columns."""
        return self.heavy * np.sqrt(self.masses)


def split_by_mass(S: np.ndarray) -> MassSplit:
    """Part the shapes of S (size, size) into those with and those without mass.  Raises IndefiniteMass."""
    return _split(np.ascontiguousarray(S, float).tobytes(), len(S))


@lru_cache(maxsize=1)
def _split(numbers: bytes, size: int) -> MassSplit:
    """As `split_by_mass`: a body's modes and the limit of its effective masses part the same matrix."""
    values, vectors = np.linalg.eigh(np.frombuffer(numbers).reshape(size, size))
    if values[0] < -MASSLESS_SHAPE * values[-1]:
        raise IndefiniteMass
    heavy = values > MASSLESS_SHAPE * values[-1]
    return MassSplit(vectors[:, heavy], values[heavy], vectors[:, ~heavy])


def quasi_static_shapes(K: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Shapes (size, k) that span `light` (size, k), of unit strain energy φ' K φ, none coupled by K.

    Raises FreeMotion for one that K does not resist either.
    """
    if not light.shape[1]:
        return light
    stiffness = light.T @ (K @ light)
    values, vectors = np.linalg.eigh((stiffness + stiffness.T) / 2)
    shapes = light @ vectors
    check_strain(K, shapes[:, 0])
    return shapes / np.sqrt(values)


def massless_in_motion(S: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Amplitudes (N, k), orthonormal, of the modes that have no mass once the body moves against them.

    `moved` (3 n, N): modes of unit modal mass less the rigid motion that has their momentum; `S` (3 n, 3 n).
    """
    left = moved.T @ (S @ moved)
    shares, amplitudes = np.linalg.eigh((left + left.T) / 2)
    return amplitudes[:, shares < MASSLESS_SHAPE]


def static_mass(values: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Modal mass (N, N) that puts the deformations `light` (N, k) at the highest of the eigenvalues `values`.

    It works on the share that a deformation has in `light`, as K measures shares, and on nothing else.
    """
    forces = values[:, None] * light
    return forces @ np.linalg.solve(light.T @ forces, forces.T) / values[-1]
