"""What the kernels of constrained dynamics pass around: the model, and arrays used again and again."""

from collections import namedtuple

import numpy as np

from ._jit import kernel

System = namedtuple(
    "System", "constraints bodies row_scale speed_scale masses loads tables table_ends gravity"
)
System.__doc__ = """A mechanism of b bodies with m equations and n = 6 b speeds.

constraints: CONSTRAINT records without normalisation.  bodies (m, 2): bodies of the two halves of each
row.  row_scale (m,), speed_scale (n,): units of equations and speeds.  masses (b,), loads, tables,
table_ends, gravity: see `model.dynamic_arrays`.
"""

Work = namedtuple(
    "Work", "rotations rows phi_q jacobian left factors order motions reduced mass vectors rank quality"
)
Work.__doc__ = """Arrays reused in every evaluation.

rotations (3, b, 3, 3): A, dA/dt and the remainder of d²A/dt².  rows (3, m): see the
names below.  phi_q (m, 14).
jacobian (m, n): scaled rows on speeds; left, factors (m, n) and order (m + n,): its elimination.
motions (n, n): in its first n - rank columns the free speeds.  reduced (n, n): Cholesky factor of
the mass matrix of the free speeds.  mass (b, 6, 6).  vectors (6, 7 b): see the names below.  rank (1,)
and quality (1,): of the order in use.
"""
A, RATE, REMAINDER = 0, 1, 2
PHI, GAMMA, SCALED = 0, 1, 2
FORCES, UNKNOWN, PRODUCT, FREE, CORRECTION, QD = 0, 1, 2, 3, 4, 5

SOLVED, SINGULAR, NO_INERTIA = 0, 1, 2


@kernel
def make_work(equations, bodies):
    """Work for a mechanism."""
    n = 6 * bodies
    return Work(
        np.zeros((3, bodies, 3, 3)),
        np.zeros((3, equations)),
        np.zeros((equations, 14)),
        np.zeros((equations, n)),
        np.zeros((equations, n)),
        np.zeros((equations, n)),
        np.zeros(equations + n, np.int64),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((bodies, 6, 6)),
        np.zeros((6, n + bodies)),
        np.zeros(1, np.int64),
        np.ones(1),
    )
