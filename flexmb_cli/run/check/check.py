"""Diagnose a deck without solving it through time: counts, rank, redundant and free coordinates, gaps."""

from collections import Counter
from collections.abc import Callable, Sequence, Sized
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.record import Deck
from ...dialects.elements_block.line import has_outputs
from ...errors import Fault, ModelError
from ..model import analysis_of, model_of, module_for, open_deck
from ..outcome import Outcome, Run, RunOptions, Stop, ending_recorded

if TYPE_CHECKING:
    from ...model.arrays.kinematic import KinematicArrays
    from ...model.arrays.system import SystemArrays
    from ...model.mechanism import Mechanism, TimeGrid
    from ...solvers.constrained.analysis import ConstrainedMotion
    from ...solvers.singular.mobility import Mobility


@dataclass
class TreeFindings:
    """Findings of `check` about a tree; None where the start could not be evaluated.

    `coordinates`: (name, unit, coordinate, speed) at the start, loops closed; `lightest`: the
    coordinate with the least inertia left of its body's own, and that share; `gaps`: (closure, gap as
    given, gap after assembly, m); `redundant`: closed directions that others close too; `energies`:
    J by name; `elastic`: (body, nodes, coordinates, lowest and highest frequency with the root held, Hz).
    """

    coordinates: list[tuple[str, str, float, float]]
    lightest: tuple[str, float] | None
    gaps: list[tuple[str, float, float]]
    redundant: list[str]
    energies: dict[str, float]
    elastic: list[tuple[str, int, int, float, float]]

    def as_dict(self) -> dict[str, Any]:
        """Plain record for `--json`."""
        return {
            "coordinates": _named(("name", "unit", "q", "u"), self.coordinates),
            "least_inertia": None if self.lightest is None else list(self.lightest),
            "assembly": _named(("closure", "given", "assembled"), self.gaps),
            "redundant": self.redundant,
            "energies": self.energies,
            "elastic": _named(("body", "nodes", "coordinates", "lowest_hz", "highest_hz"), self.elastic),
        }


@dataclass
class CheckReport:
    """Report of `check`; `outcome` holds faults and the exit code.

    `analysis`: that of the model, see `run.model.ANALYSES`.  `bodies`: those of a mechanism with flexible
    ones.
    `gaps`: (owner, largest residual of the estimates, of the assembled position, unit) per owner.
    `moved`: (body, translation in m, angle in rad) by which assembly moved it, the largest first.
    `redundant`, `free`: groups of names; None where the rank was not looked at.  `tree` is what was found
    of a tree, which has none of these.
    """

    outcome: Outcome
    deck: Deck | None = None
    analysis: str = ""
    counts: dict[str, Any] = field(default_factory=dict)
    time: float | None = None
    rank: int | None = None
    redundant: list[Any] | None = None
    free: list[Any] | None = None
    tree: TreeFindings | None = None
    bodies: Sequence[Any] | None = None
    smallest: float | None = None
    gaps: list[Any] = field(default_factory=list)
    moved: list[Any] = field(default_factory=list)
    jacobian: "LabelledJacobian | None" = None

    def __repr__(self) -> str:
        faults = [fault.severity for fault in self.outcome.faults]
        counts = ", ".join(f"{faults.count(word)} {word}s" for word in ("error", "warning", "note"))
        return f"CheckReport({self.outcome.deck!r}, {self.outcome.status}, {counts})"

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Errors, warnings and notes, in the order of the deck."""
        return tuple(self.outcome.faults)

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        record = self.outcome.as_dict()
        record.pop("files"), record.pop("rows")
        record |= {"dialect": self.deck.dialect if self.deck else None, "counts": self.counts}
        if self.tree is not None:
            return record | self.tree.as_dict()
        if self.bodies is not None:
            record["bodies"] = list(self.bodies)
        if self.jacobian is not None:
            record["jacobian"] = self.jacobian.as_dict()
        names = ("owner", "estimate", "assembled", "unit")
        return record | {
            "rank": self.rank,
            "smallest_singular_value": self.smallest,
            "redundant": self.redundant,
            "free": self.free,
            "assembly": [dict(zip(names, gap, strict=True)) for gap in self.gaps],
            "moved": [dict(zip(("body", "translation", "angle"), move, strict=True)) for move in self.moved],
        }


@dataclass(frozen=True)
class LabelledJacobian:
    """Φ_q at `time` (None: at the deck's estimates) in the source's units: rows, columns, labels."""

    time: float | None
    rows: tuple[str, ...]
    bodies: tuple[str, ...]
    matrix: np.ndarray

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints; `matrix` has seven columns a body, x y z e0 e1 e2 e3."""
        return {"time": self.time, "rows": self.rows, "bodies": self.bodies, "matrix": self.matrix.tolist()}


def check_deck(
    path: str,
    options: RunOptions,
    jacobian: str | None = None,
    read: Callable[[str, RunOptions, Outcome], Deck] | None = None,
) -> CheckReport:
    """Read the deck at `path`, assemble it at its first time and analyse what it can be solved for.

    `jacobian`: "estimate" or a time at which to give Φ_q; `read` gives the deck where it was read before.
    Failures become the outcome's faults.
    """
    report = CheckReport(Outcome(path))
    with ending_recorded(report.outcome, options), Stop.released():
        report.deck = (read or open_deck)(path, options, report.outcome)
        run = Run(report.outcome, options)
        model = model_of(report.deck, run)
        report.analysis = analysis_of(model)
        module_for(model, "check").check(report, model, run, jacobian)
        elements = getattr(model, "elements", None)
        if has_outputs(report.deck) or (elements is not None and elements.switches):
            from ..solution import complete_solution

            complete_solution(model, report.deck, run.with_new_outcome)
    return report


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


def is_too_large(report: CheckReport, counts: dict[str, Any], coordinates: int, equations: int = 0) -> bool:
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


def note_left_out(report: CheckReport, speeds: int) -> None:
    """Note that the accelerations of a large mechanism, whose matrices are dense, were not looked at."""
    message = (
        f"with {speeds} speeds check looks at the first position and speeds only; run finds accelerations"
    )
    report.outcome.faults.append(Fault("note", message, id="RUN-063"))


def start_of(analysis: "ConstrainedMotion", report: CheckReport) -> "Mobility":
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
    return {
        "bodies": len(mechanism.bodies),
        "joints": dict(Counter(joint.kind for joint in mechanism.joints)),
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
    evaluator: Any, arrays: "KinematicArrays | SystemArrays", q: np.ndarray, t: float, angles: np.ndarray
) -> Gaps:
    """Return the largest residual of each owner's equations at positions q and the expected `angles`."""
    gaps: Gaps = {}
    scaled = evaluator.residual(q, t, angles)
    for equation, value in zip(arrays.equations, abs(scaled * arrays.row_scale).tolist(), strict=True):
        key = (equation.owner, equation.unit)
        gaps[key] = max(gaps.get(key, 0.0), value)
    return gaps


def record_mobility(report: CheckReport, mobility: "Mobility") -> None:
    """Record the rank, the smallest singular value, repeated equations and what is free to move."""
    report.rank, report.smallest = int(mobility.rank), float(mobility.smallest)
    report.redundant = [[equation.name for equation in group] for group in mobility.redundant]
    report.free = [list(names) for names in mobility.free]


def note_slips(report: CheckReport, evaluator: Any, q: np.ndarray, t: float, angles: np.ndarray) -> None:
    """Note joints that the estimates q leave open far wider than the others."""
    from ...solvers.kinematics.assembly import open_estimates, slip_note

    opened, others, far = open_estimates(evaluator, q, t, angles)
    if opened:
        report.outcome.faults.append(slip_note(opened, others, far=far))


def record_assembly(report: CheckReport, before: Gaps, after: Gaps) -> None:
    """Record each owner's gaps: owner, gap of the estimates, of the assembled position, unit."""
    report.gaps = [(owner, before[owner, unit], after[owner, unit], unit) for owner, unit in before]


def note_moves(
    report: CheckReport, arrays: "KinematicArrays | SystemArrays", before: np.ndarray, after: np.ndarray
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


def refuse_jacobian(jacobian: str | None, reason: str) -> None:
    """Raise ModelError where a Jacobian is requested that the model does not have."""
    if jacobian is not None:
        raise ModelError([Fault("error", f"--jacobian: {reason}", id="RUN-001")])


def _named(keys: tuple[str, ...], rows: list[Any]) -> list[dict[str, Any]]:
    return [dict(zip(keys, row, strict=True)) for row in rows]
