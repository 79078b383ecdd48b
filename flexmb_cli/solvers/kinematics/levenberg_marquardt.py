"""Least squares by Levenberg and Marquardt's method, with Nielsen's damping.

Madsen, Nielsen and Tingleff, Methods for non-linear least squares problems (2nd ed. 2004), algorithm 3.16.
scipy's solver does the same; importing it takes longer than `flexmb check` of a deck.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable


FIRST_DAMPING = 1e-3  # of the largest squared column of the Jacobian
LEAST_DAMPING = 1e-16  # of the same: with repeated equations the Jacobian itself has no inverse
SMALLEST_MOVE = 1e-15  # of the size of x
SMALLEST_GAIN = 1e-15  # of the sum of squares
MOST_TRIALS = 200


def least_squares(
    residual: "Callable[..., Any]", jacobian: "Callable[..., Any]", x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The x (n,) with the least sum of squares of residual(x) (m,) near the given one, and its residual.

    `jacobian` gives the derivative (m, n) at the x of the last call of `residual`.
    """
    r = residual(x)
    J = jacobian(x)
    size = np.max(np.sum(J**2, axis=0))
    damping, growth = FIRST_DAMPING * size, 2.0
    for _ in range(MOST_TRIALS):
        step = damped_step(J, r, damping)
        if np.linalg.norm(step) <= SMALLEST_MOVE * (1.0 + np.linalg.norm(x)):
            break
        tried = residual(x + step)
        gain = r @ r - tried @ tried
        if not gain > 0.0:
            damping, growth = damping * growth, 2.0 * growth
            continue
        expected = step @ (damping * step - J.T @ r)
        last = gain <= SMALLEST_GAIN * (r @ r)
        x, r = x + step, tried
        if last:
            break
        J = jacobian(x)
        damping *= max(1.0 / 3.0, 1.0 - (2.0 * gain / expected - 1.0) ** 3)
        damping, growth = max(damping, LEAST_DAMPING * size), 2.0
    return x, r


def damped_step(J: np.ndarray, r: np.ndarray, damping: float) -> np.ndarray:
    """The h (n,) with the least |J h + r|² + damping |h|², by orthogonal factors.

    J.T J would lose half the digits.
    """
    n = J.shape[1]
    Q, R = np.linalg.qr(np.vstack([J, np.sqrt(damping) * np.eye(n)]))
    return np.linalg.solve(R, -Q[: len(r)].T @ r)
