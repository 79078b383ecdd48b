"""Contacts of shapes → sets of ends, where shapes are, and of pairs of them that may touch."""

import math
from collections.abc import Callable
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from ..laws import CONTACT, Element, Touch
from .function_table import fill_law
from .meshes import MESH_BOX, mesh_boxes
from .records import NONE

# The codes of kernels.contact_shapes; a test compares them.
PLANE_BALL, PLANE_RIM, CORES, BOX_BALL, CYLINDER_BALL, MESH_BALL = 0, 1, 2, 3, 4, 5
ANSWER_COLUMNS, CONTACT_COLUMNS = 8, 16
_OF_BALLS = {"plane": PLANE_BALL, "box": BOX_BALL, "cylinder": CYLINDER_BALL, "mesh": MESH_BALL}
# Pairs that a shape among many has at most: balls of one size have 6 that touch.
PAIRS_OF_AN_END = 12
SKIN = 0.5  # of the radius of the sphere about the largest shape, by which pairs are near before they touch

# A pair of shapes that may touch, the second by one of its points.
TOUCH = np.dtype(
    [
        ("end_i", np.int64),  # END of the first shape
        ("end_j", np.int64),  # END of the second
        ("pair", np.int64),  # a code of `kernels.contact_shapes`
        ("axis_i", np.float64, 3),  # unit normal of a plane, else core from its point on, axes of i, m
        ("axis_j", np.float64, 3),  # unit axis of a rim, else core from its point on, axes of j, m
        ("offset_j", np.float64, 3),  # from the point of j to that of its core, axes of j, m
        ("size", np.float64, 3),  # half edges of a box; radius of a rim or of a solid cylinder, m
        ("radius_i", np.float64),  # around the core of i, m
        ("radius_j", np.float64),  # around the core of j, m
        ("bristle", np.int64),  # the first of three states of its bristles, axes of i, -1: none
        ("first_box", np.int64),  # of its mesh
        # What kernels fill, in global axes:
        ("triangle", np.int64),  # of its mesh, the nearest
        ("gap", np.float64),  # negative where the shapes overlap, m
        ("rate", np.float64),  # of the gap, m/s
        ("effort", np.float64),  # normal force, N
        ("power", np.float64),  # of what stores no energy, W
        ("energy", np.float64),  # that the normal force stores, J
        ("stiffness", np.float64),  # -dN/d gap, N/m
        ("damping", np.float64),  # -dN/d rate, N s/m
        ("normal", np.float64, 3),  # unit vector from i to j
        ("push", np.float64, 3),  # force on j per unit of the normal force
        ("roll", np.float64, 3),  # torque on j per unit of the normal force, m
        ("along", np.float64, 3),  # unit vector of sliding
        ("slope_along", np.float64),  # -dF/dv of friction along it, N s/m
        ("slope_across", np.float64),  # the same across it, N s/m
        ("hold", np.float64),  # stiffness of bristles that do not slide, N/m
        ("arm_i", np.float64, 3),  # from the point of i to the place of contact, m
        ("arm_j", np.float64, 3),  # from the point of j to the place of contact, m
        ("state", np.int64),  # BY_GAP, SEPARATE or TOUCHING of kernels.contact
        ("at_start", np.float64),  # gap at the start of the step, m
        ("start_rate", np.float64),  # its rate there, m/s
        ("at_end", np.float64),  # gap at the end of the step, m
        ("end_rate", np.float64),  # its rate there, m/s
    ]
)
# Of a pair what must outlive another search of pairs.
KEPT = np.dtype(
    [
        (name, TOUCH[name])
        for name in ("end_i", "end_j", "state", "at_start", "start_rate", "at_end", "end_rate")
    ]
)

# The point of a shape.
END = np.dtype(
    [
        ("frame", np.int64),  # FRAME of its body in a tree, else the primitive whose V is its place
        ("point", np.float64, 3),  # in a tree, undeformed, axes of the frame, m
        ("node", np.int64, 3),  # in a tree, elastic coordinates that displace it along axis 1, 2, 3; -1: none
        ("middle", np.float64, 3),  # from it to the middle of a sphere about the shape, axes of the body, m
        ("bound", np.float64),  # radius of that sphere, m
        # What kernels fill, in global axes:
        ("position", np.float64, 3),  # m
        ("velocity", np.float64, 3),  # m/s
        ("axes", np.float64, 9),  # unit vectors of the body, one after the other
        ("angular", np.float64, 3),  # velocity of the body, rad/s
        ("force", np.float64, 3),  # of all its pairs on the body, N
        ("torque", np.float64, 3),  # of all its pairs about the point, N m
        ("centre", np.float64, 3),  # of the sphere about the shape, m
        ("reference", np.float64, 3),  # the same when pairs were searched last, m
        ("cell", np.int64, 3),  # of the grid, where the centre was then
        ("next", np.int64),  # END in the same chain of cells, -1: none
    ]
)

# The shapes and pairs of one name in results; pairs of many shapes are searched, others stay.
CONTACT_SET = np.dtype(
    [
        ("first", np.int64),  # its first TOUCH
        ("count", np.int64),  # how many there are
        ("most", np.int64),  # how many there may be
        ("first_end", np.int64),  # its first END
        ("ends", np.int64),  # how many there are
        ("second_end", np.int64),  # first END of a second shape; the first of all: each with each
        ("begun", np.float64),  # number of times that pairs began to touch
        ("changed", np.float64),  # when one began or ended last, s
        ("stepping", np.int64),  # 1: steps end for contacts
        ("full", np.int64),  # 1: more pairs are near than there may be
        ("searches", np.int64),  # how often pairs have been searched
        ("moved", np.float64),  # share of the way that a shape may move before they must be searched again
        ("before", np.int64),  # pairs of the list before
        ("skin", np.float64),  # distance within which pairs are near, m
        ("cell", np.float64),  # edge of the cells, m
        ("first_bucket", np.int64),  # of the chains of cells
        ("buckets", np.int64),  # how many; 0: its pairs stay
        ("first_joined", np.int64),  # of the pairs that never touch
        ("joined", np.int64),  # how many
    ]
)


class Contacts(NamedTuple):
    """All contacts of a model."""

    sets: np.ndarray  # CONTACT_SET records
    ends: np.ndarray  # END records
    touches: np.ndarray  # TOUCH records
    kept: np.ndarray  # KEPT records, one for each TOUCH
    heads: np.ndarray  # (buckets,) first END of each chain, -1: none
    joined: np.ndarray  # (pairs, 2) END numbers, in order
    boxes: np.ndarray  # MESH_BOX records of meshes
    triangles: np.ndarray  # (n, 9) their corners, axes of their bodies from their points on, m


class ContactTable:
    """Collects contacts; `joined`: pairs of bodies that joints connect, which do not touch in a set."""

    def __init__(self) -> None:
        self.joined: set[frozenset[int]] = set()
        self._sets: list[Any] = []
        self._ends: list[np.ndarray] = []
        self._touches: list[np.ndarray] = []
        self._never: list[tuple[int, int]] = []
        self._buckets = 0
        self.bristles = 0
        self._boxes: list[np.ndarray] = []
        self._triangles: list[np.ndarray] = []

    def new_bristles(self, number: int) -> int:
        """Return the first of a number of new states of bristles."""
        self.bristles += number
        return self.bristles - number

    def add(self, item: Element, place: Callable[[int, Any], np.ndarray]) -> np.ndarray:
        """Return the numbers of the sets of a contact, one for each of its names in results.

        `place`: the END record of a point on a body.
        """
        touch: Touch = item.measure
        shapes = touch_records(touch)
        if touch.first == "mesh":
            shapes["first_box"], shapes["triangle"] = self.mesh(touch.triangles)
        groups = [shapes] if len(item.parts) == 1 else [shapes[k : k + 1] for k in range(len(shapes))]
        return np.array([self._set(touch, group, place, item.sticks) for group in groups])

    def mesh(self, triangles: np.ndarray) -> tuple[int, int]:
        """Add a mesh of triangles (n, 9), m; return its first box and its first triangle."""
        box, first = sum(map(len, self._boxes)), sum(map(len, self._triangles))
        self._boxes.append(mesh_boxes(triangles, box, first))
        self._triangles.append(triangles)
        return box, first

    def arrays(self) -> Contacts:
        """Return what the kernels read."""
        touches = np.concatenate([np.zeros(0, TOUCH), *self._touches])
        return Contacts(
            np.array(self._sets, CONTACT_SET).reshape(-1),
            np.concatenate([np.zeros(0, END), *self._ends]),
            touches,
            np.zeros(len(touches), KEPT),
            np.zeros(self._buckets, np.int64),
            np.array(self._never, np.int64).reshape(-1, 2),
            np.concatenate([np.zeros(0, MESH_BOX), *self._boxes]),
            np.concatenate([np.zeros((0, 9)), *self._triangles]),
        )

    def _set(
        self, touch: Touch, shapes: np.ndarray, place: Callable[[int, Any], np.ndarray], bristles: bool
    ) -> int:
        first, second = touch.ends_i, touch.ends_j
        own = sum(map(len, self._ends))
        ends = np.array([place(*end) for end in (first if touch.mutual else first + second)])
        ends["axes"] = np.eye(3).ravel()
        behind = 0 if touch.mutual else len(first)
        bodies = [body for body, _ in (*first, *second)]
        apart = len(first) > 1 or len(second) > 1
        never = [
            (own + i, own + behind + j)
            for i, j in product(range(len(first)), range(len(second)))
            if apart and self._are_joined(bodies[i], bodies[len(first) + j])
        ]
        record = np.zeros((), CONTACT_SET)
        record["first"], record["first_end"] = sum(map(len, self._touches)), own
        record["ends"], record["second_end"] = len(ends), own + behind
        self._ends.append(ends)
        if touch.searched:
            self._search(record, touch, ends, never)
            touches = np.repeat(shapes[:1], record["most"])
        else:
            skipped = set(never)
            pairs = product(range(own, own + behind), range(own + behind, own + len(ends)))
            touches = np.array(
                [_between(shape, *pair) for pair in pairs if pair not in skipped for shape in shapes], TOUCH
            )
            record["count"] = record["most"] = len(touches)
            if bristles:
                touches["bristle"] = self.new_bristles(3 * len(touches)) + 3 * np.arange(len(touches))
        self._touches.append(touches)
        self._sets.append(record)
        return len(self._sets) - 1

    def _are_joined(self, i: int, j: int) -> bool:
        return i == j or (min(i, j) >= 0 and frozenset((i, j)) in self.joined)

    def _search(
        self, record: np.ndarray, touch: Touch, ends: np.ndarray, never: list[tuple[int, int]]
    ) -> None:
        """Fill what a search of pairs needs."""
        behind = record["second_end"] - record["first_end"]
        ends["middle"], ends["bound"] = touch.sphere_j
        ends["middle"][:behind], ends["bound"][:behind] = touch.sphere_i
        largest = ends["bound"].max()
        record["most"], record["skin"] = PAIRS_OF_AN_END * len(ends), SKIN * largest
        record["cell"] = 2.0 * largest + record["skin"]
        record["first_bucket"], record["buckets"] = self._buckets, 2 * len(ends)
        record["first_joined"], record["joined"] = len(self._never), len(never)
        self._buckets += 2 * len(ends)
        self._never += never


def _between(shape: np.ndarray, i: int, j: int) -> np.ndarray:
    record = shape.copy()
    record["end_i"], record["end_j"] = i, j
    return record


def touch_records(touch: Touch) -> np.ndarray:
    """Return TOUCH records (parts,) of two shapes, one for each point of the second that may touch."""
    records = np.zeros(touch.parts, TOUCH)
    records["pair"], records["bristle"] = _OF_BALLS.get(touch.first, CORES), NONE
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
    elif touch.second == "mesh":
        records["offset_j"] = touch.corners
    elif touch.parts == 2:
        records["offset_j"][1] = touch.axis_j
    return records


def fill_contact(records: Any, item: Element) -> Any:
    """Fill the law of the records of a contact; restitution and its speed are in the damping."""
    law = CONTACT._replace(parameters=CONTACT.parameters[:-2])
    return fill_law(records, law, item.with_values(damping=loss_of(item)).values[:-2])


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
