"""What is reported of a mechanism at one time: accelerations, constraint forces, energies, residuals."""

from collections import namedtuple

from ._jit import kernel
from .constrained_solve import accelerations
from .constrained_system import SOLVED, A
from .constraint_projection import evaluate_residual, largest_gap, rate_gap
from .forces import potential_energy
from .mass_matrix import kinetic_energy
from .multipliers import fill_multipliers, fill_wrenches

Report = namedtuple("Report", "times states rates wrenches multipliers powers audit")
Report.__doc__ = """T rows of a mechanism of b bodies with m equations.

times (T,).  states (T, 13 b + 1): coordinates, speeds, work.  rates (T, 6 b): of the speeds.
wrenches (T, constraints, 2, 6): see `fill_wrenches`.  multipliers (T, m).  powers (T,): of drivers and
applied loads, W.  audit (T, 4): kinetic and potential energy, J, largest scaled gap and its rate.
"""


@kernel
def observe(system, work, z, t, near, report, row):
    """Fill one row of `report` for the state z at t; a code."""
    bodies = z.shape[0] // 13
    q, u = z[: 7 * bodies], z[7 * bodies : 13 * bodies]
    code, power = accelerations(system, work, q, u, t, report.rates[row])
    if code == SOLVED:
        complete(system, work, z, t, near, power, report, row)
    return code


@kernel
def complete(system, work, z, t, near, power, report, row):
    """Fill a row of `report` whose rates have just been found, by the factors at hand."""
    bodies = z.shape[0] // 13
    q, u = z[: 7 * bodies], z[7 * bodies : 13 * bodies]
    report.powers[row] = power
    fill_multipliers(system, work, report.rates[row], report.multipliers[row])
    fill_wrenches(system, work, report.multipliers[row], report.wrenches[row])
    audit = report.audit[row]
    audit[0] = kinetic_energy(work.mass, u)
    audit[1] = potential_energy(system, q, work.rotations[A])
    evaluate_residual(system, work, q, t, near)
    audit[2] = largest_gap(system, work)[0]
    audit[3] = rate_gap(system, work, u, t)


@kernel
def observe_rows(system, work, near, report):
    """Fill all rows for states that are already there; near (T, screws).  Returns the rows filled."""
    for row in range(report.times.shape[0]):
        if observe(system, work, report.states[row], report.times[row], near[row], report, row) != SOLVED:
            return row
    return report.times.shape[0]
