"""Bringing coordinates and speeds onto the closures without exciting what an implicit step walks over.

As `projection`, but the least correction in the metric of the matrix of the step: stiff bodies
move as if rigid.  In the measure of the mass matrix light nodes would move most, however stiff.
"""

from typing import TYPE_CHECKING, Any

from .._jit import kernel
from .implicit_matrix import apply_multipliers, factor_schur_complement, set_jacobian
from .projection import (
    CLOSED_LOOP_GAP,
    MOST_CORRECTIONS,
    change_speeds,
    evaluate_gaps,
    largest_gap,
    move_coordinates,
)

if TYPE_CHECKING:
    import numpy as np


RATE_CORRECTIONS = 2  # J is that of the state before the gaps were closed


@kernel
def project_stiffly(tree: Any, work, coordinates: "np.ndarray", z: "np.ndarray", s) -> None:
    """Close gaps and rates of z; s is the `Stiff` of the step, whose J is renewed."""
    evaluate_gaps(tree, work, coordinates, z)
    set_jacobian(tree, work, coordinates, s)
    factor_schur_complement(s)
    for turn in range(MOST_CORRECTIONS + RATE_CORRECTIONS):
        of_gaps = turn < MOST_CORRECTIONS
        if of_gaps and largest_gap(tree.closures) <= CLOSED_LOOP_GAP:
            continue
        for i in range(s.rows.shape[0]):
            s.rows[i]["force"] = tree.closures[i]["gap"] if of_gaps else tree.closures[i]["rate"]
        s.rest.fill(0.0)
        apply_multipliers(s.rest, s)
        for m in range(coordinates.shape[0]):
            coordinates[m]["response"] = s.rest[m]
        if of_gaps:
            move_coordinates(tree, coordinates, z)
        else:
            change_speeds(tree, coordinates, z)
        evaluate_gaps(tree, work, coordinates, z)
