"""Files of a finite-element program to a flexible body: read, tested, reduced."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import Dropped, FEFile, FlexibleBody, FlexibleInput
from .body_basis import Basis, basis_of
from .elements.assembled_matrices import element_matrix
from .elements.body_elements import FOREIGN, element_mesh, element_table, foreign_stiffness
from .elements.element_stiffness import initial_stress_matrix, matching_elements
from .elements.stress_shapes import body_stress
from .formats.formats import OF_ELEMENTS, OF_MODES, read_matrix
from .formats.matrix_file import FEFileFault
from .input_checks import check_matrices, check_reference, rigid_motions, scalar_mass
from .invariants import effective_masses, inertia_invariants
from .linear_algebra import Matrix, all_but, in_three_directions, of_mass, turned
from .massless_shapes import massless_in_motion, split_by_mass, static_mass
from .modal_body import modal_body
from .nodal_matrices import NodalMatrix, condensed, nodal_part
from .precision import frequency_errors
from .reference_frame import Frame, as_solved, reference_frame, static_shapes, without_momentum

# A relative error of a frequency that is worth a warning.
DOUBTFUL_FREQUENCY = 1e-3


@dataclass(frozen=True)
class _Matrices:
    """Mass and stiffness in body axes (3 n, 3 n), the scalar masses (n, n), and as the files have them."""

    S: Matrix
    K: Matrix
    scalar: Matrix
    of_mass: NodalMatrix
    of_stiffness: NodalMatrix


def reduced_body(given: FlexibleInput, findings: Findings) -> FlexibleBody | None:
    """Return the body that `given` describes; None where there is none, for the reason in `findings`."""
    if OF_MODES in (given.stiffness.form, given.mass.form):
        return modal_body(given, findings)
    K = _read(given, given.stiffness, "K", condensed, findings)
    # Elements without a stiffness have no mass for the same reason, which is reported once.
    reported = K is None and given.mass.form == given.stiffness.form == OF_ELEMENTS
    arrange = partial(nodal_part, stiffness=K)
    S = None if reported else _read(given, given.mass, "M", arrange, findings)
    if given.axes is not None:
        turned_nodes = given.numbers[(given.axes != np.eye(3)).any(axis=(1, 2))]
        message = f"the displacement of node {turned_nodes[0]} must be in basic axes (CD)"
        findings.error(given.name, message, given.stiffness.place, id="FE-255")
    if given.reference:
        rows = [int(np.flatnonzero(given.numbers == node)[0]) for node in given.reference]
        check_reference(given, given.positions[rows], findings)
    errors = any(fault.severity == "error" for fault in findings.faults)
    if S is None or K is None or errors:
        return None
    figures = check_matrices(given, S.matrix, K.matrix, K.file, findings)
    if any(fault.severity == "error" for fault in findings.faults):
        return None
    scalar = scalar_mass(S.matrix)
    weights = np.asarray(scalar.sum(axis=1)).ravel()
    frame = reference_frame(given, weights @ given.positions / weights.sum())
    matrices = _Matrices(in_three_directions(scalar), turned(K.matrix, frame.axes), scalar, S, K)
    basis = basis_of(given, matrices.K, matrices.S, frame, findings)
    return None if basis is None else _body(given, matrices, frame, basis, figures, findings)


def _read(given: Any, file: FEFile, letter: str, arrange: Callable[..., Any], findings: Findings) -> Any:
    mapping = given.mapping
    try:
        if file.form == OF_ELEMENTS:
            table = element_table(given, given.material.file, given.positions, findings)
            return table and arrange(file.path.name, element_matrix(given, table, letter), given.numbers)
        path, form = (mapping.path, mapping.form) if mapping else (None, "")
        found = read_matrix(file.path, file.form, letter, path, form, file.matrix)
        return arrange(file.path.name, found, given.numbers)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None


def _body(
    given: Any, matrices: Any, frame: Frame, basis: Basis, figures: dict[str, Any], findings: Findings
) -> FlexibleBody:
    Phi, omega = basis.shapes, np.sqrt(np.maximum(basis.values, 0.0))
    invariants: dict[str, Any] = inertia_invariants(frame.r0, Phi, matrices.scalar)
    invariants["Mff"] = _with_massless(invariants["Mff"], basis.massless)
    moving = _massless_in_motion(matrices.S, frame, basis)
    if moving.shape[1]:
        invariants["Mff"] += static_mass(basis.values, moving)
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
        frequency_errors=_errors(given, matrices, frame, basis, findings),
        effective_mass=effective_masses(invariants["S1"], invariants["C0"]),
        effective_limit=_effective_limit(matrices.S, frame),
        **figures,
        massless=basis.massless,
        massless_in_motion=moving.shape[1],
        dropped=Dropped(
            len(matrices.of_stiffness.internal),
            basis.superfluous,
            basis.left_out,
            math.sqrt(basis.next_value) / math.tau,
        ),
        stress=given.material and body_stress(given, matrices.K, invariants["m"], frame, Phi, findings),
        mesh=element_mesh(given),
    )


def _with_massless(Mff: np.ndarray, count: int) -> np.ndarray:
    """`Mff` with a unit mass for each of the last `count` coordinates, whose shapes have none.

    Without it they would have no acceleration.  It couples them to nothing, and puts them at the highest
    frequency of the others, where they follow the loads as the modes there do.
    """
    first = len(Mff) - count
    completed = np.eye(len(Mff))
    completed[:first, :first] = Mff[:first, :first]
    return completed


def _massless_in_motion(S: Matrix, frame: Frame, basis: Basis) -> np.ndarray:
    """Amplitudes (N, k) of the deformations that a rigid motion rids of their mass; none in mean axes."""
    heavy = len(basis.values) - basis.massless
    amplitudes = np.zeros((len(basis.values), 0))
    if not frame.mean and heavy:
        found = massless_in_motion(S, without_momentum(frame.r0, basis.shapes[:, :heavy], S))
        amplitudes = np.zeros((len(basis.values), found.shape[1]))
        amplitudes[:heavy] = found
    return amplitudes


def _effective_limit(S: np.ndarray, frame: Frame) -> np.ndarray:
    """Sums of the effective masses over all modes: R' S R less what only the held degrees of freedom
    carry.
    """
    rigid = rigid_motions(frame.r0)
    if frame.mean:
        return np.zeros(6)
    free = all_but(S.shape[0], frame.held)
    carried = (S @ rigid)[free]
    inner = S[free][:, free]
    if not isinstance(inner, np.ndarray):
        return np.einsum("ij,ij->j", carried, of_mass(inner, carried))
    # Shapes without mass make the matrix singular; they carry nothing.
    split = split_by_mass(inner)
    return np.sum((split.heavy.T @ carried) ** 2 / split.masses[:, None], axis=0)


def _in_axes_of_table(frame: Frame, Phi: np.ndarray) -> np.ndarray:
    n, size = len(frame.r0), Phi.shape[1]
    return np.einsum("ab,nbk->nak", frame.axes, Phi.reshape(n, 3, size)).reshape(3 * n, size)


def _errors(
    given: FlexibleInput, matrices: _Matrices, frame: Frame, basis: Basis, findings: Findings
) -> np.ndarray:
    """Relative errors of the frequencies by the digits of the files; nan for shapes without mass."""
    heavy = len(basis.values) - basis.massless
    errors = np.full(len(basis.values), np.nan)
    shapes = _in_axes_of_table(frame, as_solved(frame, basis.shapes[:, :heavy]))
    parts = frequency_errors(matrices.of_stiffness, matrices.of_mass, shapes, basis.values[:heavy])
    errors[:heavy] = np.hypot(*parts)
    worst = int(np.argmax(errors[:heavy]))
    if errors[worst] > DOUBTFUL_FREQUENCY:
        by_mass = parts[1, worst] > parts[0, worst]
        message = (
            f"the digits of the {'mass' if by_mass else 'stiffness'} matrix leave mode {worst + 1}, "
            f"{math.sqrt(basis.values[worst]) / math.tau:.4g} Hz, a relative error of about "
            f"{errors[worst]:.0e}; export it with more digits, in double precision"
        )
        findings.warn(given.name, message, (given.mass if by_mass else given.stiffness).place, id="FE-012")
    return errors


def _geometric(
    given: FlexibleInput, matrices: _Matrices, frame: Frame, Phi: np.ndarray, findings: Findings
) -> np.ndarray:
    """Phi' KG Phi per component of w~ w~ in body axes; the files' unit loads are in those of the table."""
    size = Phi.shape[1]
    if given.stiffening:
        return centrifugal_stiffness(given, matrices.K, matrices.S, frame, Phi, findings)
    if not given.unit_loads:
        return np.zeros((0, 0, size, size))
    shapes = _in_axes_of_table(frame, Phi)
    reduced = np.zeros((3, 3, size, size))
    for load in given.unit_loads:
        found = _read(given, load.file, "G", partial(nodal_part, stiffness=matrices.of_stiffness), findings)
        if found is not None:
            reduced[load.i, load.j] = shapes.T @ (found.matrix @ shapes)
    return np.einsum("ia,jb,ijkl->abkl", frame.axes, frame.axes, reduced)


def centrifugal_stiffness(
    given: FlexibleInput, K: np.ndarray, S: np.ndarray, frame: Frame, Phi: np.ndarray, findings: Findings
) -> np.ndarray:
    """Phi' K_G Phi per component of w~ w~, (3, 3, N, N), body axes, from the stresses in the elements.

    The accelerations w~ w~ r0 of a body that turns load its nodes; with (w~ w~)_ij for amplitudes there are
    six loads -S (e_i r0_j + e_j r0_i)/2, since w~ w~ is symmetric.  Each is balanced where the frame holds
    the body (mean axes: by the acceleration that it causes), and its linear stresses give
    K_G^IJ = E times the integral of grad N_I . sigma . grad N_J, the initial-stress matrix.

    `K`, `S`: (3 n, 3 n), body axes; `Phi` (3 n, N).  Faults of elements and material go to
    `findings`, and the answer is zero then.
    """
    size, stiffening = Phi.shape[1], given.stiffening
    assert stiffening is not None, "centrifugal stiffness needs a material"
    table = element_table(given, stiffening.file, frame.r0, findings)
    if table is None:
        return np.zeros((3, 3, size, size))
    material = stiffening.young, stiffening.poisson
    body = matching_elements(frame.r0, table.rows, material, K)
    if body.deviation > FOREIGN:
        remedy = "give geometric stiffness matrices by FEMG"
        message = foreign_stiffness(body, stiffening, remedy)
        findings.error(given.name, message, stiffening.place, id="FE-009")
    pairs = [(i, j) for i in range(3) for j in range(i, 3)]
    forces = np.column_stack([_load(frame.r0, S, i, j) for i, j in pairs])
    displacements = static_shapes(K, S, frame, forces)
    shapes = Phi.reshape(-1, 3, size)
    reduced = np.zeros((3, 3, size, size))
    for (i, j), moved in zip(pairs, displacements.T, strict=True):
        scalars = initial_stress_matrix(body, moved)
        reduced[i, j] = sum(shapes[:, a].T @ (scalars @ shapes[:, a]) for a in range(3))
        reduced[j, i] = reduced[i, j]
    return reduced


def _load(r0: np.ndarray, S: np.ndarray, i: int, j: int) -> np.ndarray:
    field = np.zeros(r0.shape)
    field[:, i] += r0[:, j] / 2
    field[:, j] += r0[:, i] / 2
    return -(S @ field.ravel())
