"""Common part of the checks of all models: parts counted, gaps before and after assembly."""

from collections.abc import Sized
from typing import TYPE_CHECKING, Any

from ...errors import Fault, ModelError

if TYPE_CHECKING:
    import numpy as np

    from ...model.arrays.dynamic import DynamicArrays
    from ...model.arrays.kinematic import KinematicArrays
    from ...model.arrays.system import SystemArrays
    from ...model.mechanism import Mechanism, TimeGrid
    from ...solvers.constrained.analysis import ConstrainedMotion
    from ...solvers.singular.mobility import Mobility
    from .check import CheckReport


# Report steps up to the time at which a Jacobian or modes are requested: seconds for a four-bar, without any
# progress shown.
FARTHEST_STEPS = 100_000
# What kernels left uncompiled look at in about a second: coordinates, whose matrix is factorised, and loads.
INTERPRETED_COORDINATES, INTERPRETED_LOADS = 200, 300


MOST_MOVES = 3  # bodies named
# Of the size, or rad, that a note names: attitudes printed in 1996 are off by 0.75 rad.
FAR_MOVE = 1.0
MOST_ASSEMBLED = 20_000  # coordinates, which take some seconds
MOST_DENSE_EQUATIONS = 2000  # equations, most of which repeat others: their dense matrix takes 32 MB


def is_too_large(
    report: "CheckReport", counts: "dict[str, Any]", coordinates: int, equations: int = 0
) -> bool:
    """Return whether a model is too large to be assembled here; the report then has its counts and a note."""
    most, size, what = MOST_ASSEMBLED, coordinates, "coordinates"
    if equations > max(MOST_DENSE_EQUATIONS, 4 * coordinates):
        most, size, what = MOST_DENSE_EQUATIONS, equations, f"equations of {coordinates} coordinates"
    if size <= most:
        return False
    report.counts = counts | {"coordinates": coordinates}
    message = f"{size} {what} are more than the {most} that check assembles; run does"
    report.outcome.faults.append(Fault("note", message, id="RUN-002"))
    return True


def note_left_out(report: "CheckReport", speeds: int) -> None:
    """Note that the accelerations of a large mechanism, whose matrices are dense, were not looked at."""
    message = (
        f"with {speeds} speeds check looks at the first position and speeds only; run finds accelerations"
    )
    report.outcome.faults.append(Fault("note", message, id="RUN-063"))


def start_of(analysis: "ConstrainedMotion", report: "CheckReport") -> "Mobility":
    """Start an analysis as far as `check` looks at it: all of a small one, positions and speeds of others."""
    from ...solvers.constrained.system import is_large

    if not is_large(analysis.arrays):
        return analysis.start()
    note_left_out(report, analysis.arrays.speeds)
    return analysis.start_position()


def is_small(coordinates: int, *loads: Sized) -> bool:
    """Return whether a model is looked at sooner than its kernels are compiled."""
    return coordinates <= INTERPRETED_COORDINATES and sum(map(len, loads)) <= INTERPRETED_LOADS


Gaps = dict[tuple[str, str], float]  # by owner and unit, m or 1


def parts_of(mechanism: "Mechanism") -> dict[str, Any]:
    """Return how many of each thing a mechanism has."""
    joints: dict[str, int] = {}
    for joint in mechanism.joints:
        joints[joint.kind] = joints.get(joint.kind, 0) + 1
    return {
        "bodies": len(mechanism.bodies),
        "joints": joints,
        "simplified": len(mechanism.simplified),
        "distance": len(mechanism.distances),
        "drivers": len(mechanism.drivers),
        "grounds": len(mechanism.grounds),
        "points": len(mechanism.points),
        **report_times(mechanism.time),
    }


def report_times(grid: "TimeGrid") -> dict[str, Any]:
    """Return how many report times there are, and the last where it is not the end that the deck gives."""
    return {"report_times": grid.rows} | ({"last_time": grid.last} if grid.left_out else {})


def gaps_of(
    analysis: Any, arrays: "DynamicArrays | KinematicArrays", q: "np.ndarray", expected: "np.ndarray"
) -> Gaps:
    """Largest residual of each owner's equations, as {(owner, unit): m or 1}; expected: the angles
    expected.
    """
    scaled = analysis.evaluator.residual(q, analysis.mechanism.time.start, expected)
    gaps: Gaps = {}
    for equation, value in zip(arrays.equations, scaled * arrays.row_scale, strict=True):
        key = (equation.owner, equation.unit)
        gaps[key] = max(gaps.get(key, 0.0), abs(float(value)))
    return gaps


def note_slips(
    report: "CheckReport", evaluator: Any, q: "np.ndarray", t: float, expected: "np.ndarray"
) -> None:
    """Note joints that the estimates q leave open far wider than the others."""
    from ...solvers.kinematics.assembly import open_estimates, slip_note

    opened, others, far = open_estimates(evaluator, q, t, expected)
    if opened:
        report.outcome.faults.append(slip_note(opened, others, far=far))


def note_moves(
    report: "CheckReport", arrays: "KinematicArrays | SystemArrays", before: "np.ndarray", after: "np.ndarray"
) -> None:
    """Record how far assembly moved each body, and note it where one is moved far."""
    from ...solvers.assembly import displacements

    names = arrays.body_names
    scale = max((e.scale for e in arrays.equations if e.is_length), default=1.0)
    moves = zip(names, *(x.tolist() for x in displacements(before, after, len(names))), strict=True)
    report.moved = sorted(moves, key=lambda move: -(move[1] / scale + move[2]))
    far = [move for move in report.moved if max(move[1] / scale, move[2]) > FAR_MOVE]
    if far:
        named = "; ".join(f"{name} by {way:.3g} m and {turn:.3g} rad" for name, way, turn in far[:MOST_MOVES])
        message = f"assembly moves bodies from their estimates: {named}"
        report.outcome.faults.append(Fault("note", message, id="RUN-081"))


def before_and_after(before: Gaps, after: Gaps) -> list[tuple[str, float, float, str]]:
    """Rows (owner, gap of the estimates, of the assembled position, unit)."""
    return [(owner, before[owner, unit], after[owner, unit], unit) for owner, unit in before]


def refuse_jacobian(jacobian: str | None, reason: str) -> None:
    """Raise ModelError where a Jacobian is requested that the model does not have."""
    if jacobian is not None:
        raise ModelError([Fault("error", f"--jacobian: {reason}", id="RUN-001")])
