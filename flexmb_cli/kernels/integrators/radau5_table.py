"""Numbers of Radau's method IIA of order 5.

Hairer and Wanner, Solving Ordinary Differential Equations II (second edition), section IV.8: the
eigenvalues of the method's matrix, the estimate of its error.
"""

import numpy as np

STAGES = 3
_R = 6.0**0.5
TIMES = np.array([(4.0 - _R) / 10.0, (4.0 + _R) / 10.0, 1.0])
WEIGHTS = np.array(
    [
        [(88.0 - 7.0 * _R) / 360.0, (296.0 - 169.0 * _R) / 1800.0, (-2.0 + 3.0 * _R) / 225.0],
        [(296.0 + 169.0 * _R) / 1800.0, (88.0 + 7.0 * _R) / 360.0, (-2.0 - 3.0 * _R) / 225.0],
        [(16.0 - _R) / 36.0, (16.0 + _R) / 36.0, 1.0 / 9.0],
    ]
)

# Of the powers of loads, rows NOW, BEHIND and the stages, in the work of a step.
QUADRATURE = np.array([0.0, 0.0, *WEIGHTS[STAGES - 1]])

# Eigenvalues of WEIGHTS: one is real, the others are a complex one and its conjugate.
_C = 9.0 ** (1.0 / 3.0)
REAL = (6.0 + _C * (_C - 1.0)) / 30.0
COMPLEX = complex(12.0 - _C * (_C - 1.0), _C * (_C + 1.0) * 3.0**0.5) / 60.0


def _eigenvectors(value: complex) -> tuple[np.ndarray, np.ndarray]:
    """Right and left eigenvector of WEIGHTS (3,) each, their product 1."""
    left = WEIGHTS - value * np.eye(STAGES)
    right, transposed = np.cross(left[0], left[1]), np.cross(left[:, 0], left[:, 1])
    return right, transposed / np.sum(transposed * right)


REAL_RIGHT, REAL_LEFT = _eigenvectors(REAL)
COMPLEX_RIGHT, COMPLEX_LEFT = _eigenvectors(COMPLEX)

# What the stages' increments contribute to the error, besides REAL h times the slope at the start.
ERROR = REAL / 3.0 * np.array([-13.0 - 7.0 * _R, -13.0 + 7.0 * _R, -1.0])
