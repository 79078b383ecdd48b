"""A double pendulum of two rods in flexmb, and in plain compiled code: Dormand and Prince of orders 5(4)."""

import numba
import numpy as np
from scipy.integrate import RK45

from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import Body, Hinge, Integration, Tree

GRAVITY, END, ROWS = 9.81, 100.0, 1001
START = np.array([0.9, 0.3, 0.0, 0.0])  # angles from the vertical, rad, of the second against the first
A, B, E, P, C = RK45.A, RK45.B, RK45.E, RK45.P, RK45.C


def pendulum_of_flexmb(tolerance):
    """The tree: rods of 1 m and 1 kg, hanging along -y, that turn about z."""
    inertia = np.diag([1.0 / 3.0, 0.0, 1.0 / 3.0])
    bodies = tuple(Body(f"rod {k}", 1.0, inertia, (0.0, -0.5, 0.0)) for k in (1, 2))
    hinges = Hinge(-1, rotations=(3,)), Hinge(0, (0.0, -1.0, 0.0), rotations=(3,))
    grid = TimeGrid(0.0, END, END / (ROWS - 1))
    steps = Integration("dop853", tolerance, tolerance)
    return Tree(
        bodies, hinges, START[:2].copy(), START[2:].copy(), grid, (0.0, -GRAVITY, 0.0), integration=steps
    )


@numba.njit(error_model="numpy")
def slope(z, out):
    """Lagrange's equations of two rods of length and mass one."""
    first, second, u, v = z[0], z[0] + z[1], z[2], z[2] + z[3]
    c, s = 0.5 * np.cos(second - first), 0.5 * np.sin(second - first)
    a = s * v * v - 1.5 * GRAVITY * np.sin(first)
    b = -s * u * u - 0.5 * GRAVITY * np.sin(second)
    det = 4.0 / 9.0 - c * c
    ud = (a / 3.0 - c * b) / det
    out[0], out[1], out[2], out[3] = z[2], z[3], ud, (4.0 / 3.0 * b - c * a) / det - ud


@numba.njit(error_model="numpy")
def plain_rows(tolerance, start, times):
    """Rows (times, 4) by steps whose errors of order 4 are within the tolerance, relative and absolute."""
    rows, z, new, K = np.zeros((times.size, 4)), start.copy(), start.copy(), np.zeros((7, 4))
    rows[0], row, t, h = z, 1, 0.0, 1e-3
    slope(z, K[0])
    while row < times.size:
        for stage in range(1, 7):
            for i in range(4):
                total = 0.0
                for j in range(stage):
                    total += (A[stage, j] if stage < 6 else B[j]) * K[j, i]
                new[i] = z[i] + h * total
            slope(new, K[stage])
        error = 0.0
        for i in range(4):
            total = 0.0
            for j in range(7):
                total += E[j] * K[j, i]
            error += (h * total / (tolerance * (1.0 + max(abs(z[i]), abs(new[i]))))) ** 2 / 4.0
        if error <= 1.0:
            while row < times.size and times[row] <= t + h:
                x = (times[row] - t) / h
                for i in range(4):
                    total = 0.0
                    for j in range(7):
                        total += K[j, i] * x * (P[j, 0] + x * (P[j, 1] + x * (P[j, 2] + x * P[j, 3])))
                    rows[row, i] = z[i] + h * total
                row += 1
            t += h
            z[:], K[0] = new, K[6]
        h *= min(10.0, max(0.2, 0.9 * max(error, 1e-20) ** -0.1))
    return rows
