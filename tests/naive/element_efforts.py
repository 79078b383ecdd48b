"""Efforts of springs, stops, cables, bushings and friction by their definitions (`model.laws`).

Written apart from `kernels.laws`, which tests compare with them.
"""

import math
from typing import NamedTuple

from flexmb_cli.model.laws import Element
from flexmb_cli.model.time_functions import MotionFunction, integral_of

SLOW = 1e-9  # of the creep speed: tanh(x) / x is 1 there


class Effort(NamedTuple):
    """Effort of an element in its coordinate x with the rate v."""

    effort: float  # N or N m, drives x to larger values
    kept: float  # N or N m, the part of it that has a potential
    energy: float  # J, that potential


def spring_effort(item: Element, x: float, v: float) -> Effort:
    """Spring and damper, linear and by curves."""
    stiffness, rest, damping, preload, curve, damper = item.values
    s = x - rest
    kept = -preload - stiffness * s - _value(curve, s)
    lost = -damping * v - _value(damper, v)
    energy = preload * s + 0.5 * stiffness * s * s
    if curve is not None:
        integral = integral_of(curve)
        assert integral is not None, "a curve is no product"
        energy += integral.at(s)[0]
    return Effort(kept + lost, kept, energy)


def _value(function: MotionFunction | None, x: float) -> float:
    return 0.0 if function is None else function.at(x)[0]


def cable_effort(item: Element, x: float, v: float) -> Effort:
    """A cable: Hunt and Crossley's force beyond its length."""
    stiffness, rest, damping = item.values
    return _pushed_back(stiffness, damping, max(x - rest, 0.0), v, -1.0)


def stop_effort(item: Element, x: float, v: float) -> Effort:
    """Stops: Hunt and Crossley's force beyond either."""
    lower, upper, stiffness, damping = item.values
    if x > upper:
        return _pushed_back(stiffness, damping, x - upper, v, -1.0)
    return _pushed_back(stiffness, damping, max(lower - x, 0.0), -v, 1.0)


def _pushed_back(stiffness: float, damping: float, depth: float, approach: float, sign: float) -> Effort:
    """Effort at a depth that grows at the speed `approach`."""
    force = stiffness * depth
    return Effort(
        sign * force * max(0.0, 1.0 + damping * approach), sign * force, 0.5 * stiffness * depth * depth
    )


def friction_per_speed(item: Element, v: float) -> float:
    """Return mu(v) / v at the sliding speed v >= 0, s/m."""
    dynamic, static, stribeck, creep = item.values[:4]
    mu = dynamic + (static - dynamic) * math.exp(-((v / stribeck) ** 2))
    x = v / creep
    return mu / creep if x < SLOW else mu * math.tanh(x) / v
