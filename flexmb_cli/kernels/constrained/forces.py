"""Applied forces on the speeds: forces, torques, springs and dampers in line and in joints; their work.

VSDFlex paper (2008), equations (66)-(73): a force F at the end of the body vector s of a body adds F, s × Aᵀ
F and Sᵀ Aᵀ F.  `loads` are records of `model.arrays.records.LOAD`; the body vectors have been placed and
moved.
"""

import math
from typing import TYPE_CHECKING

from .._jit import kernel
from ..laws import COORDINATE, EFFORT, ENERGY, NO_LENGTH, POWER, SPEED
from ..linalg.rotation import A, rotate
from .body_vectors import RATE, VECTOR, add_vector_row, geometry_of, vector
from .constraint_primitives import add_primitive_row, primitive_rates, primitive_value
from .elements import ELEMENT, add_element
from .system import System, Work
from .time_functions import function_values

if TYPE_CHECKING:
    import numpy as np


# The codes of model.arrays.records; a test compares them.
FORCE, TORQUE, LINE, RELATIVE = 1, 2, 3, 4


@kernel
def add_applied_forces(system: System, work: Work, u: "np.ndarray", t: float, f: "np.ndarray") -> float:
    """Add all applied forces but friction to f (n,).

    Returns the power of those that store no energy: forces, torques and dampers.
    """
    power = 0.0
    for k in range(system.loads.shape[0]):
        load = system.loads[k]
        if load["kind"] == LINE:
            power += _add_line(system, work, load, work.responses[k], f)
        elif load["kind"] == RELATIVE:
            power += _add_relative(system, work, load, work.responses[k], t, f)
        elif load["kind"] == ELEMENT:
            power += add_element(system, work, k, t, f)
        elif load["kind"] < ELEMENT:
            factor = 1.0
            if load["function"] >= 0:
                factor = function_values(system.functions, system.knots, load["function"], t)[0]
            power += _add_vector(system, work, load, factor, u, f)
    return power


@kernel
def _add_vector(
    system: System, work: Work, load: "np.void", factor: float, u: "np.ndarray", f: "np.ndarray"
) -> float:
    p, v = load["body_vector"], load["vector"]
    b = system.body_vectors[p]["body"]
    if b < 0:
        return 0.0
    F = rotate(work.rotations[A], b, v) if load["following"] else (v[0], v[1], v[2])
    if load["kind"] == FORCE:
        add_vector_row(geometry_of(system, work), p, F, factor, True, f)
        w = work.body_vectors[RATE, p]
        power = 0.0
        for i in range(3):
            power += factor * F[i] * (u[6 * b + i] + w[i])
        return power
    power, axes = 0.0, work.rotations[A, b]
    for i in range(3):
        torque = factor * (axes[0, i] * F[0] + axes[1, i] * F[1] + axes[2, i] * F[2])
        f[6 * b + 3 + i] += torque
        power += torque * u[6 * b + 3 + i]
    return power


@kernel
def _length(d: tuple[float, float, float]) -> float:
    return math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])


@kernel
def _add_line(system: System, work: Work, load: "np.void", answer: "np.ndarray", f: "np.ndarray") -> float:
    """Spring and damper along V of a primitive; returns the power of the damper.

    Ends that coincide leave the direction open: no force acts then.
    """
    geometry, k = geometry_of(system, work), load["primitive"]
    d, v = vector(work.relative_vectors[VECTOR, k], 0), vector(work.relative_vectors[RATE, k], 0)
    length = _length(d)
    stretch = length - load["free_length"]
    answer[ENERGY] = 0.5 * load["stiffness"] * stretch * stretch
    if length < NO_LENGTH:
        answer[COORDINATE], answer[SPEED], answer[EFFORT], answer[POWER] = length, 0.0, 0.0, 0.0
        return 0.0
    rate = (d[0] * v[0] + d[1] * v[1] + d[2] * v[2]) / length
    pull = load["stiffness"] * stretch + load["damping"] * rate
    answer[COORDINATE], answer[SPEED], answer[EFFORT] = length, rate, -pull
    answer[POWER] = -load["damping"] * rate * rate
    ends = system.primitives[k]["ends"]
    add_vector_row(geometry, ends[0, 1], d, pull / length, True, f)
    add_vector_row(geometry, ends[0, 0], d, -pull / length, True, f)
    return -load["damping"] * rate * rate


@kernel
def _stretch(system: System, work: Work, load: "np.void") -> float:
    turn = system.primitives[load["primitive"]]["turn"]
    expected = work.angles[turn] if turn >= 0 else 0.0
    return primitive_value(geometry_of(system, work), load["primitive"], expected) - load["free_length"]


@kernel
def _add_relative(
    system: System, work: Work, load: "np.void", answer: "np.ndarray", t: float, f: "np.ndarray"
) -> float:
    """Spring, damper and motor in an angle or a stroke; returns the power of damper and motor."""
    geometry = geometry_of(system, work)
    rate = primitive_rates(geometry, load["primitive"])[0]
    # The spring keeps its work as energy; what is left does the power.
    active = -load["damping"] * rate
    if load["function"] >= 0:
        active += function_values(system.functions, system.knots, load["function"], t)[0]
    stretch = _stretch(system, work, load)
    effort = active - load["stiffness"] * stretch
    answer[COORDINATE], answer[SPEED] = stretch + load["free_length"], rate
    answer[EFFORT], answer[POWER] = effort, active * rate
    answer[ENERGY] = 0.5 * load["stiffness"] * stretch * stretch
    add_primitive_row(geometry, load["primitive"], effort, f)
    return active * rate


@kernel
def spring_energy(system: System, work: Work) -> float:
    """Energy of springs, J, at placed body vectors; that of elements is the one of the forces found last."""
    total = 0.0
    for k in range(system.loads.shape[0]):
        load, stretch = system.loads[k], 0.0
        if load["kind"] == LINE:
            stretch = (
                _length(vector(work.relative_vectors[VECTOR, load["primitive"]], 0)) - load["free_length"]
            )
        elif load["kind"] == RELATIVE:
            stretch = _stretch(system, work, load)
        elif load["kind"] == ELEMENT:
            total += work.responses[k, ENERGY]
        if load["kind"] < ELEMENT:
            total += 0.5 * load["stiffness"] * stretch * stretch
    return total
