"""End stops that are pressed at the start of a run."""

from collections.abc import Iterator

import numpy as np

from ...errors import Fault
from ...kernels.laws import COORDINATE, EFFORT
from ...model.laws import STOP, Element


def notes_of_pressed_stops(
    stops: tuple[Element, ...], loads: np.ndarray, responses: np.ndarray
) -> Iterator[Fault]:
    """Yield a note for each stop that pushes at the start; responses (loads, columns) belong to it."""
    for stop, k in zip(stops, np.flatnonzero(loads["shape"] == STOP.code), strict=True):
        length, force = ("rad", "N m") if stop.turning else ("m", "N")
        effort, x = responses[k, EFFORT], responses[k, COORDINATE]
        if effort != 0.0:
            depth = max(x - stop["upper"], stop["lower"] - x)
            message = (
                f"it begins {depth:.4g} {length} behind its limit and pushes with {abs(effort):.4g} {force}; "
                "correct the limits or the position at the start if that is not meant"
            )
            yield Fault("note", message, stop.place, stop.name, id="SOLVE-040")
