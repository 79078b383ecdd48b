"""Constraint forces at one position: the multipliers, and the forces of each constraint on its bodies.

M u̇ = f + Jᵀ λ.  Where equations repeat others the multipliers are not unique: those of least norm
are taken, Σ (s_k λ_k)² → min over all equations k, where s_k is the unit of the equation: the length scale
L of the mechanism (a power of two near its largest length) for one in m, 1 for one without a unit.  A force
F thus weighs as the moment L F, all in N m.  They lie in the range of J, spanned by the columns J_d of the
dependent speeds:

    λ = J_d y,   (J_dᵀ J_d) y = (M u̇ - f)_d.
"""

import numpy as np

from .._jit import allocating, kernel, part
from ..linalg.profile_ldl import factorise_rows, substitute_rows
from ..linalg.rank_revealing_lu import entry_of, transposed_solution
from .mass_matrix import mass_times
from .system import FORCES, FREE, PRODUCT, System, Work, factors_of


@part
def fill_multipliers(system: System, work: Work, ud: np.ndarray, lam: np.ndarray) -> None:
    """Fill lam (m,) from the rates ud of the speeds, by the factors and forces at hand."""
    rank, m, n = work.rank[0], work.jacobian.shape[0], work.motions.shape[0]
    forces, product, borne = work.vectors[FORCES], work.vectors[PRODUCT], work.vectors[FREE]
    mass_times(system, work, ud, product)
    for k in range(n):
        product[k] = (product[k] - forces[k]) * system.speed_scale[k]
    if m > rank:
        _fill_least_norm(work, product, lam)
    else:
        for i in range(rank):
            borne[i] = product[work.order[m + i]]
        transposed_solution(factors_of(work), rank, borne)
        for i in range(rank):
            lam[work.order[i]] = borne[i]
    for row in range(m):
        lam[row] /= system.row_scale[row]


@allocating
def _fill_least_norm(work: Work, constraint_forces: np.ndarray, lam: np.ndarray) -> None:
    """Fill lam (m,) with the shortest λ for which Jᵀ λ are the constraint_forces (n,), all scaled."""
    rank, m, n = work.rank[0], work.jacobian.shape[0], work.motions.shape[0]
    places, ends = np.full(n, -1, np.int64), np.zeros(rank, np.int64)
    starts, y = np.empty(rank, np.int64), np.empty(rank)
    _number_in_order(work.order[m : m + rank], places)
    gram = np.zeros(_lay_out(work, places, starts, ends))
    _fill_gram(work, places, gram, starts)
    factorise_rows(gram, starts, ends)
    for row in range(m):
        lam[row] = 0.0
    # The second pass refines: the condition number of the Gram matrix is the square of that of J.
    for _ in range(2):
        for k in range(n):
            if places[k] >= 0:
                y[places[k]] = constraint_forces[k]
        _subtract_forces(work, places, lam, y)
        substitute_rows(gram, starts, ends, y)
        _add_multipliers(work, places, y, lam)


@kernel
def _subtract_forces(work: Work, places: np.ndarray, lam: np.ndarray, y: np.ndarray) -> None:
    """Subtract J_dᵀ lam from y (rank,)."""
    for row in range(lam.shape[0]):
        for p in range(work.columns[row, 0]):
            place = places[work.columns[row, 1 + p]]
            if place >= 0:
                y[place] -= work.jacobian[row, p] * lam[row]


@kernel
def _add_multipliers(work: Work, places: np.ndarray, y: np.ndarray, lam: np.ndarray) -> None:
    """Add J_d y to lam (m,)."""
    for row in range(lam.shape[0]):
        for p in range(work.columns[row, 0]):
            place = places[work.columns[row, 1 + p]]
            if place >= 0:
                lam[row] += work.jacobian[row, p] * y[place]


@kernel
def _number_in_order(speeds: np.ndarray, places: np.ndarray) -> None:
    """Fill places (n,) of -1 with the rank of each of `speeds` among them: neighbours stay neighbours."""
    for k in speeds:
        places[k] = 0
    count = 0
    for k in range(places.shape[0]):
        if places[k] == 0:
            places[k] = count
            count += 1


@kernel
def _lay_out(work: Work, places: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> int:
    """Fill where the rows of J_dᵀ J_d start and end, each from its diagonal on: starts, ends (rank,).

    See `factorise_rows`.  Returns the number of entries.
    """
    for row in range(work.jacobian.shape[0]):
        last = -1
        for p in range(work.columns[row, 0]):
            last = max(last, places[work.columns[row, 1 + p]])
        for p in range(work.columns[row, 0]):
            i = places[work.columns[row, 1 + p]]
            if i >= 0:
                ends[i] = max(ends[i], last + 1)
    count = 0
    for i in range(ends.shape[0]):
        starts[i] = count - i
        count += ends[i] - i
    return count


@kernel
def _fill_gram(work: Work, places: np.ndarray, gram: np.ndarray, starts: np.ndarray) -> None:
    """Fill gram, zeros, with J_dᵀ J_d as `_lay_out` has it."""
    for row in range(work.jacobian.shape[0]):
        for p in range(work.columns[row, 0]):
            i = places[work.columns[row, 1 + p]]
            if i >= 0:
                for other in range(work.columns[row, 0]):
                    j = places[work.columns[row, 1 + other]]
                    if j >= i:
                        gram[starts[i] + j] += work.jacobian[row, p] * work.jacobian[row, other]


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
                    share = entry_of(work.jacobian, work.columns, row, 6 * i + k)
                    wrenches[c, 0, k] += scale * share / system.speed_scale[6 * i + k]
                if j >= 0 and j != i:
                    share = entry_of(work.jacobian, work.columns, row, 6 * j + k)
                    wrenches[c, 1, k] += scale * share / system.speed_scale[6 * j + k]
