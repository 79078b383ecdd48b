"""Single constraints of every type between bodies with random geometry, as the kernels see them."""

import numpy as np

from flexmb_cli.kernels.kinematics import constraints as equations
from flexmb_cli.kernels.linalg.rotation import rotation_matrices, rotation_rates
from flexmb_cli.model.arrays.kinematic import kinematic_arrays
from flexmb_cli.model.joints import BY_NAME, JOINT_TYPES
from flexmb_cli.model.mechanism import Body, Distance, Driver, Joint, Mechanism, Simplified, TimeGrid
from tests.solvers.kinematics.geometry import product, unit

JOINTS = [kind.name for kind in JOINT_TYPES]
CONSTRAINTS = [
    *JOINTS,
    *(f"{kind} {direction}" for kind in ("simplified", "distance", "driver") for direction in range(1, 7)),
    "normalisation",
]
BODIES = 3


def vector(random, low=0.3, high=2.0):
    """A vector in any direction, of a length between low and high."""
    return tuple(unit(random.standard_normal(3)) * random.uniform(low, high))


def any_position(random, bodies=BODIES) -> np.ndarray:
    """Coordinates (7 bodies,), Euler parameters of lengths near 1 but not 1."""
    q = random.uniform(-2.0, 2.0, (bodies, 7))
    q[:, 3:] *= random.uniform(0.8, 1.2, (bodies, 1)) / np.linalg.norm(q[:, 3:], axis=1, keepdims=True)
    return q.ravel()


def random_joint(kind, random, i=2, j=0) -> Joint:
    """A joint with all its vectors oblique, of other lengths than 1."""
    vectors = {name: vector(random) for name in ("s_i", "s_j", "h_i", "h_j")}
    return Joint(kind, f"{kind} 1", i, j, vector(random), vector(random), **vectors, pitch=0.37)


class SingleConstraint:
    """The rows of one constraint among three bodies: residual, Jacobian, right-hand sides."""

    def __init__(self, label: str, random):
        kind, _, direction = label.partition(" ")
        items = _items(kind, int(direction or 0), random)
        q = any_position(random)
        bodies = tuple(
            Body(f"body {k + 1}", tuple(x[:3]), tuple(unit(x[3:]))) for k, x in enumerate(q.reshape(-1, 7))
        )
        self.arrays = kinematic_arrays(Mechanism(bodies, TimeGrid(0.0, 1.0, 1.0), **items))
        last = -1 if kind == "normalisation" else 0
        first = int(self.arrays.constraints["first_row"][last])
        count = 2 if kind == "driver" and int(direction) > 3 else BY_NAME[kind].equations
        self.rows = slice(first, first + count)

    def residual(self, q, t=0.0, near=0.0) -> np.ndarray:
        """Rows of Φ (n,); `near`: the angle expected of a screw."""
        phi = np.zeros(len(self.arrays.equations))
        A = self._rotations(q, np.zeros_like(q))[0]
        equations.residual(self.arrays.constraints, q, t, np.array([near]), A, phi)
        return phi[self.rows]

    def jacobian(self, q) -> np.ndarray:
        """Rows of Φ_q, spread over all coordinates (n, 7 bodies)."""
        halves = np.zeros((len(self.arrays.equations), 14))
        equations.jacobian(self.arrays.constraints, q, self._rotations(q, np.zeros_like(q))[0], halves)
        matrix = np.zeros((len(halves), q.size))
        for row, (i, j) in enumerate(self.arrays.bodies_of):
            matrix[row, 7 * i : 7 * i + 7] += halves[row, :7]
            matrix[row, 7 * j : 7 * j + 7] += halves[row, 7:]
        return matrix[self.rows]

    def velocity_side(self, t) -> np.ndarray:
        """Rows of -∂Φ/∂t (n,)."""
        nu = np.zeros(len(self.arrays.equations))
        equations.velocity(self.arrays.constraints, t, nu)
        return nu[self.rows]

    def acceleration_side(self, q, qd, t) -> np.ndarray:
        """Rows of γ (n,)."""
        gamma = np.zeros(len(self.arrays.equations))
        equations.acceleration(self.arrays.constraints, q, qd, t, self._rotations(q, qd), gamma)
        return gamma[self.rows]

    @staticmethod
    def _rotations(q, qd):
        rotations = np.zeros((3, q.size // 7, 3, 3))
        rotation_matrices(q, rotations[0])
        rotation_rates(q, qd, rotations[1], rotations[2])
        return rotations


def _items(kind, direction, random):
    if kind in JOINTS:
        return {"joints": (random_joint(kind, random),)}
    if kind == "simplified":
        return {"simplified": (Simplified("simplified 1", 1, direction, 0.8),)}
    if kind == "distance":
        return {"distances": (Distance("distance 1", 2, 1, direction, 0.6),)}
    if kind == "driver":
        return {"drivers": (Driver("driver 1", 1, direction, 0.5, -0.9, 0.7),)}
    return {}


def moved(q, turn, shift, A) -> np.ndarray:
    """Coordinates of the same bodies after the whole is turned by (turn, its matrix A) and shifted."""
    out = q.reshape(-1, 7).copy()
    for body in out:
        body[:3] = A @ body[:3] + shift
        body[3:] = product(turn, body[3:])
    return out.ravel()
