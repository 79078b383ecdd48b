"""Bringing coordinates and speeds onto the closures without exciting what an implicit step walks over.

As `tree_projection`, but the least correction in the measure of the matrix of the step: stiff bodies
move as if rigid.  In the measure of the mass matrix light nodes would move most, however stiff.
"""

from .._jit import kernel
from .implicit_matrix import give_way, set_grip, set_pulls
from .projection import CLOSED, MOST_CORRECTIONS, change_speeds, largest_gap, measure, move_coordinates

RATE_CORRECTIONS = 2  # J is that of the state before the gaps were closed


@kernel
def project_stiffly(tree, work, coordinates, z, s):
    """Close gaps and rates of z; s is the `Stiff` of the step, whose J is renewed."""
    measure(tree, work, coordinates, z)
    set_pulls(tree, work, coordinates, s)
    set_grip(s)
    for turn in range(MOST_CORRECTIONS + RATE_CORRECTIONS):
        of_gaps = turn < MOST_CORRECTIONS
        if of_gaps and largest_gap(tree.closures) <= CLOSED:
            continue
        for i in range(s.rows.shape[0]):
            s.rows[i]["force"] = tree.closures[i]["gap"] if of_gaps else tree.closures[i]["rate"]
        s.rest.fill(0.0)
        give_way(s.rest, s)
        for m in range(coordinates.shape[0]):
            coordinates[m]["response"] = s.rest[m]
        if of_gaps:
            move_coordinates(tree, coordinates, z)
        else:
            change_speeds(tree, coordinates, z)
        measure(tree, work, coordinates, z)
