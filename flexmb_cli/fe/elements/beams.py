"""Straight beams with shear: stiffness and consistent mass of the exact static interpolation.

Przemieniecki, Theory of Matrix Structural Analysis (1968), sections 5.6 and 11.6: a beam that is loaded at
its ends has cubic deflections and quadratic rotations, with Φ = 12 E I / (k A G L²), which give K and, with
the rotary inertia of sections, M.  Both are exact for Guyan's reduction of any finer mesh.
"""

import numpy as np

from ..formats.beam_elements import BeamTable

# Degrees of freedom of the ends: bending in the planes of x y and x z, whose rotations are about z and -y.
_PLANES = (([1, 5, 7, 11], [1.0, 1.0, 1.0, 1.0]), ([2, 4, 8, 10], [1.0, -1.0, 1.0, -1.0]))


def beam_matrices(
    beams: BeamTable, positions: np.ndarray, elastic: tuple[float, float, float], letter: str
) -> np.ndarray:
    """Return M or K (`letter`), (m, 12, 12), in the axes of the nodes at `positions` (n, 3), m.

    `elastic`: Young's modulus, Pa, Poisson's ratio, density, kg/m³.
    """
    matrices = np.empty((len(beams.rows), 12, 12))
    for k, (rows, upward, section) in enumerate(zip(beams.rows, beams.upwards, beams.sections, strict=True)):
        along = positions[rows[1]] - positions[rows[0]]
        local = (_stiffness if letter == "K" else _mass)(float(np.linalg.norm(along)), section, elastic)
        turn = np.kron(np.eye(4), _axes(along, upward))
        matrices[k] = turn.T @ local @ turn
    return matrices


def _axes(along: np.ndarray, upward: np.ndarray) -> np.ndarray:
    """Return x, y, z of the beam in rows (3, 3)."""
    x = along / np.linalg.norm(along)
    z = np.cross(x, upward)
    z /= np.linalg.norm(z)
    return np.array([x, np.cross(z, x), z])


def _stiffness(length: float, section: np.ndarray, elastic: tuple[float, float, float]) -> np.ndarray:
    """Return K (12, 12) in the axes of the beam."""
    E, G = elastic[0], _shear_modulus(elastic)
    K = np.zeros((12, 12))
    for first, stiffness in ((0, E * section[0]), (3, G * section[3])):
        K[np.ix_([first, first + 6], [first, first + 6])] = stiffness / length * np.array([[1, -1], [-1, 1]])
    for (rows, signs), inertia, shear in zip(_PLANES, section[1:3], section[5:7], strict=True):
        weights, _, _, curvature, slip = _interpolation(length, E * inertia, shear * G)
        block = E * inertia * np.einsum("p,pa,pb->ab", weights, curvature, curvature)
        block += shear * G * np.einsum("p,pa,pb->ab", weights, slip, slip)
        K[np.ix_(rows, rows)] = np.outer(signs, signs) * block
    return K


def _mass(length: float, section: np.ndarray, elastic: tuple[float, float, float]) -> np.ndarray:
    """Return M (12, 12) in the axes of the beam."""
    E, G, density = elastic[0], _shear_modulus(elastic), elastic[2]
    line, polar = density * section[0] + section[4], density * (section[1] + section[2])
    M = np.zeros((12, 12))
    for first, mass in ((0, line), (3, polar)):
        M[np.ix_([first, first + 6], [first, first + 6])] = mass * length / 6.0 * np.array([[2, 1], [1, 2]])
    for (rows, signs), inertia, shear in zip(_PLANES, section[1:3], section[5:7], strict=True):
        weights, deflection, rotation, _, _ = _interpolation(length, E * inertia, shear * G)
        block = line * np.einsum("p,pa,pb->ab", weights, deflection, deflection)
        block += density * inertia * np.einsum("p,pa,pb->ab", weights, rotation, rotation)
        M[np.ix_(rows, rows)] = np.outer(signs, signs) * block
    return M


def _shear_modulus(elastic: tuple[float, float, float]) -> float:
    return elastic[0] / (2.0 * (1.0 + elastic[1]))


def _interpolation(length: float, bending: float, shearing: float) -> tuple[np.ndarray, ...]:
    """Return weights (p,) and values (p, 4) per deflection and rotation of both ends at points of the beam.

    Values: deflection, rotation, curvature, shear strain.  `bending` E I; `shearing` k A G, 0 for no shear.
    """
    x, weights = np.polynomial.legendre.leggauss(4)
    s, L = (1.0 + x) / 2.0, length
    ratio = 12.0 * bending / (shearing * L**2) if shearing else 0.0
    deflection = [
        1 - 3 * s**2 + 2 * s**3 + ratio * (1 - s),
        L * (s - 2 * s**2 + s**3 + ratio / 2 * (s - s**2)),
        3 * s**2 - 2 * s**3 + ratio * s,
        L * (s**3 - s**2 + ratio / 2 * (s**2 - s)),
    ]
    bend = 6 * (s**2 - s) / L
    rotation = [bend, 1 - 4 * s + 3 * s**2 + ratio * (1 - s), -bend, 3 * s**2 - 2 * s + ratio * s]
    kink = (12 * s - 6) / L**2
    curvature = [kink, (6 * s - 4 - ratio) / L, -kink, (6 * s - 2 + ratio) / L]
    slip = -ratio / 2 * np.array([2 / L, 1, -2 / L, 1]) * np.ones((4, 1))
    columns = (np.column_stack(values) / (1 + ratio) for values in (deflection, rotation, curvature))
    return weights * L / 2, *columns, slip / (1 + ratio)
