"""Contacts of sets of shapes: forces of all pairs on placed ends, and the search for pairs that are near.

A set is one line CONTACT.  Its ends are the points of its shapes, as END records, which each formulation
places before and reads forces from afterwards; its pairs are TOUCH records.  Pairs of many shapes are
searched with a grid of cells whose heads are hashed: Teschner and others, Optimized Spatial Hashing for
Collision Detection of Deformable Objects (2003).  A list holds until a shape has moved by half of the skin
by which spheres about the shapes are enlarged: Verlet, Physical Review 159 (1967), pages 98-103.  Methods
whose steps end for contacts search between steps, and make none that moves a shape further.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from ._jit import kernel
from .contact import BY_GAP, CHANGED, PLACE, PUSH, SEPARATE, TOUCHES, TOUCHING, answer_touch
from .laws import COORDINATE, DAMPING, EFFORT, ENERGY, NORMAL, POWER, SPEED, STIFFNESS
from .linalg.vec3 import accumulate, cross, dot, minus, plus, scaled, store, triple

if TYPE_CHECKING:
    from ..model.arrays.contacts import Contacts
    from ..model.arrays.signals import Signals

Triple = tuple[float, float, float]
LEAST_GAP = 1e-3  # of the skin: of a pair that has come near within a step
MOST_CELLS = 1e12  # cells from the origin, and m: no numbers of cells beyond


@kernel
def answer_set(c: np.ndarray, contacts: "Contacts", signals: "Signals", k: int, answer: np.ndarray) -> None:
    """Fill forces and torques of the placed ends of set k, and its answer (16,), by a law's numbers c (11,).

    Of several pairs gap, rate and place are those of the least gap, the others are sums.
    """
    s = contacts.sets[k]
    for e in range(s["first_end"], s["first_end"] + s["ends"]):
        store((0.0, 0.0, 0.0), contacts.ends[e]["force"], 0)
        store((0.0, 0.0, 0.0), contacts.ends[e]["torque"], 0)
    if s["buckets"] > 0:
        _measure_way(contacts, s)
        if s["stepping"] == 0 and (s["moved"] > 1.0 or s["searches"] == 0):
            search_pairs(contacts, s)
    for column in range(answer.shape[0]):
        answer[column] = 0.0
    answer[TOUCHES], answer[CHANGED], answer[COORDINATE] = s["begun"], s["changed"], s["skin"]
    for n in range(s["first"], s["first"] + s["count"]):
        touch = contacts.touches[n]
        i, j = contacts.ends[touch["end_i"]], contacts.ends[touch["end_j"]]
        answer_touch(c, touch, contacts, signals, i, j)
        if n == s["first"] or touch["gap"] < answer[COORDINATE]:
            answer[COORDINATE], answer[SPEED] = touch["gap"], touch["rate"]
            store(plus(triple(j["position"], 0), triple(touch["arm_j"], 0)), answer, PLACE)
        if touch["effort"] != 0.0:
            _push(touch, i, j, answer)
    answer[NORMAL] = answer[EFFORT]
    if s["full"] != 0:
        answer[COORDINATE] = math.nan


@kernel
def _push(touch: np.void, i: np.void, j: np.void, answer: np.ndarray) -> None:
    """Add the forces of a touch to its ends, and to an answer (16,)."""
    N = touch["effort"]
    force, torque = scaled(N, triple(touch["push"], 0)), scaled(N, triple(touch["roll"], 0))
    accumulate(force, j["force"], 0)
    accumulate(plus(torque, cross(triple(touch["arm_j"], 0), force)), j["torque"], 0)
    back = scaled(-1.0, force)
    accumulate(back, i["force"], 0)
    accumulate(minus(cross(triple(touch["arm_i"], 0), back), torque), i["torque"], 0)
    accumulate(force, answer, PUSH)
    answer[EFFORT] += N
    answer[POWER] += touch["power"]
    answer[ENERGY] += touch["energy"]
    answer[STIFFNESS] += touch["stiffness"]
    answer[DAMPING] += touch["damping"]


@kernel
def _measure_way(contacts: "Contacts", s: np.void) -> None:
    """Fill how far shapes have moved since pairs were searched."""
    first, end, farthest = s["first_end"], s["first_end"] + s["ends"], 0.0
    for e in range(first, end):
        one = contacts.ends[e]
        axes = one["axes"]
        for x in range(3):
            middle = axes[x] * one["middle"][0] + axes[3 + x] * one["middle"][1]
            one["centre"][x] = one["position"][x] + middle + axes[6 + x] * one["middle"][2]
        d = minus(triple(one["centre"], 0), triple(one["reference"], 0))
        farthest = max(farthest, max(abs(d[0]), max(abs(d[1]), abs(d[2]))))
    # A cube whose half edge is 0.28 of the skin lies within a sphere of half of it.
    s["moved"] = farthest / (0.28 * s["skin"])


@kernel
def search_pairs(contacts: "Contacts", s: np.void) -> None:
    """Search the pairs of a set that are near where its shapes are."""
    if s["moved"] * s["skin"] < MOST_CELLS * s["cell"]:
        _keep_states(contacts, s)
        _fill_cells(contacts, s)
        _search(contacts, s)
        s["searches"] += 1
        s["moved"] = 0.0


@kernel
def _keep_states(contacts: "Contacts", s: np.void) -> None:
    """Copy the pairs of the list, which are in order, and their states."""
    s["before"] = s["count"]
    for n in range(s["first"], s["first"] + s["count"]):
        touch, row = contacts.touches[n], contacts.kept[n]
        row["end_i"], row["end_j"], row["state"] = touch["end_i"], touch["end_j"], touch["state"]
        row["at_start"], row["start_rate"] = touch["at_start"], touch["start_rate"]
        row["at_end"], row["end_rate"] = touch["at_end"], touch["end_rate"]


@kernel
def _fill_cells(contacts: "Contacts", s: np.void) -> None:
    """Chain the ends of each cell, whose first stands in `heads`."""
    for b in range(s["first_bucket"], s["first_bucket"] + s["buckets"]):
        contacts.heads[b] = -1
    for e in range(s["first_end"], s["first_end"] + s["ends"]):
        one = contacts.ends[e]
        for x in range(3):
            one["reference"][x] = one["centre"][x]
            one["cell"][x] = math.floor(one["centre"][x] / s["cell"])
        b = _bucket(s, one["cell"][0], one["cell"][1], one["cell"][2])
        one["next"] = contacts.heads[b]
        contacts.heads[b] = e


@kernel
def _bucket(s: np.void, x: int, y: int, z: int) -> int:
    return s["first_bucket"] + ((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) % s["buckets"]


@kernel
def _search(contacts: "Contacts", s: np.void) -> None:
    """Fill the list of pairs that are near or touch, in order of their ends."""
    first, second, end = s["first_end"], s["second_end"], s["first_end"] + s["ends"]
    s["count"], s["full"], old = 0, 0, s["first"]
    for e in range(first, second if second > first else end):
        begin, one = s["first"] + s["count"], contacts.ends[e]
        for number in range(27):
            x = one["cell"][0] + number % 3 - 1
            y, z = one["cell"][1] + number // 3 % 3 - 1, one["cell"][2] + number // 9 - 1
            o = contacts.heads[_bucket(s, x, y, z)]
            while o >= 0:
                other = contacts.ends[o]
                there = other["cell"][0] == x and other["cell"][1] == y and other["cell"][2] == z
                if there and o > e and o >= second and _is_near(s, one, other):
                    _insert(contacts, s, begin, e, o)
                o = other["next"]
        old = _take_states(contacts, s, begin, e, old)


@kernel
def _is_near(s: np.void, one: np.void, other: np.void) -> bool:
    d = minus(triple(one["centre"], 0), triple(other["centre"], 0))
    reach = one["bound"] + other["bound"] + s["skin"]
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach


@kernel
def _is_joined(contacts: "Contacts", s: np.void, e: int, o: int) -> bool:
    """Return whether a pair is among those of the set that never touch, which are in order."""
    low, high = s["first_joined"], s["first_joined"] + s["joined"]
    while low < high:
        middle = (low + high) // 2
        pair = contacts.joined[middle]
        if pair[0] < e or (pair[0] == e and pair[1] < o):
            low = middle + 1
        else:
            high = middle
    in_range = low < s["first_joined"] + s["joined"]
    return in_range and contacts.joined[low, 0] == e and contacts.joined[low, 1] == o


@kernel
def _insert(contacts: "Contacts", s: np.void, begin: int, e: int, o: int) -> None:
    """Insert the pair of e and o, unless it is joined, in order into the list, whose pairs of e begin at
    `begin`.
    """
    if _is_joined(contacts, s, e, o):
        return
    if s["count"] >= s["most"]:
        s["full"] = 1
        return
    n = s["first"] + s["count"]
    while n > begin and contacts.touches[n - 1]["end_j"] > o:
        n -= 1
    if n > begin and contacts.touches[n - 1]["end_j"] == o:
        return
    for m in range(s["first"] + s["count"], n, -1):
        contacts.touches[m]["end_j"] = contacts.touches[m - 1]["end_j"]
        contacts.touches[m]["end_i"] = contacts.touches[m - 1]["end_i"]
    contacts.touches[n]["end_i"], contacts.touches[n]["end_j"] = e, o
    s["count"] += 1


@kernel
def _take_states(contacts: "Contacts", s: np.void, begin: int, e: int, old: int) -> int:
    """Give the pairs of e their states of the list before, from `old` on; pairs that touch stay.

    Returns where the pairs of the next end begin in the list before.
    """
    last = s["first"] + s["before"]
    while old < last and contacts.kept[old]["end_i"] < e:
        old += 1
    n = old
    while n < last and contacts.kept[n]["end_i"] == e:
        if contacts.kept[n]["state"] == TOUCHING:
            _insert(contacts, s, begin, e, contacts.kept[n]["end_j"])
        n += 1
    for m in range(begin, s["first"] + s["count"]):
        touch = contacts.touches[m]
        while old < n and contacts.kept[old]["end_j"] < touch["end_j"]:
            old += 1
        if old < n and contacts.kept[old]["end_j"] == touch["end_j"]:
            row = contacts.kept[old]
            touch["state"], touch["at_start"], touch["start_rate"] = (
                row["state"],
                row["at_start"],
                row["start_rate"],
            )
            touch["at_end"], touch["end_rate"] = row["at_end"], row["end_rate"]
        else:
            touch["state"] = SEPARATE if s["stepping"] != 0 else BY_GAP
            i, j = contacts.ends[e], contacts.ends[touch["end_j"]]
            d = minus(triple(j["centre"], 0), triple(i["centre"], 0))
            apart = math.sqrt(dot(d, d)) - i["bound"] - j["bound"]
            touch["at_end"], touch["end_rate"] = max(apart, LEAST_GAP * s["skin"]), 0.0
            touch["at_start"], touch["start_rate"] = touch["at_end"], 0.0
    return n
