"""Masses, loads and constraints of a mechanism → structured arrays for the kernels.

A body has seven coordinates x, y, z, e0 … e3 and six speeds: the velocity of its origin in global
axes and its angular velocity in body axes.  The normalisation of the Euler parameters is no
constraint on speeds and is left out of the equations.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ..joints import NORMALISATION
from ..loads import DynamicModel
from .constraint_table import PrimitiveTable
from .kinematic import KinematicArrays, kinematic_arrays
from .records import FLEXIBLE, FORCE, GROUP, MASS, NONE, TORQUE, vector_load
from .system import SystemArrays
from .young_elements import without_driven, young_elements

FEW_BODIES = 4.0


@dataclass(frozen=True)
class DynamicArrays(SystemArrays):
    """The arrays of a dynamic model of a YOUNG deck; `kinematic` without the normalisation."""

    kinematic: KinematicArrays


def dynamic_arrays(model: DynamicModel) -> DynamicArrays:
    """Arrays of a model whose data have been checked."""
    mechanism = without_driven(model.mechanism, model.elements)
    kinematic = _without_normalisation(kinematic_arrays(mechanism))
    bodies = len(mechanism.bodies)
    table = PrimitiveTable(
        mechanism.bodies, kinematic.length, len(kinematic.equations), kinematic.screw_angles
    )
    elements = young_elements(table, model)
    loads = elements.loads(_loads(table, model), model.springs)
    signals = elements.signal_arrays(len(model.forces) + len(model.torques) + len(model.springs))
    collected = table.arrays()
    return DynamicArrays(
        body_names=kinematic.body_names,
        equations=(*kinematic.equations, *collected.pop("equations")),
        q=kinematic.q,
        coordinate_scale=kinematic.column_scale,
        speed_scale=np.tile([kinematic.length] * 3 + [1.0] * 3, bodies),
        row_scale=np.concatenate([kinematic.row_scale, collected.pop("row_scale")]),
        constraints=kinematic.constraints,
        bodies_of=kinematic.bodies_of,
        groups=np.concatenate([_groups(kinematic), collected.pop("groups")]),
        masses=_masses(model, bodies),
        flexible=np.zeros(0, FLEXIBLE),
        modal=np.zeros(0),
        loads=loads,
        **signals,
        gravity=np.array(model.gravity, dtype=float),
        kinematic=kinematic,
        **collected,
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


def _groups(arrays: KinematicArrays) -> np.ndarray:
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
    others = constraints["kind"] != NORMALISATION.code
    rows = [
        r
        for c, end in zip(constraints[others], ends[others], strict=True)
        for r in range(c["first_row"], end)
    ]
    counts = (ends - constraints["first_row"])[others]
    constraints = constraints[others].copy()
    constraints["first_row"] = np.cumsum(counts) - counts
    return replace(
        arrays,
        constraints=constraints,
        equations=tuple(arrays.equations[row] for row in rows),
        bodies_of=arrays.bodies_of[rows].reshape(-1, 2),
        row_scale=arrays.row_scale[rows],
    )


def _masses(model: DynamicModel, bodies: int) -> np.ndarray:
    masses = np.zeros(bodies, MASS)
    masses["flexible"] = NONE
    for item in model.masses:
        c = np.array(item.centre)
        about_origin = inertia_matrix(item.inertia) + item.mass * (c @ c * np.eye(3) - np.outer(c, c))
        masses[item.body] = item.mass, item.mass * c, about_origin, NONE
    return masses


def inertia_matrix(elements: tuple[float, ...]) -> np.ndarray:
    """The tensor (3, 3) of its elements xx, yy, zz, xy, yz, zx."""
    xx, yy, zz, xy, yz, zx = elements
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


def _loads(table: PrimitiveTable, model: DynamicModel) -> list[np.ndarray]:
    """LOAD records of forces and torques."""
    records = [
        vector_load(FORCE, table.body_vector(f.body, f.point), f.force, f.following, table.factor(f.factor))
        for f in model.forces
    ]
    origin = np.zeros(3)
    return records + [
        vector_load(TORQUE, table.body_vector(t.body, origin), t.torque, t.following, table.factor(t.factor))
        for t in model.torques
    ]
