"""Geometric stiffness of a turning body from the stresses in its own elements.

The accelerations w~ w~ r0 of a body that turns load its nodes; with (w~ w~)_ij for amplitudes there are six
loads -S (e_i r0_j + e_j r0_i)/2, since w~ w~ is symmetric.  Each is balanced where the frame holds the body
(mean axes: by the acceleration that it causes), and its linear stresses give
K_G^IJ = E times the integral of grad N_I . sigma . grad N_J, the initial-stress matrix.
"""

import numpy as np

from ..model.diagnostics import Findings
from ..model.flexible_body import FlexibleInput
from .elements.body_elements import FOREIGN, element_table, foreign_stiffness
from .elements.element_stiffness import initial_stress_matrix, matching_elements
from .reference_frame import Frame
from .static_shapes import static_shapes


def centrifugal_stiffness(
    given: FlexibleInput, K: np.ndarray, S: np.ndarray, frame: Frame, Phi: np.ndarray, findings: Findings
) -> np.ndarray:
    """Phi' K_G Phi per component of w~ w~, (3, 3, N, N), body axes.

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
