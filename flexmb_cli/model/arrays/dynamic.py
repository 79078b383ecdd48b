"""Masses, loads and constraints of a mechanism → structured arrays for the kernels.

A body has seven coordinates x, y, z, e0 … e3 and six speeds: the velocity of its origin in global
axes and its angular velocity in body axes.  The normalisation of the Euler parameters is no
constraint on speeds and is left out of the equations.
"""

import math

import numpy as np

from ...quick_dataclass import dataclass, replace
from ..joints import NORMALISATION
from ..loads import DynamicModel, Table
from ..time_functions import HELD_TABLE
from .kinematic import KinematicArrays, kinematic_arrays
from .records import (
    FLEXIBLE,
    FORCE,
    GROUP,
    LAW,
    LINE,
    LOAD,
    MASS,
    MEASURE,
    NONE,
    TORQUE,
    ArmTable,
    blank_load,
    law_record,
    line_measure,
)
from .system import SystemArrays

FEW_BODIES = 4.0


@dataclass(frozen=True)
class DynamicArrays(SystemArrays):
    """The arrays of a dynamic model of a YOUNG deck; `kinematic` without the normalisation."""

    kinematic: KinematicArrays


def dynamic_arrays(model: DynamicModel) -> DynamicArrays:
    """Arrays of a model whose data have been checked."""
    kinematic = _without_normalisation(kinematic_arrays(model.mechanism))
    bodies = len(model.mechanism.bodies)
    loads, arms, lines, laws, knots = _loads(model)
    records, shapes = arms.arrays()
    return DynamicArrays(
        body_names=kinematic.body_names,
        equations=kinematic.equations,
        q=kinematic.q,
        turns=kinematic.screw_angles,
        coordinate_scale=kinematic.column_scale,
        speed_scale=np.tile([kinematic.length] * 3 + [1.0] * 3, bodies),
        row_scale=kinematic.row_scale,
        constraints=kinematic.constraints,
        bodies_of=kinematic.bodies_of,
        groups=_groups(kinematic),
        masses=_masses(model, bodies),
        flexible=np.zeros(0, FLEXIBLE),
        modal=np.zeros(0),
        arms=records,
        shapes=shapes,
        measures=lines,
        loads=loads,
        laws=laws,
        knots=knots,
        gravity=np.array(model.gravity, dtype=float),
        kinematic=kinematic,
    )


def step_length_scale(model: DynamicModel, length: float) -> float:
    """Return the length that errors of steps are measured by, m, at most the mechanism's `length`.

    That of a long chain is a few bodies of it: what its end is off must not grow with where it stands.
    """
    mechanism = model.mechanism
    grounds = {ground.body for ground in mechanism.grounds}
    points = [(m.body, m.centre) for m in model.masses]
    points += [(body, P) for j in mechanism.joints for body, P in ((j.i, j.P_i), (j.j, j.P_j))]
    reach = max((abs(x) for body, P in points if body not in grounds for x in P), default=0.0)
    return min(length, FEW_BODIES * 2.0 ** round(math.log2(reach))) if reach > 0.0 else length


def _groups(arrays: KinematicArrays):
    """Every constraint is a group of its own."""
    constraints = arrays.constraints
    groups = np.zeros(len(constraints), GROUP)
    groups["first_row"] = constraints["first_row"]
    groups["end_row"] = np.append(constraints["first_row"][1:], len(arrays.equations))
    groups["body_i"], groups["body_j"] = constraints["body_i"], constraints["body_j"]
    return groups


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
    masses["flexible"] = NONE
    for item in model.masses:
        c = np.array(item.centre)
        about_origin = inertia_matrix(item.inertia) + item.mass * (c @ c * np.eye(3) - np.outer(c, c))
        masses[item.body] = item.mass, item.mass * c, about_origin, NONE
    return masses


def inertia_matrix(elements) -> np.ndarray:
    """The tensor (3, 3) of its elements xx, yy, zz, xy, yz, zx."""
    xx, yy, zz, xy, yz, zx = elements
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


def _loads(model):
    """LOAD records, and the arms, measures, laws and knots they refer to."""
    arms, records, lines, laws, knots = ArmTable(), [], [], [], [np.zeros((0, 3))]
    for kind, items in ((FORCE, model.forces), (TORQUE, model.torques)):
        for item in items:
            record = blank_load(kind)
            record["following"] = item.following
            record["vector"] = item.force if kind == FORCE else item.torque
            record["arm"] = arms.add(item.body, item.point if kind == FORCE else (0.0,) * 3)
            if item.table is not None:
                record["law"], first = len(laws), sum(map(len, knots))
                knots.append(spline(item.table))
                laws.append(law_record(HELD_TABLE, first=first, last=first + len(knots[-1]) - 1))
            records.append(record)
    for spring in model.springs:
        record = blank_load(LINE)
        record["measure"] = len(lines)
        lines.append(line_measure(arms.add(spring.j, spring.P_j), arms.add(spring.i, spring.P_i)))
        for field in ("stiffness", "free_length", "damping"):
            record[field] = getattr(spring, field)
        records.append(record)
    records, laws = np.array(records, dtype=LOAD).reshape(-1), np.array(laws, dtype=LAW).reshape(-1)
    return records, arms, np.array(lines, dtype=MEASURE).reshape(-1), laws, np.concatenate(knots)


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
