"""A flexible body of modes and nodal masses, as MBDyn's .fem files give it: no matrices of nodes.

The invariants are sums over the masses at the nodes, exact in their translations; rotary inertia of nodes
counts in J0, C0 and J1.  The modal mass is that of the file, so that frequencies are the program's.
"""

from typing import Any

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleBody, FlexibleInput
from .body_figures import modal_damping
from .formats.matrix_file import FEFileFault
from .formats.mbdyn_fem import ModalFile, read_modal_file
from .invariants import EPSILON, effective_masses, inertia_invariants
from .nodal_matrices import SYMMETRY

# Relative: difference of masses along three axes, of group 12 to the sums of group 11.
ISOTROPY, SAME_INERTIA = 1e-6, 1e-2
# Least eigenvalue, relative to the largest, of a mode that strains the body.
LEAST_STRAIN = 1e-12
# Modal mass of the file less that of its nodal masses, relative to the largest, that is worth a warning.
DOUBTFUL_MASS = 1e-3


def modal_body(given: FlexibleInput, findings: Findings) -> FlexibleBody | None:
    """Return the body of the .fem file that `given` names; None where there is none, with a fault."""
    try:
        if given.mass.path != given.stiffness.path or given.mass.form != given.stiffness.form:
            raise FEFileFault("mass and stiffness of a .fem file come from the same file", id="FE-290")
        nodes = given.reference or given.clamped or given.attachment or given.interface
        if nodes or given.unit_loads or given.nodal_masses:
            message = (
                "the modes of a .fem file are the basis: no reference, clamped, attachment and "
                "interface nodes, no geometric stiffness and no added masses are read beside them"
            )
            raise FEFileFault(message, id="FE-291")
        file = read_modal_file(given.stiffness.path)
        return _body(given, file, findings)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), given.stiffness.place, id=fault.id)
        return None


def _body(given: FlexibleInput, file: ModalFile, findings: Findings) -> FlexibleBody:
    name, masses = given.stiffness.path.name, file.nodal_masses[:, 0]
    _check_nodal_masses(name, file)
    values, modes = _modes(given, file)
    shapes = np.einsum("kni,kl->nil", file.shapes, modes)
    Phi = shapes[:, :3].reshape(3 * len(masses), -1)
    invariants: dict[str, Any] = inertia_invariants(file.positions, Phi, np.diag(masses))
    lumped = invariants["Mff"] + np.einsum(
        "nik,ni,nil->kl", shapes[:, 3:], file.nodal_masses[:, 3:], shapes[:, 3:]
    )
    _add_rotary_inertia(invariants, shapes[:, 3:], file.nodal_masses[:, 3:])
    invariants["Mff"] = np.eye(len(values))
    _check_inertia(name, file, invariants)
    _check_total_mass(name, invariants)
    deviation = float(np.abs(lumped - invariants["Mff"]).max())
    if deviation > DOUBTFUL_MASS:
        message = (
            f"the modal masses of {name} differ by {deviation:.1e} from those of its nodal masses; were they "
            "made of another mass matrix?"
        )
        findings.warn(given.name, message, given.mass.place, id="FE-292")
    omega, count = np.sqrt(values), len(values)
    return FlexibleBody(
        given.name,
        file.numbers,
        file.positions,
        np.zeros(3),
        np.eye(3),
        Phi,
        **invariants,
        Kr=np.diag(values),
        Dr=modal_damping(given, invariants["Mff"], values),
        KG=np.zeros((0, 0, count, count)),
        frequencies=omega / (2.0 * np.pi),
        frequency_errors=np.full(count, np.nan),
        effective_mass=effective_masses(invariants["S1"], invariants["C0"]),
        effective_limit=np.zeros(6),
        mass_deviation=deviation,
        rigid_residual=0.0,
        Psi=shapes[:, 3:].reshape(3 * len(masses), -1),
    )


def _modes(given: FlexibleInput, file: ModalFile) -> tuple[np.ndarray, np.ndarray]:
    """Return ω² (N,), ascending, and shapes (modes of the file, N) of unit modal mass."""
    from scipy.linalg import LinAlgError, eigh

    name = given.stiffness.path.name
    for what, matrix in (("mass", file.mass), ("stiffness", file.stiffness)):
        if not np.abs(matrix - matrix.T).max() <= SYMMETRY * np.abs(matrix).max():
            raise FEFileFault(f"the modal {what} of {name} is not symmetric", id="FE-293")
    try:
        values, modes = eigh(given.stiffness_factor * file.stiffness, file.mass)
    except LinAlgError:
        raise FEFileFault(f"the modal mass of {name} is not positive definite", id="FE-294") from None
    if not values[0] > LEAST_STRAIN * values[-1]:
        message = f"a mode of {name} has no stiffness: leave rigid motions out, which the body has anyway"
        raise FEFileFault(message, id="FE-295")
    if given.modes > len(values):
        raise FEFileFault(f"{given.modes} modes are requested, and {name} has {len(values)}", id="FE-296")
    count = given.modes or len(values)
    return values[:count], modes[:, :count]


def _add_rotary_inertia(invariants: dict[str, Any], rotations: np.ndarray, inertia: np.ndarray) -> None:
    """Add nodes' inertia (n, 3) about the axes, which turn with `rotations` (n, 3, N) of the nodes."""
    tensors = np.einsum("ni,ij->nij", inertia, np.eye(3))
    turned = np.einsum("abc,nbk,ncd->kad", EPSILON, rotations, tensors)  # θ~ J, (θ~)_ac = ε_abc θ_b
    invariants["J0"] = invariants["J0"] + tensors.sum(axis=0)
    invariants["J1"] = invariants["J1"] + turned + turned.transpose(0, 2, 1)
    # C0 is minus the moment of momentum per modal velocity.
    invariants["C0"] = invariants["C0"] - np.einsum("ni,nik->ik", inertia, rotations)


def _check_nodal_masses(name: str, file: ModalFile) -> None:
    """Refuse masses that differ in direction, none at all, and negative ones."""
    masses = file.nodal_masses[:, :3]
    if not np.ptp(masses, axis=1).max() <= ISOTROPY * np.abs(masses).max() or not masses.sum() > 0.0:
        message = f"the masses of a node of {name} differ in its three directions, or all are zero"
        raise FEFileFault(f"{message}: no body has such inertia", id="FE-297")
    if file.nodal_masses.min() < 0.0:
        raise FEFileFault(f"{name} has a negative mass or inertia in record group 11", id="FE-298")


def _check_total_mass(name: str, invariants: dict[str, Any]) -> None:
    """Refuse modal masses that are less than what rigid motions take of them: energy is positive."""
    m, s0, J0 = (invariants[key] for key in ("m", "s0", "J0"))
    crossed = np.cross(s0, np.eye(3))  # minus s0~
    rigid = np.block([[m * np.eye(3), crossed], [crossed.T, J0]])
    coupling = np.vstack([invariants["S1"], -invariants["C0"]])
    remainder = invariants["Mff"] - coupling.T @ np.linalg.pinv(rigid, hermitian=True) @ coupling
    if not np.linalg.eigvalsh(remainder)[0] > 0.0:
        message = "the modal masses contradict the nodal masses: some motion would have negative energy"
        raise FEFileFault(f"{name}: {message}; make both of the same mass matrix", id="FE-300")


def _check_inertia(name: str, file: ModalFile, invariants: dict[str, Any]) -> None:
    """Refuse a body whose mass, centre or inertia in record group 12 are others than the sums."""
    m, s0, J0 = (invariants[key] for key in ("m", "s0", "J0"))
    if not len(file.rigid):
        return
    c = s0 / m
    central = J0 - m * (c @ c * np.eye(3) - np.outer(c, c))
    size = np.abs(file.positions).max()
    own = np.concatenate([[m], c, central.ravel()])
    scale = np.concatenate([[m], [size] * 3, [np.abs(central).max()] * 9])
    if not (np.abs(own - file.rigid) <= SAME_INERTIA * scale).all():
        message = (
            f"mass, centre or inertia in record group 12 of {name} differ from the sums of group 11: "
            f"{m:.6g} kg at {', '.join(f'{x:.4g}' for x in c)} m"
        )
        raise FEFileFault(message, id="FE-299")
