"""A deck from its file to records: with the changes of `--set`, and doubts about the options given."""

from ..deck.record import Deck
from ..deck.several_models import changes_of, named_model, only_model
from ..deck.text import read_text
from ..dialects.recognise import dialect_named, every_dialect, read_deck
from ..errors import Fault
from ..quick_dataclass import replace
from ..solvers.as_printed.errors import AS_PRINTED
from .outcome import Outcome, RunOptions


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


def _counting_options(deck, options):
    """The options of this run on which its numbers depend, as the command has them."""
    known = dialect_named(deck.dialect).options
    given = [(name, value) for name, value in options.given_numbers if name in known]
    return tuple(name if value is None else f"{name}={value}" for name, value in given)


def warn_of_foreign_options(deck: Deck, options: RunOptions, outcome: Outcome) -> None:
    """Options that mean nothing to the deck's dialect are said to be without effect."""
    own = dialect_named(deck.dialect).options
    foreign = [name for name, _ in options.given_numbers if name not in own]
    for owners, names in _by_owners(foreign) if foreign else ():
        *others, last = [f"--{name}" for name in names]
        told = f"{', '.join(others)} and {last} are" if others else f"{last} is"
        message = f"{told} for {owners} decks and {'have' if others else 'has'} no effect here"
        outcome.faults.append(Fault("warning", message, id="RUN-012"))


def own_options(deck: Deck, options: RunOptions) -> RunOptions:
    """Return the options without a flag that means nothing to the deck's dialect."""
    as_printed = options.as_printed and AS_PRINTED in dialect_named(deck.dialect).options
    return replace(options, as_printed=as_printed)


def _by_owners(names):
    """Pairs: titles of the dialects that know options, and those options."""
    found: dict[str, list[str]] = {}
    dialects = [*every_dialect()]
    for name in names:
        owners = [dialect.title for dialect in dialects if name in dialect.options]
        found.setdefault(" and ".join(owners), []).append(name)
    return found.items()


def _doubly_set(changes):
    """Notes on numbers that `--set` names more than once."""
    words = {}
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
