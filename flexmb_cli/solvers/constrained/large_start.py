"""The start of a forward run of many bodies: what `start` and `start_speeds` find, by sparse matrices."""

from typing import TYPE_CHECKING

import numpy as np

from ...kernels.constrained.accelerations import DENSE_START, evaluate_jacobian
from ...kernels.constrained.mass_matrix import mass_matrices, mass_times
from ...kernels.constrained.system import Work
from ..singular.mobility import MOST_DENSE, Mobility
from ..singular.sparse_rank import order_of_pivots, shortest_correction, sparse_mobility

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ...model.arrays.system import SystemArrays
    from .analysis import ConstrainedMotion


# Weights of speeds that are not given, and of those given that no mass resists, of the smallest inertia:
# what is given is kept, then what has no mass, then the others are small.
OF_MASSLESS, OF_OTHERS = 1e-6, 1e-10
CLOSED_RATE = 1e-15  # of the largest speed: round-off


def starts_sparse(arrays: "SystemArrays") -> bool:
    """Return whether sparse matrices of the start take less time than dense ones."""
    return arrays.bodies > DENSE_START or is_large(arrays)


def is_large(arrays: "SystemArrays") -> bool:
    """Return whether dense matrices of a mechanism would take seconds and hundreds of megabytes."""
    return arrays.speeds > MOST_DENSE


def sparse_jacobian(work: Work) -> "csr_matrix":
    """Return the scaled Jacobian (m, n) on speeds that was evaluated last."""
    from scipy.sparse import csr_matrix

    counts, columns = work.columns[:, 0], work.columns[:, 1:]
    rows, places = np.nonzero(np.arange(columns.shape[1]) < counts[:, None])
    shape = len(counts), len(work.motions)
    return csr_matrix((work.jacobian[rows, places], (rows, columns[rows, places])), shape)


def order_of_many(analysis: "ConstrainedMotion", q: np.ndarray) -> Mobility:
    """Choose the independent equations at q (n + b,), and which repeat others; leaves no factors."""
    system, work, arrays = analysis.system, analysis.work, analysis.arrays
    evaluate_jacobian(system, work, q)
    J = sparse_jacobian(work)
    work.order[:], work.rank[0] = order_of_pivots(J)
    return sparse_mobility(J, work.order, int(work.rank[0]), arrays.equations, arrays.speed_name)


def speeds_of_many(
    analysis: "ConstrainedMotion", q: np.ndarray, J: "csr_matrix", nu: np.ndarray
) -> np.ndarray:
    """Return scaled speeds (n,) with J u = ν: those given as nearly as can be, the others small.

    What `start_speeds` finds in three stages is one weighted least-squares problem here.
    """
    from scipy.sparse import diags

    scale = analysis.arrays.speed_scale
    given, wanted = analysis.given_speeds(q)
    wanted = np.where(given, wanted / scale, 0.0)
    rest = nu - J @ wanted
    if np.max(np.abs(rest), initial=0.0) <= CLOSED_RATE * np.max(np.abs(wanted), initial=0.0):
        return wanted
    M = _mass_matrix(analysis, q)
    inertias = M.diagonal()
    positive = inertias[inertias > 0.0] if inertias.any() else np.ones(1)
    largest, least = float(positive.max()), float(positive.min())
    chosen = diags(given.astype(float))
    light = np.where(given, OF_MASSLESS, OF_OTHERS) * least / largest
    found: np.ndarray = wanted + shortest_correction(J, rest, chosen @ (M / largest) @ chosen + diags(light))
    return found


def _mass_matrix(analysis: "ConstrainedMotion", q: np.ndarray) -> "csr_matrix":
    """Return the mass matrix (n, n) of scaled speeds: a block a body, one column of each at a time."""
    from scipy.sparse import coo_matrix

    mass_matrices(analysis.system, analysis.work, q)
    arrays = analysis.arrays
    owners, own = _places_in_bodies(arrays)
    rows, columns, values = [], [], []
    for place in range(int(own.max(initial=-1)) + 1):
        chosen = np.flatnonzero(own == place)
        x, product = np.zeros(arrays.speeds), np.empty(arrays.speeds)
        x[chosen] = arrays.speed_scale[chosen]
        mass_times(analysis.system, analysis.work, x, product)
        column = np.full(arrays.bodies, -1)
        column[owners[chosen]] = chosen
        kept = np.flatnonzero(column[owners] >= 0)
        rows.append(kept)
        columns.append(column[owners[kept]])
        values.append(product[kept] * arrays.speed_scale[kept])
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return coo_matrix(entries, (arrays.speeds, arrays.speeds)).tocsr()


def _places_in_bodies(arrays: "SystemArrays") -> tuple[np.ndarray, np.ndarray]:
    """Return the body of each speed (n,), and the place of the speed among those of its body."""
    owners, own = np.repeat(np.arange(arrays.bodies), 6), np.tile(np.arange(6), arrays.bodies)
    modes = [(record["body"], record["modes"]) for record in arrays.flexible]
    owners = np.concatenate([owners, *(np.full(count, body) for body, count in modes)])
    own = np.concatenate([own, *(6 + np.arange(count) for _, count in modes)])
    return owners, own
