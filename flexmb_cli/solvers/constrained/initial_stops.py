"""End stops that are pressed at the start of a run."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault
from ...kernels.constrained.elements import COORDINATE, EFFORT
from ...model.arrays.records import STOP
from ...model.joint_elements import EndStop, is_angle

if TYPE_CHECKING:
    from collections.abc import Iterator


def notes_of_pressed_stops(
    stops: tuple[EndStop, ...], loads: np.ndarray, responses: np.ndarray
) -> "Iterator[Fault]":
    """Yield a note for each stop that pushes at the start; responses (loads, columns) belong to it."""
    records = np.flatnonzero(loads["shape"] == STOP)
    for stop, k in zip(stops, records, strict=True):
        length, force = ("rad", "N m") if is_angle(stop.coordinate) else ("m", "N")
        effort, x = responses[k, EFFORT], responses[k, COORDINATE]
        if effort != 0.0:
            depth = max(x - loads["upper"][k], loads["lower"][k] - x)
            message = (
                f"it begins {depth:.4g} {length} behind its limit and pushes with {abs(effort):.4g} {force}; "
                "correct the limits or the position at the start if that is not meant"
            )
            yield Fault("note", message, stop.place, stop.name, id="SOLVE-040")
