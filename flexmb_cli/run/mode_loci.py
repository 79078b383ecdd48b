"""Modes over a number of a deck."""

import numpy as np

from ..dialects.settings import SettableDeck
from ..errors import DeckError, Fault, ModelError
from ..solvers.linearisation.loci import ModeLoci, Tracks
from .mechanism_modes import Wish
from .model import model_of, open_deck
from .modes import mechanism_modes
from .outcome import Listener, Outcome, Run, RunOptions, Stop, ending_recorded


def mode_loci(
    path: str, name: str, values: np.ndarray, wish: Wish, options: RunOptions, listener: Listener
) -> tuple[Outcome, ModeLoci | None]:
    """Return the modes of a deck over values (v,) of a number, None if the outcome has an error."""
    outcome, loci = Outcome(path), None
    with ending_recorded(outcome, options), Stop.released():
        loci = _loci(name, values, wish, Run(outcome, options, listener.kept_in(outcome.notices)))
        outcome.faults = list(dict.fromkeys(outcome.faults))
    return outcome, loci


def _loci(name: str, values: np.ndarray, wish: Wish, run: Run) -> ModeLoci:
    deck = open_deck(run.outcome.deck, run.options, run.outcome)
    settable, known = SettableDeck(deck), dict(deck.numbers()) | dict(deck.variables)
    if name not in settable:
        message = f"{settable.unknown(name)}; modes follow names of --set"
        raise DeckError([Fault("error", message, about=name, id="RUN-170")])
    tracks = Tracks(len(values))
    for row, value in enumerate(values.tolist()):
        model = model_of(settable.with_settings([f"{name}={value!r}"]), run)
        tracks.add(row, mechanism_modes(model, wish, run).modes)
    if not tracks.columns:
        message = "no mode oscillates at any of these values, so that there is nothing to follow"
        raise ModelError([Fault("error", message, about=name, id="RUN-171")])
    return ModeLoci(name, known[name].unit, values, np.column_stack(tracks.columns))
