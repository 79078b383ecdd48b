"""Interface of integrators to a constrained mechanism: slopes, projection, report rows.

The accelerations are those of the index-1 equations.  The state z (2 n + b + s + 1,) of b bodies with n
speeds and s states of signals holds coordinates, speeds, these states, and the work of drivers and loads
since the start.

Projection: Hairer and Wanner, Solving Ordinary Differential Equations II (second edition), section VII.2.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import allocating, kernel, plain
from ..constrained.accelerations import accelerate, factorise_at
from ..constrained.angle_unwrapping import EXPECTED, NEW, OLD
from ..constrained.near_singular_row import fill_doubtful_row
from ..constrained.projection import largest_gap, project_position, project_speeds
from ..constrained.report import BEHIND, NOW, Report, complete, coordinates_and_speeds, fill_load_powers
from ..constrained.speeds import coordinate_rates, normalise
from ..constrained.system import SOLVED, System, Work
from ..linalg.number_rows import copy
from ..linalg.rank_revealing_lu import smallest_pivot
from ..signals import give_rates, take_states
from .clock import CONTRADICTION, READY, STEP_VANISHED
from .error_norm import scaled_norm
from .hermite import cubic

if TYPE_CHECKING:
    from ...model.arrays.contacts import Contacts
    from .integrations import AlphaIntegration, Integration, RadauIntegration

NEAR_SINGULAR = -1  # code of a row that round-off may rule
DOUBTFUL_PIVOT = 2e-3  # of the largest that the smallest pivot was, at most 1: round-off may rule a row below


@kernel
def evaluate(
    integration: "Integration | AlphaIntegration | RadauIntegration",
    t: float,
    angles: np.ndarray,
    projects: bool,
    out: np.ndarray,
    ud: np.ndarray,
    system: System,
    work: Work,
):
    """Fill the slope `out` (N,) and the accelerations `ud` (n,) at `trial`, projected first where asked.

    Returns by how many tolerances the projection moved it, infinity where clock["fault"] is set, and the
    power.  All that integrators ask of the equations goes through here, so that they are compiled once.
    """
    clock, moved = integration.clock[0], 0.0
    clock["evaluations"] += 1
    copy(angles, work.angles)
    q, u = coordinates_and_speeds(system, integration.trial)
    if projects:
        moved = project(integration, t, system, work)
    else:
        clock["fault"] = factorise_at(system, work, q)
    if clock["fault"] != SOLVED:
        return np.inf, 0.0
    take_states(system.signals, integration.trial, q.shape[0] + u.shape[0])
    power = accelerate(system, work, q, u, t, ud)
    give_rates(system.signals, out, q.shape[0] + u.shape[0])
    coordinate_rates(system.masses.shape[0], q, u, coordinates_and_speeds(system, out)[0])
    last = clock["counted"]
    out[last] = power
    fill_load_powers(work, out[last + 1 :])
    return moved, power


@kernel
def slope(integration: "Integration | RadauIntegration", stage: int, t: float, system: System, work: Work):
    """Fill the slope at `trial`; return whether there is one."""
    out = integration.slopes[stage]
    ud = coordinates_and_speeds(system, out)[1]
    evaluate(integration, t, integration.angles[NEW], False, out, ud, system, work)
    return integration.clock[0]["fault"] == SOLVED


@kernel
def projected_slope(
    integration: "Integration | RadauIntegration", stage: int, t: float, system: System, work: Work
):
    """Bring `trial` onto the constraints and fill its slope; return by how many tolerances that moved it."""
    out = integration.slopes[stage]
    ud = coordinates_and_speeds(system, out)[1]
    return evaluate(integration, t, integration.angles[EXPECTED], True, out, ud, system, work)[0]


@allocating
def project(
    integration: "Integration | AlphaIntegration | RadauIntegration", t: float, system: System, work: Work
):
    """Bring `trial` onto the constraints at t, with the factors there.

    Returns by how many tolerances it moved, or infinity.
    """
    clock, z, n = integration.clock[0], integration.trial, system.speed_scale.shape[0]
    end = n + system.masses.shape[0]
    q, u, before = z[:end], z[end : end + n], z.copy()
    normalise(system.masses.shape[0], q)
    clock["fault"] = project_position(system, work, q, t, integration.angles[EXPECTED])
    if clock["fault"] == SOLVED:
        clock["fault"] = project_speeds(system, work, q, u, t)[0]
    if clock["fault"] != SOLVED:
        return np.inf
    for i in range(z.shape[0]):
        before[i] -= z[i]
    return scaled_norm(integration, integration.z, before)


@kernel
def note_violation(
    integration: "Integration | AlphaIntegration | RadauIntegration", system: System, work: Work
):
    """Note the largest gap, whose equations belong to the state, and the smallest pivot."""
    clock = integration.clock[0]
    clock["gap"], clock["equation"] = largest_gap(system, work)
    clock["firmest"] = max(clock["firmest"], smallest_pivot(work.diagonal, work.rank[0]))


@kernel
def code_of_violation(integration: "Integration | AlphaIntegration | RadauIntegration"):
    """Return whether equations that repeat others still do, as a code."""
    clock = integration.clock[0]
    return READY if clock["gap"] <= clock["repeated"] else CONTRADICTION


@kernel
def first_speed(system: System) -> int:
    """Return the place of the first speed in the state."""
    return int(system.speed_scale.shape[0] + system.masses.shape[0])


@kernel
def fastest_change(system: System, integration: "AlphaIntegration | RadauIntegration", ud: np.ndarray):
    """The largest rate at which accelerations ud (n,) change the speeds of the state, 1/s."""
    first, fastest = first_speed(system), 0.0
    for k in range(ud.shape[0]):
        size = system.speed_scale[k] + abs(integration.z[first + k])
        fastest = max(fastest, abs(ud[k]) / size)
    return fastest


@kernel
def first_step(system: System, integration: "AlphaIntegration | RadauIntegration", ud: np.ndarray) -> float:
    """A hundredth of the time in which the accelerations make the speeds."""
    clock, fastest = integration.clock[0], fastest_change(system, integration, ud)
    return 0.01 * min(1.0 / fastest if fastest > 0.0 else 1.0, clock["stop"] - clock["t"])


@kernel
def add_works(integration: "AlphaIntegration | RadauIntegration", weights: np.ndarray, h: float) -> None:
    """Add to z what the loads did in the step that ends there; weights (rows,) of their powers.

    The last row of powers is that of the end.
    """
    powers, first = integration.load_powers, integration.clock[0]["counted"] + 1
    for k in range(powers.shape[1]):
        mean = 0.0
        for row in range(powers.shape[0]):
            mean += weights[row] * powers[row, k]
        integration.z[first + k] = integration.old[first + k] + h * mean
    copy(powers[NOW], powers[BEHIND])
    copy(powers[powers.shape[0] - 1], powers[NOW])


@kernel
def works_between(
    integration: "AlphaIntegration | RadauIntegration", x: float, h: float, point: np.ndarray
) -> None:
    """Fill the works of the loads in point at the fraction x of the last step, of length h."""
    powers, first = integration.load_powers, integration.clock[0]["counted"] + 1
    old, z = integration.old, integration.z
    for k in range(powers.shape[1]):
        i = first + k
        point[i] = cubic(x, old[i], z[i], h * powers[BEHIND, k], h * powers[NOW, k])


@kernel
def interpolate_angles(integration: "Integration | AlphaIntegration | RadauIntegration", x: float):
    """Fill the angles expected at the fraction x of the last step."""
    angles = integration.angles
    for s in range(angles.shape[1]):
        angles[EXPECTED, s] = (1.0 - x) * angles[OLD, s] + x * angles[NEW, s]


@kernel
def report_trial(
    integration: "Integration | RadauIntegration",
    t: float,
    x: float,
    report: Report,
    system: System,
    work: Work,
):
    """Fill a report row from `trial` at the fraction x of the last step, projected inside it; a code.

    NEAR_SINGULAR where the row is not filled since it `is_doubtful`.
    """
    clock, row, expected = integration.clock[0], integration.clock[0]["row"], integration.angles[EXPECTED]
    interpolate_angles(integration, x)
    # The slope of a row is not needed: a stage of the next step goes into its place.
    power = evaluate(
        integration, t, expected, x < 1.0, integration.slopes[1], report.rates[row], system, work
    )[1]
    if is_doubtful(clock, work):
        return NEAR_SINGULAR
    if clock["fault"] != SOLVED:
        return STEP_VANISHED
    complete(system, work, integration.trial, t, expected, power, report, row)
    copy(integration.trial, report.states[row])
    clock["row"] += 1
    return READY


@kernel
def is_doubtful(clock: np.void, work: Work):
    """Return whether a row inside or at the end of a step, whose factors are at hand, lies so near a singular
    position that round-off may rule it.
    """
    # `not >` takes a nan for doubtful.
    return clock["step_length"] > 0.0 and not smallest_pivot(work.diagonal, work.rank[0]) > firm_pivot(clock)


@kernel
def firm_pivot(clock: np.void) -> float:
    """Return the smallest pivot below which round-off may rule a row."""
    return DOUBTFUL_PIVOT * min(1.0, clock["firmest"])


@kernel
def fill_near_singular(
    integration: "Integration | AlphaIntegration | RadauIntegration",
    t: float,
    x: float,
    report: Report,
    system: System,
    work: Work,
):
    """Fill a report row at t that `is_doubtful`; `trial` and its rates are those of the interpolation.

    At x = 1, the end of a run, the interpolation has no better accelerations than the equations: nan.
    """
    clock, row = integration.clock[0], integration.clock[0]["row"]
    if x == 1.0:
        report.rates[row, :] = np.nan
    place = integration.trial, integration.units, integration.angles[EXPECTED]
    fill_doubtful_row(system, work, integration.z, place, t, clock["rtol"], report, row)
    clock["fault"] = SOLVED
    clock["row"] += 1


@plain
def contacts_of(system: System, work: Work) -> "Contacts":
    """Contacts of a system: see `time_loop.Method`."""
    return system.contacts
