"""The screw joint's fifth equation: slide less pitch times turn.

Liang Yong (1996), section 4.2.6 and Appendix A, DO_SCREW1.  The pages with the end of DO_SCREW1 and
DO_SCREW2 are lost: the factor 2 and the columns at sin θ = 0 follow from the velocities of OUT2-6-1, the
second derivative from its accelerations.
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.vectors import cross, unit
from .equations import Rows, State, scalar_product, separation, separation_rate
from .errors import SCREW
from .vectors import dot, product

if TYPE_CHECKING:
    from ...model.mechanism import Joint


PI = 3.14159  # as the program has it


@dataclass
class ScrewZero:
    """Slide and turn of the estimates, from which both are counted, and the last turn."""

    slide: float
    turn: float
    sense: float = 1.0
    last: float = 0.0


def screw_zero(state: State, joint: "Joint") -> ScrewZero:
    """Return what the program keeps of its first evaluation."""
    if SCREW in state.errors:
        joint = _as_read(joint)
        cosine, product_of_z = _cosine(state, joint)
        return ScrewZero(_length(separation(state, joint)), _turn(cosine, product_of_z, reduced=False))
    slide, (x, y) = _slide(state, joint), _components(state, joint)
    sense, turn = -1.0 if slide.residual[0] < 0.0 else 1.0, math.atan2(y.residual[0], x.residual[0])
    return ScrewZero(sense * slide.residual[0], turn, sense, turn)


def screw_row(state: State, joint: "Joint", zero: ScrewZero) -> Rows:
    """δ - δ0 - α (θ - θ0) = 0."""
    if SCREW in state.errors:
        return _printed_row(state, _as_read(joint), zero)
    return _row(replace(state, errors=frozenset()), joint, zero)


def _as_read(joint: "Joint") -> "Joint":
    """The program does not subtract P from Q and H."""
    pairs = {"s_i": joint.P_i, "s_j": joint.P_j, "h_i": joint.P_i, "h_j": joint.P_j}
    return replace(joint, **{name: np.add(getattr(joint, name), P) for name, P in pairs.items()})


def _cosine(state: State, joint: "Joint") -> tuple[float, float]:
    a, b = state.vector(joint.i, joint.h_i), state.vector(joint.j, joint.h_j)
    return dot(a, b), a[2] * b[2]


def _length(d: np.ndarray) -> float:
    return math.sqrt(dot(d, d))


def _turn(cosine: float, product_of_z: float, reduced: bool = True) -> float:
    """The angle by the arc tangent, whose second quadrant comes out as π + |.| for π - |.|."""
    if cosine == 0.0:
        return PI * (1.5 if product_of_z < 0.0 else 0.5)
    if abs(cosine) > 1.0:
        return 0.0 if cosine > 0.0 else 3.1415926
    turn = math.atan(math.sqrt(1.0 - cosine * cosine) / cosine)
    return abs(turn) + PI if turn < 0.0 and reduced else turn


def _printed_row(state: State, joint: "Joint", zero: ScrewZero) -> Rows:
    i, j, pitch = joint.i, joint.j, joint.pitch
    d, (cosine, product_of_z) = separation(state, joint), _cosine(state, joint)
    slide = _length(d)
    direction = d / slide if slide > 0.0 else d
    residual = slide - zero.slide - pitch * (_turn(cosine, product_of_z) - zero.turn)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    turning = _turning_columns(state, joint, sine)
    of_i, of_j = np.zeros((1, 7)), np.zeros((1, 7))
    for columns, body, P, sign in ((of_i, i, joint.P_i, -1.0), (of_j, j, joint.P_j, 1.0)):
        columns[0, :3] = sign * direction
        columns[0, 3:] = sign * product(direction[None, :], state.slope(body, P))[0]
    of_i[0, 3:] += turning[0]
    of_j[0, 3:] += turning[1]
    speed = state.omega(j) - state.omega(i)
    square = dot(speed, speed) * cosine
    gamma = (1.5 * slide - (0.5 * pitch if sine == 0.0 else 0.0)) * square
    return Rows(np.array([residual]), of_i, of_j, np.array([gamma]))


def _turning_columns(state: State, joint: "Joint", sine: float) -> tuple[np.ndarray, np.ndarray]:
    """-α ∂θ/∂p of bodies i and j: by the cosine and twice too large, by the sine where that is 0."""
    i, j, pitch = joint.i, joint.j, joint.pitch
    slope_i, slope_j = state.slope(i, joint.h_i), state.slope(j, joint.h_j)
    a, b = state.vector(i, joint.h_i), state.vector(j, joint.h_j)
    if sine > 0.0:
        factor = 2.0 * pitch / sine
        return factor * product(b[None, :], slope_i)[0], factor * product(a[None, :], slope_j)[0]
    axis = state.vector(i, unit(joint.s_i))
    across_i, across_j = cross(axis, a), cross(axis, b)
    return pitch * product(across_j[None, :], slope_i)[0], -pitch * product(across_i[None, :], slope_j)[0]


def _row(state: State, joint: "Joint", zero: ScrewZero) -> Rows:
    """The equation as it should be: the turn by both components, the slide with its sign."""
    slide, (x, y) = _slide(state, joint), _components(state, joint)
    pitch = joint.pitch
    turn = math.atan2(y.residual[0], x.residual[0])
    turn += 2.0 * math.pi * round((zero.last - turn) / (2.0 * math.pi))
    zero.last = turn
    square = x.residual[0] ** 2 + y.residual[0] ** 2
    a, b = -y.residual[0] / square, x.residual[0] / square
    xd, yd = (_rate(state, joint, part) for part in (x, y))
    turning = x.residual[0] * yd - y.residual[0] * xd
    growth = 2.0 * (x.residual[0] * xd + y.residual[0] * yd) * turning / square**2
    gap = zero.sense * slide.residual[0] - zero.slide - pitch * (turn - zero.turn)
    return Rows(
        np.array([gap]),
        zero.sense * slide.of_i - pitch * (a * x.of_i + b * y.of_i),
        zero.sense * slide.of_j - pitch * (a * x.of_j + b * y.of_j),
        zero.sense * slide.gamma - pitch * (a * x.gamma + b * y.gamma + growth),
    )


def _rate(state: State, joint: "Joint", rows: Rows) -> float:
    """The first derivative of a scalar."""
    return float(product(rows.of_i, state.qd[joint.i])[0] + product(rows.of_j, state.qd[joint.j])[0])


def _across(joint: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """û, and the unit vectors f and g across it fixed to body i: f along h_i, g = û × f."""
    axis = unit(joint.s_i)
    f = unit(np.array(joint.h_i) - dot(joint.h_i, axis) * axis)
    return axis, f, cross(axis, f)


def _components(state: State, joint: "Joint") -> tuple[Any, ...]:
    """f · h_j and g · h_j, cosine and sine of the turn."""
    _, f, g = _across(joint)
    h = unit(joint.h_j)
    return tuple(scalar_product(state, joint.i, joint.j, u, h) for u in (f, g))


def _slide(state: State, joint: "Joint") -> Rows:
    """û · d."""
    i, j, axis = joint.i, joint.j, _across(joint)[0]
    u, d = state.vector(i, axis), separation(state, joint)
    of_i, of_j = np.zeros((1, 7)), np.zeros((1, 7))
    of_i[0, :3], of_j[0, :3] = -u, u
    of_i[0, 3:] = (
        product(d[None, :], state.slope(i, axis))[0] - product(u[None, :], state.slope(i, joint.P_i))[0]
    )
    of_j[0, 3:] = product(u[None, :], state.slope(j, joint.P_j))[0]
    gamma = dot(u, state.remainder(i, joint.P_i) - state.remainder(j, joint.P_j))
    gamma -= dot(d, state.remainder(i, axis)) + 2.0 * dot(state.rate(i, axis), separation_rate(state, joint))
    return Rows(np.array([dot(u, d)]), of_i, of_j, np.array([gamma]))
