"""Springs in line whose ends coincide at the start: what pushes or pulls there has no direction."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault, ModelError
from ...kernels.constrained.body_vectors import VECTOR

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ...kernels.constrained.system import System, Work
    from ...model.flexible_mechanism import PointSpring
    from ...model.joint_elements import LineSpring
    from ...model.loads import SpringDamper


# Of the free length, or m where it is 0: what assembly leaves between points that joints bring together.
COINCIDING = 1e-9


def refuse_coinciding_ends(
    system: "System",
    work: "Work",
    springs: "Sequence[SpringDamper | PointSpring]",
    lines: "Sequence[LineSpring]",
    t: float,
) -> None:
    """Raise ModelError for stretched springs without a direction at the position at hand.

    `springs` and `lines`: those in line of the model and of its elements, in the order of their loads.
    """
    loads = system.loads[system.loads["in_line"] == 1]
    faults = []
    for load, spring in zip(loads[: len(springs)], springs, strict=True):
        free_length = load["free_length"]
        if load["stiffness"] * free_length and _length(work, load) <= COINCIDING * abs(free_length):
            faults.append(_fault(spring, free_length, t))
    if faults:
        raise ModelError(faults)
    refuse_undirected_lines(lines, [_length(work, load) for load in loads[len(springs) :]], t)


def refuse_undirected_lines(lines: "Iterable[LineSpring]", lengths: "Iterable[float]", t: float) -> None:
    """Raise ModelError for springs of such lengths, m, that push or pull where they have no direction."""
    faults = []
    for line, length in zip(lines, lengths, strict=True):
        force = _force_without_length(line)
        if force and length <= COINCIDING * (abs(line.rest) or 1.0):
            faults.append(_line_fault(line, force, t))
    if faults:
        raise ModelError(faults)


def _length(work: "Work", load: np.void) -> float:
    """Distance of the ends, m."""
    return float(np.linalg.norm(work.relative_vectors[VECTOR, load["primitive"], 0]))


def _force_without_length(line: "LineSpring") -> float:
    """Return the force, N, that drives coinciding ends apart; a cable is slack there."""
    if line.slack:
        return 0.0
    curve = line.curve.at(-line.rest)[0] if line.curve is not None else 0.0
    return line.stiffness * line.rest - line.preload - curve


def _fault(spring: "PointSpring | SpringDamper", free_length: float, t: float) -> Fault:
    message = (
        f"its ends coincide at t = {t:.6g} s, where its free length of {free_length:.6g} m gives it a force "
        "without a direction; move an end, or give it the free length 0"
    )
    return Fault("error", message, spring.place, spring.name, id="SOLVE-004")


def _line_fault(line: "LineSpring", force: float, t: float) -> Fault:
    message = (
        f"its ends coincide at t = {t:.6g} s, where it {'pushes' if force > 0.0 else 'pulls'} with "
        f"{abs(force):.6g} N in no direction; move an end, or give it the rest length 0 and no preload"
    )
    return Fault("error", message, line.place, line.name, id="SOLVE-042")
