"""Springs, stops, cables and friction in joint coordinates and in line: effort, slopes, power and energy.

An element acts in a coordinate x with the rate v: an angle, a stroke or the length between two points.
What it answers is kept in a row of Work.responses, with -dF/dx and -dF/dv for implicit integrators, and the
energy it stores.
Stops and cables: Hunt and Crossley, Journal of Applied Mechanics 42 (1975), pages 440-445, exponent 1.
Friction: Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 (1994), section 3.1, made smooth by
tanh.
"""

import math
from typing import Any

import numpy as np

from .._jit import kernel
from ..contact import CONTACT
from ..laws import (
    COORDINATE,
    DAMPING,
    NO_LENGTH,
    POWER,
    RADIUS,
    SPEED,
    STIFFNESS,
    answer_law,
    answer_unit_friction,
)
from ..linalg.rotation import A, dot, rotate
from ..linalg.rotation_vectors import spin
from .body_vectors import (
    RATE,
    TURN,
    VECTOR,
    Geometry,
    add_turn_row,
    add_vector_row,
    geometry_of,
    in_body_axes,
    vector,
)
from .constraint_primitives import add_chain_row, add_primitive_row, chain_rates, chain_value, primitive_rates
from .contacts import add_contact, add_contact_slope
from .system import System, Work

# The codes of model.arrays.records; a test compares them.
ELEMENT, FRICTION = 5, 6
ALONG_VECTOR, ABOUT_VECTOR = 2, 3


@kernel
def add_element(system: System, work: Work, k: int, u: np.ndarray, t: float, f: np.ndarray) -> float:
    """Add element k at the speeds u (n,) to f (n,); returns the power of what stores no energy."""
    load, answer = system.loads[k], work.responses[k]
    if load["in_line"] >= ALONG_VECTOR:
        answer[COORDINATE], answer[SPEED] = 0.0, 0.0
        effort = answer_law(load, system.functions, system.knots, t, True, answer)
        answer[SPEED] = add_along_vector(system, work, load, load["in_line"] == ALONG_VECTOR, effort, u, f)
        answer[POWER] = effort * answer[SPEED]
        return answer[POWER]
    if load["shape"] == CONTACT:
        return add_contact(system, work, load, u, answer, f)
    directed = fill_coordinate(system, work, load, answer)
    effort = answer_law(load, system.functions, system.knots, t, directed, answer)
    if not directed:
        return 0.0
    if load["in_line"]:
        add_along_line(geometry_of(system, work), load["primitive"], effort / answer[COORDINATE], f)
    else:
        add_chain_row(system, work, load["primitive"], effort, f)
    return answer[POWER]


@kernel
def add_along_vector(
    system: System, work: Work, load: np.void, pushing: bool, factor: float, u: np.ndarray, f: np.ndarray
) -> float:
    """Add to f a factor times the force, or torque, of a load; returns the speed along that vector."""
    p, v = load["body_vector"], load["vector"]
    b = system.body_vectors[p]["body"]
    if b < 0:
        return 0.0
    F = rotate(work.rotations[A], b, v) if load["following"] else (v[0], v[1], v[2])
    speed, axes = 0.0, work.rotations[A, b]
    if not pushing and system.body_vectors[p]["turn"] >= 0:
        speed += _add_on_node(system, work, p, F, factor, u, f)
    if pushing:
        add_vector_row(geometry_of(system, work), p, F, factor, True, f)
        w = work.body_vectors[RATE, p]
        for i in range(3):
            speed += F[i] * (u[6 * b + i] + w[i])
        return speed
    for i in range(3):
        torque = axes[0, i] * F[0] + axes[1, i] * F[1] + axes[2, i] * F[2]
        f[6 * b + 3 + i] += factor * torque
        speed += torque * u[6 * b + 3 + i]
    return speed


@kernel
def _add_on_node(
    system: System,
    work: Work,
    p: int,
    torque: tuple[float, float, float],
    factor: float,
    u: np.ndarray,
    f: np.ndarray,
) -> float:
    """Add to f a factor times a torque, global axes, on a node's rotation; returns the speed along it."""
    geometry, record = geometry_of(system, work), system.body_vectors[p]
    m = in_body_axes(work.rotations[A, record["body"]], torque)
    add_turn_row(geometry, p, (factor * m[0], factor * m[1], factor * m[2]), f)
    N, at, first = record["modes"], record["turn"], 6 * system.masses.shape[0] + record["first"]
    w, speed = spin(vector(geometry.placed[TURN], p), m, -1.0), 0.0
    for i in range(3):
        for mode in range(N):
            speed += w[i] * system.shapes[at + i * N + mode] * u[first + mode]
    return speed


@kernel
def add_along_line(geometry: Any, k: int, share: float, f: np.ndarray) -> None:
    """Add to f the force `share` times V of primitive k that drives its ends apart."""
    d, ends = vector(geometry.relative_vectors[VECTOR, k], 0), geometry.primitives[k]["ends"]
    add_vector_row(geometry, ends[0, 1], d, -share, True, f)
    add_vector_row(geometry, ends[0, 0], d, share, True, f)


@kernel
def fill_coordinate(system: System, work: Work, load: np.void, answer: np.ndarray) -> bool:
    """Fill coordinate and rate of an element or sensor in answer (8,); return whether it has a direction.

    Ends that coincide have none.
    """
    k, geometry = load["primitive"], geometry_of(system, work)
    if load["in_line"]:
        d, v = (
            vector(geometry.relative_vectors[VECTOR, k], 0),
            vector(geometry.relative_vectors[RATE, k], 0),
        )
        answer[COORDINATE] = math.sqrt(dot(d, d))
        if answer[COORDINATE] < NO_LENGTH:
            answer[SPEED] = 0.0
            return False
        answer[SPEED] = dot(d, v) / answer[COORDINATE]
        return True
    if load["tilted"] >= 0 and not _is_upright(geometry, load):
        answer[COORDINATE], answer[SPEED] = math.nan, math.nan
        return True
    answer[COORDINATE] = chain_value(system, work, k, work.angles)
    answer[SPEED] = chain_rates(system, work, k)[0]
    return True


@kernel
def _is_upright(geometry: Geometry, load: np.void) -> bool:
    """Return whether the axes of both bodies about which a bushing turns are within a right angle."""
    placed = geometry.placed[VECTOR]
    return dot(vector(placed, load["body_vector"]), vector(placed, load["tilted"])) > 0.0


@kernel
def add_unit_friction(system: System, work: Work, k: int, f: np.ndarray) -> None:
    """Add friction k by the normal force 1 N to f (n,), and answer for it."""
    load, geometry = system.loads[k], geometry_of(system, work)
    r, turns, slides = load["c"][RADIUS], load["primitive"] >= 0, load["stroke"] >= 0
    turning = primitive_rates(geometry, load["primitive"])[0] * r if turns else 0.0
    sliding = primitive_rates(geometry, load["stroke"])[0] if slides else 0.0
    about, along = answer_unit_friction(
        load, system.signals, turning, sliding, turns and slides, work.responses[k]
    )
    if turns:
        add_primitive_row(geometry, load["primitive"], about * r, f)
    if slides:
        add_primitive_row(geometry, load["stroke"], along, f)


@kernel
def add_element_slope(
    system: System, work: Work, k: int, by_position: float, by_speed: float, x: np.ndarray, y: np.ndarray
) -> None:
    """y += (by_position K + by_speed D) x of element k, where the body vectors have been moved by x."""
    load, answer, geometry = system.loads[k], work.responses[k], geometry_of(system, work)
    r = load["c"][RADIUS]
    if load["shape"] == CONTACT:
        add_contact_slope(system, work, load, by_position, by_speed, x, y)
        return
    if load["in_line"] >= ALONG_VECTOR:
        return  # turns of a force are left to the iteration
    amount = by_position * answer[STIFFNESS] + by_speed * answer[DAMPING]
    if load["kind"] == FRICTION:
        if load["primitive"] >= 0:
            rate = primitive_rates(geometry, load["primitive"])[0]
            add_primitive_row(geometry, load["primitive"], amount * rate * r * r, y)
        if load["stroke"] >= 0:
            add_primitive_row(
                geometry, load["stroke"], amount * primitive_rates(geometry, load["stroke"])[0], y
            )
    elif load["in_line"]:
        d = vector(geometry.relative_vectors[VECTOR, load["primitive"]], 0)
        square = dot(d, d)
        if square > NO_LENGTH:
            stretched = dot(d, vector(geometry.relative_vectors[RATE, load["primitive"]], 0))
            add_along_line(geometry, load["primitive"], amount * stretched / square, y)
    else:
        rate = chain_rates(system, work, load["primitive"])[0]
        add_chain_row(system, work, load["primitive"], amount * rate, y)
