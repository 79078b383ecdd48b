"""Joint forces that dry friction follows, which follow from the friction in turn.

The accelerations are linear in the friction efforts, and these in the joint forces: repeated substitution
converges as a geometric series whose ratio is about the coefficient of friction.
"""

import math
from typing import Any

import numpy as np

from .._jit import allocating, kernel
from .body_vectors import VECTOR, vector
from .elements import FRICTION, NORMAL
from .multipliers import fill_multipliers
from .system import SCALED

MOST_SUBSTITUTIONS = 100
FRICTION_CONVERGED = 1e-13  # of the largest force


@kernel
def has_friction(loads: np.ndarray) -> bool:
    """Return whether there is any friction; it stands behind all other loads."""
    return loads.shape[0] > 0 and loads[loads.shape[0] - 1]["kind"] == FRICTION


@kernel
def normal_changes(system: Any, work, ud: np.ndarray):
    """Fill the normal forces of the friction elements for the accelerations ud, whose FORCES are at hand.

    Returns the largest change, of the largest force.
    """
    lam = work.rows[SCALED]
    fill_multipliers(system, work, ud, lam)
    change, largest = 0.0, 0.0
    for k in range(system.loads.shape[0]):
        load = system.loads[k]
        if load["kind"] != FRICTION:
            continue
        found = _normal(system, work, load, lam) + load["preload"]
        change = max(change, abs(found - work.responses[k, NORMAL]))
        largest = max(largest, found)
        work.responses[k, NORMAL] = found
    return change / largest if largest > 0.0 else 0.0


@allocating
def _normal(system, work, load, lam: np.ndarray):
    """Size of the joint's force across its axis, and of that on the flanks of a thread, N."""
    group, axis = system.groups[load["group"]], vector(work.body_vectors[VECTOR], load["body_vector"])
    force = np.zeros(3)
    # The ground has no columns; the other body bears the opposite force.
    body = group["body_j"] if group["body_j"] >= 0 else group["body_i"]
    for row in range(group["first_row"], group["end_row"]):
        for i in range(3):
            k = 6 * body + i
            force[i] += lam[row] * system.row_scale[row] * work.jacobian[row, k] / system.speed_scale[k]
    # Between nodes of a flexible body the axis stretches.
    size = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]
    along = (force[0] * axis[0] + force[1] * axis[1] + force[2] * axis[2]) / math.sqrt(size)
    square = force[0] * force[0] + force[1] * force[1] + force[2] * force[2] - along * along
    return math.sqrt(max(square, 0.0)) + load["thread"] * abs(along)
