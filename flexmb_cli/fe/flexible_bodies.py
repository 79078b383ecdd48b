"""Files of a finite-element program to a flexible body: read, tested, reduced, cached."""

import math
from dataclasses import dataclass

import numpy as np

from ..errors import Fault, ModelError
from ..model.findings import Findings
from ..model.flexible_body import Dropped, FEFile, FlexibleBody, FlexibleInput
from ..read.fe_files.formats import read_matrix
from ..read.fe_files.matrix_file import FEFileFault
from . import cache, modes
from .centrifugal import centrifugal_stiffness
from .input_tests import COLLINEAR, Figures, check_matrices, check_reference, rigid_motions, scalar_mass
from .invariants import effective_masses, inertia_invariants
from .linear_algebra import Matrix, in_three_directions, of_mass, turned
from .nodal_matrices import condensed, nodal_part
from .reference_frame import Frame, reference_frame

# J2 has 9 N² numbers and C1 3 N².
LARGEST_BASIS = 600


def flexible_body(given: FlexibleInput, cached: bool = True) -> tuple[FlexibleBody, list[Fault]]:
    """The body that `given` describes, and what was doubtful about its files.

    Raises ModelError with every fault found, at the cards of the files.
    """
    found = cache.load(given) if cached else None
    if found is not None:
        return found
    findings = Findings()
    body = _built(given, findings)
    if any(fault.severity == "error" for fault in findings.faults):
        raise ModelError(findings.in_order)
    if cached:
        cache.store(given, body, findings.faults)
    return body, findings.in_order


@dataclass(frozen=True)
class _Matrices:
    """Mass and stiffness in body axes (3 n, 3 n), the scalar masses (n, n), what was condensed."""

    S: Matrix
    K: Matrix
    scalar: Matrix
    internal: int


def _built(given, findings) -> FlexibleBody | None:
    S = _read(given, given.mass, "M", nodal_part, findings)
    K = _read(given, given.stiffness, "K", condensed, findings)
    _check_reference_nodes(given, findings)
    if S is None or K is None or findings.faults:
        return None
    figures = check_matrices(given, S.matrix, K.matrix, findings)
    if any(fault.severity == "error" for fault in findings.faults):
        return None
    scalar = scalar_mass(S.matrix)
    weights = np.asarray(scalar.sum(axis=1)).ravel()
    frame = reference_frame(given, weights @ given.positions / weights.sum())
    matrices = _Matrices(in_three_directions(scalar), turned(K.matrix, frame.axes), scalar, K.internal)
    basis = _basis(given, matrices, frame, findings)
    return basis and _body(given, matrices, frame, basis, figures, findings)


def _read(given, file: FEFile, letter, arrange, findings):
    mapping = given.mapping
    try:
        found = read_matrix(
            file.path, file.form, letter, mapping.path if mapping else None, mapping.form if mapping else ""
        )
        return arrange(file.path.name, found, given.numbers)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place)
        return None


def _check_reference_nodes(given, findings):
    if given.reference:
        rows = [int(np.flatnonzero(given.numbers == node)[0]) for node in given.reference]
        check_reference(given, given.positions[rows], findings)


@dataclass(frozen=True)
class _Basis:
    values: np.ndarray
    shapes: np.ndarray
    dependent: int
    dropped: int
    next_value: float


def _basis(given, matrices, frame: Frame, findings) -> _Basis | None:
    K, S = matrices.K, matrices.S
    available = K.shape[0] - (6 if frame.mean else len(frame.held))
    if not _check_count(given, available, findings):
        return None
    try:
        if given.interface:
            return _interface_basis(given, K, S, frame)
        return _eigen_basis(given, K, S, frame, available)
    except modes.NegativeStrain as motion:
        node = given.numbers[int(np.argmax(np.abs(motion.shape))) // 3]
        message = (
            f"the stiffness is not positive semidefinite: a deformation, largest at node {node}, gives "
            "energy away; is it a tangent stiffness beyond buckling, or spoilt on its way?"
        )
        findings.error(given.name, message, given.stiffness.place)
    except modes.FreeMotion as motion:
        place = given.place if _clamped_on_a_line(given) else given.stiffness.place
        findings.error(given.name, _free_motion(given, motion.shape), place)
    except modes.IndefiniteMass:
        message = "the mass matrix is not positive definite; is it complete, or of another model?"
        findings.error(given.name, message, given.mass.place)
    except modes.TooFewMasses as masses:
        message = (
            f"{given.modes} modes are asked for, and only {masses.count} shapes have mass "
            "(reduced integration?); ask for fewer modes"
        )
        findings.error(given.name, message, given.place)
    return None


def _check_count(given, available, findings):
    if given.modes > available:
        message = f"{given.modes} modes are asked for, and the body has {available}; 0 takes all"
        findings.error(given.name, message, given.place)
        return False
    wanted = given.modes or (0 if given.interface else available)
    wanted += 3 * (len(given.attachment) + len(given.interface))
    if wanted > LARGEST_BASIS:
        message = f"{wanted} shapes are more than the {LARGEST_BASIS} that can be kept; ask for fewer modes"
        findings.error(given.name, message, given.place)
        return False
    return True


def _free_motion(given, shape):
    node = given.numbers[int(np.argmax(np.abs(shape))) // 3]
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
        "piece, without hinges?"
    )


def _clamped_on_a_line(given):
    """Whether the body is held by clamped nodes that leave it a rotation."""
    if not given.clamped:
        return False
    held = given.positions[np.isin(given.numbers, given.clamped)]
    spread = np.linalg.svd(held - held.mean(axis=0), compute_uv=False)
    return len(held) < 3 or spread[1] <= COLLINEAR * spread[0]


def _rows_of(given, nodes):
    first = np.array([3 * int(np.flatnonzero(given.numbers == node)[0]) for node in nodes], dtype=np.int64)
    return np.unique((first[:, None] + np.arange(3)).ravel())


def _eigen_basis(given, K, S, frame, available):
    """One mode more than asked for is computed, so that the first dropped frequency can be told."""
    values, shapes = modes.eigenmodes(K, S, frame, min((given.modes or available) + 1, available))
    if len(values) < given.modes:
        raise modes.TooFewMasses(len(values))
    count = given.modes or len(values)
    following = float(values[count]) if len(values) > count else math.nan
    values, shapes, dependent = values[:count], shapes[:, :count], 0
    if given.attachment:
        added = modes.attachment_modes(K, S, frame, _rows_of(given, given.attachment))
        values, shapes, dependent = modes.orthonormal(np.hstack([shapes, added]), K, S)
    return _Basis(values, shapes, dependent, available - count, following)


def _interface_basis(given, K, S, frame):
    shapes = modes.craig_bampton(K, S, frame, _rows_of(given, given.interface), given.modes)
    total = shapes.shape[1]
    values, shapes, dependent = modes.orthonormal(shapes, K, S)
    inner = K.shape[0] - total + given.modes
    return _Basis(values, shapes, dependent, inner - given.modes, math.nan)


def _body(given, matrices, frame, basis, figures: Figures, findings) -> FlexibleBody:
    Phi, omega = basis.shapes, np.sqrt(np.maximum(basis.values, 0.0))
    invariants = inertia_invariants(frame.r0, Phi, matrices.scalar)
    alpha, beta, ratio = given.damping
    Kr = np.diag(basis.values)
    Dr = alpha * invariants["Mff"] + beta * Kr + np.diag(2.0 * ratio * omega)
    return FlexibleBody(
        given.name,
        given.numbers,
        frame.r0,
        frame.origin,
        frame.axes,
        Phi,
        **invariants,
        Kr=Kr,
        Dr=Dr,
        KG=_geometric(given, matrices, frame, Phi, findings),
        frequencies=omega / math.tau,
        effective_mass=effective_masses(invariants["S1"], invariants["C0"]),
        effective_limit=_effective_limit(matrices.S, frame),
        mass_deviation=figures.mass_deviation,
        rigid_residual=figures.rigid_residual,
        dropped=Dropped(
            matrices.internal, basis.dependent, basis.dropped, math.sqrt(basis.next_value) / math.tau
        ),
    )


def _effective_limit(S, frame):
    """Sums of the effective masses over all modes: R' S R less what only the held freedoms carry."""
    rigid = rigid_motions(frame.r0)
    if frame.mean:
        return np.zeros(6)
    free = np.setdiff1d(np.arange(S.shape[0]), frame.held)
    carried = (S @ rigid)[free]
    inner = S[free][:, free]
    if not isinstance(inner, np.ndarray):
        return np.einsum("ij,ij->j", carried, of_mass(inner, carried))
    # Shapes without mass make the matrix singular; they carry nothing.
    factor = modes.factor_of_mass(inner)
    return np.sum(((factor / np.sum(factor**2, axis=0)).T @ carried) ** 2, axis=0)


def _geometric(given, matrices, frame, Phi, findings):
    """Phi' KG Phi per component of w~ w~ in body axes; the files' unit loads are in those of the table."""
    size = Phi.shape[1]
    if given.bricks:
        return centrifugal_stiffness(given, matrices.K, matrices.S, frame, Phi, findings)
    if not given.unit_loads:
        return np.zeros((0, 0, size, size))
    n = len(given.numbers)
    shapes = np.einsum("ab,nbk->nak", frame.axes, Phi.reshape(n, 3, size)).reshape(3 * n, size)
    reduced = np.zeros((3, 3, size, size))
    for load in given.unit_loads:
        found = _read(given, load.file, "K", nodal_part, findings)
        if found is not None:
            reduced[load.i, load.j] = shapes.T @ (found.matrix @ shapes)
    return np.einsum("ia,jb,ijkl->abkl", frame.axes, frame.axes, reduced)
