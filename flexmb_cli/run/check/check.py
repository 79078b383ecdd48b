"""Diagnose a deck without solving it through time: counts, rank, redundant and free coordinates, gaps.

Small mechanisms are assembled by the same kernels left uncompiled, so that `check` answers at once.
"""

from typing import TYPE_CHECKING

import numpy as np

from ...deck.record import Deck
from ...dialects.young.dynamic_cards import FORWARD, analysis_of, has_elements
from ...errors import Fault, ModelError
from ...quick_dataclass import dataclass, field, replace
from ..deck import open_deck
from ..exit_status import ending_recorded
from ..outcome import Outcome, RunOptions, Stop, refuse_warnings
from .parts import before_and_after, gaps_of, parts_of

if TYPE_CHECKING:
    from .tree import TreeFindings

INTERPRETED_LIMIT = 150  # equations
FAR_STEPS = 100  # report steps to the time of a Jacobian
FARTHEST_STEPS = 100_000  # seconds of computing for a four-bar, and nothing tells how far it is
RANK_LIMIT = 2500  # equations; a singular value decomposition of more takes minutes
ASSEMBLY_LIMIT = 20_000  # coordinates, which take a second or two


@dataclass
class CheckReport:
    """What `check` found; `outcome` holds faults and the exit code.

    `bodies`: those of a VSDF deck.
    `gaps`: (owner, largest residual of the estimates, of the assembled position, unit) per owner.
    `redundant`, `free`: groups of names; None where the rank was not looked at.  `tree` is what was found
    of a tree, which has none of these.
    """

    outcome: Outcome
    deck: Deck | None = None
    counts: dict = field(default_factory=dict)
    time: float | None = None
    rank: int | None = None
    redundant: list | None = None
    free: list | None = None
    tree: "TreeFindings | None" = None
    bodies: list | None = None
    smallest: float | None = None
    gaps: list = field(default_factory=list)
    jacobian: "LabelledJacobian | None" = None

    def as_dict(self) -> dict:
        """The record that `--json` prints."""
        record = self.outcome.as_dict()
        record.pop("files"), record.pop("rows")
        record |= {"dialect": self.deck.dialect if self.deck else None, "counts": self.counts}
        if self.tree is not None:
            return record | self.tree.as_dict()
        if self.bodies is not None:
            record["bodies"] = self.bodies
        if self.jacobian is not None:
            record["jacobian"] = self.jacobian.as_dict()
        names = ("owner", "estimate", "assembled", "unit")
        return record | {
            "rank": self.rank,
            "smallest_singular_value": self.smallest,
            "redundant": self.redundant,
            "free": self.free,
            "assembly": [dict(zip(names, gap, strict=True)) for gap in self.gaps],
        }


@dataclass(frozen=True)
class LabelledJacobian:
    """Φ_q at `time` (None: at the deck's estimates) in the source's units: rows, columns, labels."""

    time: float | None
    rows: tuple[str, ...]
    bodies: tuple[str, ...]
    matrix: np.ndarray

    def as_dict(self) -> dict:
        """The record that `--json` prints; `matrix` has seven columns a body, x y z e0 e1 e2 e3."""
        return {"time": self.time, "rows": self.rows, "bodies": self.bodies, "matrix": self.matrix.tolist()}


def check_deck(path: str, options: RunOptions, jacobian: str | None = None) -> CheckReport:
    """Read the deck at `path`, assemble it at its first time and analyse what it can be solved for.

    `jacobian`: "estimate" or a time at which to give Φ_q.  Failures become the outcome's faults.
    """
    report = CheckReport(Outcome(path))
    with ending_recorded(report.outcome, options), Stop.released():
        report.deck = open_deck(path, options, report.outcome)
        if report.deck.dialect == "dafms":
            from .tree import check_tree

            _refuse_jacobian(jacobian, "a tree has relative coordinates and no constraint Jacobian")
            check_tree(report, options)
        elif report.deck.dialect == "vsdf":
            from .vsdf import check_vsdf

            _refuse_jacobian(jacobian, "it is printed of YOUNG decks only")
            check_vsdf(report, options)
        else:
            _check_mechanism(report, options, jacobian)
    return report


def _refuse_jacobian(jacobian, reason):
    if jacobian is not None:
        raise ModelError([Fault("error", f"--jacobian: {reason}", id="RUN-001")])


def _check_mechanism(report, options, jacobian):
    if analysis_of(report.deck) == FORWARD or has_elements(report.deck):
        from .forward import check_forward

        check_forward(report, options)
        return
    mechanism, warnings = _built(report.deck)
    report.outcome.faults += warnings
    refuse_warnings(report.outcome, options)
    _diagnose(report, mechanism, jacobian)
    refuse_warnings(report.outcome, options)


def _built(deck):
    """Mechanism and warnings of a deck that its drivers move, with or without dynamic cards."""
    if analysis_of(deck) is None:
        from ...dialects.young.build import build_young

        return build_young(deck)
    from ...dialects.young.build_dynamics import build_young_dynamics
    from ...model.unit_checks import unit_doubts

    model, warnings = build_young_dynamics(deck)
    return model.mechanism, [*warnings, *unit_doubts(model)]


def _diagnose(report: CheckReport, mechanism, jacobian):
    from ...solvers import compilation

    equations = 7 * len(mechanism.bodies)
    if equations > ASSEMBLY_LIMIT:
        report.counts = parts_of(mechanism) | {"coordinates": equations}
        message = f"{equations} coordinates are more than the {ASSEMBLY_LIMIT} that check assembles; run does"
        report.outcome.faults.append(Fault("note", message, id="RUN-002"))
        return
    if equations <= INTERPRETED_LIMIT and not _is_far(mechanism.time, jacobian):
        compilation.interpret()
    from ...solvers.kinematics.analysis import KinematicAnalysis
    from ...solvers.kinematics.settings import KinematicSettings

    # Points take no part in what is looked at, and there may be a million of them.
    analysis = KinematicAnalysis(replace(mechanism, points=()), KinematicSettings(most_ranked=RANK_LIMIT))
    report.counts = _counts(mechanism, analysis)
    before = gaps_of(analysis, analysis.arrays, analysis.arrays.q, analysis.arrays.screw_angles)
    if jacobian == "estimate":
        report.jacobian = _labelled(analysis, analysis.arrays.q, None)
    try:
        next(analysis.rows())
    finally:
        report.outcome.faults += analysis.warnings
    report.time = mechanism.time.start
    after = gaps_of(analysis, analysis.arrays, analysis.state[0], analysis.arrays.screw_angles)
    report.gaps = before_and_after(before, after)
    if equations <= RANK_LIMIT:
        _look_at_rank(report, analysis)
    if jacobian not in (None, "estimate"):
        report.jacobian = _jacobian_at(mechanism, float(jacobian))


def _is_far(grid, jacobian):
    """Return whether the Jacobian is asked for so late that the way there wants compiled kernels."""
    return jacobian not in (None, "estimate") and float(jacobian) - grid.start > FAR_STEPS * grid.step


def _counts(mechanism, analysis):
    equations, coordinates = len(analysis.arrays.equations), analysis.arrays.q.size
    return parts_of(mechanism) | {
        "equations": equations,
        "coordinates": coordinates,
        "degrees_of_freedom": coordinates - equations + len(mechanism.drivers),
    }


def _look_at_rank(report, analysis):
    from ...solvers.singular.mobility import mobility

    found = mobility(analysis.evaluator, analysis.state[0], report.time, analysis.motion[:, 0])
    report.rank = found.rank
    report.smallest = found.smallest
    report.redundant = [[equation.name for equation in group] for group in found.redundant]
    report.free = [list(names) for names in found.free]


def _jacobian_at(mechanism, time):
    """Φ_q at any time from the start on; the mechanism is moved there first."""
    from ...solvers.kinematics.analysis import KinematicAnalysis

    start = mechanism.time.start
    if not time >= start:
        message = f"--jacobian {time:g}: the motion begins at t = {start:g} s"
        raise ModelError([Fault("error", message, id="RUN-003")])
    if time - start > FARTHEST_STEPS * mechanism.time.step:
        message = (
            f"--jacobian {time:g}: later than {FARTHEST_STEPS} of the deck's steps; ask for an earlier time"
        )
        raise ModelError([Fault("error", message, id="RUN-004")])
    grid = replace(mechanism.time, end=time, step=max(time - start, 1.0))
    analysis = KinematicAnalysis(replace(mechanism, time=grid))
    for _ in analysis.rows():
        pass
    return _labelled(analysis, analysis.state[0], time)


def _labelled(analysis, q, time):
    evaluator, arrays = analysis.evaluator, analysis.arrays
    evaluator.residual(q, analysis.mechanism.time.start, arrays.screw_angles)
    matrix = evaluator.matrix(q) * arrays.row_scale[:, None] / arrays.column_scale
    factors = np.array([equation.factor for equation in arrays.equations])
    names = tuple(equation.name for equation in arrays.equations)
    return LabelledJacobian(time, names, arrays.body_names, matrix * factors[:, None])
