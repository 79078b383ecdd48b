"""`--method`, `--rtol` and `--atol`: one meaning for the forward dynamics of every dialect.

A method that a dialect does not have is refused with those that it has; where nothing is integrated, the
warning names what sets the accuracy instead.
"""

from typing import Any, Protocol

from ..deck.record import Deck
from ..dialects.recognise import dialect_named
from ..errors import Fault, ModelError
from .outcome import Outcome, RunOptions


class SteppedAnalysis(Protocol):
    """An analysis that integrates: its integrator, and the record of its steps."""

    integrator: Any
    clock: Any


def refuse_foreign_method(deck: Deck, options: RunOptions) -> None:
    """Raise ModelError, with the dialect's methods, when `--method` names another."""
    dialect, method = dialect_named(deck.dialect), options.integration.get("method")
    if method not in (None, *dialect.methods) and dialect.takes_steps(deck):
        known = dialect.methods
        reported = f"method {method}: a {dialect.title} deck is integrated by {', '.join(known[:-1])}"
        raise ModelError([Fault("error", f"{reported} or {known[-1]}", id="RUN-025")])


def set_tolerances(analysis: SteppedAnalysis, options: RunOptions, outcome: Outcome) -> None:
    """Set the tolerances of an analysis that chooses its steps; warn where the deck gives their length."""
    given = {name: options.integration[name] for name in ("rtol", "atol") if name in options.integration}
    if not given:
        return
    if not analysis.integrator.chosen:
        # `interface.solve` has these options, too: no dashes.
        names = " and ".join(given)
        message = f"{names}: the deck gives the length of the steps; set it to 0, or take the method radau"
        outcome.faults.append(Fault("warning", message, id="RUN-026"))
    for name, value in given.items():
        analysis.clock[name] = value
