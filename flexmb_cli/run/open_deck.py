"""A deck from its file to records: with the changes of `--set`, and warnings about the options given."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ..deck.record import Deck
from ..deck.several_models import changes_of, named_model, only_model
from ..deck.text import read_text
from ..dialects.recognise import dialect_named, read_deck
from ..errors import Fault
from ..solvers.as_printed.errors import AS_PRINTED
from .outcome import LOOP_TOLERANCE, SOLVER_OPTIONS, Outcome, RunOptions

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


def open_deck(path: str, options: RunOptions, outcome: Outcome) -> Deck:
    """Return the deck at `path` with the changes of `--set`; its text and warnings go into `outcome`.

    `path` may be `2:PATH`, the second model of a deck.
    """
    name, model = named_model(path)
    outcome.source = source = read_text(name)
    changes = changes_of(options.changes, source, model)
    if model:
        source = only_model(source, model)
    deck = read_deck(source, options.dialect)
    if changes:
        from ..dialects.settings import apply_settings

        deck = apply_settings(deck, changes)
    outcome.faults += deck.warnings
    outcome.faults += _doubly_set(changes)
    outcome.settings = deck.settings
    return replace(deck, options=_counting_options(deck, options), model=model)


def take_open_deck(deck: Deck, faults: Sequence[Fault], options: RunOptions, outcome: Outcome) -> Deck:
    """Return a deck that was read before, with `faults`; its text and these go into `outcome`."""
    outcome.source, outcome.settings = deck.source, deck.settings
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
    return [*own, LOOP_TOLERANCE]


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
