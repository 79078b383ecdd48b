"""What the kernels of constrained dynamics pass around: the model, and arrays used again and again.

A mechanism of b bodies with E modal coordinates and m equations has n = 6 b + E speeds u: v and ω of every
body, then all η̇; its coordinates q (n + b,) are r and p of every body, then all η.
"""

from collections import namedtuple

import numpy as np

from .._jit import plain

System = namedtuple(
    "System",
    "constraints bodies row_scale speed_scale masses flexible modal body_vectors shapes primitives loads "
    "functions knots gravity groups",
)
System.__doc__ = """A mechanism; records are those of `model.arrays.records`.

constraints: CONSTRAINT records without normalisation, whose rows come first.  bodies (r, 2): bodies of the
two halves of each of these rows.  row_scale (m,), speed_scale (n,): units of equations and speeds.  masses
(b,).  flexible: FLEXIBLE records, with their invariants in modal.  body vectors, shapes: ARM records and
their shapes.  primitives: MEASURE records, first those of the other rows, then those of springs.
loads, functions, knots (k, 3): forces and what varies them.  gravity (3,).  groups: GROUP records.
"""

Work = namedtuple(
    "Work",
    "rotations rows phi_q jacobian left factors order motions reduced mass modal body_vectors "
    "relative_vectors angles vectors rank quality pivots responses columns entries",
)
Work.__doc__ = """Arrays reused in every evaluation.

rotations (3, b, 3, 3): A, dA/dt and the remainder of d²A/dt².  rows (3, m): see the
names below.  phi_q (r, 14).
jacobian (m, n): scaled rows on speeds; left, factors (m, n) and order (m + n,): its elimination.
motions (n, n): in its first n - rank columns the free speeds.  reduced (n, n): Cholesky factor of
the mass matrix of the free speeds.  mass (b, 6, 6), modal: see `mass_matrix`.  body_vectors (3, body vectors,
3) and relative vectors (3, primitives, 2, 3): see `body_vectors`.  angles (angles,): the angles that joint
springs expect, rad.  vectors (6, n + b): see the names below.  rank (1,) and quality (1,): of the order in
use.  pivots (m,): see `singular_ahead`.  responses (loads, 8): see `elements`.  columns (m, 1 + c), entries
(m, n + 2): nonzero places of Jacobian and factors, see `rank_revealing_lu.factorise`.
"""
A, RATE, REMAINDER = 0, 1, 2
PHI, GAMMA, SCALED = 0, 1, 2
FORCES, UNKNOWN, PRODUCT, FREE, CORRECTION, QD = 0, 1, 2, 3, 4, 5

SOLVED, SINGULAR, NO_INERTIA = 0, 1, 2


@plain
def make_work(system, angles):
    """Work for a mechanism with `angles` angles."""
    bodies, m, n = system.masses.shape[0], system.row_scale.shape[0], system.speed_scale.shape[0]
    modal = 0
    for k in range(system.flexible.shape[0]):
        N = system.flexible[k]["modes"]
        modal += 12 + 12 * N + (6 + N) * (6 + N) + 6 + N
    # Body vectors of the ground stay as they are placed: at rest.
    return Work(
        np.zeros((3, bodies, 3, 3)),
        np.zeros((3, m)),
        np.zeros((system.bodies.shape[0], 14)),
        np.zeros((m, n)),
        np.zeros((m, n)),
        np.zeros((m, n)),
        np.zeros(m + n, np.int64),
        np.zeros((n, n)),
        np.zeros((n, n)),
        np.zeros((bodies, 6, 6)),
        np.zeros(modal),
        np.zeros((3, system.body_vectors.shape[0], 3)),
        np.zeros((3, system.primitives.shape[0], 2, 3)),
        np.zeros(angles),
        np.zeros((6, n + bodies)),
        np.zeros(1, np.int64),
        np.ones(1),
        np.zeros(m),
        np.zeros((system.loads.shape[0], 8)),
        columns_of(system),
        np.zeros((m, n + 2), np.int64),
    )


@plain
def columns_of(system):
    """Columns (m, 1 + c) of each equation's Jacobian that may be other than zero, behind their number."""
    first, bodies = system.bodies.shape[0], system.masses.shape[0]
    found = [_speeds_of({(int(body), 0, 0) for body in pair}, bodies) for pair in system.bodies]
    for row in range(first, system.row_scale.shape[0]):
        body_vectors, k = set(), row - first
        while k >= 0:
            primitive = system.primitives[k]
            body_vectors.update(map(int, primitive["ends"].ravel() if primitive["alpha"] else ()))
            body_vectors.update(int(primitive[name]) for name in ("f", "g", "h") if primitive["beta"])
            k = int(primitive["next"])
        moved = (system.body_vectors[body_vector] for body_vector in body_vectors if body_vector >= 0)
        found.append(
            _speeds_of(
                {
                    (int(body_vector["body"]), int(body_vector["first"]), int(body_vector["modes"]))
                    for body_vector in moved
                },
                bodies,
            )
        )
    columns = np.zeros((len(found), 1 + max(map(len, found), default=0)), np.int64)
    for row, places in enumerate(found):
        columns[row, 0] = len(places)
        columns[row, 1 : 1 + len(places)] = places
    return columns


@plain
def _speeds_of(parts, bodies):
    """Sorted speeds that (body, first modal coordinate, number of modes) of some body vectors have; none at
    -1.
    """
    speeds = set()
    for body, first, modes in parts:
        if body >= 0:
            speeds.update(range(6 * body, 6 * body + 6))
            speeds.update(range(6 * bodies + first, 6 * bodies + first + modes))
    return sorted(speeds)
