"""Report of a mechanism at one time: accelerations, constraint forces, energies, residuals."""

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..laws import POWER
from ..linalg.number_rows import copy
from ..signals import VALUE, take_states
from .accelerations import accelerations
from .body_vectors import geometry_of_joints, move_vectors, place_vectors
from .constraint_primitives import primitive_rates, primitive_value
from .forces import spring_energy
from .mass_matrix import kinetic_energy, strain_energy, weight_energy
from .multipliers import fill_multipliers, fill_wrenches
from .projection import evaluate_residual, largest_gap, rate_gap
from .system import SOLVED, System, Work

# Rows of the powers of loads (rows, K): at the state, at the start of the step behind, and what is tried.
NOW, BEHIND, TRIED = 0, 1, 2


class Report(NamedTuple):
    """T rows of a mechanism of b bodies with n speeds and m equations."""

    times: np.ndarray  # (T,) s
    states: (
        np.ndarray
    )  # (T, N) coordinates, speeds, states of signals, work of drivers and applied loads, then of K loads, J
    rates: np.ndarray  # (T, n) of the speeds, m/s² or 1/s²
    wrenches: np.ndarray  # (T, groups, 2, 6) on both bodies, N and N m, see `fill_wrenches`
    multipliers: np.ndarray  # (T, m) scaled
    powers: np.ndarray  # (T,) of drivers and applied loads, W
    audit: np.ndarray  # (T, 5) energy: kinetic, of weights and springs, of strain, J; largest gap, its rate
    responses: np.ndarray  # (T, loads, 8) of springs and elements, columns and SI units as in `elements`
    joints: np.ndarray  # (T, joint coordinates, 2) rad or m, rad/s or m/s
    signals: np.ndarray  # (T, S) values of signals, SI units


@kernel
def coordinates_and_speeds(system: System, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The parts q and u of a state."""
    n = system.speed_scale.shape[0]
    end = n + system.masses.shape[0]
    return z[:end], z[end : end + n]


@kernel
def fill_load_powers(work: Work, powers: np.ndarray) -> None:
    """Fill powers (K,), W, of the first K loads, whose forces have just been found."""
    for k in range(powers.shape[0]):
        powers[k] = work.responses[k, POWER]


@kernel
def observe(
    system: System, work: Work, z: np.ndarray, t: float, expected: np.ndarray, report: Report, row: int
) -> int:
    """Fill one row of `report` for the state z at t; a code."""
    q, u = coordinates_and_speeds(system, z)
    take_states(system.signals, z, q.shape[0] + u.shape[0])
    code, power = accelerations(system, work, q, u, t, report.rates[row])
    if code == SOLVED:
        complete(system, work, z, t, expected, power, report, row)
    return code


@kernel
def complete(
    system: System,
    work: Work,
    z: np.ndarray,
    t: float,
    expected: np.ndarray,
    power: float,
    report: Report,
    row: int,
) -> None:
    """Fill a row of `report` whose rates have just been found, by the factors at hand."""
    fill_multipliers(system, work, report.rates[row], report.multipliers[row])
    fill_wrenches(system, work, report.multipliers[row], report.wrenches[row])
    complete_motion(system, work, z, t, expected, power, report, row)


@kernel
def complete_motion(
    system: System,
    work: Work,
    z: np.ndarray,
    t: float,
    expected: np.ndarray,
    power: float,
    report: Report,
    row: int,
) -> None:
    """Fill what a row of `report` has besides rates and constraint forces."""
    q, u = coordinates_and_speeds(system, z)
    report.powers[row] = power
    for k in range(work.responses.shape[0]):
        for column in range(work.responses.shape[1]):
            report.responses[row, k, column] = work.responses[k, column]
    for k in range(system.signals.values.shape[0]):
        report.signals[row, k] = system.signals.values[k, VALUE]
    audit = report.audit[row]
    audit[0] = kinetic_energy(system, work, u)
    audit[1] = weight_energy(system, work, q) + spring_energy(system, work)
    audit[2] = strain_energy(system, q)
    evaluate_residual(system, work, q, t, expected)
    audit[3] = largest_gap(system, work)[0]
    audit[4] = rate_gap(system, work, u, t)
    _fill_joint_coordinates(system, work, q, u, expected, report.joints[row])


@kernel
def _fill_joint_coordinates(
    system: System, work: Work, q: np.ndarray, u: np.ndarray, expected: np.ndarray, joints: np.ndarray
) -> None:
    """Fill joints (joint coordinates, 2) with values and rates, where A belongs to q."""
    geometry = geometry_of_joints(system, work)
    place_vectors(geometry, q)
    move_vectors(geometry, u)
    for k in range(joints.shape[0]):
        turn = system.joint_coordinates[k]["turn"]
        joints[k, 0] = primitive_value(geometry, k, expected[turn] if turn >= 0 else 0.0)
        joints[k, 1] = primitive_rates(geometry, k)[0]


@kernel
def observe_rows(system: System, work: Work, expected: np.ndarray, report: Report) -> int:
    """Fill all rows for states that are already there; expected (T, screws).  Returns the rows filled."""
    for row in range(report.times.shape[0]):
        copy(expected[row], work.angles)
        if observe(system, work, report.states[row], report.times[row], expected[row], report, row) != SOLVED:
            return row
    return report.times.shape[0]
