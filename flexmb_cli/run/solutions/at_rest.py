"""Runs that begin at rest in an equilibrium: `--from-equilibrium`, or lines `START equilibrium`."""

from collections.abc import Callable, Sequence
from typing import Any

from ...errors import Fault, ModelError
from ...model.joint_elements import JointElements
from ...model.mechanism import TimeGrid
from ...model.signals import Signal
from ..outcome import Run

_STATES = (
    "has states of its own, which {} does not bring to rest; leave it out, or begin where the motion is at "
    "rest"
)


def begin_at_rest(
    analysis: Any, again: Callable[[], Any], run: Run, speeds: int, grid: TimeGrid, elements: JointElements
) -> None:
    """Have `analysis` begin in the equilibrium that a second one of the same model, `again()`, falls into.

    `speeds`: how many the model has.  Raises AnalysisError if none is found, ModelError for signals with
    states, whose values at rest are not searched.
    """
    if not (run.options.from_equilibrium or elements.rests):
        return
    refuse_states(elements.signals, "a start from equilibrium")
    # Modes and their models are for runs with this option only.
    from ...solvers.linearisation.equilibrium import rest_of
    from ..mechanism_modes import Wish, kernels_for

    with kernels_for(speeds, Wish(None, True), grid, run.listener):
        analysis.rest = rest_of(again(), analysis.warnings)


def refuse_states(signals: Sequence[Signal], what: str) -> None:
    """Raise ModelError for signals with states, which `what` cannot bring to rest."""
    faults = [
        Fault("error", _STATES.format(what), signal.place, signal.name, id="SOLVE-150")
        for signal in signals
        if signal.states
    ]
    if faults:
        raise ModelError(faults)


def refuse_rest(run: Run, elements: JointElements | None) -> None:
    """Raise ModelError for a motion that drivers prescribe, or absolute coordinates of a tree."""
    lines = elements.rests if elements else ()
    if run.options.from_equilibrium or lines:
        what = "START equilibrium" if lines else "--from-equilibrium"
        message = (
            f"{what} is for motions that forces drive: drivers prescribe this one, or --formulation absolute "
            "is given; leave it out"
        )
        raise ModelError([Fault("error", message, lines[0].place if lines else None, id="SOLVE-111")])
