"""Elements at the start of a run: springs in line whose ends coincide, end stops that are pressed."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault, ModelError
from ...kernels.constrained.body_vectors import VECTOR
from ...kernels.laws import COORDINATE, EFFORT
from ...model.laws import SPRING, STOP, Line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ...kernels.constrained.system import System, Work
    from ...model.laws import Element

# Of the free length, or m where it is 0: what assembly leaves between points that joints bring together.
COINCIDING = 1e-9


def refuse_coinciding_ends(system: "System", work: "Work", elements: "Iterable[Element]", t: float) -> None:
    """Raise ModelError for stretched springs without a direction at the position at hand.

    `elements`: all force elements of the model, in the order of their loads.
    """
    loads = system.loads[system.loads["in_line"] == 1]
    lengths = [float(np.linalg.norm(work.relative_vectors[VECTOR, k, 0])) for k in loads["primitive"]]
    refuse_undirected_lines(elements, lengths, t)


def refuse_undirected_lines(elements: "Iterable[Element]", lengths: "Iterable[float]", t: float) -> None:
    """Raise ModelError for springs in line of such lengths, m, that push or pull without a direction."""
    faults, lines = [], (item for item in elements if isinstance(item.measure, Line))
    for line, length in zip(lines, lengths, strict=True):
        force = _force_without_length(line)
        if force and length <= COINCIDING * (abs(line["rest"]) or 1.0):
            faults.append(_fault(line, force, t))
    if faults:
        raise ModelError(faults)


def _force_without_length(line: "Element") -> float:
    """Return the force, N, that drives coinciding ends apart; a cable is slack there."""
    if line.law is not SPRING:
        return 0.0
    stiffness, rest, _, preload, function, _ = line.values
    return float(stiffness * rest - preload - (function.at(-rest)[0] if function else 0.0))


def _fault(line: "Element", force: float, t: float) -> Fault:
    message = (
        f"its ends coincide at t = {t:.6g} s, where it {'pushes' if force > 0.0 else 'pulls'} with "
        f"{abs(force):.6g} N in no direction; move an end, or give it the rest length 0 and no preload"
    )
    return Fault("error", message, line.place, line.name, id="SOLVE-042")


def notes_of_pressed_stops(
    stops: "tuple[Element, ...]", loads: np.ndarray, responses: np.ndarray
) -> "Iterator[Fault]":
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
