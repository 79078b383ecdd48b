"""Solid elements: shape functions, points of integration and strains of hexahedra and tetrahedra.

Hughes, The Finite Element Method (1987), sections 3.5 and 4.4; incompatible modes by Taylor, Beresford and
Wilson, Int. J. Num. Meth. Eng. 10 (1976), 1211-1219; mean dilatation (B-bar) by Nagtegaal, Parks and Rice,
Comp. Meth. Appl. Mech. Eng. 4 (1974), 153-177.  All elements at once: arrays begin with the element and the
point of integration.  Tetrahedra have their shape functions in `tetrahedra`.
"""

from dataclasses import dataclass

import numpy as np

from . import tetrahedra

_CORNERS = np.array(
    [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
    float,
)
# Nodes on the cube of side 2: corners, then the middles of the edges 1-2, 2-3, 3-4, 4-1, 5-6, 6-7,
# 7-8, 8-5, 1-5, 2-6, 3-7, 4-8 (Abaqus, ANSYS).
_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
CUBE = np.vstack([_CORNERS, [(_CORNERS[a] + _CORNERS[b]) / 2 for a, b in _EDGES]])
_INTERNAL = 3


@dataclass(frozen=True)
class Formulation:
    """Points of integration, of a hexahedron a direction, and whether nine incompatible modes are added.

    Their gradients are scaled by det J0 / det J, with J0 the Jacobian at the centre, so that they meet
    constant strain (Taylor, Beresford and Wilson); `scaled` False: by nothing, as in CalculiX.
    `mean_dilatation`: the volumetric strain is its mean over the element, as in C3D8 of Abaqus.
    """

    name: str
    points: int
    incompatible: bool = False
    scaled: bool = True
    mean_dilatation: bool = False


# Incompatible modes come before the formulation that they improve: the first that assembles to K is taken.
FORMULATIONS = {
    4: (Formulation("one point", 1),),
    8: (
        Formulation("incompatible modes", 2, True),
        Formulation("incompatible modes of CalculiX", 2, True, scaled=False),
        Formulation("full integration", 2),
        Formulation("mean dilatation", 2, mean_dilatation=True),
        Formulation("reduced integration", 1),
    ),
    10: (Formulation("four points", 4),),
    20: (Formulation("reduced integration", 2), Formulation("full integration", 3)),
}


def gauss_points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (count³, 3) and weights (count³,) on the cube of side 2."""
    x, w = np.polynomial.legendre.leggauss(count)
    points = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return points, np.einsum("i,j,k->ijk", w, w, w).ravel()


def integration_points(nodes: int, formulation: Formulation) -> tuple[np.ndarray, np.ndarray]:
    """Natural coordinates (g, 3) and weights (g,) of elements with so many nodes."""
    if nodes in tetrahedra.COUNTS:
        return tetrahedra.integration_points(formulation.points)
    return gauss_points(formulation.points)


def shape_slopes(points: np.ndarray, nodes: int) -> np.ndarray:
    """Derivatives of the shape functions in the natural coordinates, (points, nodes, 3)."""
    if nodes in tetrahedra.COUNTS:
        return tetrahedra.shape_slopes(points, nodes)
    if nodes == 8:
        return _slopes_of_products(points)
    slopes = np.empty((len(points), 20, 3))
    for a, node in enumerate(CUBE):
        slopes[:, a] = _corner_slopes(points, node) if a < 8 else _edge_slopes(points, node)
    return slopes


def _slopes_of_products(points: np.ndarray) -> np.ndarray:
    """N = (1 + xi a)(1 + eta b)(1 + zeta c)/8."""
    factors = 1 + points[:, None] * _CORNERS
    slopes = np.empty((len(points), 8, 3))
    for d, (e, f) in enumerate([(1, 2), (2, 0), (0, 1)]):
        slopes[..., d] = _CORNERS[:, d] * factors[..., e] * factors[..., f] / 8
    return slopes


def _corner_slopes(points: np.ndarray, node: np.ndarray) -> np.ndarray:
    """N = (1 + xi a)(1 + eta b)(1 + zeta c)(xi a + eta b + zeta c - 2)/8."""
    factors, last = 1 + points * node, points @ node - 2
    slopes = np.empty((len(points), 3))
    for d, (e, f) in enumerate([(1, 2), (2, 0), (0, 1)]):
        slopes[:, d] = node[d] * factors[:, e] * factors[:, f] * (last + factors[:, d]) / 8
    return slopes


def _edge_slopes(points: np.ndarray, node: np.ndarray) -> np.ndarray:
    """N = (1 - xi²)(1 + eta b)(1 + zeta c)/4 for an edge along xi, and so on."""
    d = int(np.flatnonzero(node == 0)[0])
    e, f = [axis for axis in range(3) if axis != d]
    factors, bubble = 1 + points * node, 1 - points[:, d] ** 2
    slopes = np.empty((len(points), 3))
    slopes[:, d] = -2 * points[:, d] * factors[:, e] * factors[:, f] / 4
    slopes[:, e] = bubble * node[e] * factors[:, f] / 4
    slopes[:, f] = bubble * node[f] * factors[:, e] / 4
    return slopes


@dataclass(frozen=True)
class SolidElements:
    """Elements (m) of k nodes in one formulation, integrated at g points.

    `gradients` (m, g, k + internal, 3), 1/m: of the shape functions, axes of the nodes; `volumes` (m, g), m³;
    `rows` (m, k): nodes from 0.
    """

    formulation: Formulation
    rows: np.ndarray
    gradients: np.ndarray
    volumes: np.ndarray

    @property
    def nodes(self) -> int:
        """k, the nodes of an element."""
        return int(self.rows.shape[1])

    def strains(self, part: slice) -> np.ndarray:
        """B (m, g, 6, 3 (k + internal)) of the elements `part`: xx yy zz xy yz zx, shears as angles."""
        gradients, volumes = self.gradients[part], self.volumes[part]
        dx, dy, dz = np.moveaxis(gradients, -1, 0)
        B = np.zeros((*dx.shape[:2], 6, dx.shape[2], 3))
        B[..., 0, :, 0], B[..., 1, :, 1], B[..., 2, :, 2] = dx, dy, dz
        B[..., 3, :, 0], B[..., 3, :, 1] = dy, dx
        B[..., 4, :, 1], B[..., 4, :, 2] = dz, dy
        B[..., 5, :, 2], B[..., 5, :, 0] = dx, dz
        if self.formulation.mean_dilatation:
            mean = np.einsum("mg,mgai->mai", volumes, gradients) / volumes.sum(axis=1)[:, None, None]
            B[..., :3, :, :] += ((mean[:, None] - gradients) / 3.0)[:, :, None]
        return B.reshape(*dx.shape[:2], 6, -1)


def node_coordinates(nodes: int) -> np.ndarray:
    """Return the natural coordinates (k, 3) of the nodes of elements with so many."""
    return (tetrahedra.NODES if nodes in tetrahedra.COUNTS else CUBE)[:nodes]


def jacobians(place: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return Jacobians (m, g, 3, 3) at natural `points` (g, 3) of elements of nodes at `place` (m, k, 3)."""
    return np.einsum("mki,gkj->mgij", place, shape_slopes(points, place.shape[1]))


def solid_elements(positions: np.ndarray, rows: np.ndarray, formulation: Formulation) -> SolidElements:
    """Elements `rows` (m, k) of nodes at `positions` (n, 3), m."""
    points, weights = integration_points(rows.shape[1], formulation)
    place = positions[rows]
    slopes = shape_slopes(points, rows.shape[1])
    jacobian = jacobians(place, points)
    inverse, volume = np.linalg.inv(jacobian), np.linalg.det(jacobian)
    gradients = np.einsum("gkj,mgji->mgki", slopes, inverse)
    if formulation.incompatible:
        det = volume if formulation.scaled else None
        gradients = np.concatenate([gradients, _incompatible(place, points, det)], axis=2)
    return SolidElements(formulation, rows, gradients, volume * weights)


def _incompatible(place: np.ndarray, points: np.ndarray, det: np.ndarray | None) -> np.ndarray:
    """Gradients of 1 - xi², 1 - eta², 1 - zeta² by the centre's Jacobian J0, times det J0 / `det` (m, g)."""
    centre = np.einsum("mki,kj->mij", place, shape_slopes(np.zeros((1, 3)), place.shape[1])[0])
    scale = np.ones((len(place), len(points))) if det is None else np.linalg.det(centre)[:, None] / det
    natural = -2 * points[:, :, None] * np.eye(_INTERNAL)
    return np.einsum("mg,gaj,mji->mgai", scale, natural, np.linalg.inv(centre))


def elasticity(young: float, poisson: float) -> np.ndarray:
    """Hooke's law (6, 6), Pa, for strains as `SolidElements.strains` has them."""
    shear = young / (2 * (1 + poisson))
    D = np.zeros((6, 6))
    D[:3, :3] = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    D[:3, :3] += 2 * shear * np.eye(3)
    D[3:, 3:] = shear * np.eye(3)
    return D
