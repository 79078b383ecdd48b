"""A point on a curve in the axes of a body: the parameter of the nearest place, and the curve's normals.

The curve is c(s) = (f(s), g(s), h(s)) of three functions with consecutive numbers.  The parameter of a point
p near it is the root of c' · (p - c); p lies on the curve where (p - c) · n is 0 for both normals n.  There,
d/dt of these products is n · v, and the second derivative n · a - n · c'' (ds/dt)², v and a being velocity
and acceleration of the point against the curve's body, since from n · c' = 0 follows n' · c' = -n · c''.
"""

import math

import numpy as np

from ._jit import kernel
from .constrained.time_functions import function_values
from .linalg.vec3 import cross, dot, minus, scaled

ROUNDED_BITS = 26  # of a parameter
LAST_CORRECTIONS = 2  # from there to round-off
MOST_CORRECTIONS = 30  # of a parameter by Newton's method
CORRECTED = 1e-10  # share of the parameter: the correction that follows one so small is round-off


@kernel
def curve_values(
    functions: np.ndarray, knots: np.ndarray, first: int, s: float
) -> tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]:
    """Point c(s) of the curve whose first function is number `first`, c' and c''."""
    x, y, z = (
        function_values(functions, knots, first, s),
        function_values(functions, knots, first + 1, s),
        function_values(functions, knots, first + 2, s),
    )
    return (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])


@kernel
def nearest_parameter(
    functions: np.ndarray, knots: np.ndarray, first: int, p: tuple[float, float, float], s: float
) -> float:
    """Parameter of the place nearest to p, axes of the curve's body, m, in the neighbourhood of s.

    The last corrections begin at a rounded parameter: the same for all s from which it is reached, so that
    a resumed run has the same bytes.
    """
    before = math.inf
    for _ in range(MOST_CORRECTIONS):
        step = _correction(functions, knots, first, p, s)
        s += step
        if abs(step) <= CORRECTED * abs(s) or (abs(step) >= before and before <= CORRECTED):
            break
        before = abs(step)
    d = curve_values(functions, knots, first, s)[1]
    size = abs(s) + math.sqrt(dot(p, p) / dot(d, d))
    if 0.0 < size < math.inf:
        grid = 2.0 ** (np.floor(math.log(size) / math.log(2.0)) - ROUNDED_BITS)
        s = grid * np.floor(s / grid + 0.5)
    for _ in range(LAST_CORRECTIONS):
        s += _correction(functions, knots, first, p, s)
    return s


@kernel
def _correction(
    functions: np.ndarray, knots: np.ndarray, first: int, p: tuple[float, float, float], s: float
) -> float:
    """Step of Newton's method from s to the nearest place."""
    c, d, b = curve_values(functions, knots, first, s)
    return dot(d, minus(p, c)) / stretch(d, b, minus(p, c))


@kernel
def stretch(
    d: tuple[float, float, float], b: tuple[float, float, float], apart: tuple[float, float, float]
) -> float:
    """c' · c' less c'' · (p - c): what c' · v is divided by for the rate of the parameter."""
    square = dot(d, d)
    size = square - dot(b, apart)
    return size if size > 0.1 * square else square


@kernel
def normal(
    d: tuple[float, float, float], across: tuple[float, float, float], second: int
) -> tuple[float, float, float]:
    """First or second unit normal of a curve with the tangent d; `across` is not parallel to it."""
    n = cross(across, d)
    n = scaled(1.0 / math.sqrt(dot(n, n)), n)
    if second == 0:
        return n
    return scaled(1.0 / math.sqrt(dot(d, d)), cross(d, n))
