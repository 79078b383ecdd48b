"""Bringing coordinates and speeds onto the closures without exciting what an implicit step walks over.

As `projection`, but the least correction in the metric of the matrix of the step: stiff bodies
move as if rigid.  In the metric of the mass matrix light nodes would move most, however stiff.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from .implicit_matrix import Stiff, apply_multipliers, factor_schur_complement, set_jacobian
from .projection import Metric, projection

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@kernel
def _renew(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, s: Stiff) -> None:
    """Fill J where the frames are placed, and factorise its response."""
    set_jacobian(tree, work, coordinates, s)
    factor_schur_complement(s)


@kernel
def _respond(tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, z: np.ndarray, s: Stiff) -> None:
    """Responses of all coordinates that change the rows by what they hold as forces."""
    for i in range(s.rows.shape[0]):
        s.rows[i]["force"] = -tree.closures[i]["force"]
    s.rest.fill(0.0)
    apply_multipliers(s.rest, s)
    for m in range(coordinates.shape[0]):
        coordinates[m]["response"] = s.rest[m]


# The last array is the `Stiff` of the step, whose J is renewed.  That J is of the state before the gaps were
# closed: rates take a second correction.
project_stiffly = projection(Metric(_renew, _respond, 2))
