"""How near a position is to a singular one: its condition, and what is weakest there, by name."""

import numpy as np

from ...model.by_size import by_size
from ...quick_dataclass import dataclass
from ..kinematics.position import Evaluator
from ..kinematics.rows import twice_g

SHARE = 0.2  # of the largest part of a combination: what is reported
MOST_REPORTED = 3
SWEEPS = 6  # of inverse iteration: each gains the distance to the next singular value, squared
ROUND_OFF = 1e12  # larger conditions have no digit that is more than round-off
TINY = 1e-14  # added to an exactly singular matrix, so that it has factors


@dataclass(frozen=True)
class Conditioning:
    """The smallest singular value of the scaled Jacobian at a position.

    `condition`: the largest over the smallest.  `motion` (coordinates,): the unit motion that the
    equations resist least; `combination` (equations,): that of the equations which is nearest to nothing.
    """

    condition: float
    motion: np.ndarray
    combination: np.ndarray


def conditioning(evaluator: Evaluator, q, t, expected) -> Conditioning:
    """The conditioning at q, for any number of equations that equals that of the coordinates."""
    evaluator.residual(q, t, expected)
    return _of_sparse(evaluator.sparse_matrix(q)) if evaluator.is_large else _of_dense(evaluator.matrix(q))


def _of_dense(matrix):
    left, values, right = np.linalg.svd(matrix)
    smallest = max(float(values[-1]), np.finfo(float).tiny)
    return Conditioning(float(values[0]) / smallest, right[-1], left[:, -1])


def _of_sparse(matrix):
    """By inverse iteration: singular values of a thousand bodies would take minutes."""
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    matrix = matrix.tocsc()
    try:
        factors = splu(matrix)
    except RuntimeError:  # SuperLU: "Factor is exactly singular"
        factors = splu(matrix + TINY * identity(matrix.shape[0], format="csc"))
    start = np.random.default_rng(1996).standard_normal(matrix.shape[0])
    combination = motion = start / np.linalg.norm(start)
    for _ in range(SWEEPS):
        motion = factors.solve(combination)
        motion /= np.linalg.norm(motion)
        combination = factors.solve(motion, "T")
        size = np.linalg.norm(combination)
        combination /= size
    return Conditioning(_largest_value(matrix, start) * size, motion, combination)


def _largest_value(matrix, vector):
    """The largest singular value to a few per cent, by power iteration."""
    for _ in range(20):
        vector = matrix.T @ (matrix @ vector)
        vector /= np.linalg.norm(vector)
    return float(np.linalg.norm(matrix @ vector))


def weakest_owners(evaluator: Evaluator, weak: Conditioning) -> list:
    """The equations with the largest shares of the combination, one an owner: joints if there are some."""
    size, owners = np.abs(weak.combination), {}
    for row in by_size(size):
        equation = evaluator.arrays.equations[row]
        if size[row] < SHARE * size.max():
            break
        if equation.place is not None:
            owners.setdefault(equation.owner, equation)
    joints = [one for one in owners.values() if "joint" in one.owner or "distance" in one.owner]
    # Shares that symmetry makes equal differ by round-off: the deck's order is the same everywhere.
    return sorted((joints or list(owners.values()))[:MOST_REPORTED], key=lambda one: one.place)


def conditioning_text(evaluator: Evaluator, q, weak: Conditioning) -> str:
    """Joints with their lines, condition and the motion that is hardly determined, in words."""
    owners = [f"{one.owner} (line {one.place.line})" for one in weakest_owners(evaluator, weak)]
    joints = f" of {', '.join(owners)}" if owners else ""
    size = f"{weak.condition:.0e}" if weak.condition < ROUND_OFF else f"above {ROUND_OFF:.0e}"
    return f"{joints} (condition {size}; {_motion(evaluator, q, weak.motion)} is least determined)"


def _motion(evaluator, q, motion):
    """The bodies that take the largest part in a motion, and how."""
    rates = (motion * evaluator.arrays.column_scale).reshape(-1, 7)
    size = np.linalg.norm(motion.reshape(-1, 7), axis=1)
    moving = [k for k in by_size(size)[:MOST_REPORTED] if size[k] > SHARE * size.max()]
    return ", ".join(
        _of_body(evaluator.arrays.body_names[k], q[7 * k + 3 : 7 * k + 7], rates[k]) for k in moving
    )


def _of_body(name, p, rates):
    omega = twice_g(p, rates[3:])
    turning = np.linalg.norm(omega) > SHARE * np.linalg.norm(rates[:3])
    direction = omega if turning else rates[:3]
    direction = direction / (direction[np.argmax(np.abs(direction))] or 1.0)
    x, y, z = np.round(direction / np.linalg.norm(direction), 3) + 0.0
    return f"{name} {'turning about' if turning else 'moving along'} ({x:g}, {y:g}, {z:g})"
