"""Tests of matrices given by rows: no force in rigid motion, a mass that is one in all directions, no holes.

A failed test names its figure, nodes and components, and the likely cause.  The limits are relative;
rotations and modal rows are compared as lengths, see `RowMatrices.scales`.
"""

from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleInput
from .estimated_moments import rigid_mass
from .formats.matrix_file import MatrixFile
from .input_checks import RIGID_DOUBT, RIGID_ERROR
from .precision import rounding_force
from .rows import RowMatrices

# Least principal inertia about the centre, relative to the largest, and share below zero that is round-off.
LEAST_INERTIA, ROUND_OFF_OF_ROWS = 1e-12, 1e-9
# Share of the force in rigid motion that is left when the cause of it is taken out.
EXPLAINED = 1e-3
MOST_SUSPECTS = 12


def check_rows(
    given: FlexibleInput, matrices: RowMatrices, file: MatrixFile, findings: Findings
) -> dict[str, float]:
    """Check mass and stiffness, that of `file`; faults go to `findings`.

    Returns deviations of R' M R and K R, relative, as `FlexibleBody` names them.
    """
    factors, rows = matrices.scales(), matrices.rows
    M, K = (factors[:, None] * A * factors for A in (matrices.M, matrices.K))
    shifted = rows.positions[rows.shifting]
    origin = shifted.mean(axis=0) if len(shifted) else np.zeros(3)
    rigid = rows.seen_from(origin, np.eye(3)).rigid / factors[:, None]
    rigid[:, 3:] /= np.abs(shifted - origin).max(initial=0.0) or 1.0
    _check_diagonals(given, matrices, findings)
    if not _check_exchanged(given, M, K, rigid, findings):
        return {}
    residual = _check_rigid_motions(given, matrices, K, rigid, file, findings)
    return {"mass_deviation": _check_mass(given, M, rigid, findings), "rigid_residual": residual}


def _largest(matrix: np.ndarray) -> float:
    return float(np.abs(matrix).max(initial=0.0)) or 1.0


def _check_diagonals(given: FlexibleInput, matrices: RowMatrices, findings: Findings) -> None:
    rows = matrices.rows
    for A, what, file in ((matrices.M, "mass", given.mass), (matrices.K, "stiffness", given.stiffness)):
        wrong = np.flatnonzero(A.diagonal() < -ROUND_OFF_OF_ROWS * _largest(A))
        if len(wrong):
            message = f"a diagonal must be positive; that of the {what} is below zero: {rows.names(wrong)}"
            findings.error(given.name, message, file.place, id="FE-135")
    stiff, heavy = (np.abs(A).max(axis=1) > 0.0 for A in (matrices.K, matrices.M))
    loose = np.flatnonzero(heavy & ~stiff)
    if len(loose):
        message = f"rows with mass and without stiffness move freely: {rows.names(loose)}"
        findings.error(given.name, message + "; complete the stiffness", given.stiffness.place, id="FE-136")
    light = np.flatnonzero(stiff & ~heavy)
    if len(light):
        message = f"{len(light)} rows have stiffness and no mass, and follow the others as in statics: "
        findings.warn(given.name, message + rows.names(light), given.mass.place, id="FE-137")


def _check_exchanged(
    given: FlexibleInput, M: np.ndarray, K: np.ndarray, rigid: np.ndarray, findings: Findings
) -> bool:
    of_mass, of_stiffness = (np.abs(A @ rigid[:, :3]).max(initial=0.0) / _largest(A) for A in (M, K))
    if of_mass <= RIGID_ERROR < of_stiffness:
        message = (
            "the mass matrix gives no force in a translation, and the stiffness does: are they exchanged?"
        )
        findings.error(given.name, message, given.mass.place, id="FE-138")
        return False
    return True


def _check_rigid_motions(
    given: FlexibleInput,
    matrices: RowMatrices,
    K: np.ndarray,
    rigid: np.ndarray,
    file: MatrixFile,
    findings: Findings,
) -> float:
    forces = K @ rigid / _largest(K)
    by_row = np.abs(forces).max(axis=1)
    residual = float(by_row.max(initial=0.0))
    if residual > RIGID_DOUBT:
        severe = residual > RIGID_ERROR and residual > rounding_force(file)
        cause = _cause(matrices, K, rigid) if severe else "export it with more digits"
        message = (
            f"the stiffness resists rigid motion by {residual:.1e} of the largest entry, most at "
            f"{_worst_nodes(matrices, by_row)}; {cause}"
        )
        place = given.stiffness.place
        if severe:
            findings.error(given.name, message, place, id="FE-139")
        else:
            findings.warn(given.name, message, place, id="FE-140")
    return residual


def _worst_nodes(matrices: RowMatrices, by_row: np.ndarray) -> str:
    order = np.argsort(-by_row, kind="stable")
    named = dict.fromkeys(matrices.rows.name(int(row)) for row in order[:3] if by_row[row] > 0.0)
    return "; ".join(named)


def _cause(matrices: RowMatrices, K: np.ndarray, rigid: np.ndarray) -> str:
    """Return what would take the forces in rigid motion away: other axes, or another place, of one node."""
    rows, forces = matrices.rows, K @ rigid
    sizes = np.abs(forces).max(axis=1)
    suspects = dict.fromkeys(int(rows.labels[row, 0]) for row in np.argsort(-sizes, kind="stable"))
    for node in list(suspects)[:MOST_SUSPECTS]:
        own = rows.of(node)
        if not len(own):
            continue
        change = -np.linalg.lstsq(K[:, own], forces, rcond=1e-12)[0]
        left = np.linalg.norm(forces + K[:, own] @ change)
        if left <= EXPLAINED * np.linalg.norm(forces):
            of_shifts = np.abs(change[:, :3]).max() > EXPLAINED * np.abs(change).max()
            what = "displacement axes (CD, *TRANSFORM)" if of_shifts else "place"
            return f"the {what} of node {node} alone would explain it: correct the node table"
    return "is the body supported or tied to another, or are rows missing? export it free and complete"


def _check_mass(given: FlexibleInput, M: np.ndarray, rigid: np.ndarray, findings: Findings) -> float:
    """R' M R must be that of a rigid body, [m E, -s~; s~, J]; the largest deviation, relative to m."""
    m6: Any = rigid.T @ M @ rigid
    masses, coupling = m6.diagonal()[:3], m6[:3, 3:]
    m = float(masses.mean())
    wrong = max(np.abs(m6[:3, :3] - m * np.eye(3)).max(), np.abs(coupling + coupling.T).max() / 2) / _largest(
        m6[:3, :3]
    )
    place = given.mass.place
    if not m > 0:
        message = f"its mass is {m:.6g} kg; it must be above zero"
        findings.error(given.name, message, place, id="FE-141")
    elif wrong > RIGID_DOUBT:
        message = (
            f"its masses in translations along x, y, z are {', '.join(f'{value:.9g}' for value in masses)} "
            f"kg, and deviate from those of a rigid body by {wrong:.1e}: a body has one mass"
        )
        if wrong > RIGID_ERROR:
            remedy = "; are rows missing, or has it masses in one direction alone (added water)?"
            findings.error(given.name, message + remedy, place, id="FE-142")
        else:
            findings.warn(given.name, message + "; their mean is taken", place, id="FE-143")
    return float(wrong)


def check_inertia(given: FlexibleInput, matrices: RowMatrices, findings: Findings) -> None:
    """The inertia about the centre must be positive about every axis."""
    mass = rigid_mass(matrices)
    c = mass.s0 / mass.m
    moments = np.linalg.eigvalsh(mass.J0 - mass.m * (c @ c * np.eye(3) - np.outer(c, c)))
    if moments[0] <= LEAST_INERTIA * moments[-1]:
        message = (
            f"its principal inertias are {', '.join(f'{value:.6g}' for value in moments)} kg m2; all must be "
            "above zero: a line of nodes needs the rotations about it"
        )
        findings.error(given.name, message, given.mass.place, id="FE-144")
