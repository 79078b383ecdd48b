"""Constraint forces at one position: the multipliers, and the forces of each constraint on its bodies.

M u̇ = f + Jᵀ λ.  Where equations repeat others the multipliers are not unique: those of least norm
are taken, Σ (s_k λ_k)² → min over all equations k, where s_k is the unit of the equation: the length scale
L of the mechanism (a power of two near its largest length) for one in m, 1 for one without a unit.  A force
F thus weighs as the moment L F, all in N m.  With J_d = C J_i for the dependent rows, and l the
multipliers when the independent rows bear everything, they are

    λ_i = l - Cᵀ (1 + C Cᵀ)⁻¹ C l,   λ_d = C λ_i.
"""

import numpy as np

from .._jit import allocating, part
from ..linalg.cholesky import cholesky, cholesky_solve
from ..linalg.rank_revealing_lu import transposed_solution
from .mass_matrix import mass_times
from .system import FORCES, FREE, PRODUCT, System, Work


@part
def fill_multipliers(system: System, work: Work, ud: np.ndarray, lam: np.ndarray) -> None:
    """Fill lam (m,) from the rates ud of the speeds, by the factors and forces at hand."""
    rank, m = work.rank[0], lam.shape[0]
    forces, product, borne = work.vectors[FORCES], work.vectors[PRODUCT], work.vectors[FREE]
    mass_times(system, work, ud, product)
    for i in range(rank):
        k = work.order[m + i]
        borne[i] = (product[k] - forces[k]) * system.speed_scale[k]
    transposed_solution(work.factors, work.entries, rank, borne)
    if m > rank:
        _share(work, borne, lam)
    else:
        for i in range(rank):
            lam[work.order[i]] = borne[i]
    for row in range(m):
        lam[row] /= system.row_scale[row]


@allocating
def _share(work: Work, borne: np.ndarray, lam: np.ndarray) -> None:
    """Distribute the multipliers of the independent rows over all rows, with least norm."""
    rank, order, m = work.rank[0], work.order, lam.shape[0]
    count = m - rank
    C = np.empty((count, rank))
    gram = np.empty((count, count))
    share = np.zeros(count)
    for d in range(count):
        for i in range(rank):
            C[d, i] = work.jacobian[order[rank + d], order[m + i]]
        transposed_solution(work.factors, work.entries, rank, C[d])
        for i in range(rank):
            share[d] += C[d, i] * borne[i]
        for e in range(d + 1):
            gram[d, e] = 1.0 if d == e else 0.0
            for i in range(rank):
                gram[d, e] += C[d, i] * C[e, i]
    cholesky(gram, count, 0.0)
    cholesky_solve(gram, count, share)
    for i in range(rank):
        lam[order[i]] = borne[i]
        for d in range(count):
            lam[order[i]] -= C[d, i] * share[d]
    for d in range(count):
        lam[order[rank + d]] = 0.0
        for i in range(rank):
            lam[order[rank + d]] += C[d, i] * lam[order[i]]


@part
def fill_wrenches(system: System, work: Work, lam: np.ndarray, wrenches: np.ndarray) -> None:
    """Fill wrenches (groups, 2, 6): on the bodies i and j of every group its force, global
    axes, N, and its torque about the body's origin, body axes, N m; 0 on the ground."""
    for c in range(system.groups.shape[0]):
        group = system.groups[c]
        i, j = group["body_i"], group["body_j"]
        for k in range(6):
            wrenches[c, 0, k] = wrenches[c, 1, k] = 0.0
            for row in range(group["first_row"], group["end_row"]):
                scale = lam[row] * system.row_scale[row]
                if i >= 0:
                    wrenches[c, 0, k] += scale * work.jacobian[row, 6 * i + k] / system.speed_scale[6 * i + k]
                if j >= 0 and j != i:
                    wrenches[c, 1, k] += scale * work.jacobian[row, 6 * j + k] / system.speed_scale[6 * j + k]
