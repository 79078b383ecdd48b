"""Springs, stops, cables and friction in joint coordinates and in line: effort, slopes, power and energy.

An element acts in a coordinate x with the rate v: an angle, a stroke or the length between two points.
What it answers is kept in a row of Work.responses, with -dF/dx and -dF/dv for implicit integrators, and the
energy it stores.
Stops and cables: Hunt and Crossley, Journal of Applied Mechanics 42 (1975), pages 440-445, exponent 1.
Friction: Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 (1994), section 3.1, made smooth by
tanh.
"""

import math
from typing import TYPE_CHECKING, Any

from .._jit import kernel
from ..linalg.rotation import dot
from .body_vectors import RATE, VECTOR, Geometry, add_vector_row, geometry_of, vector
from .constraint_primitives import add_primitive_row, primitive_rates, primitive_value
from .time_functions import function_values

if TYPE_CHECKING:
    import numpy as np

    from .system import System, Work


# The codes of model.arrays.records; a test compares them.
ELEMENT, FRICTION = 5, 6
SPRING, STOP, CABLE = 1, 2, 3
# Columns of the responses.
COORDINATE, SPEED, EFFORT, POWER, STIFFNESS, DAMPING, NORMAL, ENERGY = 0, 1, 2, 3, 4, 5, 6, 7
RESPONSE_COLUMNS = 8
NO_LENGTH = 1e-300  # m, and m² of its square: a line that short has no direction
SMALL = 1e-6  # of the creep speed: tanh(x)/x is 1 there


@kernel
def add_element(system: "System", work: "Work", k: int, f: "np.ndarray") -> float:
    """Add element k to f (n,); returns the power of what stores no energy."""
    load, answer = system.loads[k], work.responses[k]
    geometry = geometry_of(system, work)
    directed = _fill_coordinate(geometry, work, load, answer)
    effort, kept = _effort(system, load, answer)
    if not directed:
        # Its energy counts, but no force acts.
        answer[EFFORT], answer[POWER] = 0.0, 0.0
        return 0.0
    answer[EFFORT], answer[POWER] = effort, (effort - kept) * answer[SPEED]
    if load["in_line"]:
        add_along_line(geometry, load["primitive"], effort / answer[COORDINATE], f)
    else:
        add_primitive_row(geometry, load["primitive"], effort, f)
    return answer[POWER]


@kernel
def add_along_line(geometry: Any, k: int, share: float, f: "np.ndarray") -> None:
    """Add to f the force `share` times V of primitive k that drives its ends apart."""
    d, ends = vector(geometry.relative_vectors[VECTOR, k], 0), geometry.primitives[k]["ends"]
    add_vector_row(geometry, ends[0, 1], d, -share, True, f)
    add_vector_row(geometry, ends[0, 0], d, share, True, f)


@kernel
def _fill_coordinate(geometry: Geometry, work: "Work", load: "np.void", answer: "np.ndarray") -> bool:
    """Coordinate and rate of an element; whether it has a direction: ends that coincide have none."""
    k = load["primitive"]
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
    turn = geometry.primitives[k]["turn"]
    answer[COORDINATE] = primitive_value(geometry, k, work.angles[turn] if turn >= 0 else 0.0)
    answer[SPEED] = primitive_rates(geometry, k)[0]
    return True


@kernel
def _is_upright(geometry: Geometry, load: "np.void") -> bool:
    """Return whether the axes of both bodies about which a bushing turns are within a right angle."""
    placed = geometry.placed[VECTOR]
    return dot(vector(placed, load["body_vector"]), vector(placed, load["tilted"])) > 0.0


@kernel
def _effort(system: "System", load: "np.void", answer: "np.ndarray") -> tuple[float, float]:
    """Effort along the coordinate, and the part of it that has a potential; fills slopes and energy."""
    x, v = answer[COORDINATE], answer[SPEED]
    if load["shape"] == STOP:
        if x > load["upper"]:
            return _pushed_back(load, x - load["upper"], v, -1.0, answer)
        if x < load["lower"]:
            return _pushed_back(load, load["lower"] - x, -v, 1.0, answer)
        return _pushed_back(load, 0.0, 0.0, 1.0, answer)
    s = x - load["free_length"]
    if load["shape"] == CABLE:
        return _pushed_back(load, max(s, 0.0), v, -1.0, answer)
    kept, lost = load["preload"] + load["stiffness"] * s, load["damping"] * v
    answer[STIFFNESS], answer[DAMPING] = load["stiffness"], load["damping"]
    answer[ENERGY] = (load["preload"] + 0.5 * load["stiffness"] * s) * s
    if load["curve"] >= 0:
        force, slope, _ = function_values(system.functions, system.knots, load["curve"], s)
        kept += force
        answer[STIFFNESS] += slope
        answer[ENERGY] += function_values(system.functions, system.knots, load["energy"], s)[0]
    if load["damper"] >= 0:
        force, slope, _ = function_values(system.functions, system.knots, load["damper"], v)
        lost += force
        answer[DAMPING] += slope
    return -kept - lost, -kept


@kernel
def _pushed_back(load: "np.void", depth: float, approach: float, sign: float, answer: "np.ndarray"):
    """A stop at a depth that grows at `approach`: effort, its part with a potential; fills slopes."""
    k, b = load["stiffness"], load["damping"]
    share = max(0.0, 1.0 + b * approach)
    answer[STIFFNESS] = k * share if depth > 0.0 else 0.0
    answer[DAMPING] = k * depth * b if share > 0.0 else 0.0
    answer[ENERGY] = 0.5 * k * depth * depth
    return sign * k * depth * share, sign * k * depth


@kernel
def add_unit_friction(system: "System", work: "Work", k: int, f: "np.ndarray") -> None:
    """Add friction k by the normal force 1 N to f (n,), and answer for it."""
    load, answer, geometry = system.loads[k], work.responses[k], geometry_of(system, work)
    r = load["radius"]
    turning = primitive_rates(geometry, load["primitive"])[0] * r if load["primitive"] >= 0 else 0.0
    sliding = primitive_rates(geometry, load["stroke"])[0] if load["stroke"] >= 0 else 0.0
    v = math.sqrt(turning * turning + sliding * sliding)
    share, slope = friction_share(load, v)
    if load["primitive"] >= 0:
        add_primitive_row(geometry, load["primitive"], -share * turning * r, f)
    if load["stroke"] >= 0:
        add_primitive_row(geometry, load["stroke"], -share * sliding, f)
    signed = v if load["primitive"] >= 0 and load["stroke"] >= 0 else turning + sliding
    answer[COORDINATE], answer[SPEED], answer[EFFORT] = 0.0, signed, -share * signed
    answer[POWER], answer[DAMPING], answer[NORMAL] = -share * v * v, max(slope, 0.0), 1.0


@kernel
def friction_share(load: "np.void", v: float):
    """μ(v)/v and dμ/dv at the sliding speed v >= 0."""
    x, fade = v / load["creep"], math.exp(-((v / load["stribeck"]) ** 2))
    mu = load["dynamic"] + (load["static"] - load["dynamic"]) * fade
    rise = math.tanh(x)
    bend = -2.0 * (load["static"] - load["dynamic"]) * fade * v / load["stribeck"] ** 2
    slope = mu * (1.0 - rise * rise) / load["creep"] + bend * rise
    return (mu * rise / v if x > SMALL else mu / load["creep"]), slope


@kernel
def add_element_slope(
    geometry: Any, work: "Work", load: "np.void", k: int, by_position: float, by_speed: float, y: "np.ndarray"
) -> None:
    """y += (by_position K + by_speed D) x of element k, where the body vectors have been moved by x."""
    answer, r = work.responses[k], load["radius"]
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
        add_primitive_row(
            geometry, load["primitive"], amount * primitive_rates(geometry, load["primitive"])[0], y
        )
