"""A deck from its file to records and to the model that it describes, ready for an analysis.

`--set` changes numbers; options that mean nothing to the deck are named in warnings.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ..deck.number import MOST_DIGITS
from ..deck.record import Deck
from ..deck.several_models import changes_of, named_model, only_model
from ..deck.text import STANDARD_INPUT
from ..dialects.elements_block.line import system_of
from ..dialects.recognise import dialect_named, open_text, read_deck
from ..errors import Fault
from ..solvers.as_printed.errors import AS_PRINTED
from .outcome import FROM_EQUILIBRIUM, LOOP_TOLERANCE, SOLVER_OPTIONS, Outcome, Run, RunOptions

if TYPE_CHECKING:
    from ..model.loads import DynamicModel
    from ..model.mechanism import Mechanism
    from ..model.tree import Tree


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


def module_for(model: "DynamicModel | Mechanism | Tree", package: str) -> ModuleType:
    """Return the module of the model's analysis in a package of this folder: "solutions", "check" …"""
    # A run imports the analysis of its own model only.
    return import_module(f"{__package__}.{package}.{analysis_of(model)}")


def _integrated(tree: Any, deck: Deck, options: RunOptions) -> Any:
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


INTEGRATION = ("method", "rtol", "atol")
# What takes the place of an option where it means nothing.
INSTEAD = dict.fromkeys(
    SOLVER_OPTIONS.values(), "forward dynamics solve to round-off; --rtol sets the tolerance of a step"
)
INSTEAD |= dict.fromkeys(
    INTEGRATION, "nothing is integrated, and every row is solved to round-off; --feps sets the residual"
)
INSTEAD["formulation"] = "there is one formulation; flexmb verify compares it with a second one"
INSTEAD[AS_PRINTED] = "only the YOUNG program of 1996 is emulated"


def open_deck(path: str, options: RunOptions, outcome: Outcome, text: str | None = None) -> Deck:
    """Return the deck at `path` with the changes of `--set`; its text and warnings go into `outcome`.

    `path` may be `2:PATH`, the second model of a deck.  A `text` is read as if it stood at `path`.
    """
    name, model = named_model(path)
    outcome.source = source = open_text(name, options.dialect, options.changes, text)
    changes = changes_of(options.changes, source, model)
    if model:
        source = only_model(source, model)
    deck = read_deck(source, options.dialect)
    if changes:
        from ..dialects.settings import apply_settings

        deck = apply_settings(deck, changes)
    outcome.faults += deck.warnings
    outcome.faults += _doubly_set(changes)
    outcome.settings, outcome.system = deck.settings, system_of(deck)
    return replace(deck, options=_counting_options(deck, options), model=model)


def take_open_deck(deck: Deck, faults: Sequence[Fault], options: RunOptions, outcome: Outcome) -> Deck:
    """Return a deck that was read before, with `faults`; its text and these go into `outcome`."""
    outcome.source, outcome.settings, outcome.system = deck.source, deck.settings, system_of(deck)
    outcome.faults += faults
    return replace(deck, options=_counting_options(deck, options))


def _counting_options(deck: Deck, options: RunOptions) -> tuple[str, ...]:
    """The options of this run on which its numbers depend, as the command has them."""
    known = _options_of(deck)
    given = [(name, value) for name, value in options.given_numbers if name in known]
    return tuple(name if value is None else f"{name}={value}" for name, value in given)


def _options_of(deck: Deck) -> list[str]:
    """The options on which numbers of this deck depend: those of steps only where steps are taken."""
    dialect = dialect_named(deck.dialect)
    own = [name for name in dialect.options if name not in INTEGRATION or dialect.takes_steps(deck)]
    return [*own, LOOP_TOLERANCE, FROM_EQUILIBRIUM]


def warn_of_foreign_options(deck: Deck, options: RunOptions, outcome: Outcome) -> None:
    """Warn of options that mean nothing to the deck, each with what takes their place."""
    own, title = _options_of(deck), dialect_named(deck.dialect).title
    foreign: dict[str, list[str]] = {}
    for name, _ in options.given_numbers:
        if name not in own:
            foreign.setdefault(INSTEAD[name], []).append(f"--{name}")
    for instead, names in foreign.items():
        *others, last = names
        reported = f"{', '.join(others)} and {last} have" if others else f"{last} has"
        message = f"{reported} no effect on this {title} deck: {instead}"
        outcome.faults.append(Fault("warning", message, id="RUN-012"))


def own_options(deck: Deck, options: RunOptions) -> RunOptions:
    """Return the options without a flag that means nothing to the deck's dialect."""
    as_printed = options.as_printed and AS_PRINTED in dialect_named(deck.dialect).options
    return replace(options, as_printed=as_printed)


def _doubly_set(changes: Sequence[str]) -> Iterator[Fault]:
    """Notes on numbers that `--set` names more than once."""
    words: dict[Any, Any] = {}
    for change in changes:
        name, _, word = (part.strip() for part in change.partition("="))
        words.setdefault(name, []).append(word)
    for name, given in words.items():
        if len(given) > 1:
            yield Fault(
                "note",
                f"--set names {name} {len(given)} times: the last counts, {name}={given[-1]}",
                id="RUN-013",
            )
