"""A report row so near to a singular position that round-off may rule what the equations say.

Where two motions of a mechanism cross, the smallest pivot p of the constraint Jacobian vanishes.  Round-off
of the coordinates then changes speeds by its 1/p², accelerations by its 1/p³ and constraint forces by
its 1/p⁴, while the motion itself is smooth.  Two states that differ by round-off show whether it rules a row:
if so, speeds and accelerations are those of the interpolation between the ends of the step, and the forces
of constraints nan.
"""

import numpy as np

from .._jit import allocating, kernel
from ..linalg.number_rows import copy
from .accelerations import accelerate, add_power_of_drivers, choose_order, evaluate_jacobian, solve
from .body_vectors import geometry_of, move_vectors
from .forces import add_applied_forces
from .mass_matrix import inertia_and_elastic_forces, mass_matrices
from .multipliers import fill_multipliers
from .projection import project_position, project_speeds
from .report import Report, complete, complete_motion, coordinates_and_speeds
from .speeds import move, normalise
from .system import CORRECTION, FORCES, GAMMA, QD, SOLVED, System, Work

STATE_ROUND_OFF = 2e-16  # of units: by up to twice that a state is moved to see what depends on it
GAP_ROUND_OFF = (
    6e-16  # of units: by up to 1.5 times that its equations are left open; a projection leaves 4e-16
)
# Changes by round-off above which it rules: of accelerations, of their size, or the tolerance where that is
# larger; of constraint forces, of the largest.
OF_ACCELERATIONS, OF_FORCES = 1e-6, 1e-3
DETERMINED = 1e-10  # change of accelerations below which constraint forces are determined, however small


@allocating
def fill_doubtful_row(
    system: System,
    work: Work,
    state: np.ndarray,
    place: tuple[np.ndarray, np.ndarray, np.ndarray],
    t: float,
    rtol: float,
    report: Report,
    row: int,
) -> None:
    """Fill a row of `report` at t, whose rates are those of the interpolation, or nan.

    state (N,): an accepted one near by, away from the singular position; place (3,): the interpolated state
    (N,) of the row, units of its coordinates and speeds (N,), angles expected (angles,), rad.
    """
    m, n = work.jacobian.shape[0], work.motions.shape[0]
    z, expected, raw = place[0], place[2], place[0].copy()
    speeds, rates, forces = np.zeros((2, n)), np.zeros((2, n)), np.zeros((2, m))
    solved, power = _ask_twice(system, work, raw, place, t, (speeds, rates, forces))
    if solved and _is_determined(system, rtol, report.rates[row], speeds, rates, forces):
        copy(rates[1], report.rates[row])
        complete(system, work, z, t, expected, power, report, row)
    else:
        if not solved:
            copy(raw, z)
            _leave_singular(system, work, state, z)
        if not (
            solved and _change(speeds, system.speed_scale) < rtol * _largest(speeds[1], system.speed_scale)
        ):
            for i in range(n + system.masses.shape[0], raw.shape[0]):
                z[i] = raw[i]
        _fill_without_forces(system, work, place, t, power if solved else np.nan, report, row)
    copy(z, report.states[row])


@kernel
def _ask_twice(
    system: System,
    work: Work,
    raw: np.ndarray,
    place: tuple[np.ndarray, np.ndarray, np.ndarray],
    t: float,
    answers: tuple[np.ndarray, np.ndarray, np.ndarray],
):
    """Fill speeds, accelerations (2, n) and multipliers (2, m) of two states that differ by round-off.

    Returns whether both have them, and the power of the second, whose state z is then projected.
    """
    (z, units, expected), (speeds, rates, forces), power = place, answers, 0.0
    q, u = coordinates_and_speeds(system, z)
    for k in range(2):
        for i in range(raw.shape[0]):
            z[i] = raw[i] + (1 - k) * STATE_ROUND_OFF * ((7 * i) % 5 - 2) * units[i]
        normalise(system.masses.shape[0], q)
        copy(expected, work.angles)
        code = project_position(system, work, q, t, expected)
        if code == SOLVED and k == 0:
            _open_gaps(system, work, q)
        if code == SOLVED:
            code = project_speeds(system, work, q, u, t)[0]
        if code != SOLVED:
            return False, 0.0
        power = accelerate(system, work, q, u, t, rates[k])
        fill_multipliers(system, work, rates[k], forces[k])
        copy(u, speeds[k])
    return True, power


@kernel
def _open_gaps(system: System, work: Work, q: np.ndarray) -> None:
    """Move q, near to which the factors are, by the shortest way that leaves round-off in the equations."""
    zero, step, gaps = work.vectors[QD], work.vectors[CORRECTION], work.rows[GAMMA]
    zero[:] = 0.0
    for row in range(gaps.shape[0]):
        gaps[row] = GAP_ROUND_OFF * ((7 * row) % 4 - 1.5) * system.row_scale[row]
    solve(system, work, zero, gaps, step)
    move(system.masses.shape[0], q, step)


@allocating
def _is_determined(
    system: System, rtol: float, smooth: np.ndarray, speeds: np.ndarray, rates: np.ndarray, forces: np.ndarray
):
    """Return whether accelerations (2, n) and multipliers (2, m) are the equations', not round-off's.

    Accelerations have the size of the `smooth` ones, where these are not nan.
    """
    scale, unit = system.speed_scale, 1.0 / system.row_scale
    size = _largest(rates[1] if np.isnan(smooth[0]) else smooth, scale) + _largest(speeds[1], scale) ** 2
    change = _change(rates, scale)
    if not change <= max(OF_ACCELERATIONS, rtol) * size:
        return False
    return change <= DETERMINED * size or _change(forces, unit) < OF_FORCES * _largest(forces[1], unit)


@kernel
def _largest(values: np.ndarray, scale: np.ndarray):
    """The largest of values (n,) in units of their scale."""
    largest = 0.0
    for k in range(values.shape[0]):
        largest = max(largest, abs(values[k]) / scale[k])
    return largest


@kernel
def _change(values: np.ndarray, scale: np.ndarray):
    """The largest difference of values (2, n) in units of their scale; infinity where one is nan."""
    largest = 0.0
    for k in range(values.shape[1]):
        change = abs(values[1, k] - values[0, k]) / scale[k]
        if not change <= largest:
            largest = change if change > largest else np.inf
    return largest


@kernel
def _leave_singular(system: System, work: Work, state: np.ndarray, z: np.ndarray) -> None:
    """Normalise z, and choose an order of elimination that serves the state.

    The search for another order ended at a singular position with one that serves nowhere.
    """
    rank = work.rank[0]
    evaluate_jacobian(system, work, coordinates_and_speeds(system, state)[0])
    choose_order(work, rank)
    work.rank[0] = rank
    normalise(system.masses.shape[0], coordinates_and_speeds(system, z)[0])


@kernel
def _fill_without_forces(
    system: System,
    work: Work,
    place: tuple[np.ndarray, np.ndarray, np.ndarray],
    t: float,
    power: float,
    report: Report,
    row: int,
) -> None:
    """Fill a row of `report` from its rates and state, with nan for the forces of constraints.

    A power that is nan is that of these rates.
    """
    z, _, expected = place
    q, u = coordinates_and_speeds(system, z)
    evaluate_jacobian(system, work, q)
    mass_matrices(system, work, q)
    if np.isnan(power):
        power = _power(system, work, q, u, t, report.rates[row])
    report.multipliers[row, :] = np.nan
    report.wrenches[row, :, :, :] = np.nan
    complete_motion(system, work, z, t, expected, power, report, row)


@kernel
def _power(system: System, work: Work, q: np.ndarray, u: np.ndarray, t: float, ud: np.ndarray):
    """Power of the drivers and of the applied forces that store no energy, for given accelerations."""
    forces = work.vectors[FORCES]
    move_vectors(geometry_of(system, work), u)
    power = inertia_and_elastic_forces(system, work, q, u, forces)
    power += add_applied_forces(system, work, u, t, forces)
    return add_power_of_drivers(system, work, u, ud, power)
