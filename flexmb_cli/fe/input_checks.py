"""Tests that matrices and node table must pass before a body is made of them.

A failed test names its figure, the worst node and the likely causes.  The limits are relative.
"""

import numpy as np

from ..errors import Place
from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleInput
from .formats.matrix_file import MatrixFile
from .linear_algebra import in_three_directions
from .precision import rounding_force

ISOTROPIC_DOUBT, ISOTROPIC_ERROR = 1e-8, 1e-3
RIGID_DOUBT, RIGID_ERROR = 1e-7, 1e-4
COLLINEAR = 1e-6


def check_matrices(
    given: FlexibleInput, S: np.ndarray, K: np.ndarray, file: MatrixFile, findings: Findings
) -> dict[str, float]:
    """Check mass `S` and stiffness `K`, both (3 n, 3 n), K of `file`; faults go to `findings`.

    Returns the largest |S^ij - m_ij E| and |K R|, relative, as `FlexibleBody` names them.
    """
    check_holes(given, S, "mass", given.mass.place, findings)
    check_holes(given, K, "stiffness", given.stiffness.place, findings)
    _check_exchanged(given, S, K, findings)
    return {
        "mass_deviation": check_isotropy(given, S, findings),
        "rigid_residual": check_rigid_motions(given, K, file, findings),
    }


def _check_exchanged(given: FlexibleInput, S: np.ndarray, K: np.ndarray, findings: Findings) -> None:
    """Only a stiffness lets the body translate freely, so the two matrices cannot be mistaken."""
    translations = np.tile(np.eye(3), (len(given.numbers), 1))
    of_mass, of_stiffness = (np.abs(A @ translations).max() / _largest(A) for A in (S, K))
    if of_mass <= RIGID_ERROR < of_stiffness:
        message = "it gives no force in a translation, and the stiffness does: are the files exchanged?"
        message = f"this mass matrix looks like a stiffness; {message}"
        findings.error(given.name, message, given.mass.place, id="FE-055")


def _largest(matrix: np.ndarray) -> float:
    """The largest entry, by which others are measured; 1 where all are 0, which is reported of each degree of
    freedom.
    """
    return abs(matrix).max() or 1.0


def check_holes(
    given: FlexibleInput, matrix: np.ndarray, what: str, place: Place | None, findings: Findings
) -> None:
    """Every degree of freedom needs a mass and a stiffness above zero on the diagonal."""
    diagonal = matrix.diagonal()
    wrong = np.flatnonzero(~(diagonal > 0))
    if wrong.size:
        row = wrong[0]
        node, axis = given.numbers[row // 3], "xyz"[row % 3]
        hint = "is the node in no element?" if diagonal[row] == 0 else "a diagonal must be positive"
        findings.error(
            given.name,
            f"the {what} of node {node} along {axis} is {diagonal[row]:.6g}; {hint} "
            f"({wrong.size} of {len(diagonal)} such degrees of freedom)",
            place,
            id="FE-056",
        )


def is_condensed(given: FlexibleInput, S: np.ndarray, K: np.ndarray) -> bool:
    """Return whether a mass is none of solid elements but condensed (Guyan): S^ij are no multiples of E."""
    exchanged = Findings()
    _check_exchanged(given, S, K, exchanged)
    return not exchanged.has_errors and _anisotropy(S)[0] > ISOTROPIC_ERROR


def _anisotropy(S: np.ndarray) -> tuple[float, int]:
    """The largest deviation of S^ij from multiples of E (24), relative to the largest entry, and its row."""
    difference = abs(S - in_three_directions(scalar_mass(S)))
    return float(difference.max() / _largest(S)), int(difference.argmax()) // difference.shape[1]


def check_isotropy(given: FlexibleInput, S: np.ndarray, findings: Findings) -> float:
    """S^ij must be multiples of E (24): the largest deviation, relative to the largest entry of S."""
    deviation, row = _anisotropy(S)
    if deviation > ISOTROPIC_DOUBT:
        message = (
            f"the mass of directions x, y, z differs by {deviation:.1e} of the largest entry, most at node "
            f"{given.numbers[row // 3]}: the equations need equal masses in all directions and none between "
            "them; their mean is taken"
        )
        findings.warn(given.name, message, given.mass.place, id="FE-058")
    mass = scalar_mass(S).sum()
    if not mass > 0:
        message = f"its mass is {mass:.6g} kg; it must be above zero"
        findings.error(given.name, message, given.mass.place, id="FE-059")
    return deviation


def scalar_mass(S: np.ndarray) -> np.ndarray:
    """The n x n matrix m of S^ij = m_ij E, the mean of the three directions."""
    return (S[0::3, 0::3] + S[1::3, 1::3] + S[2::3, 2::3]) / 3


def rigid_motions(r: np.ndarray) -> np.ndarray:
    """Unit translations along, rotations about the axes through the origin, (3 n, 6), of nodes `r` (n, 3)."""
    motions = np.zeros((len(r), 3, 6))
    motions[:, :, :3] = np.eye(3)
    x, y, z = r.T
    motions[:, 1, 3], motions[:, 2, 3] = -z, y
    motions[:, 2, 4], motions[:, 0, 4] = -x, z
    motions[:, 0, 5], motions[:, 1, 5] = -y, x
    return motions.reshape(-1, 6)


def check_rigid_motions(given: FlexibleInput, K: np.ndarray, file: MatrixFile, findings: Findings) -> float:
    """K must not resist rigid motion: the largest |K R| relative to the largest entry of K."""
    centred = given.positions - given.positions.mean(axis=0)
    size = np.abs(centred).max() or 1.0
    forces = np.abs(K @ rigid_motions(centred / size)) / _largest(K)
    translation, rotation = forces[:, :3].max(), forces[:, 3:].max()
    residual = float(max(translation, rotation))
    if residual > RIGID_DOUBT:
        node = given.numbers[int(forces.max(axis=1).argmax()) // 3]
        report = findings.error if residual > RIGID_ERROR else findings.warn
        message = _rigid_message(translation, rotation, node)
        if RIGID_ERROR < residual <= rounding_force(file):
            message = _few_digits(given, residual, file.digits)
        report(given.name, message, given.stiffness.place)
    return residual


def check_damping(given: FlexibleInput, B: np.ndarray, motions: np.ndarray, findings: Findings) -> None:
    """Viscous damping must not resist the rigid `motions` (rows, 6): forces on them would be from nowhere."""
    place = given.damping_matrix.place if given.damping_matrix else given.place
    residual = np.abs(B @ motions).max() / _largest(B)
    if not residual <= RIGID_ERROR:
        message = (
            f"the damping matrix resists rigid motion by {residual:.1e} of the largest entry: is it "
            "mass-proportional, or to ground? give alpha on DAMP, or dampers in joints"
        )
        findings.error(given.name, message, place, id="FE-302")
    if not B.diagonal().min() >= 0.0:
        message = "the damping matrix has a negative diagonal entry: damping that feeds energy in"
        findings.error(given.name, message, place, id="FE-303")


def _few_digits(given: FlexibleInput, residual: float, digits: int) -> str:
    remedy = "at least ten"
    if given.stiffness.form == "DMIG":
        remedy = "large fields of 16 columns (DMIG*), fields separated by commas, or OP4"
    return (
        f"the digits of the stiffness are too few: with {digits} of them it resists rigid motion by "
        f"{residual:.1e} of the largest entry, as rounding makes it; export {remedy}"
    )


def _rigid_message(translation: float, rotation: float, node: int) -> str:
    figure = f"{max(translation, rotation):.1e} of the largest entry, most at node {node}"
    if max(translation, rotation) <= RIGID_ERROR:
        return f"the stiffness resists rigid motion by {figure}; export it with more digits"
    if translation > RIGID_ERROR:
        return (
            f"the stiffness resists a translation by {figure}; is the body supported, or joined to another? "
            "export it free"
        )
    return (
        f"the stiffness resists a rotation by {figure}, but no translation: the node table does not belong "
        "to the matrix (order of the nodes, unit of length, rotated nodal axes)"
    )


def check_reference(given: FlexibleInput, positions: np.ndarray, findings: Findings) -> None:
    """The three reference nodes, at `positions` (3, 3), must be distinct and not on one line."""
    a, b = positions[1] - positions[0], positions[2] - positions[0]
    product = np.linalg.norm(np.cross(a, b))
    if product <= COLLINEAR * np.linalg.norm(a) * np.linalg.norm(b):
        nodes = ", ".join(map(str, given.reference))
        message = f"the reference nodes {nodes} lie on one line; three that span a plane are needed"
        findings.error(given.name, message, given.place, id="FE-060")
