"""Elements at the start of a run: lines whose ends coincide, stops that are pressed, shapes that overlap."""

from collections.abc import Iterable, Iterator

import numpy as np

from ...errors import Fault, ModelError
from ...kernels.constrained.body_vectors import VECTOR
from ...kernels.constrained.system import System, Work
from ...kernels.laws import ANSWER_COLUMNS, COORDINATE, EFFORT, answer_law
from ...model.joint_elements import JointElements
from ...model.laws import CONTACT, STOP, Element, Line
from ..compilation import interpreting

# Of the longest length among its values, or m where they are 0: what assembly leaves between points that
# joints bring together.
COINCIDING = 1e-9


def refuse_coinciding_ends(system: System, work: Work, elements: Iterable[Element], t: float) -> None:
    """Raise ModelError for elements without a direction that act at the position at hand.

    `elements`: all force elements of the model, in the order of their loads.
    """
    loads = system.loads[system.loads["in_line"] == 1]
    lengths = [float(np.linalg.norm(work.relative_vectors[VECTOR, k, 0])) for k in loads["primitive"]]
    refuse_undirected_lines(elements, loads, lengths, (system.functions, system.knots), t)


def refuse_undirected_lines(
    elements: Iterable[Element],
    laws: np.ndarray,
    lengths: Iterable[float],
    functions: tuple[np.ndarray, np.ndarray],
    t: float,
) -> None:
    """Raise ModelError for elements in line that push or pull without a direction.

    `laws`, `lengths`: records with the fields of LAW and lengths, m, of those in line, in their order;
    `functions`: the functions and their knots that the records name.
    """
    faults, lines = [], (item for item in elements if isinstance(item.measure, Line))
    for line, law, length in zip(lines, laws, lengths, strict=True):
        if length > COINCIDING * _size(line):
            continue
        if force := _force_without_length(law, functions, t):
            faults.append(_fault(line, force, t))
    if faults:
        raise ModelError(faults)


def _size(line: Element) -> float:
    lengths = [abs(line[p.name]) for p in line.law.parameters if p.is_coordinate]
    return max(lengths, default=0.0) or 1.0


def _force_without_length(law: np.void, functions: tuple[np.ndarray, np.ndarray], t: float) -> float:
    """Return the force, N, that drives coinciding ends apart, which do not move."""
    with interpreting():
        return float(answer_law(law, *functions, t, True, np.zeros(ANSWER_COLUMNS)))


def _fault(line: Element, force: float, t: float) -> Fault:
    message = (
        f"its ends coincide at t = {t:.6g} s, where it {'pushes' if force > 0.0 else 'pulls'} with "
        f"{abs(force):.6g} N in no direction; move an end, or let it have no force at length 0"
    )
    return Fault("error", message, line.place, line.name, id="SOLVE-042")


def notes_of_pressed_elements(
    elements: JointElements, loads: np.ndarray, responses: np.ndarray
) -> Iterator[Fault]:
    """Yield a note for each stop and contact that pushes at the start; responses (loads, columns)."""
    yield from _pressed_stops(elements.of(STOP), responses[np.flatnonzero(loads["shape"] == STOP.code)])
    points = np.flatnonzero(loads["shape"] == CONTACT.code)
    for contact in elements.of(CONTACT):
        own, points = np.split(points, [len(contact.parts)])
        deepest = responses[own[np.argmin(responses[own, COORDINATE])]]
        if deepest[EFFORT] != 0.0:
            message = (
                f"its shapes overlap by {-deepest[COORDINATE]:.4g} m at the start and push with "
                f"{deepest[EFFORT]:.4g} N; correct shapes or the position at the start if that is not meant"
            )
            yield Fault("note", message, contact.place, contact.name, id="SOLVE-062")


def _pressed_stops(stops: Iterable[Element], answers: np.ndarray) -> Iterator[Fault]:
    for stop, answer in zip(stops, answers, strict=True):
        length, force = ("rad", "N m") if stop.turning else ("m", "N")
        effort, x = answer[EFFORT], answer[COORDINATE]
        if effort != 0.0:
            depth = max(x - stop["upper"], stop["lower"] - x)
            message = (
                f"it begins {depth:.4g} {length} beyond its limit and pushes with {abs(effort):.4g} {force}; "
                "correct the limits or the position at the start if that is not meant"
            )
            yield Fault("note", message, stop.place, stop.name, id="SOLVE-040")
