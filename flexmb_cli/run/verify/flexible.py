"""A mechanism of flexible bodies in two floating frames, which its dialect makes.

With all modes both hold the same deformations: the two models are one and the same.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...deck.record import Deck
from ...dialects.recognise import dialect_named
from ...errors import Fault, ModelError
from ...model.flexible_mechanism import FlexibleMechanism
from ..model import folder_of
from ..outcome import Run
from .verify import ELEMENTS, Difference, Size, compared_rows, finely_stepped, joined, largest_difference

FORMULATIONS = "two floating frames, nodes n1 and n2 exchanged, all modes"
FRAMES_TOLERANCE = 1e-9
SERIES = (
    ("point position", "m", "point_position"),
    ("point velocity", "m/s", "point_velocity"),
    ("point acceleration", "m/s^2", "point_acceleration"),
)
FORCES = (
    ("reaction force", "N", "reaction_force"),
    ("reaction torque", "N m", "reaction_torque"),
    ("force of pins", "N", "holding_force"),
    ("driver effort", "N, N m", "driver_effort"),
)
# Of decks with elements: joint coordinates are of no use here, they may be angles of the frames.
OF_ELEMENTS = (
    *((name, unit, path.replace("/", "_")) for path, (name, unit) in ELEMENTS.items()),
    ("element work", "J", "element_work"),
)
ENERGIES = ("kinetic", "potential", "strain")


def differences(mechanism: FlexibleMechanism, deck: Deck, run: Run) -> tuple[Difference, ...]:
    """Run `deck` in both frames and return what the motions differ in.  Raises FlexmbError."""
    dialect = dialect_named(deck.dialect)
    if not dialect.second_model:
        message = f"decks of dialect {dialect.name} have no second model to compare with"
        raise ModelError([Fault("error", message, id="RUN-041")])
    second = dialect.part(dialect.second_model)(deck, folder_of(run), mechanism)
    finer = finely_stepped(mechanism.integrator, run.options, "RAD5", FRAMES_TOLERANCE)
    (one, unique), (other, _) = (_rows(replace(model, integrator=finer)) for model in (mechanism, second))
    run.outcome.rows = one["time"].size
    return tuple(_differences(mechanism, one, other, unique))


def _rows(mechanism: FlexibleMechanism) -> tuple[Any, Any]:
    """Return the rows by their fields, and whether no equation repeats others."""
    from ...solvers.constrained.flexible_dynamics import FlexibleDynamics

    analysis = FlexibleDynamics(mechanism)
    blocks = list(compared_rows(analysis))
    named = [key for _, _, key in (*SERIES, *FORCES, *OF_ELEMENTS)]
    rows = joined(blocks, ("time", "position", "velocity", *ENERGIES, *named))
    return rows, analysis.mobility is not None and not analysis.mobility.redundant


def _size(mechanism: FlexibleMechanism) -> Size:
    from ...model.arrays.flexible import length_scale

    time = mechanism.time
    return Size(length_scale(mechanism), time.end - time.start, sum(body.m for body in mechanism.bodies))


def _differences(
    mechanism: FlexibleMechanism, one: np.ndarray, other: np.ndarray, unique: Any
) -> Iterator[Any]:
    time, size = one["time"], _size(mechanism)
    for name, unit, key in SERIES + OF_ELEMENTS + (FORCES if unique else ()):
        if key in one and one[key].size:
            yield largest_difference(name, unit, time, one[key], other[key], size)
    rigid = [k for k, body in enumerate(mechanism.bodies) if body.flexible is None]
    if rigid:
        for name, unit, key in (("position", "m", "position"), ("velocity", "m/s", "velocity")):
            yield largest_difference(
                f"rigid body {name}", unit, time, one[key][:, rigid], other[key][:, rigid], size
            )
    moved = max(np.max(np.abs(one[name])) for name in ("kinetic", "strain"))
    for name in ENERGIES:
        yield largest_difference(f"{name} energy", "J", time, one[name], other[name], size, moved)
