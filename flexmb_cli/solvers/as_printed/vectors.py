"""Vectors and Euler parameters as the program has them: A = G Lᵀ without |p| = 1 put in.

Products are sums of elements in a fixed order and never BLAS's, whose last digits depend on the processor.
"""

import numpy as np


def g_matrix(p: np.ndarray) -> np.ndarray:
    """G (3, 4) of Young (1996), section 3.3."""
    e0, e1, e2, e3 = p
    return np.array([[-e1, e0, -e3, e2], [-e2, e3, e0, -e1], [-e3, -e2, e1, e0]])


def l_matrix(p: np.ndarray) -> np.ndarray:
    """L (3, 4) of Young (1996), section 3.3."""
    e0, e1, e2, e3 = p
    return np.array([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Matrix (m, n) times matrix (n, k), or times vector (n,)."""
    if b.ndim == 1:
        return product(a, b[:, None])[:, 0]
    return np.add.reduce(a[:, :, None] * b[None, :, :], axis=1)


def dot(a: np.ndarray, b: np.ndarray) -> float:
    """Scalar product of two vectors (3,)."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def tilde(a: np.ndarray) -> np.ndarray:
    """The matrix of a × (3, 3)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def turned(p: np.ndarray, s: np.ndarray) -> np.ndarray:
    """G(p) L(p)ᵀ s (3,), p (4,), s (3,): A s of Euler parameters.

    Of their rates it is half the remainder of the second derivative of A s.
    """
    return product(g_matrix(p), product(l_matrix(p).T, np.asarray(s, dtype=float)))


def turned_slope(p: np.ndarray, s: np.ndarray) -> np.ndarray:
    """G(p) s̄ (3, 4), half the derivative of A s with respect to p (4.9)."""
    bar = np.zeros((4, 4))
    bar[0, 1:] = np.negative(s)
    bar[1:, 0] = s
    bar[1:, 1:] = -tilde(s)
    return product(g_matrix(p), bar)


def solved(matrix: np.ndarray, right: np.ndarray, smallest_pivot: float) -> np.ndarray | None:
    """Solution (n,) of a linear system (n, n) by elimination with row exchange, `right` (n,).

    None below the smallest pivot.
    """
    a = np.column_stack([matrix, right])
    n = len(right)
    for k in range(n):
        best = k + int(np.argmax(np.abs(a[k:, k])))
        if not abs(a[best, k]) > smallest_pivot:
            return None
        a[[k, best]] = a[[best, k]]
        a[k + 1 :] -= (a[k + 1 :, k] / a[k, k])[:, None] * a[k]
    x = a[:, n].copy()
    for k in range(n - 1, -1, -1):
        x[k] /= a[k, k]
        x[:k] -= a[:k, k] * x[k]
    return x
