"""Shapes of a body in its frame: eigenmodes of (104), attachment modes, Craig-Bampton.

Eigenmodes: Vlasenko and Kasper (2008), (104).  Interface and fixed-interface modes: Craig and Bampton, AIAA
Journal 6 (1968), 1313-1319.  All shapes are (3 n, k), x y z node by node, body axes.
"""

import numpy as np

from . import linear_algebra
from .input_tests import rigid_motions
from .linear_algebra import Singular, as_array, lowest_by_iteration, pencil, solver
from .reference_frame import Frame

# Shapes whose part independent of the others has less than this share of their square are dropped.
DEPENDENT = 1e-10
# Eigenvalues of the mass matrix below this share of the largest are those of shapes without mass.
MASSLESS = 1e-10
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


class IndefiniteMass(Exception):
    """The mass matrix has negative eigenvalues."""


class TooFewMasses(Exception):
    """Only `count` shapes have mass, fewer than the modes wanted."""

    def __init__(self, count: int):
        super().__init__("too few masses")
        self.count = count


def eigenmodes(K, S, frame: Frame, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The `count` lowest eigenvalues (rad²/s²) and modes of unit modal mass that the frame allows.

    They are fewer where fewer shapes have mass.  Raises FreeMotion and IndefiniteMass.
    """
    if frame.mean:
        return _mean_axis_modes(K, S, frame, count)
    free = np.setdiff1d(np.arange(K.shape[0]), frame.held)
    values, full = _modes_of(K, S, free, count)
    return values, signed(full)


def _modes_of(K, S, free, count):
    """Modes of the freedoms `free` with all others at rest, as shapes of the whole body."""
    count = min(count, len(free))
    if not count:
        return np.zeros(0), np.zeros((K.shape[0], 0))
    values, shapes = _lowest(K[free][:, free], S[free][:, free], count)
    full = np.zeros((K.shape[0], len(values)))
    full[free] = shapes
    _check_strain(K, full[:, 0])
    return values, full


def _check_strain(K, shape):
    """Whether the lowest mode has a strain energy, measured against that of its terms one by one."""
    terms, energy = np.abs(shape) @ (abs(K) @ np.abs(shape)), shape @ (K @ shape)
    if energy < -NEGATIVE * terms:
        raise NegativeStrain(shape)
    if not energy > NO_STRAIN * terms:
        raise FreeMotion(shape)


def _lowest(K, S, count):
    """Lowest eigenvalues and S-orthonormal vectors.

    Slender bodies have frequencies far apart: the lowest are found as the largest of the inverse problem.
    """
    size = K.shape[0]
    if _is_small(size, count):
        return _lowest_at_once(as_array(K), as_array(S), count)
    try:
        solve = solver(K)
    except Singular:
        raise FreeMotion(np.zeros(size)) from None
    return lowest_by_iteration(K, S, count, solve, np.ones(size))


def _is_small(size, count):
    """Whether all eigenvectors at once are to be found; few are found faster by iteration."""
    return size <= linear_algebra.DENSE or count > size // 3


def _lowest_at_once(K, S, count):
    size, rank = len(K), factor_of_mass(S).shape[1]
    count = min(count, rank)
    try:
        if 2 * count > size and rank == size:
            return pencil(K, S, count)
        inverse, vectors = pencil(S, K, count, largest=True)
    except np.linalg.LinAlgError:
        lowest = np.linalg.eigh(K)[1][:, 0]
        _check_strain(K, lowest)
        raise FreeMotion(lowest) from None
    return 1.0 / inverse[::-1], (vectors / np.sqrt(inverse))[:, ::-1]


def factor_of_mass(S: np.ndarray) -> np.ndarray:
    """F (size, rank) with F F' = S and orthogonal columns.

    Reduced integration (C3D20R) leaves shapes without mass, which move at no finite frequency.
    Raises IndefiniteMass.
    """
    values, vectors = np.linalg.eigh(S)
    if values[0] < -MASSLESS * values[-1]:
        raise IndefiniteMass
    heavy = values > MASSLESS * values[-1]
    return vectors[:, heavy] * np.sqrt(values[heavy])


class _FreeBody:
    """Static shapes of a body that nothing holds: forces are balanced by the acceleration they cause."""

    def __init__(self, K, S, frame: Frame):
        self.S, self.frame = S, frame
        self._free = np.setdiff1d(np.arange(K.shape[0]), _supports(frame.r0))
        self._solve = _solver(K, self._free)
        self._rigid = rigid_motions(frame.r0)
        self._weighted = S @ self._rigid
        self._mass = self._rigid.T @ self._weighted

    def shapes(self, forces: np.ndarray) -> np.ndarray:
        """Displacements in mean axes under `forces`, both (3 n, k) or (3 n,)."""
        balanced = forces - self._weighted @ np.linalg.solve(self._mass, self._rigid.T @ forces)
        shapes = np.zeros(forces.shape)
        shapes[self._free] = self._solve(balanced[self._free])
        return self.frame.shifted(shapes, self.S)


def _mean_axis_modes(K, S, frame, count):
    """Free modes without the six rigid ones, to which they are S-orthogonal, as mean axes ask."""
    if not count:
        return np.zeros(0), np.zeros((K.shape[0], 0))
    size, body = K.shape[0], _FreeBody(K, S, frame)
    if _is_small(size, count):
        factor = factor_of_mass(as_array(S))
        count = min(count, factor.shape[1] - 6)
        flexibility = factor.T @ body.shapes(factor)
        inverse, vectors = np.linalg.eigh((flexibility + flexibility.T) / 2)
        if inverse[0] < -NEGATIVE * inverse[-1]:
            _check_strain(K, body.shapes(factor @ vectors[:, 0]))
        last = slice(None, -count - 1, -1)
        values = 1.0 / inverse[last]
        shapes = body.shapes(factor @ vectors[:, last]) * values
    else:
        start = body.shapes(np.arange(size, dtype=float))
        values, shapes = lowest_by_iteration(K, S, count, body.shapes, start)
    _check_strain(K, shapes[:, 0])
    shapes = frame.shifted(shapes, S)
    return values, signed(shapes / np.sqrt(np.einsum("ij,ij->j", shapes, S @ shapes)))


def attachment_modes(K, S, frame: Frame, rows: np.ndarray) -> np.ndarray:
    """Static shapes under a unit force in each of the freedoms `rows`, (3 n, k)."""
    rows = np.setdiff1d(rows, frame.held)
    forces = np.zeros((K.shape[0], len(rows)))
    forces[rows, np.arange(len(rows))] = 1.0
    return static_shapes(K, S, frame, forces)


def static_shapes(K, S, frame: Frame, forces: np.ndarray) -> np.ndarray:
    """Displacements (3 n, k) of the body held in its frame under `forces` (3 n, k).

    In mean axes it is free, and the forces are balanced by those of the rigid acceleration they cause.
    """
    if frame.mean:
        return _FreeBody(K, S, frame).shapes(forces)
    free = np.setdiff1d(np.arange(K.shape[0]), frame.held)
    shapes = np.zeros(forces.shape)
    shapes[free] = _solver(K, free)(forces[free])
    return shapes


def _supports(r0):
    """Six rows that hold the body: a node, one far from it, and one far from their line."""
    first = int(np.argmax(np.linalg.norm(r0 - r0.mean(axis=0), axis=1)))
    arms = r0 - r0[first]
    second = int(np.argmax(np.linalg.norm(arms, axis=1)))
    third = int(np.argmax(np.linalg.norm(np.cross(arms, arms[second]), axis=1)))
    normal = np.cross(arms[second], arms[third])
    along = int(np.argmax(np.abs(arms[second])))
    others = [axis for axis in range(3) if axis != along]
    last = max(others, key=lambda axis: abs(normal[axis]))
    rows = [
        3 * first,
        3 * first + 1,
        3 * first + 2,
        *(3 * second + axis for axis in others),
        3 * third + last,
    ]
    return np.array(rows)


def _solver(K, free):
    """The solution of K x = b with all freedoms but `free` at rest, as a function of b.

    Raises FreeMotion, then or at once: whether a pivot of exactly 0 is met depends on the processor.
    """

    def solve(b):
        try:
            return solution(b)
        except Singular:
            raise FreeMotion(_weakest(K, free)) from None

    try:
        solution = solver(K[free][:, free])
    except Singular:
        raise FreeMotion(_weakest(K, free)) from None
    return solve


def _weakest(K, free):
    """The shape of the freedoms `free` with the least strain energy; 0 where finding it takes too long."""
    shape = np.zeros(K.shape[0])
    if _is_small(len(free), 1):
        shape[free] = np.linalg.eigh(as_array(K[free][:, free]))[1][:, 0]
    return shape


def craig_bampton(K, S, frame: Frame, rows: np.ndarray, count: int) -> np.ndarray:
    """Interface modes of the freedoms `rows` and `count` fixed-interface eigenmodes, in the body frame.

    The rigid motion in the interface modes is taken out, which leaves six of them dependent.  Raises
    FreeMotion, IndefiniteMass, and TooFewMasses.
    """
    clamped = frame.held if frame.clamped else np.arange(0)
    interface = np.setdiff1d(rows, clamped)
    inner = np.setdiff1d(np.arange(K.shape[0]), np.union1d(interface, clamped))
    shapes = np.zeros((K.shape[0], len(interface)))
    shapes[interface, np.arange(len(interface))] = 1.0
    shapes[inner] = -_solver(K, inner)(as_array(K[inner][:, interface]))
    values, fixed = _modes_of(K, S, inner, count)
    if len(values) < count:
        raise TooFewMasses(len(values))
    return frame.shifted(np.hstack([shapes, fixed]), S)


def orthonormal(shapes: np.ndarray, K, S) -> tuple[np.ndarray, np.ndarray, int]:
    """Eigenvalues and modes of unit mass that span `shapes`, and how many dependent shapes were dropped."""
    mass = shapes.T @ (S @ shapes)
    norms = np.sqrt(np.maximum(np.diag(mass), 0.0))
    kept = norms > 1e-9 * norms.max(initial=0.0)
    scaled = shapes[:, kept] / norms[kept]
    sizes, directions = np.linalg.eigh(scaled.T @ (S @ scaled))
    independent = sizes > DEPENDENT
    basis = scaled @ (directions[:, independent] / np.sqrt(sizes[independent]))
    values, mixed = pencil(basis.T @ (K @ basis), basis.T @ (S @ basis), basis.shape[1])
    return values, signed(basis @ mixed), shapes.shape[1] - len(values)


def signed(shapes: np.ndarray) -> np.ndarray:
    """The shapes with the largest component of each positive, so that every machine has the same."""
    if not shapes.size:
        return shapes
    # Components equal up to round-off must not decide by their last digits: the first of them does.
    large = np.abs(shapes) >= (1 - 1e-6) * np.abs(shapes).max(axis=0)
    first = np.argmax(large, axis=0)
    return shapes * np.where(shapes[first, np.arange(shapes.shape[1])] < 0, -1.0, 1.0)
