"""Input of the kernels of a dynamic analysis, and one position by them: residuals and Jacobian on speeds."""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.accelerations import DENSE_START, evaluate_jacobian
from ...kernels.constrained.projection import evaluate_residual
from ...kernels.constrained.report import Report
from ...kernels.constrained.speeds import move
from ...kernels.constrained.system import PHI, System, Work, make_work
from ...model.arrays.contacts import columns_of_answers
from ...model.arrays.records import FUNCTION, function_record
from ...model.arrays.system import SystemArrays
from ...model.time_functions import POLYNOMIAL
from ..singular.mobility import MOST_DENSE

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def constrained_system(arrays: SystemArrays) -> System:
    """The kernels' view of a dynamic model."""
    same = (getattr(arrays, name) for name in System._fields[2:])
    return System(arrays.constraints, arrays.bodies_of, *same)


def new_work(arrays: SystemArrays) -> Work:
    """Work for the kernels."""
    return make_work(constrained_system(arrays), arrays.angles.size)


def blank_report(arrays: SystemArrays, times: np.ndarray, works: int = 0) -> Report:
    """A report for the given times (T,), s; the works of the first `works` loads are kept."""
    rows, n = times.size, arrays.speeds
    return Report(
        times, np.zeros((rows, 2 * n + arrays.bodies + len(arrays.signals.states) + 1 + works)),
        np.zeros((rows, n)),
        np.zeros((rows, len(arrays.groups), 2, 6)), np.zeros((rows, len(arrays.equations))), np.zeros(rows),
        np.zeros((rows, 5)), np.zeros((rows, len(arrays.loads), columns_of_answers(arrays.loads))),
        np.zeros((rows, len(arrays.joint_coordinates), 2)),
        np.zeros((rows, len(arrays.signals.values))),
    )  # fmt: skip


def dense_jacobian(work: Work) -> np.ndarray:
    """Return the scaled Jacobian (m, n) on speeds that was evaluated last, as a matrix."""
    counts, columns = work.columns[:, 0], work.columns[:, 1:]
    rows, places = np.nonzero(np.arange(columns.shape[1]) < counts[:, None])
    J = np.zeros((len(counts), len(work.motions)))
    J[rows, columns[rows, places]] = work.jacobian[rows, places]
    return J


def starts_sparse(arrays: SystemArrays) -> bool:
    """Return whether sparse matrices of the start take less time than dense ones."""
    return arrays.bodies > DENSE_START or is_large(arrays)


def is_large(arrays: SystemArrays) -> bool:
    """Return whether dense matrices of a mechanism would take seconds and hundreds of megabytes."""
    return arrays.speeds > MOST_DENSE


def sparse_jacobian(work: Work) -> "csr_matrix":
    """Return the scaled Jacobian (m, n) on speeds that was evaluated last."""
    from scipy.sparse import csr_matrix

    counts, columns = work.columns[:, 0], work.columns[:, 1:]
    rows, places = np.nonzero(np.arange(columns.shape[1]) < counts[:, None])
    shape = len(counts), len(work.motions)
    return csr_matrix((work.jacobian[rows, places], (rows, columns[rows, places])), shape)


def with_driven(system: System, row: int, values: np.ndarray, t: float) -> System:
    """Return the system whose equation `row` follows another value and two rates, `values` (3,), at t.

    A polynomial with these takes the place of its function.
    """
    value, rate, second = values
    c = value - rate * t + 0.5 * second * t * t, rate - second * t, 0.5 * second, 0.0
    primitives = system.primitives.copy()
    primitives["function"][row] = system.functions.size
    record = np.array([function_record(POLYNOMIAL, c)], dtype=FUNCTION)
    return system._replace(functions=np.append(system.functions, record), primitives=primitives)


class PositionGaps:
    """Scaled residuals of the equations, for messages and searches: the `Equations` of `projection`."""

    def __init__(self, arrays: SystemArrays, system: System, work: Work):
        self.arrays, self.system, self.work = arrays, system, work
        self.sparse = is_large(arrays)

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Scaled residual (m,) at q; expected: the angles expected."""
        self.work.angles[:] = expected
        evaluate_residual(self.system, self.work, q, t, expected)
        return self.work.rows[PHI] / self.arrays.row_scale

    def jacobian(self, q: np.ndarray) -> "np.ndarray | csr_matrix":
        """Scaled Jacobian (m, n) on speeds, sparse where it is large."""
        evaluate_jacobian(self.system, self.work, q)
        return sparse_jacobian(self.work) if self.sparse else dense_jacobian(self.work)

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the coordinates after a scaled step (n,) of translations, rotations and deformation."""
        q = q.copy()
        move(self.arrays.bodies, q, step * self.arrays.speed_scale)
        return q
