"""Elements of a tree: what they measure at placed frames, and their efforts along coordinates and on frames.

An element in a hinge coordinate adds to the effort along it, and of a follower along that of its cam.
One between two bodies pushes body j at a place
by its effort and body i by the opposite there; along the elastic coordinates that displace its ends the same
force does work: each costs O(1).
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel, part
from ..constrained.time_functions import function_values
from ..contact_sets import answer_set
from ..laws import COORDINATE, EFFORT, ENERGY, NO_LENGTH, POWER, SPEED, answer_law
from ..linalg.vec3 import accumulate, column, cross, dot, inward, minus, outward, plus, scaled, store, triple
from ..signals import evaluate_signals
from .kinematics import _along_axes

if TYPE_CHECKING:
    from ...model.arrays.tree import TreeArrays

# The codes of model.arrays.tree_elements; a test compares them.
IN_COORDINATE, IN_LINE, ALONG, ABOUT, BETWEEN, PUSHED, TWISTED = 0, 1, 2, 3, 4, 5, 6


@part
def answer_elements(
    tree: "TreeArrays", work: np.ndarray, t: float, q: np.ndarray, y: np.ndarray, coordinates: np.ndarray
) -> None:
    """Fill the answers of all elements, frames being placed, and add their efforts along coordinates.

    Signals follow from those of elements that no signal drives, and these from them.
    """
    signals = tree.signals.records.shape[0] > 0
    for turn in range(2 if signals else 1):
        for i in range(tree.elements.shape[0]):
            if tree.elements[i]["driven"] == turn:
                _answer_element(tree, work, t, q, y, coordinates, i)
        if signals and turn == 0:
            for i in range(tree.sensors.shape[0]):
                _fill_coordinate(tree, work, q, y, tree.sensors[i], tree.signals.sensed[i])
            evaluate_signals(tree.signals, tree.curves, tree.knots, tree.answers, t)


@part
def _answer_element(
    tree: "TreeArrays",
    work: np.ndarray,
    t: float,
    q: np.ndarray,
    y: np.ndarray,
    coordinates: np.ndarray,
    i: int,
) -> None:
    element, answer = tree.elements[i], tree.answers[i]
    if element["measure"] == BETWEEN:
        _answer_contact(tree, element, work, q, y, coordinates, answer)
        return
    directed = _fill_coordinate(tree, work, q, y, element, answer)
    effort = answer_law(element, tree.curves, tree.knots, min(t, element["until"]), directed, answer)
    if element["measure"] == IN_COORDINATE:
        coordinates[element["coordinate"]]["effort"] += effort
        if element["curve"] >= 0:
            coordinates[element["cam"]]["effort"] -= element["slope"] * effort
    elif element["measure"] != ABOUT:
        force = scaled(effort, triple(element["force"], 0))
        _push_node(element["node_j"], inward(work[element["frame_j"]]["axes"], force), 1.0, coordinates)
        _push_node(element["node_i"], inward(work[element["frame_i"]]["axes"], force), -1.0, coordinates)


@part
def _fill_coordinate(
    tree: "TreeArrays", work: np.ndarray, q: np.ndarray, y: np.ndarray, element: np.void, answer: np.ndarray
) -> bool:
    """Fill the coordinate of an element or sensor and its rate; return whether it has a direction."""
    if element["measure"] != IN_COORDINATE:
        return _measure(element, work, q, y, answer)
    answer[COORDINATE], answer[SPEED] = q[element["coordinate"]], y[element["coordinate"]]
    if element["curve"] >= 0:
        cam = element["cam"]
        value, slope, _ = function_values(tree.curves, tree.knots, element["curve"], q[cam])
        element["slope"] = slope
        answer[COORDINATE] -= value
        answer[SPEED] -= slope * y[cam]
    return True


@kernel
def _answer_contact(
    tree: "TreeArrays",
    element: np.void,
    work: np.ndarray,
    q: np.ndarray,
    y: np.ndarray,
    coordinates: np.ndarray,
    answer: np.ndarray,
) -> None:
    """Place the ends of a contact, answer for it, and add forces on nodes along their coordinates."""
    s = tree.contacts.sets[element["coordinate"]]
    for e in range(s["first_end"], s["first_end"] + s["ends"]):
        end = tree.contacts.ends[e]
        f = work[end["frame"]]
        position, velocity = _point(f, end["point"], end["node"], q, y)
        store(position, end["position"], 0)
        store(velocity, end["velocity"], 0)
        store(triple(f["angular"], 0), end["angular"], 0)
        for k in range(3):
            store(column(f["axes"], k), end["axes"], 3 * k)
    answer_set(element["c"], tree.contacts, tree.signals, element["coordinate"], answer)
    for e in range(s["first_end"], s["first_end"] + s["ends"]):
        end = tree.contacts.ends[e]
        force = inward(work[end["frame"]]["axes"], triple(end["force"], 0))
        _push_node(end["node"], force, 1.0, coordinates)


@part
def _push_node(
    node: np.ndarray, force: tuple[float, float, float], sign: float, coordinates: np.ndarray
) -> None:
    for axis in range(3):
        if node[axis] >= 0:
            coordinates[node[axis]]["effort"] += sign * force[axis]


@part
def add_element_wrenches(tree: "TreeArrays", work: np.ndarray) -> None:
    """Take the forces that elements put on frames off their biases."""
    for i in range(tree.elements.shape[0]):
        element = tree.elements[i]
        if element["measure"] != IN_COORDINATE and element["measure"] != BETWEEN:
            effort, place = tree.answers[i, EFFORT], triple(element["place"], 0)
            force, torque = (
                scaled(effort, triple(element["force"], 0)),
                scaled(effort, triple(element["torque"], 0)),
            )
            _add_wrench(work[element["frame_i"]], place, force, torque, 1.0)
            _add_wrench(work[element["frame_j"]], place, force, torque, -1.0)
    for e in range(tree.contacts.ends.shape[0]):
        end = tree.contacts.ends[e]
        force, torque = triple(end["force"], 0), triple(end["torque"], 0)
        _add_wrench(work[end["frame"]], triple(end["position"], 0), force, torque, -1.0)


@part
def _add_wrench(
    s: np.void,
    place: tuple[float, float, float],
    force: tuple[float, float, float],
    torque: tuple[float, float, float],
    sign: float,
) -> None:
    arm = minus(place, triple(s["position"], 0))
    accumulate(scaled(sign, plus(torque, cross(arm, force))), s["bias"], 0)
    accumulate(scaled(sign, force), s["bias"], 3)


@part
def _measure(element: np.void, work: np.ndarray, q: np.ndarray, y: np.ndarray, answer: np.ndarray) -> bool:
    """Fill coordinate, speed and the unit force; False where it has no direction."""
    a, b = work[element["frame_i"]], work[element["frame_j"]]
    if element["measure"] == ABOUT:
        return _measure_turn(element, a, b, answer)
    if element["measure"] >= PUSHED:
        return _set_direction(element, b, q, y, answer)
    place, velocity = _point(b, element["point_j"], element["node_j"], q, y)
    start, start_velocity = _point(a, element["point_i"], element["node_i"], q, y)
    gap, rate = minus(place, start), minus(velocity, start_velocity)
    store(place, element["place"], 0)
    if element["measure"] == ALONG:
        axis = column(a["axes"], element["axis"])
        store(axis, element["force"], 0)
        answer[COORDINATE] = dot(axis, gap)
        answer[SPEED] = dot(axis, minus(rate, cross(triple(a["angular"], 0), gap)))
        return True
    length = math.sqrt(dot(gap, gap))
    answer[COORDINATE] = length
    if length < NO_LENGTH:
        answer[SPEED] = 0.0
        return False
    unit = scaled(1.0 / length, gap)
    store(unit, element["force"], 0)
    answer[SPEED] = dot(unit, rate)
    return True


@part
def _set_direction(element: np.void, s: np.void, q: np.ndarray, y: np.ndarray, answer: np.ndarray) -> bool:
    """Fill the unit force or torque of an effort along a direction, and the speed along it."""
    direction = triple(element["point_i"], 0)
    if element["axis"] != 0:
        direction = outward(s["axes"], direction)
    place, velocity = _point(s, element["point_j"], element["node_j"], q, y)
    store(place, element["place"], 0)
    answer[COORDINATE] = 0.0
    if element["measure"] == TWISTED:
        store(direction, element["torque"], 0)
        answer[SPEED] = dot(direction, triple(s["angular"], 0))
    else:
        store(direction, element["force"], 0)
        answer[SPEED] = dot(direction, velocity)
    return True


@part
def _point(
    s: np.void, point: np.ndarray, node: np.ndarray, q: np.ndarray, y: np.ndarray
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Place and velocity of a point of a frame, or of a node."""
    arm = outward(s["axes"], plus(triple(point, 0), _along_axes(node, q)))
    velocity = plus(triple(s["velocity"], 0), cross(triple(s["angular"], 0), arm))
    velocity = plus(velocity, outward(s["axes"], _along_axes(node, y)))
    return plus(triple(s["position"], 0), arm), velocity


@part
def _measure_turn(element: np.void, a: np.void, b: np.void, answer: np.ndarray) -> bool:
    """Angle from an axis of i to that of j in the plane across `axis`; not a number where it overturns."""
    k = element["axis"]
    after, last = (k + 1) % 3, (k + 2) % 3
    f, g = column(a["axes"], after), column(a["axes"], last)
    h = outward(b["axes"], column(element["turned"], after))
    if (
        element["resists"] != 0
        and not dot(column(a["axes"], k), outward(b["axes"], column(element["turned"], k))) > 0.0
    ):
        answer[COORDINATE], answer[SPEED] = math.nan, math.nan
        return True
    c, s = dot(f, h), dot(g, h)
    square = c * c + s * s
    slope = minus(scaled(c / square, cross(h, g)), scaled(s / square, cross(h, f)))
    store(slope, element["torque"], 0)
    turn = 2.0 * math.pi
    angle = math.atan2(s, c)
    angle += turn * math.floor((element["expected"] - angle) / turn + 0.5)
    element["expected"] = angle
    answer[COORDINATE] = angle
    answer[SPEED] = dot(slope, minus(triple(b["angular"], 0), triple(a["angular"], 0)))
    return True


@part
def element_energy(tree: "TreeArrays") -> float:
    """Return what all elements store, J, as they answered last."""
    total = 0.0
    for i in range(tree.answers.shape[0]):
        total += tree.answers[i, ENERGY]
    return total


@part
def element_powers(tree: "TreeArrays", first: int, dz: np.ndarray) -> float:
    """Fill dz from `first` on with the powers of elements, W; returns their sum."""
    total = 0.0
    for i in range(tree.answers.shape[0]):
        dz[first + i] = tree.answers[i, POWER]
        total += tree.answers[i, POWER]
    return total
