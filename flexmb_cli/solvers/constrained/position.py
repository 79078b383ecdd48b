"""One position of a mechanism of rigid and flexible bodies: residuals, and Jacobian on speeds."""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.accelerations import evaluate_jacobian
from ...kernels.constrained.projection import evaluate_residual
from ...kernels.constrained.speeds import move
from ...kernels.constrained.system import PHI, System, Work
from ...model.arrays.system import SystemArrays
from .large_start import is_large, sparse_jacobian
from .system import dense_jacobian

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class PositionGaps:
    """Scaled residuals of the equations, for messages and searches: the `Equations` of `projection`."""

    def __init__(self, arrays: SystemArrays, system: System, work: Work):
        self.arrays, self.system, self.work = arrays, system, work
        self.sparse = is_large(arrays)

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Scaled residual (m,) at q; expected: the angles expected."""
        evaluate_residual(self.system, self.work, q, t, expected)
        found: np.ndarray = self.work.rows[PHI] / self.arrays.row_scale
        return found

    def jacobian(self, q: np.ndarray) -> "np.ndarray | csr_matrix":
        """Scaled Jacobian (m, n) on speeds, sparse where it is large."""
        evaluate_jacobian(self.system, self.work, q)
        return sparse_jacobian(self.work) if self.sparse else dense_jacobian(self.work)

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the coordinates after a scaled step (n,) of translations, rotations and deformation."""
        q = q.copy()
        move(self.arrays.bodies, q, step * self.arrays.speed_scale)
        return q
