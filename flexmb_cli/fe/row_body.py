"""A flexible body from matrices with rotations, modal rows or a condensed mass: tested, placed, reduced."""

import math
from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import Dropped, FlexibleBody, FlexibleInput
from .body_basis import Basis, basis_of
from .body_figures import completed_mass, doubtful_frequencies, effective_limit, modal_damping
from .body_files import matrix_file
from .estimated_moments import rigid_mass, row_invariants
from .formats.formats import OF_ELEMENTS, OF_STRUCTURES
from .formats.matrix_file import FEFileFault, MatrixFile
from .input_checks import check_damping
from .invariants import effective_masses
from .nodal_matrices import NodalMatrix
from .reference_frame import Frame, as_solved, origin_and_axes
from .row_checks import check_inertia, check_rows
from .rows import RowMatrices, Rows, in_rows, row_matrices


def row_body(
    given: FlexibleInput, files: tuple[MatrixFile, MatrixFile], findings: Findings
) -> FlexibleBody | None:
    """Return the body of mass and stiffness `files`; None where there is none, as `findings` say."""
    names = given.mass.path.name, given.stiffness.path.name
    try:
        matrices = row_matrices(names, files, given)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), given.stiffness.place, id=fault.id)
        return None
    figures = check_rows(given, matrices, files[1], findings)
    _check_settings(given, matrices, findings)
    if findings.has_errors:
        return None
    check_inertia(given, matrices, findings)
    if findings.has_errors:
        return None
    return _reduced(given, files, matrices, figures, findings)


def _check_settings(given: FlexibleInput, matrices: RowMatrices, findings: Findings) -> None:
    """Refuse settings that need elements, or rows that the body lacks."""
    rows = matrices.rows
    if given.stiffening or (given.material and given.mass.form not in (OF_ELEMENTS, OF_STRUCTURES)):
        message = (
            "stresses, and stiffening by elements, need full matrices of solid elements; these have "
            "rotations, modal rows or a condensed mass: remove MATL, and give geometric stiffness by FEMG"
        )
        findings.error(given.name, message, given.place, id="FE-145")
    missing = [
        node for node in (*given.clamped, *given.attachment, *given.interface) if not len(rows.of(node))
    ]
    whole = {int(given.numbers[place]) for place in rows.triples(1)}
    missing += [node for node in given.reference if node not in whole]
    if missing:
        message = f"the matrices have no rows of node {missing[0]}, which its frame or basis needs"
        findings.error(given.name, message, given.place, id="FE-146")


def _reduced(
    given: FlexibleInput,
    files: tuple[MatrixFile, MatrixFile],
    matrices: RowMatrices,
    figures: dict[str, float],
    findings: Findings,
) -> FlexibleBody | None:
    mass, places = rigid_mass(matrices), {int(number): row for row, number in enumerate(given.numbers)}
    origin, axes = origin_and_axes(given, places, mass.s0 / mass.m)
    own, B = matrices.seen_from(origin, axes)
    factors = own.scales()
    frame = _frame(given, own, factors, origin, axes)
    M, K = (factors[:, None] * A * factors for A in (own.M, own.K))
    basis = basis_of(given, K, M, frame, findings)
    if basis is None:
        return None
    return _body(given, (own, matrices, B), (M, factors, files), frame, basis, figures, findings)


def _frame(
    given: FlexibleInput, own: RowMatrices, factors: np.ndarray, origin: np.ndarray, axes: np.ndarray
) -> Frame:
    rows = own.rows
    shifts = rows.triples(1)
    held = rows.of(given.clamped) if given.clamped else np.arange(0)
    if given.reference and not given.clamped:
        n1, n2, n3 = (shifts[int(np.flatnonzero(given.numbers == node)[0])] for node in given.reference)
        held = np.array([*n1, *n2[1:], n3[2]])
    r0 = np.array([rows.positions[triple[0]] for _, triple in sorted(shifts.items())]).reshape(-1, 3)
    return Frame(origin, axes, r0, held, bool(given.clamped), rows.rigid / factors[:, None], rows.labels)


def _body(
    given: FlexibleInput,
    matrices: Any,
    scaled: Any,
    frame: Frame,
    basis: Basis,
    figures: dict[str, Any],
    findings: Findings,
) -> FlexibleBody:
    (own, as_filed, B), (M, factors, files) = matrices, scaled
    shapes = factors[:, None] * basis.shapes
    invariants: dict[str, Any] = row_invariants(own, shapes)
    invariants["Mff"], in_motion = completed_mass(invariants["Mff"], M, frame, basis)
    nodes, Phi, Psi = _nodal_shapes(own, shapes)
    heavy = len(basis.values) - basis.massless
    solved = B @ (factors[:, None] * as_solved(frame, basis.shapes[:, :heavy]))
    of_mass, of_stiffness = (
        NodalMatrix(A, file, places, np.arange(0), shifts=as_filed.rows.rigid[:, :3])
        for A, file, places in zip(
            (as_filed.M, as_filed.K), files, (as_filed.in_mass, as_filed.in_stiffness), strict=True
        )
    )
    return FlexibleBody(
        given.name,
        given.numbers[nodes],
        frame.r0,
        frame.origin,
        frame.axes,
        Phi,
        **invariants,
        Kr=np.diag(basis.values),
        Dr=modal_damping(given, invariants["Mff"], basis.values)
        + _damping_of_file(given, as_filed.rows, B @ shapes, findings),
        KG=_given_stiffening(given, as_filed.rows, frame, B @ shapes, findings),
        frequencies=np.sqrt(np.maximum(basis.values, 0.0)) / math.tau,
        frequency_errors=doubtful_frequencies(given, of_stiffness, of_mass, solved, basis, findings),
        effective_mass=effective_masses(invariants["S1"], invariants["C0"]),
        effective_limit=effective_limit(M, frame),
        **figures,
        massless=basis.massless,
        massless_in_motion=in_motion,
        dropped=Dropped(0, basis.superfluous, basis.left_out, math.sqrt(basis.next_value) / math.tau),
        Psi=Psi,
        estimated=True,
    )


def _nodal_shapes(own: RowMatrices, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places of the nodes with three displacements, these (3 n, N) and their rotations, nan if rows lack."""
    shifts, turns = own.rows.triples(1), own.rows.triples(4)
    nodes = np.array(sorted(shifts), dtype=np.int64)
    Phi = shapes[np.array([shifts[node] for node in nodes], int).ravel()]
    Psi = np.full(Phi.shape, np.nan)
    for k, node in enumerate(nodes):
        if node in turns:
            Psi[3 * k : 3 * k + 3] = shapes[turns[node]]
    return nodes, Phi, Psi


def _damping_of_file(
    given: FlexibleInput, rows: Rows, shapes: np.ndarray, findings: Findings
) -> np.ndarray | float:
    """Phi' B Phi of the damping matrix, `shapes` (k, N): rows; 0 without one."""
    file: Any = given.damping_matrix and matrix_file(given, given.damping_matrix, "B", findings)
    if file is None or given.damping_matrix is None:
        return 0.0
    size = np.abs(rows.positions).max()
    try:
        matrix = in_rows(given.damping_matrix.path.name, file, given.numbers, rows.labels)[0]
    except FEFileFault as fault:
        findings.error(given.name, str(fault), given.damping_matrix.place, id=fault.id)
        return 0.0
    motions = rows.rigid / np.array([1.0, 1.0, 1.0, size, size, size])
    check_damping(given, matrix, motions, findings)
    return np.asarray(shapes.T @ matrix @ shapes)


def _given_stiffening(
    given: FlexibleInput, rows: Rows, frame: Frame, shapes: np.ndarray, findings: Findings
) -> np.ndarray:
    """Phi' KG Phi per component of w~ w~, body axes, of the files' unit loads; `shapes` (k, N): rows."""
    size = shapes.shape[1]
    if not given.unit_loads:
        return np.zeros((0, 0, size, size))
    reduced = np.zeros((3, 3, size, size))
    for load in given.unit_loads:
        file = matrix_file(given, load.file, "G", findings)
        try:
            if file is not None:
                KG = in_rows(load.file.path.name, file, given.numbers, rows.labels)[0]
                reduced[load.i, load.j] = shapes.T @ (KG @ shapes)
        except FEFileFault as fault:
            findings.error(given.name, str(fault), load.file.place, id=fault.id)
    return np.einsum("ia,jb,ijkl->abkl", frame.axes, frame.axes, reduced)
