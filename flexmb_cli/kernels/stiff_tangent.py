"""Products with the mass matrix and the tangents of elastic and damping forces: what makes a mechanism stiff.

Modes contribute their K and D.  A spring along a line or in a joint, whose length or angle has the rate
gᵀ u, contributes k g gᵀ and c g gᵀ; what turns its force is left to the iteration.
"""

from ._jit import part
from .arms import ARM, RATE, add_arm_row, move_arms
from .forces import AT_REST, LINE, RELATIVE
from .mass_matrix import constants_of, places_of
from .measures import add_measure_row, measure_rates
from .rotation import dot


@part
def tangent_times(system, work, by_position, by_speed, x, y):
    """y = (M + by_position K + by_speed D) x for x, y (n,) where the arms are placed; moves the arms by x.

    Columns of zeros in x cost nothing.
    """
    bodies = system.masses.shape[0]
    for k in range(system.speed_scale.shape[0]):
        y[k] = 0.0
    for b in range(bodies):
        if system.masses[b]["flexible"] < 0:
            for j in range(6):
                if x[6 * b + j] != 0.0:
                    for i in range(6):
                        y[6 * b + i] += work.mass[b, j, i] * x[6 * b + j]
    for k in range(system.flexible.shape[0]):
        _add_flexible(system, work, system.flexible[k], by_position, by_speed, x, y)
    if system.loads.shape[0] > 0:
        move_arms(system, work, x)
    for k in range(system.loads.shape[0]):
        load = system.loads[k]
        amount = by_position * load["stiffness"] + by_speed * load["damping"]
        if load["kind"] == LINE:
            _add_line(system, work, load["measure"], amount, y)
        elif load["kind"] == RELATIVE:
            rate = measure_rates(system, work, load["measure"])[0]
            add_measure_row(system, work, load["measure"], amount * rate, y)


@part
def _add_flexible(system, work, f, by_position, by_speed, x, y):
    constants, M, N = constants_of(system, f), places_of(work, f)[4], f["modes"]
    K, D = constants[6], constants[7]
    rigid, modal = 6 * f["body"], 6 * system.masses.shape[0] + f["first"]
    for j in range(6 + N):
        amount = x[rigid + j] if j < 6 else x[modal + j - 6]
        if amount == 0.0:
            continue
        for i in range(6):
            y[rigid + i] += M[j, i] * amount
        for i in range(N):
            y[modal + i] += M[j, 6 + i] * amount
        if j >= 6:
            for i in range(N):
                y[modal + i] += (by_position * K[j - 6, i] + by_speed * D[j - 6, i]) * amount


@part
def _add_line(system, work, k, amount, y):
    d, v = work.spans[ARM, k, 0], work.spans[RATE, k, 0]
    square = dot(d, d)
    if square > AT_REST:
        pull, ends = amount * dot(d, v) / square, system.measures[k]["ends"]
        add_arm_row(system, work, ends[0, 1], d, -pull, True, y)
        add_arm_row(system, work, ends[0, 0], d, pull, True, y)
