"""Mechanism → structured arrays for the kernels, and equation and coordinate ↔ name.

Equations stand in YOUNG's order (tables 6.1 and 6.2): joints, simplified, distance, drivers,
ground, normalisation.  Coordinates are x, y, z, e0, e1, e2, e3 body by body.
"""

import math
from dataclasses import dataclass, field, replace
from operator import is_
from typing import Any

import numpy as np

from ...errors import Place
from ..attitudes import Attitudes, held_coordinate
from ..joints import (
    BY_NAME,
    DISTANCE,
    DRIVER,
    NORMALISATION,
    PITCH,
    SIMPLIFIED,
    Equation,
    JointType,
    joint_equations,
)
from ..mechanism import Distance, Driver, Joint, Mechanism
from ..vectors import cross, dot, rotated, rotation_matrix, unit

COINCIDENT = 1e-9  # of the length scale
COORDINATES = ("x", "y", "z", "e0", "e1", "e2", "e3")

CONSTRAINT = np.dtype(
    [
        ("kind", np.int64),  # code of joint_types
        ("body_i", np.int64),  # first body
        ("body_j", np.int64),  # equals body_i where there is only one body
        ("first_row", np.int64),  # first equation in phi and phi_q
        ("coordinate", np.int64),  # 0-6 in COORDINATES (simplified, distance, driver)
        ("screw", np.int64),  # running number of the screw joint
        ("P_i", np.float64, 3),  # joint point of body i, body axes, m
        ("P_j", np.float64, 3),  # joint point of body j, body axes, m
        ("s_i", np.float64, 3),  # unit vector along the axis, body axes of i
        ("s_j", np.float64, 3),  # unit vector along the axis, body axes of j
        ("a_i", np.float64, 3),  # first vector across s_i, body axes of i (vector_pairs)
        ("b_i", np.float64, 3),  # second vector across s_i, body axes of i
        ("h_i", np.float64, 3),  # translational: unit h_i; screw: unit part of h_i across the axis
        ("g_i", np.float64, 3),  # screw: s_i × h_i, unit vector
        ("h_j", np.float64, 3),  # unit vector, body axes of j
        ("C", np.float64),  # value of a constraint, m or 1; driver: C + B t + A t²/2, m or rad
        ("B", np.float64),  # driver: rate at t = 0, m/s or rad/s
        ("A", np.float64),  # driver: acceleration, m/s² or rad/s²
        ("pitch", np.float64),  # screw: advance per radian, m
        ("sense", np.float64),  # screw: sign of the slide, 1 or -1
        ("offset", np.float64),  # screw: delta0 - pitch * theta0, m
    ]
)


@dataclass(frozen=True)
class KinematicArrays:
    """Arrays of a mechanism for the kernels and the solver."""

    constraints: np.ndarray  # (k,) CONSTRAINT
    equations: tuple[Equation, ...]
    q: np.ndarray  # (7 bodies,) estimates
    bodies_of: np.ndarray  # (equations, 2) bodies of the two halves of a Jacobian row
    row_scale: np.ndarray  # (equations,) the unit of each equation: 1 or the length scale
    column_scale: np.ndarray  # (7 bodies,) the same for coordinates
    length: float  # length scale, a power of two, m
    screw_angles: np.ndarray  # (screws,) theta0, rad
    body_names: tuple[str, ...]
    # What follows from all but the functions of the drivers, for variants that differ in these only.
    of_variants: dict[str, Any] = field(default_factory=dict[str, Any], repr=False, compare=False)

    def coordinate_name(self, column: int) -> str:
        """Readable name of a coordinate, such as "body 2 e1"."""
        return f"{self.body_names[column // 7]} {COORDINATES[column % 7]}"


def kinematic_arrays(mechanism: Mechanism) -> KinematicArrays:
    """Arrays of a mechanism whose data have been checked (`build_young`)."""
    global _last
    if not isinstance(mechanism.joints, tuple):  # of a large deck
        return _arrays_of(mechanism)
    parts, drivers = _all_but_functions(mechanism)
    known, known_drivers, arrays = _last
    # Zeros of different signs are equal, but may give different digits: the parts must be the same objects.
    same = arrays is not None and drivers == known_drivers and len(parts) == len(known)
    if arrays is None or not same or not all(map(is_, parts, known)):
        arrays = _arrays_of(mechanism)
        _last = parts, drivers, arrays
    constraints = arrays.constraints.copy()
    driven = constraints["kind"] == DRIVER.code
    functions = [(driver.C, driver.B, driver.A) for driver in mechanism.drivers]
    for name, values in zip("CBA", zip(*functions, strict=True), strict=False):
        constraints[name][driven] = values
    return replace(arrays, constraints=constraints)


def _all_but_functions(mechanism: Mechanism) -> tuple[list[Any], list[Any]]:
    """Return the parts of a mechanism without points and times, and the drivers without their functions."""
    drivers = [(driver.name, driver.body, driver.direction, driver.place) for driver in mechanism.drivers]
    holders = *mechanism.simplified, *mechanism.distances, *mechanism.grounds
    return [*mechanism.bodies, *mechanism.joints, *holders], drivers


# A study makes thousands of mechanisms, most of which differ in a function or a point from the last.
_last: tuple[list[Any], list[Any], KinematicArrays | None] = [], [], None


def _arrays_of(mechanism: Mechanism) -> KinematicArrays:
    length = length_scale(mechanism)
    rows = _Rows(length)
    attitudes = Attitudes(mechanism)
    for joint in mechanism.joints:
        _add_joint(rows, mechanism, joint)
    for held in mechanism.simplified:
        rows.hold(held.name, held.place, held.body, held.direction, held.value)
    for distance in mechanism.distances:
        _add_distance(rows, distance)
    for driver in mechanism.drivers:
        _add_driver(rows, driver)
    for ground in mechanism.grounds:
        for direction, value in enumerate(ground.values, start=1):
            rows.hold(ground.name, ground.place, ground.body, direction, value)
    for body in range(len(mechanism.bodies)):
        _add_normalisation(rows, attitudes, mechanism, body)
    return KinematicArrays(
        constraints=rows.array,
        equations=tuple(rows.equations),
        q=attitudes.estimates(),
        bodies_of=np.array(rows.bodies, dtype=np.int64).reshape(-1, 2),
        row_scale=np.array([e.scale for e in rows.equations]),
        column_scale=np.tile([length] * 3 + [1.0] * 4, len(mechanism.bodies)),
        length=length,
        screw_angles=np.array(rows.screw_angles),
        body_names=tuple(body.name for body in mechanism.bodies),
    )


def length_scale(mechanism: Mechanism) -> float:
    """A power of two near the largest length of the mechanism, so that scaling is exact."""
    lengths = [abs(x) for body in mechanism.bodies for x in body.r]
    lengths += [abs(x) for joint in mechanism.joints for x in (*joint.P_i, *joint.P_j)]
    largest = max(lengths, default=0.0)
    return 2.0 ** round(math.log2(largest)) if largest > 0.0 else 1.0


class _Rows:
    """Collects constraint records and their equations in order."""

    def __init__(self, length: float):
        self.length = length
        self.records: list[Any] = []
        self.equations: list[Any] = []
        self.bodies: list[Any] = []
        self.screw_angles: list[Any] = []

    def add(self, kind: JointType, i: int, j: int, equations: list[Equation], **values: Any) -> None:
        record = np.zeros((), dtype=CONSTRAINT)
        record["kind"], record["body_i"], record["body_j"] = kind.code, i, j
        record["first_row"] = len(self.equations)
        for name, value in values.items():
            record[name] = value
        self.records.append(record)
        self.equations += equations
        self.bodies += [(i, j)] * len(equations)

    @property
    def array(self) -> Any:
        """The records in order; `np.stack` would promote their fields pair by pair."""
        array = np.zeros(len(self.records), dtype=CONSTRAINT)
        for k, record in enumerate(self.records):
            array[k] = record
        return array

    def hold(self, owner: str, place: Place | None, body: int, direction: int, value: float) -> None:
        """A coordinate held at a value; an angle holds e1, e2 or e3 at sin(angle/2)."""
        coordinate, target = held_coordinate(direction, value)
        scale = self.length if coordinate < 3 else 1.0
        part = Equation(owner, COORDINATES[coordinate], place, scale, is_length=coordinate < 3)
        self.add(SIMPLIFIED, body, body, [part], coordinate=coordinate, C=target)


def _add_joint(rows: _Rows, mechanism: Any, joint: Joint) -> None:
    kind = BY_NAME[joint.kind]
    values: dict[str, Any] = {"P_i": joint.P_i, "P_j": joint.P_j}
    if "Q_i" in kind.points:
        values |= {"s_i": unit(joint.s_i), "s_j": unit(joint.s_j)}
        values["a_i"], values["b_i"] = across(values["s_i"])
    if "H_i" in kind.points and kind.size != PITCH:
        values |= {"h_i": unit(joint.h_i), "h_j": unit(joint.h_j)}
    if kind.size == PITCH:
        values |= screw_values(mechanism, joint)
        values["screw"] = len(rows.screw_angles)
        rows.screw_angles.append(values.pop("theta"))
    rows.add(kind, joint.i, joint.j, joint_equations(joint, rows.length), **values)


def across(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """e_m × s and e_n × s, m and n the axes other than that of the largest component of s.

    For s along x the order is z, y, as in rows 11 and 12 of table 6.1.
    """
    largest = int(np.argmax(np.abs(s)))
    m, n = sorted({0, 1, 2} - {largest}, reverse=True)
    axes = np.eye(3)
    return cross(axes[m], s), cross(axes[n], s)


def screw_values(mechanism: Mechanism, joint: Joint) -> dict[str, Any]:
    """Return what the kernel needs of a screw.

    Slide and turn of the deck's own estimates, before assembly, are the zero of the thread.  Its `sense` is
    -1 if P_j lies before P_i: then a positive pitch moves P_j back along the axis.
    """
    s_i = unit(joint.s_i)
    f = unit(np.array(joint.h_i) - dot(joint.h_i, s_i) * s_i)
    g = cross(s_i, f)
    h_j = unit(joint.h_j)
    body_i, body_j = mechanism.bodies[joint.i], mechanism.bodies[joint.j]
    A_i, A_j = rotation_matrix(body_i.p), rotation_matrix(body_j.p)
    d = np.add(body_j.r, rotated(A_j, joint.P_j)) - np.add(body_i.r, rotated(A_i, joint.P_i))
    slide = dot(rotated(A_i, s_i), d)
    # Points that coincide in the estimates leave a slide of round-off, which has no sign to follow.
    sense = -1.0 if slide < -COINCIDENT * length_scale(mechanism) else 1.0
    axis_j = rotated(A_j, h_j)
    theta = math.atan2(dot(rotated(A_i, g), axis_j), dot(rotated(A_i, f), axis_j))
    return {
        "h_i": f,
        "g_i": g,
        "h_j": h_j,
        "pitch": joint.pitch,
        "sense": sense,
        "offset": sense * slide - joint.pitch * theta,
        "theta": theta,
    }


def _add_distance(rows: _Rows, item: Distance) -> None:
    coordinate = item.direction - 1 if item.direction <= 3 else item.direction
    scale = rows.length if coordinate < 3 else 1.0
    part = Equation(item.name, COORDINATES[coordinate], item.place, scale, is_length=coordinate < 3)
    rows.add(DISTANCE, item.i, item.j, [part], coordinate=coordinate, C=item.value)


def _add_driver(rows: _Rows, driver: Driver) -> None:
    function = {"C": driver.C, "B": driver.B, "A": driver.A}
    if driver.direction <= 3:
        part = Equation(
            driver.name, COORDINATES[driver.direction - 1], driver.place, rows.length, is_length=True
        )
        rows.add(DRIVER, driver.body, driver.body, [part], coordinate=driver.direction - 1, **function)
    else:
        parts = [Equation(driver.name, e, driver.place, 1.0) for e in (COORDINATES[driver.direction], "e0")]
        rows.add(DRIVER, driver.body, driver.body, parts, coordinate=driver.direction, **function)


def _add_normalisation(rows: _Rows, attitudes: Attitudes, mechanism: Mechanism, body: int) -> None:
    """|p| = 1 of a body, unless a rotational driver or three held components determine e0.

    With e1, e2, e3 all held and e0 = 0 (a half turn) the normalisation has no slope in e0.
    """
    if body in attitudes.driven:
        return
    item = mechanism.bodies[body]
    if len(attitudes.held[body]) == 3:
        part = Equation(f"{item.name} Euler parameters", "e0", item.place, 1.0)
        rows.add(SIMPLIFIED, body, body, [part], coordinate=3, C=attitudes.e0(body))
    else:
        part = Equation(f"{item.name} Euler parameters", "normalisation", item.place, 1.0)
        rows.add(NORMALISATION, body, body, [part])
