"""The model that a deck describes, ready for an analysis: building ends here, before solving starts."""

import re
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..deck.number import MOST_DIGITS
from ..deck.record import Deck
from ..deck.text import STANDARD_INPUT
from ..dialects.recognise import dialect_named
from .outcome import Run

if TYPE_CHECKING:
    from types import ModuleType

    from ..model.loads import DynamicModel
    from ..model.mechanism import Mechanism
    from ..model.tree import Tree
    from .outcome import RunOptions


# The analysis of every type of model.  Each has a module of this name for runs, checks, modes and
# verifications; a run imports that of its own model only.
ANALYSES = {
    "Mechanism": "kinematic",
    "DynamicModel": "dynamic",
    "FlexibleMechanism": "flexible",
    "Tree": "tree",
}


def model_of(deck: Deck, run: Run) -> Any:
    """Return the model of `deck` as the options want it solved; file names are relative to the deck.

    Its warnings go into the outcome.  Raises ModelError.
    """
    model, warnings = dialect_named(deck.dialect).build(deck, folder_of(run))
    run.warn(warnings)
    model = with_loop_tolerance(model, deck, run.options.loop_tolerance)
    return _integrated(model, deck, run.options) if analysis_of(model) == "tree" else model


def folder_of(run: Run) -> Path:
    """Return the folder of the deck."""
    deck = run.outcome.deck
    return Path() if deck == STANDARD_INPUT else Path(deck).parent


def analysis_of(model: Any) -> str:
    """Return the name of a model's analysis."""
    return ANALYSES[type(model).__name__]


def module_for(model: "DynamicModel | Mechanism | Tree", package: str) -> "ModuleType":
    """Return the module of the model's analysis in a package of this folder: "solutions", "check" …"""
    # A run imports the analysis of its own model only.
    return import_module(f"{__package__}.{package}.{analysis_of(model)}")


def _integrated(tree: Any, deck: Deck, options: "RunOptions") -> Any:
    """The tree with the integration that the options ask for; another method has another tolerance."""
    from ..model.tree import default_tolerances

    given = dict(options.integration)
    if "method" in given and not deck.section("tolerance"):
        rtol, atol = default_tolerances(given["method"])
        given = {"rtol": rtol, "atol": atol} | given
    return replace(tree, integration=replace(tree.integration, **given))


LARGEST_TOLERANCE = 0.02  # of the size, or rad: what is farther from closing is no loop
CHARACTERS_LOOKED_AT = 100_000  # characters of a deck
NUMBER = re.compile(r"(?<![\w.])-?(\d*)\.(\d*)(?:[EeDd][-+]?\d+)?(?![\w.])")
FEWEST_DIGITS, USUAL_DIGITS = 6, 8  # fewer may be exact; where no number has so many
UNITS_OFF = 5.0  # of the last digit: the roundings of a loop add up


def typed_precision(deck: Deck) -> float:
    """Return how well loops of a deck can close, by the number with the fewest digits that looks rounded."""
    return _precision_of(deck.source.text[:CHARACTERS_LOOKED_AT])


@lru_cache(maxsize=1)  # all variants of a study have the text of one deck
def _precision_of(text: str) -> float:
    texts = NUMBER.finditer(text)
    counts = {len((match[1] + match[2]).lstrip("0")) for match in texts}
    digits = min((n for n in counts if n >= FEWEST_DIGITS), default=USUAL_DIGITS)
    return UNITS_OFF * 10.0 ** -min(digits, MOST_DIGITS)


def with_loop_tolerance(model: Any, deck: Deck, given: float | None) -> Any:
    """Return the model with the tolerance of its loops: the one given, or that of the digits typed."""
    tolerance = typed_precision(deck) if given is None else given
    if hasattr(model, "mechanism"):
        return replace(model, mechanism=replace(model.mechanism, loop_tolerance=tolerance))
    return replace(model, loop_tolerance=tolerance)
