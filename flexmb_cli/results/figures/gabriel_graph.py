"""Lines between a body's points when it is drawn.

Gabriel and Sokal, Systematic Zoology 18 (1969), 259-278: two points are neighbours when the sphere on the
line between them holds no third one.  Points in a row become a chain, three points of a link a triangle
or an angle, and the nodes of a regular finite-element mesh its edges.
"""

import numpy as np

# The sphere of an edge of a rectangle passes through no other corner, that of its diagonal through two,
# also when node tables give six digits.
TOUCH = 1e-5


def gabriel_edges(points: np.ndarray) -> np.ndarray:
    """Pairs (m, 2), i < j, of neighbours among different `points` (n, 3).

    A point on the sphere counts as inside, so that rectangles have no diagonals.
    """
    points = np.asarray(points, float)
    square = np.sum((points[:, None] - points) ** 2, axis=-1)
    pairs = []
    for i in range(len(points) - 1):
        later = np.arange(i + 1, len(points))
        # |ik|² + |kj|² <= |ij|²: k lies in the sphere on ij.
        inside = square[i] + square[later] <= square[i, later][:, None] * (1 + TOUCH)
        inside[:, i] = inside[np.arange(len(later)), later] = False
        pairs += [(i, int(j)) for j in later[~inside.any(axis=1)]]
    return np.array(pairs, int).reshape(-1, 2)


def different(points: np.ndarray, distance: float) -> list[int]:
    """Indices of `points` (n, 3) without those within `distance` of an earlier one."""
    kept: list[int] = []
    for k, point in enumerate(points):
        if not kept or np.min(np.linalg.norm(points[kept] - point, axis=1)) > distance:
            kept.append(k)
    return kept
