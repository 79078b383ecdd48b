"""Springs in line whose ends coincide at the start: with a free length they have no direction to push in."""

from typing import TYPE_CHECKING

import numpy as np

from ...errors import Fault, ModelError
from ...kernels.constrained.body_vectors import VECTOR
from ...model.arrays.records import LINE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...kernels.constrained.system import System, Work
    from ...model.flexible_mechanism import PointSpring
    from ...model.loads import SpringDamper


COINCIDING = 1e-9  # of the free length: what assembly leaves between points that joints bring together


def refuse_coinciding_ends(
    system: "System", work: "Work", springs: "Sequence[SpringDamper | PointSpring]", t: float
) -> None:
    """Raise ModelError for stretched springs without a direction at the position at hand.

    `springs`: the springs in line of the model, in the order of their loads.
    """
    loads = system.loads[system.loads["kind"] == LINE]
    faults = []
    for load, spring in zip(loads, springs, strict=True):
        length = float(np.linalg.norm(work.relative_vectors[VECTOR, load["primitive"], 0]))
        if load["stiffness"] * load["free_length"] and length <= COINCIDING * abs(load["free_length"]):
            faults.append(_fault(spring, load["free_length"], t))
    if faults:
        raise ModelError(faults)


def _fault(spring: "PointSpring | SpringDamper", free_length: float, t: float) -> Fault:
    message = (
        f"its ends coincide at t = {t:.6g} s, where its free length of {free_length:.6g} m gives it a force "
        "without a direction; move an end, or give it the free length 0"
    )
    return Fault("error", message, spring.place, spring.name, id="SOLVE-004")
