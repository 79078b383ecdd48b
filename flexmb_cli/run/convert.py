"""A deck's model for another program: the dialect that has the model, and who writes it."""

from pathlib import PurePath

from ..errors import FlexmbError, ModelError
from .deck import open_deck
from .outcome import Outcome, RunOptions

TREES = "--to mjcf takes rigid trees, which DAFMS decks describe; this is a {} deck"


def converted(path: str, form: str, changes: tuple[str, ...] = ()) -> str:
    """Return the model of the deck at `path` as text of the form "mjcf" or "exudyn".

    Raises FlexmbError, with the deck's name, for a deck with errors and for what the form cannot hold.
    """
    options = RunOptions(changes=changes)
    try:
        deck = open_deck(path, options, Outcome(path))
        name = PurePath(deck.source.name).stem
        return _mjcf(deck, name) if form == "mjcf" else _exudyn(deck, name, options)
    except FlexmbError as failure:
        failure.file = failure.file or path
        raise


def _mjcf(deck, name):
    from ..dialects.dafms.build import build_dafms
    from ..errors import Fault
    from ..results.models.mjcf import mjcf

    if deck.dialect != "dafms":
        raise ModelError([Fault("error", TREES.format(deck.dialect.upper()), id="RUN-027")])
    return mjcf(build_dafms(deck)[0], name)


def _exudyn(deck, name, options):
    from ..dialects.young.dynamic_cards import FORWARD, analysis_of
    from ..errors import Fault
    from ..results.models.exudyn import exudyn_script

    if deck.dialect != "young" or analysis_of(deck) != FORWARD:
        message = "--to exudyn takes rigid mechanisms in forward dynamics: YOUNG decks with DYNAMICS forward"
        raise ModelError([Fault("error", message, id="RUN-028")])
    from ..dialects.young.build_dynamics import build_young_dynamics

    model, _ = build_young_dynamics(deck)
    return exudyn_script(model, start_of(model), name)


def start_of(model) -> dict:
    """Return positions "r", Euler parameters "p", velocities "v", "omega" of the bodies at the first time."""
    from dataclasses import replace

    from ..results.hdf5.dynamic import dynamic_values
    from ..solvers.constrained.young_dynamics import ForwardDynamics

    time = model.mechanism.time
    first = replace(model, mechanism=replace(model.mechanism, time=replace(time, end=time.start)))
    values = dynamic_values(first, next(iter(ForwardDynamics(first).rows())))
    names = {"r": "position", "p": "euler_parameters", "v": "velocity", "omega": "angular_velocity"}
    return {short: values[f"body/{name}"][0] for short, name in names.items()}
