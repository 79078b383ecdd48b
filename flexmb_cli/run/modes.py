"""Eigenfrequencies of a deck: of its flexible bodies, each in its frame, and of its mechanism."""

import io
import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..deck.record import Deck
from ..errors import Fault, ModelError
from ..model.flexible_body import Dropped, FlexibleBody
from ..model.general_joints import refuse_switches
from ..model.unit_checks import unit_warnings
from ..results.files.replaced_file import write_whole
from .mechanism_modes import MechanismModes, Wish, dynamic_modes, flexible_modes, tree_modes
from .model import analysis_of, model_of, open_deck
from .outcome import Listener, Outcome, Run, RunOptions, Stop, ending_recorded


@dataclass
class ModesReport:
    """Result of one deck: `outcome` holds faults and exit code, `bodies` the flexible ones.

    `mechanism` is None where its linearised motion was not requested, or not found.
    """

    outcome: Outcome
    deck: Deck | None = None
    bodies: list[FlexibleBody] = field(default_factory=list)
    mechanism: MechanismModes | None = None

    def as_dict(self) -> dict[str, Any]:
        """The record that `--json` prints."""
        record = self.outcome.as_dict()
        record.pop("files"), record.pop("rows")
        record["bodies"] = [_as_dict(body) for body in self.bodies]
        return record | {"mechanism": self.mechanism and self.mechanism.as_dict()}


def modes_of_deck(path: str, wish: Wish, options: RunOptions, listener: Listener) -> ModesReport:
    """Frequencies of the deck at `path`; failures become the outcome's faults.

    A mechanism with flexible bodies is looked at only where a time or an equilibrium is
    asked for.
    """
    report = ModesReport(Outcome(path))
    with ending_recorded(report.outcome, options), Stop.released():
        _fill(report, wish, Run(report.outcome, options, listener.kept_in(report.outcome.notices)))
    return report


def _fill(report: ModesReport, wish: Wish, run: Run) -> None:
    deck = open_deck(run.outcome.deck, run.options, run.outcome)
    model = model_of(deck, run)
    analysis = _free(model)
    wish = _at_rest(model, wish)
    run.outcome.faults += unit_warnings(model, run.outcome.system)
    report.deck = deck
    if analysis == "flexible":
        report.bodies = [body.flexible for body in model.bodies if body.flexible is not None]
    if wish.of_mechanism or not report.bodies:
        report.mechanism = mechanism_modes(model, wish, run)
        if wish.out is not None:
            write_state_space(wish.out, report.mechanism.state_space)


def _free(model: Any) -> str:
    """Return the analysis of a model whose motion is free; raises ModelError for another."""
    analysis = analysis_of(model)
    if analysis == "kinematic" or (analysis == "dynamic" and model.analysis != "forward"):
        message = (
            "modes need masses and a free motion: cards after the last number, from DYNAMICS forward on, "
            "give them"
        )
        raise ModelError([Fault("error", message, id="RUN-018")])
    return analysis


def mechanism_modes(model: Any, wish: Wish, run: Run) -> MechanismModes:
    """Linearised motion of a mechanism; raises ModelError, AnalysisError."""
    return MODES[_free(model)](model, _at_rest(model, wish), run)


def _at_rest(model: Any, wish: Wish) -> Wish:
    """Return the wish for the equilibrium that the deck begins in, if it does; refuse releases."""
    if wish.time is not None:
        refuse_switches(model.elements, "modes --at TIME")
    if not model.elements.rests:
        return wish
    if wish.time is not None and not wish.equilibrium:
        [line] = model.elements.rests
        message = "the motion from the equilibrium is not followed to --at TIME; leave out one of them"
        raise ModelError([Fault("error", message, line.place, line.name, id="SOLVE-183")])
    return replace(wish, equilibrium=True)


MODES: dict[str, Callable[[Any, Wish, Run], MechanismModes]] = {
    "dynamic": dynamic_modes,
    "flexible": flexible_modes,
    "tree": tree_modes,
}


def _as_dict(body: FlexibleBody) -> dict[str, Any]:
    return {
        "name": body.name,
        "nodes": len(body.numbers),
        "mass": body.m,
        "centre": body.centre.tolist(),
        "inertia": body.J0.tolist(),
        "mass_deviation": body.mass_deviation,
        "rigid_residual": body.rigid_residual,
        "frequencies": body.frequencies.tolist(),
        "frequency_errors": [error if error == error else None for error in body.frequency_errors.tolist()],
        "effective_mass": body.effective_mass.tolist(),
        "effective_limit": body.effective_limit.tolist(),
        "massless": body.massless,
        "massless_in_motion": body.massless_in_motion,
        "dropped": _as_record(body.dropped),
    }


def _as_record(dropped: Dropped) -> dict[str, Any]:
    following = dropped.next_frequency
    known = {"dependent": dropped.dependent, "next_frequency": following if following == following else None}
    return vars(dropped) | known


def write_state_space(path: str, record: dict[str, Any]) -> None:
    """Write the record of a state space to `path`; raises OutputError."""
    forms = {".npz": npz_bytes, ".mat": _matlab_bytes, ".json": json_bytes}
    write_whole(path, forms[Path(path).suffix.lower()](record))


def _matlab_bytes(record: Any) -> Any:
    from ..results.files.matlab import variable_bytes

    # MATLAB has cells of texts where NumPy has arrays of them.
    arrays = {
        name: value.astype(object) if value.dtype.kind == "U" and value.ndim else value
        for name, value in arrays_of(record).items()
    }
    return variable_bytes("state_space", {name: np.asarray(value) for name, value in arrays.items()})


SHAPES = (("states", "states"), ("states", "inputs"), ("outputs", "states"), ("outputs", "inputs"))
FORMS = (".npz", ".mat", ".json")


def arrays_of(record: dict[str, Any]) -> dict[str, np.ndarray]:
    """Return matrices, names and units of a state space's record as arrays.

    `states`, `inputs`, `outputs`: names; `state_units` and so on: their units.
    """
    sizes = {what: len(record[what]) for what in ("states", "inputs", "outputs")}
    shapes = zip("ABCD", SHAPES, strict=True)
    arrays = {
        name: np.array(record[name], float).reshape([sizes[what] for what in shape]) for name, shape in shapes
    }
    for what in ("state", "input", "output"):
        for suffix, key in (("s", "name"), ("_units", "unit")):
            arrays[what + suffix] = np.array([signal[key] for signal in record[f"{what}s"]], dtype=str)
    arrays["state_relative_to"] = np.array([signal["relative_to"] for signal in record["states"]], dtype=str)
    arrays["constant"] = np.array([record["constant"][name] for name in "ABCD"])
    arrays["time"], arrays["axes"] = np.array(record["time"]), np.array(record["axes"])
    return arrays


def npz_bytes(record: dict[str, Any]) -> bytes:
    """Return a NumPy archive of the arrays of a state space."""
    stream = io.BytesIO()
    # numpy's type takes an array for its own option `allow_pickle`.
    np.savez(stream, **arrays_of(record))  # type: ignore[arg-type]
    return stream.getvalue()


def json_bytes(record: dict[str, Any]) -> bytes:
    """Return the record of a state space as JSON."""
    return (json.dumps(record) + "\n").encode()
