"""Files of a finite-element program to a flexible body: read, tested, reduced."""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import Dropped, FlexibleBody, FlexibleInput
from .body_basis import Basis, basis_of
from .body_figures import completed_mass, doubtful_frequencies, effective_limit, modal_damping
from .body_files import arranged, matrix_file
from .elements.body_elements import FOREIGN, element_mesh, element_table, foreign_stiffness
from .elements.element_stiffness import initial_stress_matrix, matching_elements
from .elements.stress_shapes import body_stress
from .formats.formats import OF_ELEMENTS, OF_MODES
from .input_checks import (
    check_damping,
    check_matrices,
    check_reference,
    is_condensed,
    rigid_motions,
    scalar_mass,
)
from .invariants import effective_masses, inertia_invariants
from .linear_algebra import Matrix, in_three_directions, turned
from .modal_body import modal_body
from .nodal_matrices import NodalMatrix, condensed, nodal_part
from .reference_frame import Frame, as_solved, reference_frame, static_shapes
from .row_body import row_body
from .rows import is_general


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
    of_stiffness = matrix_file(given, given.stiffness, "K", findings)
    # Elements without a stiffness have no mass for the same reason, which is reported once.
    reported = of_stiffness is None and given.mass.form == given.stiffness.form == OF_ELEMENTS
    of_mass = None if reported else matrix_file(given, given.mass, "M", findings)
    files = [file for file in (of_mass, of_stiffness) if file]
    by_rows = given.axes is not None or is_general(files, len(given.numbers))
    K: Any = None
    S: Any = None
    if not by_rows:
        K = of_stiffness and arranged(given, given.stiffness, of_stiffness, condensed, findings)
        arrange = partial(nodal_part, stiffness=K)
        S = of_mass and arranged(given, given.mass, of_mass, arrange, findings)
    if given.reference:
        rows = [int(np.flatnonzero(given.numbers == node)[0]) for node in given.reference]
        check_reference(given, given.positions[rows], findings)
    if of_mass is None or of_stiffness is None or findings.has_errors:
        return None
    if by_rows or is_condensed(given, S.matrix, K.matrix):
        return row_body(given, (of_mass, of_stiffness), findings)
    return _solid_body(given, S, K, findings)


def _solid_body(
    given: FlexibleInput, S: NodalMatrix, K: NodalMatrix, findings: Findings
) -> FlexibleBody | None:
    given = given.with_factor
    figures = check_matrices(given, S.matrix, K.matrix, K.file, findings)
    if findings.has_errors:
        return None
    scalar = scalar_mass(S.matrix)
    weights = np.asarray(scalar.sum(axis=1)).ravel()
    frame = reference_frame(given, weights @ given.positions / weights.sum())
    matrices = _Matrices(in_three_directions(scalar), turned(K.matrix, frame.axes), scalar, S, K)
    basis = basis_of(given, matrices.K, matrices.S, frame, findings)
    return None if basis is None else _body(given, matrices, frame, basis, figures, findings)


def _body(
    given: Any, matrices: Any, frame: Frame, basis: Basis, figures: dict[str, Any], findings: Findings
) -> FlexibleBody:
    Phi = basis.shapes
    invariants: dict[str, Any] = inertia_invariants(frame.r0, Phi, matrices.scalar)
    invariants["Mff"], in_motion = completed_mass(invariants["Mff"], matrices.S, frame, basis)
    heavy = len(basis.values) - basis.massless
    shapes = _in_axes_of_table(frame, as_solved(frame, Phi[:, :heavy]))
    return FlexibleBody(
        given.name,
        given.numbers,
        frame.r0,
        frame.origin,
        frame.axes,
        Phi,
        **invariants,
        Kr=np.diag(basis.values),
        Dr=modal_damping(given, invariants["Mff"], basis.values)
        + _damping_of_file(given, matrices, _in_axes_of_table(frame, Phi), findings),
        KG=_geometric(given, matrices, frame, Phi, findings),
        frequencies=np.sqrt(np.maximum(basis.values, 0.0)) / math.tau,
        frequency_errors=doubtful_frequencies(
            given, matrices.of_stiffness, matrices.of_mass, shapes, basis, findings
        ),
        effective_mass=effective_masses(invariants["S1"], invariants["C0"]),
        effective_limit=effective_limit(matrices.S, frame),
        **figures,
        massless=basis.massless,
        massless_in_motion=in_motion,
        dropped=Dropped(
            len(matrices.of_stiffness.internal),
            basis.superfluous,
            basis.left_out,
            math.sqrt(basis.next_value) / math.tau,
        ),
        stress=given.material and body_stress(given, matrices.K, invariants["m"], frame, Phi, findings),
        mesh=element_mesh(given),
    )


def _damping_of_file(
    given: FlexibleInput, matrices: _Matrices, shapes: np.ndarray, findings: Findings
) -> np.ndarray | float:
    """Phi' B Phi of the damping matrix, `shapes` (3 n, N) in axes of the table; 0 without one."""
    file: Any = given.damping_matrix and matrix_file(given, given.damping_matrix, "B", findings)
    if file is None or given.damping_matrix is None:
        return 0.0
    arrange = partial(nodal_part, stiffness=matrices.of_stiffness)
    B: Any = arranged(given, given.damping_matrix, file, arrange, findings)
    if B is None:
        return 0.0
    centred = given.positions - given.positions.mean(axis=0)
    check_damping(given, B.matrix, rigid_motions(centred / np.abs(centred).max()), findings)
    return np.asarray(shapes.T @ (B.matrix @ shapes))


def _in_axes_of_table(frame: Frame, Phi: np.ndarray) -> np.ndarray:
    n, size = len(frame.r0), Phi.shape[1]
    return np.einsum("ab,nbk->nak", frame.axes, Phi.reshape(n, 3, size)).reshape(3 * n, size)


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
        file = matrix_file(given, load.file, "G", findings)
        arrange = partial(nodal_part, stiffness=matrices.of_stiffness)
        arranged_file: Any = file and arranged(given, load.file, file, arrange, findings)
        if arranged_file is not None:
            reduced[load.i, load.j] = shapes.T @ (arranged_file.matrix @ shapes)
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
