"""The options of `solve`: what is refused, as the command line refuses it of `flexmb run`.

`--method`, `--rtol` and `--atol`: one meaning for the forward dynamics of every dialect.

A method that a dialect does not have is refused with those that it has; where nothing is integrated, the
warning names what sets the accuracy instead.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..deck.record import Deck
from ..dialects.recognise import dialect_named, every_dialect
from ..errors import Fault, ModelError
from ..model.time_checks import FINEST
from .model import LARGEST_TOLERANCE
from .outcome import Outcome, RunOptions

if TYPE_CHECKING:
    from ..solvers.constrained.analysis import ConstrainedMotion


FORMULATIONS = ("kane", "absolute")
# Lowest and highest value, and whether they are allowed.
RANGES = {
    "rtol": (FINEST, True, 1.0, False),
    "atol": (0.0, False, 1.0, False),
    "tolerance": (0.0, True, math.inf, False),
    "smallest_pivot": (0.0, True, 1.0, True),
    "most_iterations": (1, True, math.inf, False),
    "loop_tolerance": (0.0, True, LARGEST_TOLERANCE, True),
}
KNOWN = (*RANGES, "method", "formulation", "as_printed")


def refuse_wrong(options: Mapping[str, object]) -> None:
    """Raise TypeError for an option that `solve` does not have, ValueError for a value out of its range."""
    for name, value in options.items():
        if name not in KNOWN:
            raise TypeError(f"solve has no option {name!r}{_meant(name)}")
        # Integrators of all dialects; which of them a deck's has is tested with the deck.
        methods = dict.fromkeys(method for dialect in every_dialect() for method in dialect.methods)
        if name == "method" and value not in methods:
            raise ValueError(f"method is one of {', '.join(methods)}; read {value!r}")
        if name == "formulation" and value not in FORMULATIONS:
            raise ValueError(f"formulation is one of {', '.join(FORMULATIONS)}; read {value!r}")
        if name in RANGES:
            _refuse_out_of_range(name, value)


def _refuse_out_of_range(name: str, value: Any) -> None:
    low, with_low, high, with_high = RANGES[name]
    sign_low, sign_high = "<=" if with_low else "<", "<=" if with_high else "<"
    try:
        fits = (low <= value if with_low else low < value) and (value <= high if with_high else value < high)
    except TypeError:
        fits = False
    if not fits:
        upper = f" {sign_high} {high:g}" if high < math.inf else ", finite"
        raise ValueError(f"solve needs {low:g} {sign_low} {name}{upper}; read {value!r}")


def _meant(name: str) -> str:
    from difflib import get_close_matches

    close = get_close_matches(name, KNOWN, n=1)
    return f"; is {close[0]} meant?" if close else f"; it has {', '.join(KNOWN)}"


def refuse_foreign_method(deck: Deck, options: RunOptions) -> None:
    """Raise ModelError, with the dialect's methods, when `--method` names another."""
    dialect, method = dialect_named(deck.dialect), options.integration.get("method")
    if method not in (None, *dialect.methods) and dialect.takes_steps(deck):
        known = dialect.methods
        reported = f"method {method}: a {dialect.title} deck is integrated by {', '.join(known[:-1])}"
        raise ModelError([Fault("error", f"{reported} or {known[-1]}", id="RUN-025")])


def set_tolerances(analysis: "ConstrainedMotion", options: RunOptions, outcome: Outcome) -> None:
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
