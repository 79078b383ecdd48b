"""Products with the mass matrix and the tangents of elastic and damping forces: what makes a mechanism stiff.

Modes contribute their K and D.  A spring along a line or in a joint, whose length or angle has the rate
gᵀ u, contributes k g gᵀ and c g gᵀ; what turns its force is left to the iteration.
"""

import numpy as np

from .._jit import kernel, part
from .body_vectors import geometry_of, move_vectors
from .elements import ELEMENT, add_element_slope
from .mass_matrix import constants_of, mass_times
from .system import System, Work


@part
def tangent_times(
    system: System, work: Work, by_position: float, by_speed: float, x: np.ndarray, y: np.ndarray
) -> None:
    """Fill y (n,) with (M + by_position K + by_speed D) x, x (n,), where the body vectors are placed.

    Moves the body vectors by x.
    """
    mass_times(system, work, x, y)
    add_stiff(system, work, by_position, by_speed, x, y)


@kernel
def add_stiff(
    system: System, work: Work, by_position: float, by_speed: float, x: np.ndarray, y: np.ndarray
) -> None:
    """y += (by_position K + by_speed D) x, as `tangent_times`."""
    for k in range(system.flexible.shape[0]):
        _add_flexible(system, system.flexible[k], by_position, by_speed, x, y)
    geometry = geometry_of(system, work)
    if system.loads.shape[0] > 0:
        move_vectors(geometry, x)
    for k in range(system.loads.shape[0]):
        if system.loads[k]["kind"] >= ELEMENT:
            add_element_slope(geometry, work, system.loads[k], k, by_position, by_speed, y)


@part
def _add_flexible(
    system: System, f: np.void, by_position: float, by_speed: float, x: np.ndarray, y: np.ndarray
) -> None:
    constants, N, modal = constants_of(system.modal, f), f["modes"], 6 * system.masses.shape[0] + f["first"]
    K, D = constants[6], constants[7]
    for j in range(N):
        amount = x[modal + j]
        if amount != 0.0:
            for i in range(N):
                y[modal + i] += (by_position * K[j, i] + by_speed * D[j, i]) * amount
