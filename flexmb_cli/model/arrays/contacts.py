"""Contacts of shapes → the fields that records of elements have for them."""

import math
from itertools import product
from typing import Any

import numpy as np

from ..laws import CONTACT, Element, Touch
from .function_table import fill_law

# The codes of kernels.contact; a test compares them.
PLANE_BALL, PLANE_RIM, CORES, BOX_BALL, CYLINDER_BALL = 0, 1, 2, 3, 4
ANSWER_COLUMNS, CONTACT_COLUMNS = 8, 21
_OF_BALLS = {"plane": PLANE_BALL, "box": BOX_BALL, "cylinder": CYLINDER_BALL}


def fill_contact(records: Any, item: Element) -> Any:
    """Fill the records (parts,) of a contact, one for each point of its second shape that may touch."""
    touch: Touch = item.measure
    given = item.with_values(damping=loss_of(item))
    fill_law(records, CONTACT, given.values)
    records["pair"] = _OF_BALLS.get(touch.first, CORES)
    records["axis_i"], records["radius_i"] = touch.axis_i, touch.radius_i
    records["radius_j"] = touch.radius_j
    if touch.first == "cylinder":
        records["size"][:, 0], records["radius_i"] = touch.radius_i, 0.0
    elif touch.first == "box":
        records["size"] = np.array(touch.size_i) / 2.0
    if touch.second == "cylinder":
        records["pair"], records["radius_j"] = PLANE_RIM, 0.0
        records["size"][:, 0] = touch.radius_j
        records["axis_j"] = np.array(touch.axis_j) / math.hypot(*touch.axis_j)
    elif touch.first != "plane":
        records["axis_j"] = touch.axis_j
    if touch.second == "box":
        records["offset_j"] = [np.array(s) * touch.size_j / 2.0 for s in product((-1.0, 1.0), repeat=3)]
    elif touch.parts == 2:
        records["offset_j"][1] = touch.axis_j
    return records


def loss_of(item: Element) -> float:
    """Return the damping b of a contact, s/m: that of its coefficient of restitution e, where it has one.

    A free collision of the speed v obeys H(b v) = H(-e b v), H(x) = x - log(1 + x) (Hunt and Crossley's law
    integrated over the approach and over the departure), whatever the exponent: b v depends on e alone.
    """
    e, v = float(item["restitution"]), float(item["speed"])
    if e == 1.0:
        return float(item["damping"])

    def gap(x: float) -> float:
        return x - math.log1p(x) + e * x + math.log1p(-e * x)

    low, high = 0.0, 1.0 / e
    while high - low > 1e-16 * high and (x := 0.5 * (low + high)) not in (low, high):
        low, high = (x, high) if gap(x) > 0.0 else (low, x)
    return low / v


def columns_of_answers(records: Any) -> int:
    """Return how many columns the answers of records (E,) have: more where there are contacts."""
    return CONTACT_COLUMNS if np.any(records["shape"] == CONTACT.code) else ANSWER_COLUMNS
