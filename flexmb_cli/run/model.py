"""The model that a deck describes, ready for an analysis: building ends here, before solving starts."""

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..deck.record import Deck
from ..deck.text import STANDARD_INPUT
from ..dialects.recognise import dialect_named
from .context import Run
from .loop_tolerance import with_loop_tolerance

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
