"""Forces in the hinges of a tree, as the recursion leaves them behind.

What hangs on hinge k needs from it n = J al + H a + p_n, f = Hᵀ al + M a + p_f, with its articulated inertia
after the elimination of the hinge and the acceleration (al, a) before that of the hinge: Featherstone, Rigid
Body Dynamics Algorithms (2008), section 7.3.
"""

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel, part
from ..linalg.vec3 import cross, plus, scaled, store, symmetric, symmetric_times, triple
from .articulated_inertia import _times_H, _transposed_H
from .work import J_, M_

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@part
def hinge_wrench(
    motion: np.ndarray, share: float, bias: np.ndarray, s: np.void
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Moment about its origin and force on a frame by its hinge.

    motion (6,): acceleration (al, a) of the parent; bias (6,): that of the frame, or unit forces; `share` of
    the accelerations by velocities: 1, or 0 for a response to unit forces.
    """
    al = plus(triple(motion, 0), scaled(share, triple(s["remainder"], 0)))
    a = plus(triple(motion, 3), cross(triple(motion, 0), triple(s["offset"], 0)))
    a = plus(a, scaled(share, triple(s["remainder"], 3)))
    I = s["inertia"]
    n = plus(symmetric_times(symmetric(I, J_), al), _times_H(I, a))
    f = plus(_transposed_H(I, al), symmetric_times(symmetric(I, M_), a))
    return plus(n, triple(bias, 0)), plus(f, triple(bias, 3))


@kernel
def set_reactions(tree: "TreeArrays", work: np.ndarray) -> None:
    """Fill the reactions of the tree: force of the hinge of every frame and its moment, inertial axes."""
    for k in range(1, tree.frames.shape[0]):
        n, f = hinge_wrench(work[tree.frames[k]["parent"]]["acceleration"], 1.0, work[k]["bias"], work[k])
        store(f, tree.reactions[k], 0)
        store(n, tree.reactions[k], 3)
