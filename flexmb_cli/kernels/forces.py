"""Applied forces on the speeds (ṙ, ω): gravity, forces, torques, springs and dampers; their work.

VSDFlex paper (2008), equations (66)-(73) for rigid bodies: a force F at the body point P adds F and
P × Aᵀ F.  `loads` are records of `model.dynamic_arrays.LOAD`.
"""

import math

from ._jit import kernel
from .rotation import rotate

# The codes of model.dynamic_arrays; a test compares them.
FORCE, TORQUE, LINE = 1, 2, 3
AT_REST = 1e-300


@kernel
def add_applied_forces(system, q, u, A, t, f):
    """Add all applied forces to f (6 bodies,).

    Returns the power of those that store no energy: forces, torques and dampers.
    """
    _add_gravity(system.masses, system.gravity, A, f)
    power = 0.0
    for k in range(system.loads.shape[0]):
        load = system.loads[k]
        if load["kind"] == LINE:
            power += _add_line(load, q, u, A, f)
        else:
            factor = table_value(system.tables, system.table_ends, load["table"], t)
            power += _add_vector(load, factor, u, A, f)
    return power


@kernel
def _add_gravity(masses, g, A, f):
    for b in range(masses.shape[0]):
        add_force(b, masses[b]["moment"], (g[0], g[1], g[2]), A, 1.0, masses[b]["mass"], f)


@kernel
def add_force(b, P, F, A, arm, factor, f):
    """Add factor F (global axes) and arm times its moment P × Aᵀ F about the body's origin to f."""
    k = 6 * b
    axes = A[b]
    for i in range(3):
        f[k + i] += factor * F[i]
    F0 = axes[0, 0] * F[0] + axes[1, 0] * F[1] + axes[2, 0] * F[2]
    F1 = axes[0, 1] * F[0] + axes[1, 1] * F[1] + axes[2, 1] * F[2]
    F2 = axes[0, 2] * F[0] + axes[1, 2] * F[1] + axes[2, 2] * F[2]
    f[k + 3] += arm * (P[1] * F2 - P[2] * F1)
    f[k + 4] += arm * (P[2] * F0 - P[0] * F2)
    f[k + 5] += arm * (P[0] * F1 - P[1] * F0)


@kernel
def table_value(tables, ends, table, t):
    """Factor of a load at time t: 1 without a table, else the cubic through its knots."""
    if table < 0:
        return 1.0
    first, last = ends[table], ends[table + 1] - 1
    if t <= tables[first, 0]:
        return tables[first, 1]
    if t >= tables[last, 0]:
        return tables[last, 1]
    while last - first > 1:
        middle = (first + last) // 2
        if tables[middle, 0] <= t:
            first = middle
        else:
            last = middle
    h = tables[last, 0] - tables[first, 0]
    b = (t - tables[first, 0]) / h
    a = 1.0 - b
    bend = (a * a * a - a) * tables[first, 2] + (b * b * b - b) * tables[last, 2]
    return a * tables[first, 1] + b * tables[last, 1] + bend * h * h / 6.0


@kernel
def _add_vector(load, factor, u, A, f):
    b, v = load["body_i"], load["vector"]
    F = rotate(A, b, v) if load["following"] else (v[0], v[1], v[2])
    if load["kind"] == FORCE:
        add_force(b, load["P_i"], F, A, factor, factor, f)
        w = point_velocity(b, load["P_i"], u, A)
        return factor * (F[0] * w[0] + F[1] * w[1] + F[2] * w[2])
    power = 0.0
    for i in range(3):
        torque = factor * (A[b, 0, i] * F[0] + A[b, 1, i] * F[1] + A[b, 2, i] * F[2])
        f[6 * b + 3 + i] += torque
        power += torque * u[6 * b + 3 + i]
    return power


@kernel
def point_velocity(b, P, u, A):
    """Velocity of the point P of body b, global axes."""
    k = 6 * b
    w0, w1, w2 = u[k + 3], u[k + 4], u[k + 5]
    turned = rotate(A, b, (w1 * P[2] - w2 * P[1], w2 * P[0] - w0 * P[2], w0 * P[1] - w1 * P[0]))
    return u[k] + turned[0], u[k + 1] + turned[1], u[k + 2] + turned[2]


@kernel
def line_vector(load, q, A):
    """Vector from P_i to P_j, global axes, and its length, m."""
    i, j = load["body_i"], load["body_j"]
    a, b = rotate(A, i, load["P_i"]), rotate(A, j, load["P_j"])
    d = (
        q[7 * j] + b[0] - q[7 * i] - a[0],
        q[7 * j + 1] + b[1] - q[7 * i + 1] - a[1],
        q[7 * j + 2] + b[2] - q[7 * i + 2] - a[2],
    )
    return d, math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])


@kernel
def _add_line(load, q, u, A, f):
    """Spring and damper in line; returns the power of the damper.

    Ends that coincide leave the direction open: no force acts then.
    """
    i, j = load["body_i"], load["body_j"]
    d, length = line_vector(load, q, A)
    if length < AT_REST:
        return 0.0
    v_i, v_j = point_velocity(i, load["P_i"], u, A), point_velocity(j, load["P_j"], u, A)
    rate = (d[0] * (v_j[0] - v_i[0]) + d[1] * (v_j[1] - v_i[1]) + d[2] * (v_j[2] - v_i[2])) / length
    pull = load["stiffness"] * (length - load["free_length"]) + load["damping"] * rate
    F = (d[0] / length, d[1] / length, d[2] / length)
    add_force(i, load["P_i"], F, A, pull, pull, f)
    add_force(j, load["P_j"], F, A, -pull, -pull, f)
    return -load["damping"] * rate * rate


@kernel
def potential_energy(system, q, A):
    """Energy of gravity and of springs, J."""
    total = 0.0
    for b in range(system.masses.shape[0]):
        arm = rotate(A, b, system.masses[b]["moment"])
        for i in range(3):
            total -= system.gravity[i] * (system.masses[b]["mass"] * q[7 * b + i] + arm[i])
    for k in range(system.loads.shape[0]):
        load = system.loads[k]
        if load["kind"] == LINE:
            stretch = line_vector(load, q, A)[1] - load["free_length"]
            total += 0.5 * load["stiffness"] * stretch * stretch
    return total
