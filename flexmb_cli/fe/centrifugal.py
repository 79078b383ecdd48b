"""Geometric stiffness of a turning body from the stresses in its own bricks.

The accelerations w~ w~ r0 of a body that turns load its nodes; with (w~ w~)_ij for amplitudes there are six
loads -S (e_i r0_j + e_j r0_i)/2, since w~ w~ is symmetric.  Each is balanced where the frame holds the body
(mean axes: by the acceleration that it causes), and its linear stresses give
K_G^IJ = E times the integral of grad N_I . sigma . grad N_J, the initial-stress matrix.
"""

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleInput
from .brick_stiffness import initial_stress_matrix, matching_bricks
from .bricks import FORMULATIONS, bricks
from .formats.connectivity import Hexahedra, read_hexahedra
from .formats.matrix_file import FEFileFault
from .reference_frame import Frame
from .static_shapes import static_shapes

# The stiffness need only differ by this share of its largest entry for stresses to be off by several times.
LARGEST_DEVIATION = 1e-4


def centrifugal_stiffness(given: FlexibleInput, K, S, frame: Frame, Phi, findings: Findings) -> np.ndarray:
    """Phi' K_G Phi per component of w~ w~, (3, 3, N, N), body axes.

    `K`, `S`: (3 n, 3 n), body axes; `Phi` (3 n, N).  Faults of elements and material go to
    `findings`, and the answer is zero then.
    """
    size = Phi.shape[1]
    rows = _element_rows(given, frame, findings)
    if rows is None:
        return np.zeros((3, 3, size, size))
    material = given.bricks.young, given.bricks.poisson
    body = matching_bricks(frame.r0, rows, material, K)
    if body.deviation > LARGEST_DEVIATION:
        findings.error(given.name, _foreign(given, body), given.bricks.place, id="FE-009")
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


def _load(r0, S, i, j):
    field = np.zeros(r0.shape)
    field[:, i] += r0[:, j] / 2
    field[:, j] += r0[:, i] / 2
    return -(S @ field.ravel())


def _foreign(given, body):
    material = f"E = {given.bricks.young:g} Pa, nu = {given.bricks.poisson:g}"
    return (
        f"the stiffness matrix differs by {body.deviation:.1e} of its largest entry from that of its "
        f"{len(body.bricks.rows)} bricks with {material}, the nearest being {body.bricks.formulation.name}: "
        "check E and nu, or, if the program's elements are others, give geometric stiffness matrices by FEMG"
    )


def _element_rows(given, frame, findings):
    """Rows (m, k) of the elements' nodes in the node table, None when they cannot be used."""
    file = given.bricks.file
    try:
        found = read_hexahedra(file.path, file.form)
        rows = _rows(given, found)
    except FEFileFault as fault:
        findings.error(given.name, str(fault), file.place, id=fault.id)
        return None
    volumes = bricks(frame.r0, rows, FORMULATIONS[rows.shape[1]][0]).volumes
    if not (volumes > 0).all():
        number = found.numbers[np.flatnonzero(~(volumes > 0).all(axis=1))[0]]
        message = f"{file.path.name}: element {number} is turned inside out or folded"
        findings.error(given.name, message, file.place, id="FE-010")
        return None
    return rows


def _rows(given, found: Hexahedra):
    order = np.argsort(given.numbers)
    places = np.searchsorted(given.numbers[order], found.nodes)
    rows = order[np.minimum(places, len(order) - 1)]
    missing = given.numbers[rows] != found.nodes
    if missing.any():
        element, node = np.argwhere(missing)[0]
        raise FEFileFault(
            f"element {found.numbers[element]} has node {found.nodes[element, node]}, which no line of the "
            "node table defines",
            id="FE-011",
        )
    return rows
