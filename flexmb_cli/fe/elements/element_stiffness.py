"""From elements to matrices of the body: which formulation its stiffness is made of, stresses, K_G."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..linear_algebra import Matrix, summed
from .solid_elements import FORMULATIONS, SolidElements, elasticity, solid_elements

# Elements at a time: the strains of a brick of 20 nodes and 27 points are 80 kB.
_CHUNK = 500
# Matrices that differ by less of their largest entry are equal but for round-off; formulations that agree on
# parallelepipeds are then distinguished by their order.
SAME_STIFFNESS = 1e-9


@dataclass(frozen=True)
class BodyElements:
    """Elements whose assembled stiffness comes nearest to the body's; `deviation`: by how much it differs.

    `internal` (m, internal degrees of freedom, 3 k): the displacements of incompatible modes per nodal
    displacement.
    """

    elements: SolidElements
    D: np.ndarray
    internal: np.ndarray
    deviation: float


def matching_elements(
    positions: np.ndarray, rows: np.ndarray, material: tuple[float, float], K: Matrix
) -> BodyElements:
    """Return the formulation of elements `rows` (m, k) that assembles to K (3 n, 3 n), else the nearest.

    `positions` (n, 3), m; `material`: Young's modulus, Pa, and Poisson's ratio.
    """
    D, size = elasticity(*material), abs(K).max()
    candidates = []
    for formulation in FORMULATIONS[rows.shape[1]]:
        elements = solid_elements(positions, rows, formulation)
        stiffness, internal = element_stiffness(elements, D)
        difference = assembled(stiffness, rows, len(positions), 3) - K
        candidates.append(BodyElements(elements, D, internal, float(abs(difference).max() / size)))
        if candidates[-1].deviation < SAME_STIFFNESS:
            break
    return min(candidates, key=lambda body: body.deviation)


def element_stiffness(elements: SolidElements, D: np.ndarray) -> tuple[Any, Any]:
    """Return the nodal stiffness (m, 3 k, 3 k), N/m, and how incompatible modes follow the nodes.

    `elements`: m elements of k nodes; `D` (6, 6), Pa.  The second has (m, internal degrees of freedom, 3 k).
    """
    count, nodal = len(elements.rows), 3 * elements.nodes
    inner = 3 * elements.gradients.shape[2] - nodal
    stiffness, internal = np.empty((count, nodal, nodal)), np.zeros((count, inner, nodal))
    for part in parts(count):
        B = elements.strains(part)
        full = np.einsum("mgai,ab,mgbj,mg->mij", B, D, B, elements.volumes[part], optimize=True)
        stiffness[part] = full[:, :nodal, :nodal]
        if inner:
            internal[part] = -np.linalg.solve(full[:, nodal:, nodal:], full[:, nodal:, :nodal])
            stiffness[part] += full[:, :nodal, nodal:] @ internal[part]
    return stiffness, internal


def parts(count: int) -> list[slice]:
    """Slices of so many elements, each small enough to hold their strains."""
    return [slice(first, min(first + _CHUNK, count)) for first in range(0, count, _CHUNK)]


def assembled(elements: np.ndarray, rows: np.ndarray, n: int, directions: int) -> np.ndarray:
    """Sum of element matrices (m, d k, d k) over the nodes, (d n, d n)."""
    places = (directions * rows[:, :, None] + np.arange(directions)).reshape(len(rows), -1)
    width = places.shape[1]
    i = np.repeat(places, width, axis=1).ravel()
    j = np.tile(places, (1, width)).ravel()
    return summed(elements.ravel(), i, j, directions * n)


def uniform_strain_deviation(
    elements: SolidElements, stiffness: np.ndarray, positions: np.ndarray, K: np.ndarray
) -> float:
    """Return how far `K` and the elements differ in the nodal forces of uniform strains, relative.

    Elements of any sound formulation agree in them; `stiffness` (m, 3 k, 3 k), `positions` (n, 3), m.
    """
    fields = np.zeros((*positions.shape, 9))
    for i, j in np.ndindex(3, 3):
        fields[:, i, 3 * i + j] = positions[:, j]
    nodal = fields[elements.rows].reshape(len(elements.rows), -1, 9)
    forces = np.zeros(fields.shape)
    np.add.at(forces, elements.rows, (stiffness @ nodal).reshape(*elements.rows.shape, 3, 9))
    exact = K @ fields.reshape(-1, 9)
    return float(np.abs(exact - forces.reshape(-1, 9)).max() / np.abs(exact).max())


def initial_stress_matrix(body: BodyElements, displacements: np.ndarray) -> np.ndarray:
    """Scalars (n, n) of K_G: the sum over elements of grad N_I . sigma . grad N_J, N/m.

    `displacements` (3 n,), m, are those of the load that stresses the body; K_G itself is (n, n) times
    the unit matrix of the three directions.  The incompatible modes carry stress, but do not stiffen.
    """
    mesh, k = body.elements, body.elements.nodes
    elements = np.empty((len(mesh.rows), k, k))
    for part in parts(len(mesh.rows)):
        slopes = mesh.gradients[part, :, :k]
        stress = _tensor(stresses(body, displacements[:, None], part)[..., 0])
        elements[part] = np.einsum(
            "mgai,mgij,mgbj,mg->mab", slopes, stress, slopes, mesh.volumes[part], optimize=True
        )
    return assembled(elements, mesh.rows, len(displacements) // 3, 1)


def stresses(body: BodyElements, displacements: np.ndarray, part: slice) -> np.ndarray:
    """Stresses (part, g, 6, c), Pa, at the points of integration for `displacements` (3 n, c), m.

    Components xx yy zz xy yz zx in the axes of the nodes.
    """
    mesh, count = body.elements, displacements.shape[1]
    rows = mesh.rows[part]
    nodal = displacements.reshape(-1, 3, count)[rows].reshape(len(rows), -1, count)
    full = np.concatenate([nodal, body.internal[part] @ nodal], axis=1)
    return np.einsum("ab,mgbi,mic->mgac", body.D, mesh.strains(part), full, optimize=True)


def _tensor(stress: np.ndarray) -> np.ndarray:
    """(…, 6) xx yy zz xy yz zx as (…, 3, 3)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=-1).reshape(*stress.shape[:-1], 3, 3)
