"""Conditioning of a position: its distance from a singular one, and what is weakest there, by name."""

from typing import Any

import numpy as np

from ...model.by_size import by_size
from ...model.equations import Equation
from ..kinematics.position import Evaluator
from ..kinematics.rows import twice_g
from .weakest import (
    REPORTED_SHARE,
    Conditioning,
    condition_text,
    conditioning_of,
    owners_text,
    weakest_owners,
)

MOST_WEAK_REPORTED = 3
SWEEPS = 6  # of inverse iteration: each gains the distance to the next singular value, squared
WORST_CONDITION = 1e12  # larger conditions have no digit that is more than round-off
REGULARISATION = 1e-14  # added to an exactly singular matrix, so that it has factors


def conditioning(evaluator: Evaluator, q: np.ndarray, t: float, expected: np.ndarray) -> Conditioning:
    """The conditioning at q, for any number of equations that equals that of the coordinates."""
    evaluator.residual(q, t, expected)
    return (
        _of_sparse(evaluator.sparse_matrix(q))
        if evaluator.is_large
        else conditioning_of(evaluator.jacobian(q), q.size)
    )


def _of_sparse(matrix: Any) -> Conditioning:
    """By inverse iteration: singular values of a thousand bodies would take minutes."""
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    matrix = matrix.tocsc()
    try:
        factors = splu(matrix)
    except RuntimeError:  # SuperLU: "Factor is exactly singular"
        factors = splu(matrix + REGULARISATION * identity(matrix.shape[0], format="csc"))
    start = np.random.default_rng(1996).standard_normal(matrix.shape[0])
    combination = motion = start / np.linalg.norm(start)
    for _ in range(SWEEPS):
        motion = factors.solve(combination)
        motion /= np.linalg.norm(motion)
        combination = factors.solve(motion, "T")
        size = np.linalg.norm(combination)
        combination /= size
    return Conditioning(_largest_value(matrix, start) * size, motion, combination)


def _largest_value(matrix: Any, vector: np.ndarray) -> Any:
    """The largest singular value to a few per cent, by power iteration."""
    for _ in range(20):
        vector = matrix.T @ (matrix @ vector)
        vector /= np.linalg.norm(vector)
    return float(np.linalg.norm(matrix @ vector))


def weakest_joints(evaluator: Evaluator, weak: Conditioning) -> list[Equation]:
    """The equations that are weakest, one a joint."""
    return weakest_owners(evaluator.arrays.equations, weak.combination, MOST_WEAK_REPORTED)


def conditioning_text(evaluator: Evaluator, q: np.ndarray, weak: Conditioning) -> str:
    """Joints with their lines, condition and the motion hardly determined at q (7 n,), in words."""
    owners = weakest_joints(evaluator, weak)
    joints = f" of {owners_text(owners)}" if owners else ""
    size = condition_text(weak.condition, WORST_CONDITION)
    return f"{joints} ({size}; {_motion(evaluator, q, weak.motion)} is least determined)"


def _motion(evaluator: Evaluator, q: np.ndarray, motion: np.ndarray) -> Any:
    """The bodies that take the largest part in a motion, and how."""
    rates = (motion * evaluator.arrays.column_scale).reshape(-1, 7)
    size = np.linalg.norm(motion.reshape(-1, 7), axis=1)
    moving = [k for k in by_size(size)[:MOST_WEAK_REPORTED] if size[k] > REPORTED_SHARE * size.max()]
    return ", ".join(
        _of_body(evaluator.arrays.body_names[k], q[7 * k + 3 : 7 * k + 7], rates[k]) for k in moving
    )


def _of_body(name: str, p: np.ndarray, rates: np.ndarray) -> str:
    omega = twice_g(p, rates[3:])
    turning = np.linalg.norm(omega) > REPORTED_SHARE * np.linalg.norm(rates[:3])
    direction = omega if turning else rates[:3]
    direction = direction / (direction[np.argmax(np.abs(direction))] or 1.0)
    x, y, z = np.round(direction / np.linalg.norm(direction), 3) + 0.0
    return f"{name} {'turning about' if turning else 'moving along'} ({x:g}, {y:g}, {z:g})"
