"""Applied forces on the speeds: forces, torques, springs and dampers in line and in joints; their work.

VSDFlex paper (2008), equations (66)-(73): a force F at the end of the body vector s of a body adds F, s × Aᵀ
F and Sᵀ Aᵀ F.  `loads` are records of `model.arrays.records.LOAD`; the body vectors have been placed and
moved.

Products with the mass matrix and the tangents of elastic and damping forces are what makes a mechanism stiff.
Modes contribute their K and D.  A spring along a line or in a joint, whose length or angle has the rate
gᵀ u, contributes k g gᵀ and c g gᵀ; what turns its force is left to the iteration.
"""

import numpy as np

from .._jit import kernel, part
from ..laws import ENERGY
from ..signals import evaluate_signals
from .body_vectors import geometry_of, move_vectors
from .elements import ELEMENT, add_along_vector, add_element, add_element_slope, fill_coordinate
from .mass_matrix import constants_of, mass_times
from .system import System, Work
from .time_functions import function_values

# The codes of model.arrays.records; a test compares them.
FORCE, TORQUE = 1, 2


@kernel
def add_applied_forces(system: System, work: Work, u: np.ndarray, t: float, f: np.ndarray) -> float:
    """Add all applied forces but friction to f (n,).

    Returns the power of those that store no energy: forces, torques and dampers.  Signals follow from
    elements that no signal drives, and other loads from them.
    """
    power, signals = 0.0, system.signals.records.shape[0] > 0
    for turn in range(2 if signals else 1):
        for k in range(system.loads.shape[0]):
            if system.loads[k]["driven"] == turn:
                power += _add_load(system, work, k, u, t, f)
        if signals and turn == 0:
            for k in range(system.sensors.shape[0]):
                fill_coordinate(system, work, system.sensors[k], system.signals.sensed[k])
            evaluate_signals(system.signals, system.functions, system.knots, work.responses, t)
    return power


@kernel
def _add_load(system: System, work: Work, k: int, u: np.ndarray, t: float, f: np.ndarray) -> float:
    load, factor = system.loads[k], 1.0
    if load["kind"] == ELEMENT:
        return add_element(system, work, k, u, t, f)
    if load["kind"] > ELEMENT:
        return 0.0
    if load["function"] >= 0:
        factor = function_values(system.functions, system.knots, load["function"], t)[0]
    return factor * add_along_vector(system, work, load, load["kind"] == FORCE, factor, u, f)


@kernel
def spring_energy(system: System, work: Work) -> float:
    """Energy of springs and elements, J, of the forces found last."""
    total = 0.0
    for k in range(system.loads.shape[0]):
        if system.loads[k]["kind"] == ELEMENT:
            total += work.responses[k, ENERGY]
    return total


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
    if system.loads.shape[0] > 0:
        move_vectors(geometry_of(system, work), x)
    for k in range(system.loads.shape[0]):
        if system.loads[k]["kind"] >= ELEMENT:
            add_element_slope(system, work, k, by_position, by_speed, x, y)


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
