"""Meshes of triangles → a tree of boxes for the search of the nearest one."""

import numpy as np

MESH_BOX = np.dtype(
    [
        ("low", np.float64, 3),  # least corner, axes of the body from the point of the mesh on, m
        ("high", np.float64, 3),  # largest corner, m
        ("skip", np.int64),  # the box that follows if this one is passed over
        ("triangle", np.int64),  # that is in it, -1: boxes that follow
    ]
)


def mesh_boxes(triangles: np.ndarray, first_box: int, first_triangle: int) -> np.ndarray:
    """Return MESH_BOX records (2 n - 1,) of triangles (n, 9), m, in depth-first order.

    Each box is split at the median of the middles along its longest edge.
    """
    corners = triangles.reshape(-1, 3, 3)
    low, high, middle = corners.min(axis=1), corners.max(axis=1), corners.mean(axis=1)
    boxes = np.zeros(2 * len(triangles) - 1, MESH_BOX)
    waiting, n = [np.arange(len(triangles))], 0
    while waiting:
        group = waiting.pop()
        box = boxes[n : n + 1]
        box["low"], box["high"] = low[group].min(axis=0), high[group].max(axis=0)
        box["skip"], box["triangle"] = first_box + n + 2 * len(group) - 1, -1
        n += 1
        if len(group) == 1:
            box["triangle"] = first_triangle + group[0]
            continue
        axis = np.argmax(np.ptp(middle[group], axis=0))
        group = group[np.argsort(middle[group, axis], kind="stable")]
        waiting += [group[len(group) // 2 :], group[: len(group) // 2]]
    return boxes
