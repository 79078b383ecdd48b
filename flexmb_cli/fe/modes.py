"""Shapes of a body in its frame: eigenmodes of (104), shapes without mass, Craig-Bampton.

Eigenmodes: Vlasenko and Kasper (2008), (104).  Interface and fixed-interface modes: Craig and Bampton, AIAA
Journal 6 (1968), 1313-1319.  All shapes are (3 n, k), x y z node by node, body axes.
"""

import numpy as np

from .linear_algebra import all_but, as_array, is_small, lowest_by_iteration, pencil
from .massless_shapes import NEGATIVE, FreeMotion, check_strain, quasi_static_shapes, split_by_mass
from .reference_frame import Frame, FreeBody, held_solver

# Share of the sum of its terms below which a force is round-off: of a hundred degrees of freedom 1e-14, more
# or less by processor and LAPACK.  Scaled to unit strain energy, such a force would be a wrong mode.
ROUND_OFF_FORCE = 1e-12


class TooFewMasses(Exception):
    """Only `count` shapes have mass, fewer than the modes wanted."""

    def __init__(self, count: int):
        super().__init__("too few masses")
        self.count = count


def eigenmodes(K: np.ndarray, S: np.ndarray, frame: Frame, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the `count` lowest eigenvalues (rad²/s²) and modes of unit modal mass that the frame allows.

    They are fewer where fewer shapes have mass.  Raises FreeMotion and IndefiniteMass.
    """
    if frame.mean:
        return _mean_axis_modes(K, S, frame, count)
    free = all_but(K.shape[0], frame.held)
    values, full = _modes_of(K, S, frame, free, count)
    return values, signed(full)


def massless_modes(K: np.ndarray, S: np.ndarray, frame: Frame) -> np.ndarray:
    """Return the shapes (3 n, k) without mass that the frame allows, of unit strain energy φ' K φ.

    With all eigenmodes they span every deformation: z' K φ = ω² z' S φ = 0 keeps both apart.
    """
    free = all_but(K.shape[0], frame.held)
    light = split_by_mass(as_array(S[free][:, free])).light
    shapes = np.zeros((K.shape[0], light.shape[1]))
    shapes[free] = light
    return signed(quasi_static_shapes(K, shapes))


def _modes_of(
    K: np.ndarray, S: np.ndarray, frame: Frame, free: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Modes of the degrees of freedom `free` with all others at rest, as shapes of the whole body."""
    count = min(count, len(free))
    if not count:
        return np.zeros(0), np.zeros((K.shape[0], 0))
    inner, mass = K[free][:, free], S[free][:, free]
    if is_small(len(free), count):
        try:
            values, shapes = _lowest(as_array(inner), as_array(mass), count)
        except FreeMotion as motion:
            raise type(motion)(_placed(motion.shape, free, K.shape[0])) from None
    else:
        values, shapes = lowest_by_iteration(mass, count, held_solver(K, free, frame))
    full = _placed(shapes, free, K.shape[0])
    check_strain(K, full[:, 0])
    return values, full


def _placed(shapes: np.ndarray, free: np.ndarray, size: int) -> np.ndarray:
    """The shapes of the degrees of freedom `free` as those of all."""
    full = np.zeros((size, *shapes.shape[1:]))
    full[free] = shapes
    return full


def _lowest(K: np.ndarray, S: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Lowest eigenvalues and S-orthonormal vectors of small matrices.

    Slender bodies have frequencies far apart: the lowest are found as the largest of the inverse problem.
    """
    split = split_by_mass(S)
    rank = len(split.masses)
    count = min(count, rank)
    if 2 * count <= len(K):
        return _slowest(K, S, count)
    if rank == len(K):
        return pencil(K, S, count)
    # The shapes without mass follow the others as K wants: static condensation, exact here.
    light = quasi_static_shapes(K, split.light)
    following = split.heavy - light @ (light.T @ (K @ split.heavy))
    values, vectors = pencil(following.T @ (K @ following), np.diag(split.masses), count)
    return values, following @ vectors


def _slowest(K: np.ndarray, S: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Few of many: the largest eigenvalues of the inverse problem."""
    try:
        inverse, vectors = pencil(S, K, count, largest=True)
    except np.linalg.LinAlgError:
        lowest = np.linalg.eigh(K)[1][:, 0]
        check_strain(K, lowest)
        raise FreeMotion(lowest) from None
    return 1.0 / inverse[::-1], (vectors / np.sqrt(inverse))[:, ::-1]


def _mean_axis_modes(K: np.ndarray, S: np.ndarray, frame: Frame, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Free modes without the six rigid ones, to which they are S-orthogonal, as mean axes ask."""
    if not count:
        return np.zeros(0), np.zeros((K.shape[0], 0))
    size, body = K.shape[0], FreeBody(K, S, frame)
    if is_small(size, count):
        factor = split_by_mass(as_array(S)).factor
        count = min(count, factor.shape[1] - 6)
        flexibility = factor.T @ body.shapes(factor)
        inverse, vectors = np.linalg.eigh((flexibility + flexibility.T) / 2)
        if inverse[0] < -NEGATIVE * inverse[-1]:
            check_strain(K, body.shapes(factor @ vectors[:, 0]))
        last = slice(None, -count - 1, -1)
        values = 1.0 / inverse[last]
        shapes = body.shapes(factor @ vectors[:, last]) * values
    else:
        values, shapes = lowest_by_iteration(S, count, body.shapes)
    check_strain(K, shapes[:, 0])
    shapes = frame.shifted(shapes, S)
    return values, signed(shapes / np.sqrt(np.einsum("ij,ij->j", shapes, S @ shapes)))


def interface_rows(frame: Frame, rows: np.ndarray) -> np.ndarray:
    """Return those of the degrees of freedom `rows` of interface nodes that no clamp holds."""
    return np.setdiff1d(rows, _clamped(frame))


def _clamped(frame: Frame) -> np.ndarray:
    return frame.held if frame.clamped else np.arange(0)


def craig_bampton(
    K: np.ndarray, S: np.ndarray, frame: Frame, rows: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return `count` fixed-interface eigenmodes, then the interface modes of the degrees of freedom `rows`;
    the forces.

    The rigid motion in the interface modes is taken out, which leaves six of them dependent; the forces
    that K answers them with are at the interface.  Raises FreeMotion, IndefiniteMass, and TooFewMasses.
    """
    inner = all_but(K.shape[0], np.concatenate([rows, _clamped(frame)]))
    shapes, forces = np.zeros((2, K.shape[0], len(rows)))
    shapes[rows, np.arange(len(rows))] = 1.0
    shapes[inner] = -held_solver(K, inner, frame)(as_array(K[inner][:, rows]))
    forces[rows] = _without_round_off(K[rows], shapes)
    values, fixed = _modes_of(K, S, frame, inner, count)
    if len(values) < count:
        raise TooFewMasses(len(values))
    return frame.shifted(np.hstack([fixed, shapes]), S), np.hstack([K @ fixed, forces])


def _without_round_off(K: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """K @ `shapes` with zeros where only round-off is left, as in rigid motion."""
    forces, terms = K @ shapes, abs(K) @ np.abs(shapes)
    return np.where(np.abs(forces) > ROUND_OFF_FORCE * terms, forces, 0.0)


def signed(shapes: np.ndarray) -> np.ndarray:
    """The shapes with the largest component of each positive, so that every machine has the same."""
    if not shapes.size:
        return shapes
    # Components equal up to round-off must not decide by their last digits: the first of them does.
    large = np.abs(shapes) >= (1 - 1e-6) * np.abs(shapes).max(axis=0)
    first = np.argmax(large, axis=0)
    return shapes * np.where(shapes[first, np.arange(shapes.shape[1])] < 0, -1.0, 1.0)
