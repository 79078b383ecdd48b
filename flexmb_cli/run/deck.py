"""Run one deck of any dialect; every failure becomes an outcome with its exit code."""

from ..deck.record import Deck
from ..deck.several_models import changes_of, named_model, only_model
from ..deck.text import read_text
from ..dialects.recognise import read_deck
from ..dialects.young.sections import AS_PRINTED
from ..errors import DeckError, Fault
from ..quick_dataclass import replace
from ..results.files.file_names import result_paths
from .exit_status import ending_recorded
from .outcome import ABSOLUTE, SOLVER_OPTIONS, Listener, Outcome, RunOptions, Stop


def _run_young(*arguments):
    from .young_dynamics import run_young_deck

    run_young_deck(*arguments)


def _run_dafms(*arguments):
    from .dafms import run_dafms

    run_dafms(*arguments)


def _run_vsdf(*arguments):
    from .vsdf import run_vsdf

    run_vsdf(*arguments)


# A run imports the models and the solver of its own dialect.
RUNNERS = {"young": _run_young, "dafms": _run_dafms, "vsdf": _run_vsdf}


def run_deck(path: str, options: RunOptions, listener: Listener | None = None, stdout=None) -> Outcome:
    """Read, solve and write the deck at `path` ("-": standard input).

    `stdout` receives the OUT table of `--out -`.  Never raises for what a deck, a disk or a signal
    can do.
    """
    outcome = Outcome(path)
    with ending_recorded(outcome, options):
        with Stop.released():
            deck = open_deck(path, options, outcome)
        warn_of_foreign_options(deck, options, outcome)
        runner = RUNNERS[deck.dialect]
        try:
            runner(deck, paths_of(deck, options), options, outcome, listener or Listener(), stdout)
        finally:
            if options.echo:
                from ..results.texts.echo import echo

                # By now the model tells what it took for empty fields.
                outcome.echo = echo(deck)
    return outcome


def open_deck(path: str, options: RunOptions, outcome: Outcome) -> Deck:
    """The deck at `path` with the changes of `--set`; its text and warnings go into `outcome`.

    `path` may be `2:PATH`, the second model of a DAFMS deck.
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
    if deck.dialect not in RUNNERS:
        message = f"decks of dialect {deck.dialect} cannot be run yet by this version"
        raise DeckError([Fault("error", message, id="RUN-011")])
    return replace(deck, options=_told_options(deck, options), model=model)


def _told_options(deck, options):
    """The options of this run on which its numbers depend, as the command has them."""
    given = dict(options.solver) if deck.dialect == "young" else {}
    given |= options.integration if _is_integrated(deck) else {}
    told = [f"{SOLVER_OPTIONS.get(key, key)}={value}" for key, value in given.items()]
    if deck.dialect == "young" and options.as_printed:
        told.append(AS_PRINTED)
    if deck.dialect == "dafms" and options.formulation == ABSOLUTE:
        told.append(f"formulation={ABSOLUTE}")
    return tuple(told)


def _is_integrated(deck):
    """Whether time steps are taken: in kinematics and inverse dynamics every row is solved for itself."""
    from ..dialects.young.dynamic_cards import FORWARD, analysis_of

    return deck.dialect != "young" or analysis_of(deck) == FORWARD


def warn_of_foreign_options(deck: Deck, options: RunOptions, outcome: Outcome) -> None:
    """Warn of options that mean nothing to the deck, each with what takes their place."""
    foreign = []
    if deck.dialect != "young":
        there = "forward dynamics solve to round-off; --rtol sets the tolerance of a step"
        foreign.append(([SOLVER_OPTIONS[key] for key in options.solver], there))
        foreign.append(([AS_PRINTED] * options.as_printed, "the program of 1996 read YOUNG decks only"))
    if not _is_integrated(deck):
        there = "nothing is integrated, and every row is solved to round-off; --feps sets the residual"
        foreign.append(([*options.integration], there))
    if deck.dialect != "dafms":
        there = "there is one formulation; flexmb verify compares it with a second one"
        foreign.append((["formulation"] * (options.formulation == ABSOLUTE), there))
        there = "a stopped run keeps its rows, marked as failed; the run starts anew"
        foreign.append((["resume"] * options.resume, there))
    for names, there in foreign:
        if names:
            *others, last = [f"--{name}" for name in names]
            told = f"{', '.join(others)} and {last} have" if others else f"{last} has"
            message = f"{told} no effect on this {deck.dialect.upper()} deck: {there}"
            outcome.faults.append(Fault("warning", message, id="RUN-012"))


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


def paths_of(deck: Deck, options: RunOptions):
    """Return where the results of `deck` go."""
    return result_paths(
        deck.source.name,
        deck.dialect,
        options.folder,
        options.out,
        options.h5,
        options.no_out,
        options.no_h5,
        deck.model,
    )
