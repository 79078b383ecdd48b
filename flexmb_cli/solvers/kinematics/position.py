"""One position of a mechanism: residuals and Jacobian as matrices, with the names of their rows."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.kinematics import constraints as equations
from ...kernels.kinematics.newton import System, Work, evaluate_position
from ...kernels.linalg.rotation import A
from ...model.arrays.kinematic import KinematicArrays
from ...quick_dataclass import dataclass

if TYPE_CHECKING:
    from ...kernels.constrained.system import System as ConstrainedSystem
    from ...kernels.constrained.system import Work as ConstrainedWork

DENSE_LIMIT = 350  # equations; above, matrices are sparse


def light_work(coordinates: int) -> Work:
    """Work of the kernels without room for dense factors."""
    return Work(
        np.zeros((3, coordinates // 7, 3, 3)),
        np.zeros((6, coordinates)),
        np.zeros((coordinates, 14)),
        np.zeros((0, 0)),
        np.zeros(0, dtype=np.int64),
        np.zeros((0, 1), dtype=np.int64),
    )


@dataclass(frozen=True)
class Evaluator:
    """Evaluates the constraints of one mechanism at any position, all in scaled units.

    It is the `Equations` of `solvers.projection`.
    """

    arrays: KinematicArrays
    system: "System | ConstrainedSystem"
    work: "Work | ConstrainedWork"

    @classmethod
    def of(cls, arrays: KinematicArrays, system: System) -> "Evaluator":
        """An evaluator with its own work arrays."""
        return cls(arrays, system, light_work(arrays.q.size))

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Scaled residual (equations,) at q; expected (screws,) are the angles expected."""
        evaluate_position(self.system, self.work, q, t, expected)
        found: np.ndarray = self.work.vectors[0, : self.arrays.row_scale.size] / self.arrays.row_scale
        return found

    def rows(self, q: np.ndarray) -> np.ndarray:
        """Jacobian rows phi_q (equations, 14), unscaled, at the q of the last `residual`."""
        equations.jacobian(self.system.constraints, q, self.work.rotations[A], self.work.phi_q)
        return self.work.phi_q[: self.arrays.row_scale.size]

    def entries(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows, columns and scaled values of the Jacobian's entries, halves of one body added up."""
        rows = self.rows(q)
        bodies = self.arrays.bodies_of
        place = np.arange(7)
        columns = np.concatenate([7 * bodies[:, :1] + place, 7 * bodies[:, 1:] + place], axis=1)
        values = rows * self.arrays.column_scale[columns] / self.arrays.row_scale[:, None]
        row_numbers = np.broadcast_to(np.arange(len(rows))[:, None], columns.shape)
        return row_numbers, columns, values

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Scaled Jacobian (equations, coordinates), dense, at the q of the last `residual`."""
        rows, columns, values = self.entries(q)
        matrix = np.zeros((len(rows), q.size))
        np.add.at(matrix, (rows, columns), values)
        return matrix

    def sparse_matrix(self, q: np.ndarray) -> Any:
        """The same as a scipy CSR matrix."""
        from scipy.sparse import coo_matrix

        rows, columns, values = self.entries(q)
        shape = (len(rows), q.size)
        return coo_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape).tocsr()

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the coordinates after a scaled step (coordinates,)."""
        found: np.ndarray = q + step * self.arrays.column_scale
        return found

    @property
    def is_large(self) -> bool:
        """Return whether dense matrices would be wasteful."""
        return self.arrays.q.size > DENSE_LIMIT
