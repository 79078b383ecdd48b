"""DOP853 on the equations of a tree, with its loops closed at the end of every step.

A resumed run continues from the start of the last step and makes the same steps as an uninterrupted one.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._jit import kernel, plain
from ..linalg.number_rows import copy
from ..tree.kane import SOLVED
from ..tree.motion import derivative, derivative_in_body_axes, normalise_attitudes, turn_speeds
from ..tree.projection import largest_gap, project
from ..tree.report import Report as TreeReport
from ..tree.report import observe
from .clock import NO_INERTIA, READY, new_clock
from .dop853 import Equations, dop853, first_step, interpolate, next_factor
from .dop853_table import ALL_STAGES, DENSE_TERMS, STAGES
from .error_norm import projection_too_large, scaled_norm

if TYPE_CHECKING:
    from ...model.arrays.contacts import Contacts
    from ...model.arrays.tree import TreeArrays

# Tasks besides BEGIN and INTEGRATION of `clock`: close the loops of z; continue at z with a known step; then,
# for the steps of this module, in which z holds speeds as in `derivative_in_body_axes`: begin, go, leave.
CLOSE, GO_ON, BEGIN_STEPS, GO_ON_STEPS, LEAVE_STEPS = 2, 3, 4, 5, 6
# Place in `slopes` of what is not a stage.
ASIDE = ALL_STAGES


class Integration(NamedTuple):
    """State of an integration between calls, for states of n numbers: m, rad, m/s, rad/s and, the work, J."""

    clock: np.ndarray  # one record of CLOCK
    z: np.ndarray  # (n,) state at the time t, units as above
    old: np.ndarray  # (n,) state at the start of the last step, units as above
    trial: np.ndarray  # (n,) state whose slope is evaluated, units as above
    slopes: np.ndarray  # (17, n) slopes of the stages, units a second
    dense: np.ndarray  # (7, n) terms of the dense output, units as above
    units: np.ndarray  # (n,) a state's unit, of which the absolute tolerance is


def new_integration(n: int, n_loads: int = 1) -> Integration:
    """An integration at time 0 with an empty state of n numbers, the last of which are works of loads."""
    clock = new_clock(n - n_loads)
    clock["fault"] = SOLVED
    states = [np.zeros(n) for _ in range(3)]
    return Integration(clock, *states, np.zeros((ASIDE + 1, n)), np.zeros((DENSE_TERMS, n)), np.ones(n))  # type: ignore[call-arg]


@kernel
def evaluate(
    integration: Integration,
    slope: np.ndarray,
    t: float,
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
):
    """Fill the slope (n,) of `trial`; return whether there is one."""
    clock = integration.clock[0]
    clock["evaluations"] += 1
    clock["fault"] = derivative(tree, work, coordinates, t, integration.trial, slope)
    return clock["fault"] == SOLVED


@kernel
def _slope(
    integration: Integration,
    stage: int,
    t: float,
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
):
    """Fill the slope of a stage at `trial`, in axes of the bodies; return whether there is one."""
    clock = integration.clock[0]
    clock["evaluations"] += 1
    clock["fault"] = derivative_in_body_axes(
        tree, work, coordinates, t, integration.trial, integration.slopes[stage]
    )
    return clock["fault"] == SOLVED


@kernel
def _normalise(
    integration: Integration, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray
) -> None:
    normalise_attitudes(tree, integration.trial)


@kernel
def _finish(
    integration: Integration, h: float, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray
):
    clock = integration.clock[0]
    if not _slope(integration, STAGES, clock["t"] + h, tree, work, coordinates):
        return -0.2
    return next_factor(clock["error"], clock["rejected"])


@kernel
def _watch(integration: Integration, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray):
    """Tables of loads end the steps by `stop`: there are no other events."""
    return READY


@kernel
def _close(integration: Integration, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray):
    """Close the loops at the end of a step, whose slope then is that at the start of the next; a code."""
    clock = integration.clock[0]
    if tree.closures.shape[0] == 0:
        copy(integration.slopes[STAGES], integration.slopes[0])
        return READY
    copy(integration.z, integration.trial)
    # slopes[0] is needed again where the step must be taken back.
    if not _slope(integration, ASIDE, clock["t"], tree, work, coordinates):
        return NO_INERTIA
    turn_speeds(tree, coordinates, integration.trial, 1.0, integration.trial)
    project(tree, work, coordinates, integration.trial)
    turn_speeds(tree, coordinates, integration.trial, -1.0, integration.trial)
    place = projection_too_large(integration.z, integration.trial, clock)
    if place >= 0:
        _take_back(integration, place)
        return READY
    clock["gap"] = largest_gap(tree.closures)
    copy(integration.trial, integration.z)
    return READY if _slope(integration, 0, clock["t"], tree, work, coordinates) else NO_INERTIA


@kernel
def _take_back(integration: Integration, place: int) -> None:
    """Go back to the start of the last step, for the projection moved its end too far."""
    clock = integration.clock[0]
    clock["t"], clock["step"] = clock["step_start"], 0.2 * clock["step_length"]
    # A resumed run begins with the shorter step too.
    clock["step_length"] = clock["step_tried"] = clock["step"]
    clock["rejected"] = clock["step_rejected"] = 1
    clock["worst"], clock["projection_too_large"] = place, 1
    clock["rejections"] += 1
    clock["steps"] -= 1
    copy(integration.old, integration.z)


@kernel
def _fill_row(
    integration: Integration,
    t: float,
    report: TreeReport,
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
):
    """Fill a report row at a time up to the present one; a code."""
    clock = integration.clock[0]
    copy(integration.z, integration.trial)
    if clock["step_start"] <= t < clock["t"]:
        interpolate(
            integration.old,
            integration.dense,
            (t - clock["step_start"]) / clock["step_length"],
            integration.trial,
        )
        normalise_attitudes(tree, integration.trial)
    turn_speeds(tree, coordinates, integration.trial, 1.0, integration.trial)
    return observe_trial(integration, integration.slopes[ASIDE], t, report, tree, work, coordinates)


@kernel
def observe_trial(
    integration: Integration,
    slope: np.ndarray,
    t: float,
    report: TreeReport,
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
):
    """Fill a report row from `trial`, its loops closed first; a code."""
    fault = integration.clock[0]["fault"]
    finite = evaluate(integration, slope, t, tree, work, coordinates)
    if tree.closures.shape[0] > 0:
        if not finite:
            return NO_INERTIA
        project(tree, work, coordinates, integration.trial)
        evaluate(integration, slope, t, tree, work, coordinates)
    # The ends of the step had inertia; a row between them that has none is not worth a failure.
    integration.clock[0]["fault"] = fault
    observe(tree, work, coordinates, integration.trial, report, integration.clock[0]["row"])
    integration.clock[0]["row"] += 1
    return READY


@plain
def contacts_of_tree(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray) -> "Contacts":
    """Contacts of a tree: see `Method`."""
    return tree.contacts


_advance = dop853(Equations(_slope, _normalise, _finish, _watch, _close, _fill_row, contacts_of_tree))


@kernel
def integrate_rows(
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
    integration: Integration,
    report: TreeReport,
    budget: int,
):
    """Fill the rows of `report`, at most `budget` evaluations and the rest of a step; a code."""
    return _advance(integration, report, budget, tree, work, coordinates)


@kernel
def begin(task: int, tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, integration: Integration):
    """Do a task that makes no steps; a code."""
    clock, z = integration.clock[0], integration.z
    in_body_axes = task in (BEGIN_STEPS, GO_ON_STEPS)
    if task in (BEGIN_STEPS, LEAVE_STEPS):
        turn_speeds(tree, coordinates, z, -1.0 if task == BEGIN_STEPS else 1.0, z)
    if task == LEAVE_STEPS:
        return READY
    copy(z, integration.trial)
    if not _slope_at_start(integration, 0, clock["t"], in_body_axes, tree, work, coordinates):
        return NO_INERTIA
    if task == CLOSE:
        project(tree, work, coordinates, integration.trial)
        clock["gap"] = largest_gap(tree.closures)
        copy(integration.trial, integration.z)
    elif task not in (GO_ON, GO_ON_STEPS):
        return _choose_first_step(integration, in_body_axes, tree, work, coordinates)
    return READY


@kernel
def _slope_at_start(
    integration: Integration,
    stage: int,
    t: float,
    in_body_axes: bool,
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
):
    """Fill a slope at `trial`, in axes of the bodies or of the hinges; return whether there is one."""
    if in_body_axes:
        return _slope(integration, stage, t, tree, work, coordinates)
    return evaluate(integration, integration.slopes[stage], t, tree, work, coordinates)


@kernel
def _choose_first_step(
    integration: Integration,
    in_body_axes: bool,
    tree: "TreeArrays",
    work: np.ndarray,
    coordinates: np.ndarray,
):
    """Choose the first step (Hairer et al., section II.4) from the first slope and a probe."""
    clock, counted = integration.clock[0], integration.clock[0]["counted"]
    first = first_step(integration, integration.slopes[0])
    for i in range(integration.z.shape[0]):
        integration.trial[i] = integration.z[i] + first * integration.slopes[0, i]
    if not _slope_at_start(integration, 1, clock["t"] + first, in_body_axes, tree, work, coordinates):
        return NO_INERTIA
    for i in range(counted):
        integration.slopes[1, i] -= integration.slopes[0, i]
    steepest = max(
        scaled_norm(integration, integration.z, integration.slopes[0]),
        scaled_norm(integration, integration.z, integration.slopes[1]) / first,
    )
    second = (0.01 / steepest) ** 0.125 if steepest > 1e-15 else max(1e-6, 1e-3 * first)
    clock["step"] = min(100.0 * first, second)
    clock["step_start"], clock["step_length"] = clock["t"], clock["step"]
    clock["step_tried"] = clock["step"]
    clock["rejected"] = clock["step_rejected"] = 0
    return READY
