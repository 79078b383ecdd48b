"""Mass matrix and gyroscopic forces of rigid bodies in the speeds (ṙ, ω), ω in body axes.

VSDFlex paper (2008), equations (55) and (75)-(77) for a rigid body, in body axes:

    M = [ m E        -A s~ ]      f = [ -A ω~ ω~ s ]      s = m c, J about the origin
        [ (-A s~)ᵀ     J   ]          [  -ω~ J ω   ]

M is kept body by body: matrix (bodies, 6, 6).
"""

from ._jit import kernel


@kernel
def mass_matrices(masses, A, matrix):
    """Fill matrix (bodies, 6, 6); A (bodies, 3, 3)."""
    for b in range(masses.shape[0]):
        s, block, axes = masses[b]["moment"], matrix[b], A[b]
        for i in range(3):
            for j in range(3):
                block[i, j] = masses[b]["mass"] if i == j else 0.0
                block[3 + i, 3 + j] = masses[b]["inertia"][i, j]
            # -A s~, row i
            block[i, 3] = axes[i, 2] * s[1] - axes[i, 1] * s[2]
            block[i, 4] = axes[i, 0] * s[2] - axes[i, 2] * s[0]
            block[i, 5] = axes[i, 1] * s[0] - axes[i, 0] * s[1]
            for j in range(3, 6):
                block[j, i] = block[i, j]


@kernel
def mass_times(matrix, x, y):
    """y = M x for x, y (6 bodies,)."""
    for b in range(matrix.shape[0]):
        for i in range(6):
            total = 0.0
            for j in range(6):
                total += matrix[b, i, j] * x[6 * b + j]
            y[6 * b + i] = total


@kernel
def gyroscopic_forces(masses, A, u, f):
    """Fill f (6 bodies,) with the quadratic velocity forces."""
    for b in range(masses.shape[0]):
        k = 6 * b
        s, J, axes = masses[b]["moment"], masses[b]["inertia"], A[b]
        w0, w1, w2 = u[k + 3], u[k + 4], u[k + 5]
        along = w0 * s[0] + w1 * s[1] + w2 * s[2]
        square = w0 * w0 + w1 * w1 + w2 * w2
        # -ω × (ω × s)
        c0, c1, c2 = square * s[0] - along * w0, square * s[1] - along * w1, square * s[2] - along * w2
        for i in range(3):
            f[k + i] = axes[i, 0] * c0 + axes[i, 1] * c1 + axes[i, 2] * c2
        h0 = J[0, 0] * w0 + J[0, 1] * w1 + J[0, 2] * w2
        h1 = J[1, 0] * w0 + J[1, 1] * w1 + J[1, 2] * w2
        h2 = J[2, 0] * w0 + J[2, 1] * w1 + J[2, 2] * w2
        f[k + 3] = h1 * w2 - h2 * w1
        f[k + 4] = h2 * w0 - h0 * w2
        f[k + 5] = h0 * w1 - h1 * w0


@kernel
def kinetic_energy(matrix, u):
    """½ uᵀ M u, J."""
    total = 0.0
    for b in range(matrix.shape[0]):
        for i in range(6):
            for j in range(6):
                total += 0.5 * u[6 * b + i] * matrix[b, i, j] * u[6 * b + j]
    return total
