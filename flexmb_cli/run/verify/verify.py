"""Two formulations of a deck, and how far their motions lie apart.

Trees: Kane's equations and absolute coordinates.  Mechanisms: Euler parameters and natural coordinates.
Flexible bodies: two floating frames.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import ANALYSIS_FAILED
from ...results.texts.echo import echo
from ..exit_status import ending_recorded
from ..model import model_of, module_for
from ..open_deck import open_deck
from ..outcome import Listener, Outcome, Run, RunOptions, Stop
from .difference import Difference


@dataclass
class Verification:
    """Result of a comparison; `tolerance` is what a relative difference may reach.

    `formulations` names what was compared.
    """

    outcome: Outcome
    tolerance: float
    differences: tuple[Difference, ...] = ()
    formulations: str = ""

    @property
    def largest(self) -> Difference | None:
        """The largest relative difference; None before anything was compared."""
        # What is no number is further apart than any.
        sizes = np.nan_to_num([found.relative for found in self.differences], nan=np.inf)
        return self.differences[int(np.argmax(sizes))] if self.differences else None

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        rows = [
            {
                "quantity": found.name,
                "unit": found.unit,
                "difference": found.difference,
                "scale": found.scale,
                "relative": found.relative,
                "time": found.time,
            }
            for found in self.differences
        ]
        agree = bool(rows) and self.outcome.exit_code == 0
        record = {"formulations": self.formulations, "tolerance": self.tolerance, "agree": agree}
        return self.outcome.as_dict() | record | {"differences": rows}


def verify_deck(
    path: str, options: RunOptions, tolerance: float, listener: Listener | None = None
) -> Verification:
    """Run the deck at `path` by two formulations, and compare the motions.

    The outcome's exit code is 1 when they lie further apart than `tolerance`.  Never raises for what a
    deck can do.
    """
    found = Verification(Outcome(path), tolerance)
    with ending_recorded(found.outcome, options), Stop.released():
        deck = open_deck(path, options, found.outcome)
        if options.echo:
            found.outcome.echo = echo(deck)
        run = Run(found.outcome, options, (listener or Listener()).kept_in(found.outcome.notices))
        model = model_of(deck, run)
        formulation = module_for(model, "verify")
        found.formulations = formulation.FORMULATIONS
        found.differences = formulation.differences(model, deck, run)
        largest = found.largest
        if largest is None or not largest.relative <= tolerance:
            found.outcome.exit_code = ANALYSIS_FAILED
    return found
