"""End stops that are pressed at the start of a run."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault
from ...kernels.constrained.elements import COORDINATE, EFFORT
from ...model.arrays.records import ELEMENT, STOP

if TYPE_CHECKING:
    from collections.abc import Iterator


def notes_of_pressed_stops(loads: np.ndarray, responses: np.ndarray) -> "Iterator[Fault]":
    """Yield a note for each stop that pushes at the start; responses (loads, columns) belong to it."""
    stops = np.flatnonzero((loads["kind"] == ELEMENT) & (loads["shape"] == STOP))
    for number, k in enumerate(stops, start=1):
        effort, x = responses[k, EFFORT], responses[k, COORDINATE]
        if effort != 0.0:
            depth = max(x - loads["upper"][k], loads["lower"][k] - x)
            message = (
                f"it begins {depth:.4g} (m or rad) behind its limit and pushes with "
                f"{abs(effort):.4g} (N or N m); correct the limits or the position at the start "
                "if that is not meant"
            )
            yield Fault("note", message, None, f"end stop {number}", id="SOLVE-040")
