"""The motion of a tree as a first-order system z' = f(t, z): DAFMS thesis (1992), eqs. (2.23) and (3.16).

z holds the NS speeds, the NS coordinates, four Euler parameters for each hinge with three rotations, the
states of signals, the works of E elements, and last the work that has been applied; errors of works do not
count.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from .._jit import allocating, kernel, plain
from ..laws import COORDINATE
from ..linalg.number_rows import block
from ..linalg.vec3 import cross, plus, scaled, store, triple
from ..signals import give_rates, take_states
from .elements import element_powers
from .energy import applied_power
from .kane import SOLVED, accelerations
from .kinematics import attitude_rates
from .loads import set_prescribed

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays


@plain
def parts(tree: "TreeArrays", z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Views of z: speeds, coordinates, Euler parameters (balls, 4)."""
    n = tree.given.shape[0]
    return z[:n], z[n : 2 * n], block(z, 2 * n, (tree.balls, 4))


@kernel
def derivative(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, t: float, z: np.ndarray, dz: np.ndarray
) -> int:
    """Fill dz, not numbers where an element has no force; puts prescribed coordinates in their place in z.

    Returns as `accelerations`.
    """
    # A trial state after one where an element has no force.
    if tree.answers.shape[0] > 0 and not _is_finite(z):
        dz.fill(math.nan)
        for i in range(tree.answers.shape[0]):
            tree.answers[i, COORDINATE] = math.nan
        return SOLVED
    y, q, attitudes = parts(tree, z)
    yd, qd, rates = parts(tree, dz)
    set_prescribed(tree, t, q, y, coordinates)
    states = 2 * y.shape[0] + 4 * tree.balls
    take_states(tree.signals, z, states)
    fault = accelerations(tree, work, coordinates, t, q, y, attitudes)
    if fault != SOLVED:
        return fault
    give_rates(tree.signals, dz, states)
    for m in range(y.shape[0]):
        yd[m] = coordinates[m]["rate"]
        qd[m] = y[m]
    turn_attitudes(tree, y, attitudes, rates)
    last = dz.shape[0] - 1
    powers = element_powers(tree, last - tree.answers.shape[0], dz)
    dz[last] = powers + applied_power(tree, work, coordinates, q, y)
    return SOLVED


@allocating
def derivative_in_body_axes(
    tree: "TreeArrays", work: np.ndarray, coordinates: np.ndarray, t: float, z: np.ndarray, dz: np.ndarray
) -> int:
    """Fill dz as `derivative`, where speeds of three free rotations in z are in axes of their body O_k.

    In these axes errors of the attitude do not change the kinetic energy: they do not act on the speeds of a
    body that turns freely (Euler's equations), whose steps then err a thousandth as much.
    """
    if tree.balls == 0:
        return derivative(tree, work, coordinates, t, z, dz)
    speeds = z[: tree.given.shape[0]].copy()
    turn_speeds(tree, coordinates, z, 1.0, z)
    fault = derivative(tree, work, coordinates, t, z, dz)
    turn_speeds(tree, coordinates, z, -1.0, dz)
    for m in range(speeds.shape[0]):
        if coordinates[m]["held"] == 0:
            z[m] = speeds[m]
    return fault


@kernel
def turn_speeds(
    tree: "TreeArrays", coordinates: np.ndarray, z: np.ndarray, sense: float, values: np.ndarray
) -> None:
    """Turn speeds of three free rotations, or their rates, at the head of values (n,) by the attitudes of z.

    From axes of O_k to those of P_k, or with the sense -1 back.  Hinges with a held rotation keep theirs.
    """
    _y, _q, attitudes = parts(tree, z)
    for k in range(1, tree.frames.shape[0]):
        ball, first = tree.frames[k]["ball"], tree.frames[k]["first_rotation"]
        if (
            ball < 0
            or coordinates[first]["held"] + coordinates[first + 1]["held"] + coordinates[first + 2]["held"]
            > 0
        ):
            continue
        v, e = triple(values, first), triple(attitudes[ball], 1)
        across = cross(e, v)
        turn = plus(scaled(sense * attitudes[ball, 0], across), cross(e, across))
        square = attitudes[ball, 0] ** 2 + e[0] ** 2 + e[1] ** 2 + e[2] ** 2
        store(plus(v, scaled(2.0 / square, turn)), values, first)


@kernel
def _is_finite(z: np.ndarray) -> bool:
    total = 0.0
    for i in range(z.shape[0]):
        total += 0.0 * z[i]
    return total == 0.0


@kernel
def turn_attitudes(tree: "TreeArrays", y: np.ndarray, attitudes: np.ndarray, rates: np.ndarray) -> None:
    """Fill the rates (balls, 4) of Euler parameters for the speeds y."""
    for k in range(1, tree.frames.shape[0]):
        if tree.frames[k]["ball"] >= 0:
            attitude_rates(tree.frames[k], y, attitudes, rates)


@kernel
def normalise_attitudes(tree: "TreeArrays", z: np.ndarray) -> None:
    """Bring all Euler parameters back to length one."""
    _y, _q, attitudes = parts(tree, z)
    for b in range(attitudes.shape[0]):
        square = 0.0
        for i in range(4):
            square += attitudes[b, i] ** 2
        for i in range(4):
            attitudes[b, i] /= square**0.5
