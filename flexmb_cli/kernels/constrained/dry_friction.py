"""Normal forces of dry friction, which follow from the joint forces that the friction itself changes.

The accelerations are linear in the friction efforts, and the joint forces in both.  Joint forces for unit
normal forces are therefore found once, with the factors at hand; what is left is one equation a friction,

    N = |F across the axis| + thread |F along it| + preload,   F = F0 + Σ N_p F_p,

which Newton's method solves.  Of several solutions the one is taken that is reached where friction grows
from none: with s F_p in place of F_p, s goes from 0 to 1 in steps short enough to stay on one branch.

An effort that changes by e at the same N changes N too: with J = ∂N/∂N_p of the right side the efforts
change by (1 - J)⁻¹ e.  Implicit methods take its diagonal into their slopes.
"""

import math

import numpy as np

from .._jit import allocating, kernel
from ..laws import NORMAL_PRELOAD
from ..linalg.number_rows import copy
from ..linalg.rank_revealing_lu import entry_of
from .body_vectors import VECTOR, vector
from .elements import ELEMENT, FRICTION
from .system import System, Work

# Of a joint force: three across the axis, what a thread bears of the one along it, the preload.
THREAD, PRELOAD, COMPONENTS = 3, 4, 5
LARGEST_GROWTH = 0.9  # of s, of that by which friction could change its own normal force by the whole
SHORTEST_GROWTH = 1e-6  # of s: the solution ends where a shorter step would be needed
MOST_ITERATIONS = 30
NORMALS_FOUND = 1e-11  # Newton's last step, of the largest normal force: the next would be round-off


@kernel
def has_friction(loads: np.ndarray) -> bool:
    """Return whether there is any friction; it stands behind all other loads."""
    return loads.shape[0] > 0 and loads[loads.shape[0] - 1]["kind"] == FRICTION


@kernel
def has_elements(loads: np.ndarray) -> bool:
    """Return whether there are springs, stops or cables at joints or in line, or friction."""
    k = loads.shape[0]
    while k > 0 and loads[k - 1]["kind"] < ELEMENT:
        k -= 1
    return k > 0


@kernel
def first_friction(loads: np.ndarray) -> int:
    """Return the place of the first friction among the loads."""
    k = loads.shape[0]
    while k > 0 and loads[k - 1]["kind"] == FRICTION:
        k -= 1
    return k


@kernel
def fill_joint_forces(
    system: System, work: Work, first: int, lam: np.ndarray, joint_forces: np.ndarray
) -> None:
    """Fill joint_forces (frictions, 5) with the joint forces of the multipliers lam, N, and the preloads."""
    for k in range(joint_forces.shape[0]):
        load = system.loads[first + k]
        group, axis = system.groups[load["group"]], vector(work.body_vectors[VECTOR], load["body_vector"])
        # The ground has no columns; the other body bears the opposite force.
        body = group["body_j"] if group["body_j"] >= 0 else group["body_i"]
        along = square = 0.0
        for i in range(3):
            column, total = 6 * body + i, 0.0
            for row in range(group["first_row"], group["end_row"]):
                share = entry_of(work.jacobian, work.columns, row, column)
                total += lam[row] * system.row_scale[row] * share / system.speed_scale[column]
            joint_forces[k, i] = total
            along += total * axis[i]
            square += axis[i] * axis[i]
        # Between nodes of a flexible body the axis stretches.
        for i in range(3):
            joint_forces[k, i] -= along / square * axis[i]
        joint_forces[k, THREAD] = load["thread"] * along / math.sqrt(square)
        joint_forces[k, PRELOAD] = load["c"][NORMAL_PRELOAD]


@allocating
def fill_normal_forces(forces: np.ndarray, normals: np.ndarray) -> None:
    """Fill normals (m,), N, from the joint forces of m frictions.

    forces (1 + m, m, 5): without friction, N, and by unit normal forces, as `fill_joint_forces` fills them.

    Where no normal forces agree with the joint forces that they cause, they are not numbers.
    """
    m = normals.shape[0]
    trial, equations, grown, share = np.zeros(m), np.empty((m, m + 1)), 0.0, 0.0
    growth = LARGEST_GROWTH / max(_reach(forces), LARGEST_GROWTH)
    while growth > SHORTEST_GROWTH:
        if _solve(forces, share, trial, equations):
            copy(trial, normals)
            if share == 1.0:
                return
            grown = share
        else:
            copy(normals, trial)
            growth *= 0.5
        share = min(grown + growth, 1.0)
    for k in range(m):
        normals[k] = np.nan


@allocating
def fill_feedback(forces: np.ndarray, normals: np.ndarray, feedback: np.ndarray) -> None:
    """Fill feedback (m,): the efforts' changes, of those at the normal forces found.

    forces (1 + m, m, 5) and normals (m,) are those of `fill_normal_forces`.  Changes are 1 where friction
    does not change its own normal force, or where that cannot be determined, and never below 0: matrices
    of implicit methods must stay positive definite.
    """
    m = normals.shape[0]
    equations = np.zeros((m, 2 * m))
    for k in range(m):
        _linearise(forces, 1.0, normals, k, equations[k])
        equations[k, m] = 0.0
    for k in range(m):
        equations[k, m + k] = 1.0
    solvable = _eliminate(equations)
    for k in range(m):
        feedback[k] = max(equations[k, m + k], 0.0) if solvable else 1.0


@kernel
def _reach(forces: np.ndarray) -> float:
    """The most by which unit normal forces change one of them."""
    most = 0.0
    for k in range(forces.shape[1]):
        total = 0.0
        for p in range(1, forces.shape[0]):
            force = forces[p, k]
            across = force[0] * force[0] + force[1] * force[1] + force[2] * force[2]
            total += math.sqrt(across) + abs(force[THREAD])
        most = max(most, total)
    return most


@kernel
def _solve(forces: np.ndarray, share: float, normals: np.ndarray, equations: np.ndarray) -> bool:
    """Bring normals (m,) to a solution for s = share by Newton's method; returns whether it got there.

    Equations (m, m + 1) is its work.
    """
    m = normals.shape[0]
    for _ in range(MOST_ITERATIONS):
        for k in range(m):
            _linearise(forces, share, normals, k, equations[k])
        if not _eliminate(equations):
            return False
        moved = largest = 0.0
        for k in range(m):
            normals[k] += equations[k, m]
            moved, largest = max(moved, abs(equations[k, m])), max(largest, abs(normals[k]))
        if moved <= NORMALS_FOUND * largest:
            return True
    return False


@kernel
def _linearise(forces: np.ndarray, share: float, normals: np.ndarray, k: int, equation: np.ndarray) -> None:
    """Fill equation (m + 1,) of Newton's step: the slopes of normal force k less its size, and its gap."""
    m, own = normals.shape[0], forces[0, k]
    x, y, z, w = own[0], own[1], own[2], own[THREAD]
    for p in range(m):
        force, amount = forces[1 + p, k], share * normals[p]
        x, y, z = x + amount * force[0], y + amount * force[1], z + amount * force[2]
        w += amount * force[THREAD]
    across = math.sqrt(x * x + y * y + z * z)
    inverse = 1.0 / across if across > 0.0 else 0.0
    for p in range(m):
        force = forces[1 + p, k]
        change = inverse * (x * force[0] + y * force[1] + z * force[2])
        change += force[THREAD] if w > 0.0 else -force[THREAD]
        equation[p] = (1.0 if p == k else 0.0) - share * change
    equation[m] = across + abs(w) + own[PRELOAD] - normals[k]


@kernel
def _eliminate(equations: np.ndarray) -> bool:
    """Solve the equations (m, m + sides) in place, the unknowns behind column m; False where singular."""
    m, end = equations.shape
    for k in range(m):
        pivot = k
        for i in range(k + 1, m):
            if abs(equations[i, k]) > abs(equations[pivot, k]):
                pivot = i
        if not abs(equations[pivot, k]) > 0.0:
            return False
        inverse = 1.0 / equations[pivot, k]
        for j in range(k, end):
            held = equations[pivot, j]
            equations[pivot, j] = equations[k, j]
            equations[k, j] = held * inverse
        for i in range(m):
            amount = equations[i, k]
            for j in range(k, end if i != k else 0):
                equations[i, j] -= amount * equations[k, j]
    return True
