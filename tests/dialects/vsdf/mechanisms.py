"""Mechanisms of trusses and rigid bodies in any pose, with every kind of joint between their nodes."""

import math

import numpy as np

from flexmb_cli.model.flexible_mechanism import (
    FlexibleMechanism,
    FloatingBody,
    NodePoint,
    PointJoint,
    PointPin,
)
from flexmb_cli.model.integrators import Integrator
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.time_functions import MotionFunction
from flexmb_cli.solvers.constrained.flexible_dynamics import FlexibleDynamics
from tests.fe.supplied import body as reduced
from tests.fe.trusses import truss_input

KINDS = (
    "spherical",
    "universal",
    "revolute",
    "cylindrical",
    "translational",
    "screw",
    "fixed",
    "revolute-spherical",
    "spherical-spherical",
)
POINTS = {"spherical": 1, "spherical-spherical": 1, "revolute-spherical": 2, "universal": 2}
POINTS |= {"revolute": 2, "cylindrical": 2}
GRID = TimeGrid(0.0, 0.1, 0.01)
DEFAULT = Integrator("RK45", 0.0, 1e-10)
NO_SHAPE = np.zeros((3, 0))


def unit(v):
    return v / np.linalg.norm(v)


def rigid(random, name="rigid"):
    """A rigid body with every element of its inertia its own."""
    root = random.uniform(-0.3, 0.3, (3, 3)) + np.eye(3)
    s0 = random.uniform(-0.2, 0.2, 3)
    m = 2.0
    J = root @ root.T + (s0 @ s0 * np.eye(3) - np.outer(s0, s0)) / m
    pose = random.uniform(-1, 1, 3), unit(random.uniform(-1, 1, 4))
    return FloatingBody(name, *pose, np.zeros(3), np.zeros(3), m, s0, J)


def flexible(folder, seed, random, modes=4, **choices):
    found = reduced(truss_input(folder, seed, modes=modes, reference=(12, 15, 17), **choices))
    pose = random.uniform(-1, 1, 3), unit(random.uniform(-1, 1, 4))
    zero = np.zeros(3)
    return FloatingBody(found.name, *pose, zero, zero, found.m, found.s0, found.J0, found)


def node(bodies, k, number):
    """Node `number` (11 ...) of a truss, a made-up point of a rigid body, or of the ground."""
    if k >= 0 and bodies[k].flexible is not None:
        found = bodies[k].flexible
        return NodePoint(f"body {k + 1} node {number}", k, found.position(number), found.shape(number))
    place = np.random.default_rng(number).uniform(-1, 1, 3)
    return NodePoint(f"body {k + 1} node {number}", k, place, NO_SHAPE)


def joint(bodies, kind, a, b, name="joint 1"):
    """A joint between nodes of bodies a and b, not assembled."""
    count = POINTS.get(kind, 3)
    on_a = tuple(node(bodies, a, n) for n in (11, 14, 16)[:count])
    on_b = tuple(node(bodies, b, n) for n in (13, 16, 11)[:count])
    on_b = on_b[:1] if kind == "revolute-spherical" else on_b
    size = {"screw": 0.3, "revolute-spherical": 0.8, "spherical-spherical": 0.7}.get(kind, math.nan)
    return PointJoint(name, kind, on_a, on_b, size)


def sample(folder, **parts):
    """A flexible, a rigid and another flexible body."""
    random = np.random.default_rng(5)
    (folder / "1").mkdir()
    (folder / "2").mkdir()
    bodies = flexible(folder / "1", 1, random), rigid(random), flexible(folder / "2", 2, random, 5)
    return FlexibleMechanism(bodies, GRID, parts.pop("integrator", DEFAULT), (0.4, -9.0, 2.0), **parts)


def with_joint(folder, kind, a, b):
    from dataclasses import replace

    mechanism = sample(folder)
    return replace(mechanism, joints=(joint(mechanism.bodies, kind, a, b),))


def random_state(analysis, seed=3):
    """Coordinates and speeds away from the start, |p| = 1."""
    random, arrays = np.random.default_rng(seed), analysis.arrays
    q = arrays.q + random.uniform(-0.3, 0.3, arrays.q.size)
    for k in range(arrays.bodies):
        q[7 * k + 3 : 7 * k + 7] = unit(q[7 * k + 3 : 7 * k + 7])
    return q, random.uniform(-1, 1, arrays.speeds)


def multiplied(p, r):
    """Product of quaternions."""
    scalar = p[0] * r[0] - p[1:] @ r[1:]
    return np.append(scalar, p[0] * r[1:] + r[0] * p[1:] + np.cross(p[1:], r[1:]))


def moved(arrays, q, u, t):
    """Where constant speeds (global v, body-fixed ω, η̇) bring the coordinates in the time t: exactly."""
    b = arrays.bodies
    out = q.copy()
    out[7 * b :] += t * u[6 * b :]
    for k in range(b):
        v, w = u[6 * k : 6 * k + 3], u[6 * k + 3 : 6 * k + 6]
        out[7 * k : 7 * k + 3] += t * v
        half = 0.5 * t * np.linalg.norm(w)
        turn = np.append(math.cos(half), 0.5 * t * np.sinc(half / math.pi) * w)
        out[7 * k + 3 : 7 * k + 7] = multiplied(q[7 * k + 3 : 7 * k + 7], turn)
    return out


def analysis_of(mechanism):
    return FlexibleDynamics(mechanism)


def pin(bodies, k, number, directions=(True, True, True)):
    point = node(bodies, k, number)
    return PointPin("pin 1", point, directions, np.array([0.3, -0.2, 0.5]))


SINE = MotionFunction(3, (0.2, 0.5, 3.0, 0.4))
