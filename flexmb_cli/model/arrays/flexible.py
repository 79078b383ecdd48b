"""FlexibleMechanism → the arrays that the kernels of constrained dynamics read."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..flexible_mechanism import FlexibleMechanism, FloatingBody
from .constraint_table import PrimitiveTable
from .element_table import ElementTable, PointJoints, coordinates_of_joints, report_coordinates
from .kinematic import CONSTRAINT
from .node_joints import add_joints, add_motions
from .records import FLEXIBLE, FORCE, MASS, NONE, TORQUE, vector_load
from .system import SystemArrays


def flexible_arrays(mechanism: FlexibleMechanism) -> SystemArrays:
    """Arrays of a mechanism of rigid and flexible bodies, which is at its start undeformed.

    Raises ModelError where a body is to be turned about two axes.
    """
    bodies = mechanism.bodies
    length = length_scale(mechanism)
    table = PrimitiveTable(bodies, length)
    add_joints(table, mechanism)
    add_motions(table, mechanism)
    elements = _elements(table, mechanism)
    loads = elements.loads(_loads(table, mechanism), mechanism.springs)
    first = len(mechanism.forces) + len(mechanism.torques) + len(mechanism.springs)
    signals = elements.signal_arrays(first)
    flexible, modal = _flexible(bodies)
    modes = np.concatenate([np.zeros(0), *(_mode_scale(body, length) for body in bodies)])
    return SystemArrays(
        body_names=tuple(body.name for body in bodies),
        q=np.concatenate([*(np.concatenate([body.r, body.p]) for body in bodies), 0.0 * modes]),
        coordinate_scale=np.concatenate([np.tile([length] * 3 + [1.0] * 4, len(bodies)), modes]),
        speed_scale=np.concatenate([np.tile([length] * 3 + [1.0] * 3, len(bodies)), modes]),
        constraints=np.zeros(0, CONSTRAINT),
        bodies_of=np.zeros((0, 2), np.int64),
        masses=_masses(bodies),
        flexible=flexible,
        modal=modal,
        loads=loads,
        gravity=np.array(mechanism.gravity, dtype=float),
        **signals,
        **table.arrays(),
    )


ROUND_OFF_SHAPE = 1e-9  # of the largest shape: what a mode moves the nodes by that moves inner points alone


def length_scale(mechanism: FlexibleMechanism) -> float:
    """A power of two near the largest length of the mechanism."""
    sizes = [np.abs(body.r).max() for body in mechanism.bodies]
    sizes += [np.abs(body.flexible.r0).max() for body in mechanism.bodies if body.flexible]
    sizes += [np.abs(p.r0).max() for joint in mechanism.joints for p in (*joint.a, *joint.b)]
    largest = max(sizes)
    return 2.0 ** round(math.log2(largest)) if largest > 0.0 else 1.0


def _mode_scale(body: FloatingBody, length: float) -> np.ndarray:
    """The modal coordinates whose largest displacement is `length`, or whose largest rotation is 1 rad."""
    if body.flexible is None:
        return np.zeros(0)
    scale: np.ndarray = np.abs(body.flexible.Phi).max(axis=0)
    if body.flexible.Psi.size:
        scale = np.maximum(scale, length * np.nan_to_num(np.abs(body.flexible.Psi)).max(axis=0))
        # Modes in which no node moves are as large as the others.
        scale = np.maximum(scale, ROUND_OFF_SHAPE * scale.max())
    return length / scale


def _masses(bodies: Sequence[FloatingBody]) -> np.ndarray:
    masses = np.zeros(len(bodies), MASS)
    flexible = 0
    for k, body in enumerate(bodies):
        masses[k] = body.m, body.s0, body.J0, flexible if body.modes else NONE
        flexible += bool(body.modes)
    return masses


def _flexible(bodies: Any) -> tuple[np.ndarray, np.ndarray]:
    """FLEXIBLE records, and the invariants in their order."""
    records, parts, first, at, places = [], [np.zeros(0)], 0, 0, 0
    for k, body in enumerate(bodies):
        invariants, N = body.flexible, body.modes
        if not N:
            continue
        stiffened = body.stiffened and invariants.KG.size > 0
        records.append((k, N, first, at, places, stiffened))
        own = [
            invariants.S1,
            invariants.J1,
            invariants.J2,
            invariants.C0,
            invariants.C1,
            invariants.Mff,
            invariants.Kr,
            invariants.Dr,
        ]
        parts += [np.ravel(array) for array in (*own, *([invariants.KG] if stiffened else []))]
        first += N
        at = sum(map(len, parts))
        places += 12 + 12 * N + (6 + N) ** 2 + 6 + N
    return np.array(records, dtype=FLEXIBLE).reshape(-1), np.concatenate(parts)


def _elements(table: PrimitiveTable, mechanism: FlexibleMechanism) -> Any:
    """The elements, whose equations stand after all others."""
    first = mechanism.elements.first_values
    elements = ElementTable(table, PointJoints(table, mechanism.joints, first), mechanism.elements)
    joints = PointJoints(table.reported(), mechanism.joints)
    report_coordinates(joints, coordinates_of_joints(mechanism.joints))
    elements.add_couplings()
    elements.add_drivers(mechanism.time.start)
    return elements


def _loads(table: PrimitiveTable, mechanism: FlexibleMechanism) -> list[np.ndarray]:
    records = [
        vector_load(FORCE, table.point(f.point), f.force, f.follows, table.factor(f.factor))
        for f in mechanism.forces
    ]
    origin = np.zeros(3)
    return records + [
        vector_load(
            TORQUE,
            table.direction(t.at, origin) if t.at else table.body_vector(t.body, origin),
            t.torque,
            t.follows,
            table.factor(t.factor),
        )
        for t in mechanism.torques
    ]
