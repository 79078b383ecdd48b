"""A deck's model for another program: the dialect that has the model, and who writes it."""

from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from ..errors import Fault, FlexmbError, ModelError
from .context import Run
from .model import analysis_of, model_of
from .open_deck import open_deck
from .outcome import Outcome, RunOptions

if TYPE_CHECKING:
    pass


def converted(path: str, form: str, changes: tuple[str, ...] = ()) -> str:
    """Return the model of the deck at `path` as text of the form "mjcf" or "exudyn".

    Raises FlexmbError, with the deck's name, for a deck with errors and for what the form cannot hold.
    """
    options = RunOptions(changes=changes)
    try:
        run = Run(Outcome(path), options)
        deck = open_deck(path, options, run.outcome)
        write = _mjcf if form == "mjcf" else _exudyn
        return write(model_of(deck, run), PurePath(deck.source.name).stem)
    except FlexmbError as failure:
        failure.file = failure.file or path
        raise


def _mjcf(model: Any, name: Any) -> str:
    from ..results.models.mjcf import mjcf

    if analysis_of(model) != "tree":
        message = "--to mjcf takes trees of bodies; this deck describes a mechanism with constraints"
        raise ModelError([Fault("error", message, id="RUN-027")])
    return mjcf(model, name)


def _exudyn(model: Any, name: Any) -> str:
    from ..results.models.exudyn import exudyn_script

    if analysis_of(model) != "dynamic" or model.analysis != "forward":
        message = "--to exudyn takes rigid mechanisms under forces: decks with DYNAMICS forward"
        raise ModelError([Fault("error", message, id="RUN-028")])
    return exudyn_script(model, start_of(model), name)


def start_of(model: Any) -> dict:
    """Return positions "r", Euler parameters "p", velocities "v", "omega" of the bodies at the first time."""
    from dataclasses import replace

    from ..results.hdf5.dynamic import dynamic_values
    from ..solvers.constrained.young_dynamics import ForwardDynamics

    time = model.mechanism.time
    first = replace(model, mechanism=replace(model.mechanism, time=replace(time, end=time.start)))
    values = dynamic_values(first, next(iter(ForwardDynamics(first).rows())))
    names = {"r": "position", "p": "euler_parameters", "v": "velocity", "omega": "angular_velocity"}
    return {short: values[f"body/{name}"][0] for short, name in names.items()}
