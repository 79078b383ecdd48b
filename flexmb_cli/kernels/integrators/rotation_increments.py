"""Rotations of bodies in a step, as rotation vectors in body axes from where it starts.

A steady turn has no error, however long the step is: without a bound steps would reach over several turns,
of which report rows between the ends know nothing.
"""

import math

import numpy as np

from .._jit import kernel
from ..linalg.vec3 import cross

SMALL_TURN = 1e-2  # rad, below which the series is exact
LONGEST_TURN = 1.0  # rad, of a body in a step whose length is chosen
FAR_TURN = 3.0  # rad, beyond which the rate of a rotation vector, singular at 2π, is not used


@kernel
def set_slope(bodies: int, shift: np.ndarray, u: np.ndarray, slope: np.ndarray) -> None:
    """The rates of a shift (n,), displacements and rotation vectors, where the speeds are u."""
    for k in range(u.shape[0]):
        slope[k] = u[k]
    for body in range(bodies):
        k = 6 * body + 3
        turn, w = (shift[k], shift[k + 1], shift[k + 2]), (u[k], u[k + 1], u[k + 2])
        square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
        share = 1.0 / 12.0 + square / 720.0
        if square > SMALL_TURN * SMALL_TURN:
            angle = math.sqrt(square)
            share = 1.0 / square - 0.5 / (angle * math.tan(0.5 * angle))
        once = cross(turn, w)
        twice = cross(turn, once)
        for i in range(3):
            slope[k + i] += 0.5 * once[i] + share * twice[i]


@kernel
def largest_turn(bodies: int, turn: np.ndarray) -> float:
    """Length of the largest rotation vector in turn (n,): a shift in rad, or speeds in rad/s."""
    largest = 0.0
    for body in range(bodies):
        k = 6 * body + 3
        largest = max(largest, turn[k] ** 2 + turn[k + 1] ** 2 + turn[k + 2] ** 2)
    return largest**0.5


@kernel
def shift_between(bodies: int, old: np.ndarray, new: np.ndarray, mean: np.ndarray, shift: np.ndarray) -> None:
    """Fill shift (n,) with what brings the position old to new, turns near to the given mean (n,)."""
    for body in range(bodies):
        k, s = 7 * body, 6 * body
        for i in range(3):
            shift[s + i] = new[k + i] - old[k + i]
        a0, a = old[k + 3], (old[k + 4], old[k + 5], old[k + 6])
        b0, b = new[k + 3], (new[k + 4], new[k + 5], new[k + 6])
        across = cross(a, b)
        axis = (
            a0 * b[0] - b0 * a[0] - across[0],
            a0 * b[1] - b0 * a[1] - across[1],
            a0 * b[2] - b0 * a[2] - across[2],
        )
        size = (axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2) ** 0.5
        angle = 2.0 * math.atan2(size, a0 * b0 + a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
        if size < 1e-12:
            # Whole turns have no axis of their own.
            axis = (mean[s + 3], mean[s + 4], mean[s + 5])
            size = (axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2) ** 0.5
        share = 0.0
        if size > 0.0:
            along = (axis[0] * mean[s + 3] + axis[1] * mean[s + 4] + axis[2] * mean[s + 5]) / size
            share = (angle + 2.0 * math.pi * round((along - angle) / (2.0 * math.pi))) / size
        for i in range(3):
            shift[s + 3 + i] = share * axis[i]
    for k in range(6 * bodies, shift.shape[0]):
        shift[k] = new[k + bodies] - old[k + bodies]
