"""The flexible bodies of a VSDF deck, reduced and reported without solving its motion."""

from dataclasses import dataclass, field
from pathlib import Path

from ..errors import Fault, FlexmbError, ModelError
from ..model.build_vsdf import build_vsdf
from ..model.flexible_body import FlexibleBody
from ..read.deck import Deck
from ..read.dialects import read_deck
from ..read.settings import apply_settings
from ..read.text import STANDARD_INPUT, read_text
from .outcome import Outcome, RunOptions, refuse_warnings


@dataclass
class BodyModes:
    """What became of one deck: `outcome` holds faults and exit code, `bodies` the flexible ones."""

    outcome: Outcome
    deck: Deck | None = None
    bodies: list[FlexibleBody] = field(default_factory=list)

    def as_dict(self) -> dict:
        """The record that `--json` prints."""
        record = self.outcome.as_dict()
        record.pop("files"), record.pop("rows")
        return record | {"bodies": [_as_dict(body) for body in self.bodies]}


def body_modes(path: str, options: RunOptions) -> BodyModes:
    """Read the deck at `path` and reduce its flexible bodies; failures become the outcome's faults."""
    report = BodyModes(Outcome(path))
    try:
        _reduce(report, path, options)
    except FlexmbError as failure:
        known = set(report.outcome.faults)
        report.outcome.faults += [fault for fault in failure.faults if fault not in known]
        report.outcome.exit_code = failure.exit_code
    return report


def _reduce(report: BodyModes, path: str, options: RunOptions):
    from ..fe.build_mechanism import flexible_mechanism

    outcome = report.outcome
    outcome.source = read_text(path)
    deck = apply_settings(read_deck(outcome.source, options.dialect), list(options.changes))
    outcome.faults += deck.warnings
    if deck.dialect != "vsdf":
        message = f"a {deck.dialect.upper()} deck has no finite-element bodies; modes are those of VSDF decks"
        raise ModelError([Fault("error", message)])
    folder = Path() if path == STANDARD_INPUT else Path(path).parent
    model, doubts = build_vsdf(deck, folder)
    outcome.faults += doubts
    mechanism, doubts = flexible_mechanism(model)
    outcome.faults += doubts
    refuse_warnings(outcome, options)
    report.deck = deck
    report.bodies = [body.flexible for body in mechanism.bodies if body.flexible is not None]


def _as_dict(body: FlexibleBody) -> dict:
    following = body.dropped.next_frequency
    return {
        "name": body.name,
        "nodes": len(body.numbers),
        "mass": body.m,
        "centre": body.centre.tolist(),
        "inertia": body.J0.tolist(),
        "mass_deviation": body.mass_deviation,
        "rigid_residual": body.rigid_residual,
        "frequencies": body.frequencies.tolist(),
        "effective_mass": body.effective_mass.tolist(),
        "effective_limit": body.effective_limit.tolist(),
        "dropped": vars(body.dropped) | {"next_frequency": following if following == following else None},
    }
