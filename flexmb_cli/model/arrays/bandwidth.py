"""Bandwidth of a flexible body's matrices: a condensed matrix is full, but falls off.

Condensing the rotations out of a beam leaves a stiffness between any two nodes, which falls by the
factor 2 - sqrt(3) from node to node: thirty nodes away it is below the round-off of the diagonal.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence


NEGLIGIBLE = 1e-17  # of the geometric mean of the two diagonal places: a tenth of the unit round-off


def row_reach(matrices: "Sequence[Any]") -> np.ndarray:
    """(NM, 2): where each row begins in any of the symmetric `matrices`, and one past its end.

    The first is (NM, NM), the others are one, several or None.
    """
    n = len(matrices[0])
    counts = np.eye(n, dtype=bool)
    for matrix in np.concatenate([np.reshape(m, (-1, n, n)) for m in matrices if m is not None]):
        size = np.sqrt(np.abs(np.diag(matrix)))
        counts |= np.abs(matrix) > NEGLIGIBLE * np.outer(size, size)
    counts |= counts.T
    return np.stack([np.argmax(counts, axis=1), n - np.argmax(counts[:, ::-1], axis=1)], axis=1)
