"""What a dynamic analysis hands to the kernels."""

import numpy as np

from ..kernels import constraints as equations
from ..kernels.constrained_report import Report
from ..kernels.constrained_system import PHI, A, System, Work, make_work
from ..kernels.rotation import rotation_matrices
from ..model.dynamic_arrays import DynamicArrays
from .position import Evaluator


def constrained_system(arrays: DynamicArrays) -> System:
    """The kernels' view of a dynamic model."""
    return System(
        arrays.kinematic.constraints,
        arrays.kinematic.bodies_of,
        arrays.row_scale,
        arrays.speed_scale,
        arrays.masses,
        arrays.loads,
        arrays.tables,
        arrays.table_ends,
        arrays.gravity,
    )


def new_work(arrays: DynamicArrays) -> Work:
    """Work for the kernels."""
    return make_work(len(arrays.kinematic.equations), len(arrays.masses))


def blank_report(arrays: DynamicArrays, times) -> Report:
    """A report for the given times."""
    rows, bodies = times.size, len(arrays.masses)
    count, constraints = len(arrays.kinematic.equations), len(arrays.kinematic.constraints)
    return Report(
        times,
        np.zeros((rows, 13 * bodies + 1)),
        np.zeros((rows, 6 * bodies)),
        np.zeros((rows, constraints, 2, 6)),
        np.zeros((rows, count)),
        np.zeros(rows),
        np.zeros((rows, 4)),
    )


class AnyCountEvaluator(Evaluator):
    """An evaluator for any number of equations: redundant ones, and freedoms left open.

    Its system and work are those of constrained dynamics; |p| = 1 is not among its equations.
    """

    def residual(self, q, t, near) -> np.ndarray:
        """Scaled residual (equations,) at q; near (screws,) are the angles expected."""
        rotations, phi = self.work.rotations[A], self.work.rows[PHI]
        rotation_matrices(q, rotations)
        equations.residual(self.system.constraints, q, t, near, rotations, phi)
        return phi / self.arrays.row_scale
