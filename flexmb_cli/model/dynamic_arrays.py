"""Masses, loads and constraints of a mechanism → structured arrays for the kernels.

A body has seven coordinates x, y, z, e0 … e3 and six speeds: the velocity of its origin in global
axes and its angular velocity in body axes.  The normalisation of the Euler parameters is no
constraint on speeds and is left out of the equations.
"""

from dataclasses import dataclass, replace

import numpy as np

from .arrays import KinematicArrays, kinematic_arrays
from .dynamics import DynamicModel, Table
from .joint_types import NORMALISATION

COORDINATES_OF_BODY, SPEEDS_OF_BODY = 7, 6
FORCE, TORQUE, LINE = 1, 2, 3

MASS = np.dtype(
    [
        ("mass", np.float64),  # kg
        ("moment", np.float64, 3),  # mass times centre of mass, body axes, kg m
        ("inertia", np.float64, (3, 3)),  # about the origin, body axes, kg m²
    ]
)

LOAD = np.dtype(
    [
        ("kind", np.int64),  # FORCE, TORQUE or LINE
        ("body_i", np.int64),
        ("body_j", np.int64),  # equals body_i for forces and torques
        ("following", np.int64),  # 1: the vector is in body axes
        ("table", np.int64),  # number of the table that multiplies the vector, -1 for none
        ("P_i", np.float64, 3),  # points of action, body axes, m
        ("P_j", np.float64, 3),
        ("vector", np.float64, 3),  # N or N m
        ("stiffness", np.float64),  # N/m
        ("free_length", np.float64),  # m
        ("damping", np.float64),  # N s/m
    ]
)


@dataclass(frozen=True)
class DynamicArrays:
    """What the kernels need to know of a dynamic model with n bodies, m equations and 6 n speeds."""

    kinematic: KinematicArrays  # without the normalisation: m equations
    masses: np.ndarray  # (n,) MASS
    loads: np.ndarray  # (k,) LOAD
    tables: np.ndarray  # (knots of all tables, 3): time, value, second derivative
    table_ends: np.ndarray  # (tables + 1,) first knot of each table
    gravity: np.ndarray  # (3,) global axes, m/s²
    row_scale: np.ndarray  # (m,)
    speed_scale: np.ndarray  # (6 n,)

    @property
    def speeds(self) -> int:
        """Number of speeds."""
        return self.speed_scale.size


def dynamic_arrays(model: DynamicModel) -> DynamicArrays:
    """Arrays of a model whose data have been checked."""
    kinematic = _without_normalisation(kinematic_arrays(model.mechanism))
    bodies = len(model.mechanism.bodies)
    tables = [load.table for load in (*model.forces, *model.torques) if load.table is not None]
    knots = [spline(table) for table in tables]
    return DynamicArrays(
        kinematic=kinematic,
        masses=_masses(model, bodies),
        loads=_loads(model),
        tables=np.concatenate(knots) if knots else np.zeros((0, 3)),
        table_ends=np.cumsum([0, *(len(rows) for rows in knots)]),
        gravity=np.array(model.gravity, dtype=float),
        row_scale=kinematic.row_scale,
        speed_scale=np.tile([kinematic.length] * 3 + [1.0] * 3, bodies),
    )


def _without_normalisation(arrays: KinematicArrays) -> KinematicArrays:
    constraints = arrays.constraints
    ends = np.append(constraints["first_row"][1:], len(arrays.equations))
    kept = constraints["kind"] != NORMALISATION.code
    rows = [
        r for c, end in zip(constraints[kept], ends[kept], strict=True) for r in range(c["first_row"], end)
    ]
    counts = (ends - constraints["first_row"])[kept]
    constraints = constraints[kept].copy()
    constraints["first_row"] = np.cumsum(counts) - counts
    return replace(
        arrays,
        constraints=constraints,
        equations=tuple(arrays.equations[row] for row in rows),
        bodies_of=arrays.bodies_of[rows].reshape(-1, 2),
        row_scale=arrays.row_scale[rows],
    )


def _masses(model, bodies):
    masses = np.zeros(bodies, MASS)
    for item in model.masses:
        c = np.array(item.centre)
        about_origin = inertia_matrix(item.inertia) + item.mass * (c @ c * np.eye(3) - np.outer(c, c))
        masses[item.body] = item.mass, item.mass * c, about_origin
    return masses


def inertia_matrix(elements) -> np.ndarray:
    """The tensor (3, 3) of its elements xx, yy, zz, xy, yz, zx."""
    xx, yy, zz, xy, yz, zx = elements
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


def _loads(model):
    records = []
    table = 0
    for kind, items in ((FORCE, model.forces), (TORQUE, model.torques)):
        for item in items:
            record = np.zeros((), LOAD)
            record["kind"], record["body_i"], record["body_j"] = kind, item.body, item.body
            record["following"], record["table"] = item.following, -1
            if item.table is not None:
                record["table"], table = table, table + 1
            record["vector"] = item.force if kind == FORCE else item.torque
            record["P_i"] = item.point if kind == FORCE else 0.0
            records.append(record)
    records += [_line(spring) for spring in model.springs]
    return np.array(records, dtype=LOAD).reshape(-1)


def _line(spring):
    record = np.zeros((), LOAD)
    record["kind"], record["table"] = LINE, -1
    record["body_i"], record["body_j"] = spring.i, spring.j
    for field in ("P_i", "P_j", "stiffness", "free_length", "damping"):
        record[field] = getattr(spring, field)
    return record


def spline(table: Table) -> np.ndarray:
    """Knots (k, 3) of the natural cubic spline through a table: time, value, second derivative."""
    t, y = np.array(table.times), np.array(table.values)
    k = t.size
    second = np.zeros(k)
    if k > 2:
        h = np.diff(t)
        system = np.diag(2.0 * (h[:-1] + h[1:])) + np.diag(h[1:-1], 1) + np.diag(h[1:-1], -1)
        second[1:-1] = np.linalg.solve(system, 6.0 * np.diff(np.diff(y) / h))
    return np.column_stack([t, y, second])
