"""Laws of elements: the effort along a coordinate x with the rate v, by whichever formulation x was measured.

A law answers effort and the part of it that has a potential, and fills -dF/dx, -dF/dv and the stored energy.
`law` is any record with the fields of `model.arrays.records.LAW`: a LOAD, or a TREE_ELEMENT.
Friction: Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 (1994), section 3.1, made smooth by
tanh.  Stops and cables: Hunt and Crossley, Journal of Applied Mechanics 42 (1975), pages 440-445, exponent 1.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from ._jit import kernel, plain
from .bristles import answer_bristles, stribeck_friction
from .constrained.time_functions import function_values

if TYPE_CHECKING:
    from ..model.arrays.signals import Signals

# The codes of model.laws; a test compares them.
SPRING, CABLE, MOTOR, STOP = 1, 2, 3, 4
# Numbers of friction: coefficients, speeds in m/s, radius in m, normal force besides that of the joint in N.
DYNAMIC, STATIC, STRIBECK, CREEP, RADIUS, NORMAL_PRELOAD = 0, 1, 2, 3, 4, 5
BRISTLE, BRISTLE_DAMPING = 6, 7  # stiffness, 1/m, and damping, s/m, of bristles
# Columns of the answers.
COORDINATE, SPEED, EFFORT, POWER, STIFFNESS, DAMPING, NORMAL, ENERGY = 0, 1, 2, 3, 4, 5, 6, 7
ANSWER_COLUMNS = 8
SMALL = 1e-6  # of the creep speed: tanh(x)/x is 1 there
NO_LENGTH = 1e-300  # m, and m² of its square: a line that short has no direction


@plain
def answer_law(
    law: np.void, functions: np.ndarray, knots: np.ndarray, t: float, directed: bool, answer: np.ndarray
) -> float:
    """Effort at the coordinate and speed in `answer` (8,), whose other columns are filled.

    An element without direction acts with no force; its energy counts.
    """
    effort, stored = _effort(law, functions, knots, t, answer)
    if not directed:
        effort = stored = 0.0
    answer[EFFORT], answer[POWER] = effort, (effort - stored) * answer[SPEED]
    return effort


@kernel
def _effort(
    law: np.void, functions: np.ndarray, knots: np.ndarray, t: float, answer: np.ndarray
) -> tuple[float, float]:
    """Effort along the coordinate, and the part of it that has a potential; fills slopes and energy."""
    x, v, c, f = answer[COORDINATE], answer[SPEED], law["c"], law["f"]
    if law["shape"] == STOP:
        lower, upper, k, b = c[0], c[1], c[2], c[3]
        if x > upper:
            return _pushed_back(k, b, x - upper, v, -1.0, answer)
        if x < lower:
            return _pushed_back(k, b, lower - x, -v, 1.0, answer)
        return _pushed_back(k, b, 0.0, 0.0, 1.0, answer)
    if law["shape"] == MOTOR:
        answer[STIFFNESS], answer[DAMPING], answer[ENERGY] = 0.0, 0.0, 0.0
        return c[0] + function_values(functions, knots, f[0], t)[0], 0.0
    if law["shape"] == CABLE:
        return _pushed_back(c[0], c[2], max(x - c[1], 0.0), v, -1.0, answer)
    if law["shape"] != SPRING:
        return math.nan, math.nan
    k, s, b, preload = c[0], x - c[1], c[2], c[3]
    stored, lost = preload + k * s, b * v
    answer[STIFFNESS], answer[DAMPING] = k, b
    answer[ENERGY] = (preload + 0.5 * k * s) * s
    curve, energy, damper = f[0], f[1], f[2]
    if curve >= 0:
        force, slope, _ = function_values(functions, knots, curve, s)
        answer[STIFFNESS] += slope
        if energy >= 0:
            stored += force
            answer[ENERGY] += function_values(functions, knots, energy, s)[0]
        else:
            lost += force
    if damper >= 0:
        force, slope, _ = function_values(functions, knots, damper, v)
        lost += force
        answer[DAMPING] += slope
    return -stored - lost, -stored


@kernel
def _pushed_back(k: float, b: float, depth: float, approach: float, sign: float, answer: np.ndarray):
    """A stop at a depth that grows at `approach`: effort, its part with a potential; fills slopes."""
    share = max(0.0, 1.0 + b * approach)
    answer[STIFFNESS] = k * share if depth > 0.0 else 0.0
    answer[DAMPING] = k * depth * b if share > 0.0 else 0.0
    answer[ENERGY] = 0.5 * k * depth * depth
    return sign * k * depth * share, sign * k * depth


@kernel
def answer_unit_friction(
    law: np.void, signals: "Signals", turning: float, sliding: float, both: bool, answer: np.ndarray
) -> tuple[float, float]:
    """Answer for friction by the normal force 1 N at two sliding speeds, m/s; returns forces along them."""
    v = math.sqrt(turning * turning + sliding * sliding)
    if law["bristle"] >= 0:
        return _answer_unit_bristles(law, signals, turning, sliding, v if both else 0.0, answer)
    share, slope = friction_share(law, v)
    signed = v if both else turning + sliding
    answer[COORDINATE], answer[SPEED], answer[EFFORT] = 0.0, signed, -share * signed
    answer[POWER], answer[DAMPING], answer[NORMAL] = -share * v * v, max(slope, 0.0), 1.0
    answer[STIFFNESS] = 0.0
    return -share * turning, -share * sliding


@kernel
def _answer_unit_bristles(
    law: np.void, signals: "Signals", turning: float, sliding: float, both: float, answer: np.ndarray
) -> tuple[float, float]:
    """The same with bristles; `both`: the sliding speed of two, 0: of one, m/s."""
    c = law["c"]
    v = math.sqrt(turning * turning + sliding * sliding)
    mu = stribeck_friction(c[DYNAMIC], c[STATIC], c[STRIBECK], v)
    force, share = answer_bristles(
        signals, law["bristle"], 2, c[BRISTLE], c[BRISTLE_DAMPING], mu, (turning, sliding, 0.0)
    )
    power = force[0] * turning + force[1] * sliding
    answer[COORDINATE], answer[SPEED] = 0.0, both if both > 0.0 else turning + sliding
    answer[EFFORT], answer[POWER] = power / both if both > 0.0 else force[0] + force[1], power
    answer[STIFFNESS], answer[DAMPING] = c[BRISTLE] * share, c[BRISTLE_DAMPING] * share
    answer[NORMAL] = 1.0
    return force[0], force[1]


@kernel
def friction_share(law: np.void, v: float):
    """μ(v)/v and dμ/dv at the sliding speed v >= 0."""
    c = law["c"]
    x, fade = v / c[CREEP], math.exp(-((v / c[STRIBECK]) ** 2))
    mu = c[DYNAMIC] + (c[STATIC] - c[DYNAMIC]) * fade
    rise = math.tanh(x)
    bend = -2.0 * (c[STATIC] - c[DYNAMIC]) * fade * v / c[STRIBECK] ** 2
    slope = mu * (1.0 - rise * rise) / c[CREEP] + bend * rise
    return (mu * rise / v if x > SMALL else mu / c[CREEP]), slope
