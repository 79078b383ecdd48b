"""From bricks to matrices of the body: which formulation its stiffness is made of, stresses, K_G."""

import numpy as np

from ..quick_dataclass import dataclass
from .bricks import FORMULATIONS, Bricks, bricks, elasticity
from .linear_algebra import summed

# Elements at a time: the strains of a brick of 20 nodes and 27 points are 80 kB.
_CHUNK = 500
# Matrices that differ by less of their largest entry are equal but for round-off; formulations that agree on
# parallelepipeds are then told by their order.
EQUAL = 1e-9


@dataclass(frozen=True)
class BodyBricks:
    """Elements whose assembled stiffness comes nearest to the body's; `deviation`: by how much it differs.

    `internal` (m, internal freedoms, 3 k): the displacements of incompatible modes per nodal displacement.
    """

    bricks: Bricks
    D: np.ndarray
    internal: np.ndarray
    deviation: float


def matching_bricks(positions: np.ndarray, rows: np.ndarray, material, K) -> BodyBricks:
    """Return the formulation of elements `rows` (m, k) that assembles to K (3 n, 3 n), else the nearest.

    `positions` (n, 3), m; `material`: Young's modulus, Pa, and Poisson's ratio.
    """
    D, size = elasticity(*material), abs(K).max()
    found = []
    for formulation in FORMULATIONS[rows.shape[1]]:
        made = bricks(positions, rows, formulation)
        stiffness, internal = element_stiffness(made, D)
        assembled = _assembled(stiffness, rows, len(positions), 3)
        found.append(BodyBricks(made, D, internal, float(abs(assembled - K).max() / size)))
        if found[-1].deviation < EQUAL:
            break
    return min(found, key=lambda body: body.deviation)


def element_stiffness(made: Bricks, D):
    """Return the nodal stiffness (m, 3 k, 3 k), N/m, and how incompatible modes follow the nodes.

    `made`: m elements of k nodes; `D` (6, 6), Pa.  The second has (m, internal freedoms, 3 k).
    """
    count, nodal = len(made.rows), 3 * made.nodes
    inner = 3 * made.gradients.shape[2] - nodal
    stiffness, internal = np.empty((count, nodal, nodal)), np.zeros((count, inner, nodal))
    for part in _parts(count):
        B = made.strains(part)
        full = np.einsum("mgai,ab,mgbj,mg->mij", B, D, B, made.volumes[part], optimize=True)
        stiffness[part] = full[:, :nodal, :nodal]
        if inner:
            internal[part] = -np.linalg.solve(full[:, nodal:, nodal:], full[:, nodal:, :nodal])
            stiffness[part] += full[:, :nodal, nodal:] @ internal[part]
    return stiffness, internal


def _parts(count):
    return [slice(first, min(first + _CHUNK, count)) for first in range(0, count, _CHUNK)]


def _assembled(elements, rows, n, directions):
    """Sum of element matrices (m, d k, d k) over the nodes, (d n, d n)."""
    places = (directions * rows[:, :, None] + np.arange(directions)).reshape(len(rows), -1)
    width = places.shape[1]
    i = np.repeat(places, width, axis=1).ravel()
    j = np.tile(places, (1, width)).ravel()
    return summed(elements.ravel(), i, j, directions * n)


def initial_stress_matrix(body: BodyBricks, displacements: np.ndarray):
    """Scalars (n, n) of K_G: the sum over elements of grad N_I . sigma . grad N_J, N/m.

    `displacements` (3 n,), m, are those of the load that stresses the body; K_G itself is (n, n) times
    the unit matrix of the three directions.  The incompatible modes carry stress, but do not stiffen.
    """
    made, k = body.bricks, body.bricks.nodes
    elements = np.empty((len(made.rows), k, k))
    for part in _parts(len(made.rows)):
        nodal = displacements.reshape(-1, 3)[made.rows[part]].reshape(-1, 3 * k)
        inner = np.einsum("mij,mj->mi", body.internal[part], nodal)
        strains = np.einsum("mgai,mi->mga", made.strains(part), np.hstack([nodal, inner]))
        slopes = made.gradients[part, :, :k]
        stress = _tensor(strains @ body.D)
        elements[part] = np.einsum(
            "mgai,mgij,mgbj,mg->mab", slopes, stress, slopes, made.volumes[part], optimize=True
        )
    return _assembled(elements, made.rows, len(displacements) // 3, 1)


def _tensor(stress):
    """(…, 6) xx yy zz xy yz zx as (…, 3, 3)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=-1).reshape(*stress.shape[:-1], 3, 3)
