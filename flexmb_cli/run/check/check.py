"""Diagnose a deck without solving it through time: counts, rank, redundant and free coordinates, gaps."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.record import Deck
from ...errors import Fault
from ..exit_status import ending_recorded
from ..model import analysis_of, model_of, module_for
from ..open_deck import open_deck
from ..outcome import Outcome, Run, RunOptions, Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from .tree import TreeFindings


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
    tree: "TreeFindings | None" = None
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
    read: "Callable[[str, RunOptions, Outcome], Deck] | None" = None,
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
    return report
