"""The stiff part of a tree's equations: b y' = ... - D y - K q, with b, D and K as matrices.

K and D hold elastic bodies, their stiffening and hinge springs; what else depends on the coordinates
is soft, and an implicit step may leave it out of its matrix.
"""

from ._jit import kernel
from .kane_tree import solve_tree
from .plain_elimination import row_times
from .tree_kinematics import place_frames
from .tree_loads import pulls
from .tree_motion import parts


@kernel
def set_mass(tree, work, coordinates, z, mass):
    """Fill mass (NS, NS) with b at the state z, column by column from inverse dynamics.

    Prescribed coordinates get rows and columns of the unit matrix, the one-way assumption its zeros.
    """
    y, q, attitudes = parts(tree, z)
    n = mass.shape[0]
    for m in range(n, -1, -1):
        # The first turn finds what no acceleration asks for; it stays in column 0, which is filled last.
        for i in range(n):
            coordinates[i]["effort"], coordinates[i]["locked"] = 0.0, 1
            coordinates[i]["rate"] = 1.0 if i == m else 0.0
        place_frames(tree, work, coordinates, q, y, attitudes)
        solve_tree(tree, work, coordinates, 0.0, q, y)
        for i in range(n):
            if m == n:
                mass[i, 0] = coordinates[i]["drive"]
            else:
                mass[i, m] = coordinates[i]["drive"] - mass[i, 0]
    _respect_assumptions(tree, mass)


@kernel
def _respect_assumptions(tree, mass):
    n = mass.shape[0]
    for i in range(n):
        for j in range(n):
            if tree.given[i] or tree.given[j]:
                mass[i, j] = 1.0 if i == j else 0.0
            elif tree.one_way and tree.elastic[j] and not tree.elastic[i]:
                mass[i, j] = 0.0


@kernel
def set_stiffness(tree, work, K):
    """Fill K (NS, NS) for placed frames."""
    for i in range(K.shape[0]):
        for j in range(K.shape[0]):
            K[i, j] = 0.0
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        _add_block(1.0, tree.stiffness, body["stiffness"], body, K)
        if body["stiffening"] >= 0:
            turning, weight = pulls(tree, work, body)
            _add_block(turning, tree.stiffening, body["stiffening"], body, K)
            _add_block(weight, tree.stiffening, body["stiffening"] + body["count"] ** 2, body, K)
    for i in range(tree.springs.shape[0]):
        m = tree.springs[i]["coordinate"]
        if not tree.given[m]:
            K[m, m] += tree.springs[i]["stiffness"]


@kernel
def add_damping(tree, factor, A):
    """A += factor D; A (NS, NS)."""
    for b in range(tree.elastic_bodies.shape[0]):
        body = tree.elastic_bodies[b]
        if body["damping"] >= 0:
            _add_block(factor, tree.damping, body["damping"], body, A)
    for i in range(tree.springs.shape[0]):
        m = tree.springs[i]["coordinate"]
        if not tree.given[m]:
            A[m, m] += factor * tree.springs[i]["damping"]


@kernel
def _add_block(factor, matrices, start, body, A):
    first, count = body["first"], body["count"]
    for i in range(count):
        for j in range(count):
            A[first + i, first + j] += factor * matrices[start + i * count + j]


@kernel
def set_matrix_times(A, x, out):
    """out = A x, (NS, NS) by (NS,)."""
    n = out.shape[0]
    for i in range(n):
        out[i] = row_times(A[i], x, n)
