"""End stops that are pressed at the start of a run."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault
from ...kernels.laws import COORDINATE, EFFORT
from ...model.joint_elements import is_angle
from ...model.laws import STOP, JointLaw

if TYPE_CHECKING:
    from collections.abc import Iterator


def notes_of_pressed_stops(
    laws: tuple[JointLaw, ...], loads: np.ndarray, responses: np.ndarray
) -> "Iterator[Fault]":
    """Yield a note for each stop that pushes at the start; responses (loads, columns) belong to it."""
    stops = [item for item in laws if item.law is STOP]
    for stop, k in zip(stops, np.flatnonzero(loads["shape"] == STOP.code), strict=True):
        length, force = ("rad", "N m") if is_angle(stop.coordinate) else ("m", "N")
        effort, x = responses[k, EFFORT], responses[k, COORDINATE]
        if effort != 0.0:
            depth = max(x - stop["upper"], stop["lower"] - x)
            message = (
                f"it begins {depth:.4g} {length} behind its limit and pushes with {abs(effort):.4g} {force}; "
                "correct the limits or the position at the start if that is not meant"
            )
            yield Fault("note", message, stop.place, stop.name, id="SOLVE-040")
