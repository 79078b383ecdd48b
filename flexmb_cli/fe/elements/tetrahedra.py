"""Tetrahedra of 4 and 10 nodes: shape functions and points of integration.

Zienkiewicz and Taylor, The Finite Element Method, volume 1: with the volume coordinates
L1 = 1 - xi - eta - zeta, L2 = xi, L3 = eta, L4 = zeta a corner has N = (2 L - 1) L, the middle of an edge
N = 4 L_a L_b.
"""

import numpy as np

COUNTS = (4, 10)
# Nodes 5 to 10 lie on the edges 1-2, 2-3, 3-1, 1-4, 2-4, 3-4 (Abaqus, ANSYS, Nastran).
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
NODES = np.vstack([_CORNERS, [(_CORNERS[a] + _CORNERS[b]) / 2 for a, b in EDGES]])
# Derivatives of L1 to L4 in xi, eta, zeta.
_SLOPES = np.array([(-1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
_VOLUME = 1 / 6


def integration_points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Natural coordinates (count, 3) and weights (count,) of the rule with one point or four."""
    if count == 1:
        return np.full((1, 3), 0.25), np.array([_VOLUME])
    near, far = (5 + 3 * np.sqrt(5)) / 20, (5 - np.sqrt(5)) / 20
    points = np.full((4, 3), far)
    points[[1, 2, 3], [0, 1, 2]] = near
    return points, np.full(4, _VOLUME / 4)


def shape_values(points: np.ndarray, nodes: int) -> np.ndarray:
    """Shape functions, (points, nodes)."""
    L = np.column_stack([1 - points.sum(axis=1), points])
    if nodes == 4:
        return L
    return np.hstack([(2 * L - 1) * L, *(4 * L[:, [i]] * L[:, [j]] for i, j in EDGES)])


def shape_slopes(points: np.ndarray, nodes: int) -> np.ndarray:
    """Derivatives of the shape functions in xi, eta, zeta, (points, nodes, 3)."""
    if nodes == 4:
        return np.tile(_SLOPES, (len(points), 1, 1))
    L = np.column_stack([1 - points.sum(axis=1), points])
    slopes = np.empty((len(points), 10, 3))
    slopes[:, :4] = (4 * L - 1)[:, :, None] * _SLOPES
    for a, (i, j) in enumerate(EDGES, start=4):
        slopes[:, a] = 4 * (L[:, i, None] * _SLOPES[j] + L[:, j, None] * _SLOPES[i])
    return slopes
