"""Joint coordinates of bodies in absolute coordinates: their motion relative to a parent body.

A spanning tree of the joints gives every body a parent.  The six coordinates of a body are the
displacement of its mass centre and its rotation relative to the parent, along axes that turn with the
motion.  They are linear functionals L d of the displacements d (n,): of the origin in global axes and
the rotation in body axes, body by body, then of the modal coordinates.
"""

import numpy as np

from ...model.arrays.constraint_table import tilde
from ...model.arrays.system import SystemArrays
from ...model.mechanism import GROUND
from ...model.vectors import rotation_matrix

# Axes that the displacements are resolved in: of the body itself, of its parent, or at rest.
OWN, PARENT, INERTIAL = "own", "parent", "inertial"
AXES = (OWN, PARENT, INERTIAL)
SPRING_WEIGHT = 0.01  # of one equation: a spring names a parent where no joint does
# Preference for dependent coordinates where several would do: displacements, then rotations, then modes.
PREFERENCE = {"displacement": 1.0, "rotation": 0.2, "mode": 0.02}


class JointCoordinates:
    """The n relative coordinates of a mechanism along `axes`, one of AXES."""

    def __init__(self, arrays: SystemArrays, axes: str = OWN):
        self.arrays, self.axes = arrays, axes
        self.parents = [GROUND] * arrays.bodies if axes == INERTIAL else parents_of(arrays)
        masses = arrays.masses["mass"]
        self.centres = arrays.masses["moment"] / np.where(masses > 0.0, masses, 1.0)[:, None]

    def functionals(self, q: np.ndarray) -> np.ndarray:
        """Return L (n, n) at the coordinates q."""
        arrays = self.arrays
        poses = q[: 7 * arrays.bodies].reshape(-1, 7)
        R = [rotation_matrix(p) for p in poses[:, 3:]]
        L = np.eye(arrays.speeds)
        for body, parent in enumerate(self.parents):
            across = self._axes_of(body, parent, R).T
            centre = poses[body, :3] + R[body] @ self.centres[body]
            rows = slice(6 * body, 6 * body + 6)
            L[rows, rows] = _carried(across, centre - poses[body, :3], R[body])
            if parent != GROUND:
                columns = slice(6 * parent, 6 * parent + 6)
                L[rows, columns] = -_carried(across, centre - poses[parent, :3], R[parent])
        return L

    def _axes_of(self, body: int, parent: int, R: list[np.ndarray]) -> np.ndarray:
        if self.axes == OWN:
            return R[body]
        return np.eye(3) if parent == GROUND else R[parent]

    def independent(self, L: np.ndarray, jacobian: np.ndarray, rank: int) -> np.ndarray:
        """Return the numbers (n - rank,) of independent coordinates; jacobian (m, n): of scaled columns."""
        scale = self.arrays.speed_scale
        columns = (jacobian / scale) @ np.linalg.inv(L) * scale * self._weights()
        return np.flatnonzero(~dependent_columns(columns, rank))

    def _weights(self) -> np.ndarray:
        body = [PREFERENCE["displacement"]] * 3 + [PREFERENCE["rotation"]] * 3
        modes = self.arrays.speeds - 6 * self.arrays.bodies
        return np.array(body * self.arrays.bodies + [PREFERENCE["mode"]] * modes)

    def parent_name(self, k: int) -> str:
        """Return the name of the body that coordinate k is relative to, "" for the ground and for modes."""
        if k >= 6 * self.arrays.bodies or self.parents[k // 6] == GROUND:
            return ""
        return self.arrays.body_names[self.parents[k // 6]]


def _carried(across: np.ndarray, body_vector: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Displacement at `body_vector` (3,) from the origin of a body, and its rotation, along axes: (6, 6)."""
    block = np.zeros((6, 6))
    block[:3, :3], block[:3, 3:], block[3:, 3:] = across, -across @ tilde(body_vector) @ R, across @ R
    return block


def dependent_columns(columns: np.ndarray, rank: int) -> np.ndarray:
    """Return which (n,) of the columns (m, n) span the others, by orthogonalisation with column pivoting."""
    dependent, columns = np.zeros(columns.shape[1], bool), columns.copy()
    for _ in range(rank):
        sizes = np.where(dependent, -1.0, np.linalg.norm(columns, axis=0))
        # Round-off does not choose between equal columns.
        best = int(np.flatnonzero(sizes >= (1.0 - 1e-6) * sizes.max())[0])
        along = columns[:, best] / sizes[best]
        columns -= np.outer(along, along @ columns)
        dependent[best] = True
    return dependent


def parents_of(arrays: SystemArrays) -> list[int]:
    """Return the parent of every body in a spanning tree that takes joints with most equations first."""
    weights = _weights_of_pairs(arrays)
    parents, reached = [GROUND] * arrays.bodies, [GROUND]
    left = list(range(arrays.bodies))
    while left:
        weight, _, _, body, parent = max(
            (weights.get((min(a, b), max(a, b)), 0.0), -b, -k, b, a)
            for k, a in enumerate(reached)
            for b in left
        )
        parents[body] = parent if weight > 0.0 else GROUND
        reached.append(body)
        left.remove(body)
    return parents


def _weights_of_pairs(arrays: SystemArrays) -> dict[tuple[int, int], float]:
    weights: dict[tuple[int, int], float] = {}
    for group in arrays.groups:
        i, j = int(group["body_i"]), int(group["body_j"])
        pair = (GROUND, i) if i == j else (min(i, j), max(i, j))
        weights[pair] = weights.get(pair, 0.0) + float(group["end_row"] - group["first_row"])
    for load in arrays.loads:
        if load["primitive"] >= 0:
            body_vectors = arrays.primitives[load["primitive"]]["ends"][0]
            i, j = sorted(
                int(arrays.body_vectors[body_vector]["body"]) if body_vector >= 0 else GROUND
                for body_vector in body_vectors
            )
            weights[i, j] = weights.get((i, j), 0.0) + SPRING_WEIGHT
    return weights
