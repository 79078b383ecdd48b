"""One position of a mechanism: input of the kernels, residuals and Jacobian with the names of their rows."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...kernels.kinematics import constraints as equations
from ...kernels.kinematics.newton import COLUMN, RANK, System, Work, evaluate_position, make_work
from ...kernels.linalg.rotation import A
from ...model.arrays.kinematic import KinematicArrays
from ...model.joints import DRIVER, SIMPLIFIED

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ...kernels.constrained.system import System as ConstrainedSystem
    from ...kernels.constrained.system import Work as ConstrainedWork


DENSE_LIMIT = 700  # equations; above, matrices are sparse


def matrix_of(columns: np.ndarray, values: np.ndarray, count: int, *, sparse: bool) -> Any:
    """Return the matrix (rows, count) with `values` at `columns` of each row, those at one place added up."""
    rows = np.broadcast_to(np.arange(len(columns))[:, None], columns.shape)
    if sparse:
        from scipy.sparse import coo_matrix

        places = rows.ravel(), columns.ravel()
        return coo_matrix((values.ravel(), places), (len(columns), count)).tocsr()
    matrix = np.zeros((len(columns), count))
    np.add.at(matrix, (rows, columns), values)
    return matrix


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
        return cls(arrays, system, make_work(arrays.q.size, 0))

    def residual(self, q: np.ndarray, t: float, expected: np.ndarray) -> np.ndarray:
        """Scaled residual (equations,) at q; expected (screws,) are the angles expected."""
        evaluate_position(self.system, self.work, q, t, expected)
        return self.work.vectors[0, : self.arrays.row_scale.size] / self.arrays.row_scale

    def rows(self, q: np.ndarray) -> np.ndarray:
        """Jacobian rows phi_q (equations, 14), unscaled, at the q of the last `residual`."""
        equations.jacobian(self.system.constraints, q, self.work.rotations[A], self.work.phi_q)
        return self.work.phi_q[: self.arrays.row_scale.size]

    def entries(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Columns and scaled values (equations, 14) of the Jacobian's entries: halves of one body add up."""
        rows = self.rows(q)
        bodies = self.arrays.bodies_of
        place = np.arange(7)
        columns = np.concatenate([7 * bodies[:, :1] + place, 7 * bodies[:, 1:] + place], axis=1)
        values = rows * self.arrays.column_scale[columns] / self.arrays.row_scale[:, None]
        return columns, values

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Scaled Jacobian (equations, coordinates), dense, at the q of the last `residual`."""
        return matrix_of(*self.entries(q), q.size, sparse=False)

    def sparse_matrix(self, q: np.ndarray) -> Any:
        """The same as a scipy CSR matrix."""
        return matrix_of(*self.entries(q), q.size, sparse=True)

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the coordinates after a scaled step (coordinates,)."""
        return q + step * self.arrays.column_scale

    @property
    def is_large(self) -> bool:
        """Return whether dense matrices would be wasteful."""
        return self.arrays.q.size > DENSE_LIMIT


class Poses:
    """The equations of an `Evaluator` where bodies move by translations and rotations: |p| = 1 always."""

    def __init__(self, evaluator: Evaluator):
        self.evaluator, self.arrays = evaluator, evaluator.arrays
        self.residual = evaluator.residual

    def jacobian(self, q: np.ndarray) -> "np.ndarray | csr_matrix":
        """Scaled Jacobian (equations, 6 bodies), rotations about body axes, sparse where it is large."""
        rows, arrays = self.evaluator.rows(q), self.arrays
        halves = []
        for half in (0, 1):
            e0, e1, e2, e3 = q.reshape(-1, 7)[arrays.bodies_of[:, half], 3:].T
            L = np.array([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])
            own = rows[:, 7 * half : 7 * half + 7]
            halves += [own[:, :3] * arrays.length, 0.5 * np.einsum("kcm,mc->mk", L, own[:, 3:])]
        values = np.concatenate(halves, axis=1) / arrays.row_scale[:, None]
        columns = (6 * arrays.bodies_of[:, :, None] + np.arange(6)).reshape(len(rows), 12)
        return matrix_of(columns, values, 6 * (q.size // 7), sparse=self.evaluator.is_large)

    def moved(self, q: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the coordinates after a scaled step (6 bodies,)."""
        positions, parts = q.reshape(-1, 7).copy(), step.reshape(-1, 6)
        turn = parts[:, 3:]
        angle = np.linalg.norm(turn, axis=1)[:, None]
        c, s = np.cos(0.5 * angle), 0.5 * np.sinc(angle / (2.0 * np.pi)) * turn
        e0, e = positions[:, 3:4], q.reshape(-1, 7)[:, 4:]
        positions[:, :3] += self.arrays.length * parts[:, :3]
        positions[:, 4:] = e0 * s + c * e + np.cross(e, s)
        positions[:, 3:4] = c * e0 - np.sum(e * s, axis=1, keepdims=True)
        return positions.ravel()


@dataclass(frozen=True)
class KinematicSettings:
    """Limits of Newton's method.

    `tolerance`: scaled residual at which iteration ends early; 0 continues to round-off (YOUNG's FEPS
    was 1e-4).  `smallest_pivot`: scaled pivot below which a position counts as singular (EPSLU, 1e-5).
    `most_iterations`: for the assembly of the estimates (NRMAX, 250).  `most_ranked`: equations among which
    those that repeat others are looked for, by singular values: some minutes for 5,000.
    """

    tolerance: float = 0.0
    smallest_pivot: float = 1e-13
    most_iterations: int = 250
    most_ranked: int = 10_000


def kinematic_system(arrays: KinematicArrays, settings: KinematicSettings) -> System:
    """The kernels' view of a mechanism.

    Bodies at rest come first among the columns, and held or driven coordinates first among the
    rows: elimination then finds them as pivots and leaves zeros below.
    """
    if "places" not in arrays.of_variants:
        arrays.of_variants["places"] = _places_and_units(arrays)
    places, units = arrays.of_variants["places"]
    return System(
        arrays.constraints,
        places,
        units,
        np.array([settings.tolerance, settings.smallest_pivot, settings.most_iterations, arrays.q.size]),
    )


def _places_and_units(arrays: KinematicArrays) -> tuple[np.ndarray, np.ndarray]:
    constraints = arrays.constraints
    simple = np.isin(constraints["kind"], (SIMPLIFIED.code, DRIVER.code))
    of_row = np.searchsorted(constraints["first_row"], np.arange(len(arrays.equations)), side="right") - 1
    order = np.argsort(~simple[of_row], kind="stable")
    held = np.bincount(constraints["body_i"][simple], minlength=len(arrays.body_names))
    column = np.empty(arrays.q.size, dtype=np.int64)
    for position, body in enumerate(np.argsort(-held, kind="stable")):
        column[7 * body : 7 * body + 7] = np.arange(7 * position, 7 * position + 7)
    # Fewer equations than coordinates can be evaluated, though not solved: the table is padded.
    places, units = np.zeros((arrays.q.size, 4), dtype=np.int64), np.ones((2, arrays.q.size))
    places[: len(order), :2], places[: len(order), 2], places[:, COLUMN] = arrays.bodies_of, order, column
    units[0, : len(order)], units[1] = 1.0 / arrays.row_scale, arrays.column_scale
    return places, units


def with_dependent_columns(system: System, dependent: tuple[int, ...]) -> System:
    """The system for a position at which the coordinates `dependent` follow from the others.

    They are eliminated last, and their corrections and rates are 0.
    """
    places = system.places.copy()
    order = np.argsort(
        places[:, COLUMN] + system.places.shape[0] * np.isin(np.arange(len(places)), dependent)
    )
    places[order, COLUMN] = np.arange(len(places))
    limits = system.limits.copy()
    limits[RANK] -= len(dependent)
    return system._replace(places=places, limits=limits)
