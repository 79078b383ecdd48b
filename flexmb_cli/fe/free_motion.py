"""Motions without strain, and strain without energy: what a body that is held must not have."""

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
