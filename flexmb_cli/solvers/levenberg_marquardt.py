"""Least squares by Levenberg and Marquardt's method, with Nielsen's damping.

Madsen, Nielsen and Tingleff, Methods for non-linear least squares problems (2nd ed. 2004), algorithm 3.16.
scipy's solver does the same; importing it takes longer than `flexmb check` of a deck.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


FIRST_DAMPING = 1e-3  # of the largest squared column of the Jacobian
LEAST_DAMPING = 1e-16  # of the same: with repeated equations the Jacobian itself has no inverse
LEAST_SPARSE = 1e-12  # the same where J.T J has lost half the digits
SMALLEST_MOVE = 1e-15  # of the size of x
SMALLEST_GAIN = 1e-15  # of the sum of squares
MOST_TRIALS = 200


def least_squares(
    residual: Callable[..., Any],
    jacobian: Callable[..., Any],
    x: np.ndarray,
    moved: Callable[..., Any] = np.add,
    first: float = FIRST_DAMPING,
    met: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """The x (N,) with the least sum of squares of residual(x) (m,) near the given one, and its residual.

    `jacobian` gives the derivative (m, n), dense or sparse, at the x of the last call of `residual`; `moved`
    gives the x after a step (n,).  `first`: damping of the first step, which keeps it short; `met`: the
    largest residual that ends the search.
    """
    r = residual(x)
    J = jacobian(x)
    is_dense = isinstance(J, np.ndarray)
    size = np.max(np.sum(J**2, axis=0)) if is_dense else J.power(2).sum(axis=0).max()
    least = (LEAST_DAMPING if is_dense else LEAST_SPARSE) * size
    damping, growth = first * size, 2.0
    for _ in range(MOST_TRIALS):
        step = (damped_step if is_dense else _sparse_step)(J, r, damping)
        if np.max(np.abs(r)) <= met or np.linalg.norm(step) <= SMALLEST_MOVE * (1.0 + np.linalg.norm(x)):
            break
        tried_x = moved(x, step)
        tried = residual(tried_x)
        gain = r @ r - tried @ tried
        if not gain > 0.0:
            damping, growth = damping * growth, 2.0 * growth
            continue
        expected = step @ (damping * step - J.T @ r)
        last = gain <= SMALLEST_GAIN * (r @ r)
        x, r = tried_x, tried
        if last:
            break
        J = jacobian(x)
        damping *= max(1.0 / 3.0, 1.0 - (2.0 * gain / expected - 1.0) ** 3)
        damping, growth = max(damping, least), 2.0
    return x, r


def damped_step(J: np.ndarray, r: np.ndarray, damping: float) -> np.ndarray:
    """The h (n,) with the least |J h + r|² + damping |h|², by orthogonal factors.

    J.T J would lose half the digits.
    """
    n = J.shape[1]
    Q, R = np.linalg.qr(np.vstack([J, np.sqrt(damping) * np.eye(n)]))
    return np.linalg.solve(R, -Q[: len(r)].T @ r)


def _sparse_step(J: "csr_matrix", r: np.ndarray, damping: float) -> np.ndarray:
    """As `damped_step` for a sparse Jacobian, by normal equations, which lose half the digits."""
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    normal = (J.T @ J + damping * identity(J.shape[1])).tocsc()
    found: np.ndarray = splu(normal, "MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(-J.T @ r)
    return found
