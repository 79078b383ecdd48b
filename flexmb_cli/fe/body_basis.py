"""The basis that a deck asks for: eigenmodes, attachment modes or Craig-Bampton, with faults at the cards.

Eigenmodes and static shapes are made independent in strain energy.  K measures independence, not the mass
matrix: static shapes of neighbouring nodes differ by what hardly moves any mass, and that difference is the
local deformation under a load at either.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleInput
from . import modes
from .input_checks import COLLINEAR
from .linear_algebra import distinct
from .massless_shapes import NO_STRAIN, FreeMotion, IndefiniteMass, NegativeStrain
from .reference_frame import Frame, static_shapes, unit_forces

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
    independent, orthogonal = _independent(shapes, forces, first)
    mass = orthogonal.T @ (S @ orthogonal)
    inverse, mixing = np.linalg.eigh((mass + mass.T) / 2)
    # Ascending 1/ω² would begin with the highest frequency.
    inverse, modes = inverse[::-1], orthogonal @ mixing[:, ::-1]
    heavy = inverse > ROUND_OFF_MASS * inverse.max(initial=0.0)
    if not heavy.any():
        raise IndefiniteMass
    values = 1.0 / np.where(heavy, inverse, inverse[heavy][-1])
    return ReducedBasis(values, modes * np.sqrt(values), independent, int(np.count_nonzero(~heavy)))


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
    return (gram + gram.T) / 2


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


# J2 has 9 N² numbers, and copies while it is made: a run with so many shapes takes 1.1 GB, seconds a step.
LARGEST_BASIS = 1500
_AXES = ("e1", "e2", "e3")
_COMPONENTS = ("modal", *_AXES, *(f"about {axis}" for axis in _AXES))


@dataclass(frozen=True)
class Basis:
    """Eigenvalues ω² (N,), rad²/s², and shapes (3 n, N); the last `massless` of them have no mass.

    `superfluous`: nodes and directions of the static shapes that are not in it; `left_out`: how many
    eigenmodes it is short of all; `next_value`: ω² of the first that was not requested, nan when it is not
    known.
    """

    values: np.ndarray
    shapes: np.ndarray
    massless: int
    superfluous: tuple[tuple[int, str], ...]
    left_out: int
    next_value: float


def basis_of(
    given: FlexibleInput, K: np.ndarray, S: np.ndarray, frame: Frame, findings: Findings
) -> Basis | None:
    """Return the basis for stiffness `K` and mass `S` (3 n, 3 n), body axes; None with a fault found."""
    available = K.shape[0] - (6 if frame.mean else len(frame.held))
    if not _check_count(given, frame, available, findings):
        return None
    try:
        if given.interface:
            return _interface_basis(given, K, S, frame)
        return _eigen_basis(given, K, S, frame, available)
    except NegativeStrain as motion:
        message = _negative_strain(given, frame, motion.shape)
        findings.error(given.name, message, given.stiffness.place, id="FE-001")
    except FreeMotion as motion:
        place = given.place if _clamped_on_a_line(given) else given.stiffness.place
        findings.error(given.name, _free_motion(given, frame, motion.shape), place, id="FE-002")
    except IndefiniteMass:
        message = "the mass matrix is not positive definite; is it complete, or of another model?"
        findings.error(given.name, message, given.mass.place, id="FE-003")
    except modes.TooFewMasses as masses:
        findings.error(given.name, _too_few_masses(given, masses.count), given.place, id="FE-004")
    return None


def _check_count(given: FlexibleInput, frame: Frame, available: int, findings: Findings) -> bool:
    if given.modes > available:
        message = f"{given.modes} modes are requested, and the body has {available}; 0 takes all"
        findings.error(given.name, message, given.place, id="FE-005")
        return False
    count = given.modes or (0 if given.interface else available)
    count += len(_rows_of(given, frame, (*given.attachment, *given.interface)))
    if count > LARGEST_BASIS:
        message = (
            f"{count} shapes are more than the {LARGEST_BASIS} that can be kept, since inertia takes "
            f"9 numbers for every two of them ({72e-9 * count**2:.2g} GB); ask for fewer modes, and for "
            "static shapes (ATTM) of the loaded nodes only"
        )
        findings.error(given.name, message, given.place, id="FE-006")
        return False
    return True


def _largest_at(given: FlexibleInput, frame: Frame, shape: np.ndarray) -> int:
    """Return the node, or modal row, that a shape moves most."""
    row = int(np.argmax(np.abs(shape)))
    return int(given.numbers[row // 3] if frame.labels is None else frame.labels[row, 0])


def _negative_strain(given: FlexibleInput, frame: Frame, shape: np.ndarray) -> str:
    node = _largest_at(given, frame, shape)
    return (
        f"the stiffness is not positive semidefinite: a deformation, largest at node {node}, gives "
        "energy away; is it a tangent stiffness beyond buckling, or spoilt on its way?"
    )


def _free_motion(given: FlexibleInput, frame: Frame, shape: np.ndarray) -> str:
    node = _largest_at(given, frame, shape)
    if given.interface:
        return (
            "the interface nodes do not hold the body: three that are not on one line are needed "
            f"(it moves most at node {node})"
        )
    if _clamped_on_a_line(given):
        return (
            "the clamped nodes do not hold the body in its frame: three that are not on one line are needed "
            f"(it moves most at node {node})"
        )
    return (
        f"held in its frame the body still moves without strain, most at node {node}: is the mesh in one "
        "piece, without hinges, and, of elements with reduced integration (C3D20R), with two or more across?"
    )


def _too_few_masses(given: FlexibleInput, count: int) -> str:
    remedy = "ask for fewer modes"
    if not given.interface:
        remedy += "; 0 takes all, and those without mass as static shapes"
    return (
        f"{given.modes} modes are requested, and only {count} shapes have mass "
        f"(reduced integration?); {remedy}"
    )


def _clamped_on_a_line(given: FlexibleInput) -> bool:
    """Return whether the body is held by clamped nodes that leave it a rotation."""
    if not given.clamped:
        return False
    held = given.positions[np.isin(given.numbers, given.clamped)]
    spread = np.linalg.svd(held - held.mean(axis=0), compute_uv=False)
    return len(held) < 3 or spread[1] <= COLLINEAR * spread[0]


def _rows_of(given: FlexibleInput, frame: Frame, nodes: tuple[int, ...]) -> np.ndarray:
    if frame.labels is not None:
        return np.flatnonzero(np.isin(frame.labels[:, 0], nodes) & (frame.labels[:, 1] > 0))
    first = np.array([3 * int(np.flatnonzero(given.numbers == node)[0]) for node in nodes], dtype=np.int64)
    return distinct(first[:, None] + np.arange(3))


def _eigen_basis(given: FlexibleInput, K: np.ndarray, S: np.ndarray, frame: Frame, available: int) -> Basis:
    """One mode more than asked for is computed, so that the first dropped frequency can be reported."""
    values, shapes = modes.eigenmodes(K, S, frame, min((given.modes or available) + 1, available))
    if len(values) < given.modes:
        raise modes.TooFewMasses(len(values))
    count, massless = given.modes or len(values), 0
    following = float(values[count]) if len(values) > count else math.nan
    values, shapes = values[:count], shapes[:, :count]
    if not given.modes and count < available:
        static = modes.massless_modes(K, S, frame)
        massless = static.shape[1]
        shapes = np.hstack([shapes, static * math.sqrt(values[-1])])
        values = np.append(values, np.full(massless, values[-1]))
    basis = Basis(values, shapes, massless, (), available - count - massless, following)
    return _with_attachment(given, K, S, frame, basis) if given.attachment else basis


def _with_attachment(given: FlexibleInput, K: Any, S: Any, frame: Frame, basis: Basis) -> Basis:
    """The eigenmodes and the static shapes under forces at the nodes of the deck."""
    rows = _rows_of(given, frame, given.attachment)
    moving = np.setdiff1d(rows, frame.held)
    attached = unit_forces(K.shape[0], moving)
    shapes = np.hstack([basis.shapes, static_shapes(K, S, frame, attached)])
    forces, count = np.hstack([K @ basis.shapes, attached]), len(basis.values)
    solved = reduced_basis(shapes, forces, S, count)
    superfluous = np.setdiff1d(rows, moving[solved.kept[solved.kept >= count] - count])
    # Every static shape brings in a deformation of the modes not requested: those of all nodes bring in all.
    left_out = max(count + basis.left_out - len(solved.values), 0)
    following = basis.next_value if left_out else math.nan
    shapes = modes.signed(solved.shapes)
    return Basis(
        solved.values, shapes, solved.massless, _named(given, frame, superfluous), left_out, following
    )


def _interface_basis(given: FlexibleInput, K: np.ndarray, S: np.ndarray, frame: Frame) -> Basis:
    rows, count = modes.interface_rows(frame, _rows_of(given, frame, given.interface)), given.modes
    reduced = reduced_basis(*modes.craig_bampton(K, S, frame, rows, count), S, count)
    superfluous = np.setdiff1d(rows, rows[reduced.kept[reduced.kept >= count] - count])
    inner = K.shape[0] - len(rows)
    shapes, named = modes.signed(reduced.shapes), _named(given, frame, superfluous)
    return Basis(reduced.values, shapes, reduced.massless, named, inner - count, math.nan)


def _named(given: FlexibleInput, frame: Frame, rows: np.ndarray) -> tuple[tuple[int, str], ...]:
    """Node and axis of the body frame of degrees of freedom `rows`."""
    if frame.labels is not None:
        return tuple((int(node), _COMPONENTS[component]) for node, component in frame.labels[rows])
    return tuple((int(given.numbers[row // 3]), _AXES[row % 3]) for row in rows)
