"""Joints and drivers of a model that are caught and let go while it moves."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...model.general_joints import GeneralJoint
from ...model.joint_elements import JointDriver
from ...model.time_functions import POLYNOMIAL, Motion, MotionFunction, sum_of
from ...model.tree import Closure


def parts_of(model: Any) -> list[Any]:
    """Return the general joints, drivers and motions of a model; those that are off at the start, too."""
    elements = model.elements
    present = (*elements.generals, *elements.drivers, *getattr(model, "motions", ()))
    return [*present, *elements.later]


def with_parts(model: Any, parts: Sequence[Any]) -> Any:
    """Return a dynamic model, flexible mechanism or tree with these general joints, drivers and motions."""

    def all_of(kind: type) -> tuple[Any, ...]:
        return tuple(part for part in parts if isinstance(part, kind))

    generals = all_of(GeneralJoint)
    elements = replace(model.elements, generals=generals, drivers=all_of(JointDriver), later=())
    changed: dict[str, Any] = {"elements": elements}
    if hasattr(model, "motions"):
        changed["motions"] = all_of(Motion)
    if hasattr(model, "closures"):
        changed["closures"] = tuple(_closures(model.closures, generals))
    return replace(model, **changed)


def _closures(closures: Sequence[Closure], generals: Sequence[GeneralJoint]) -> Iterator[Closure]:
    """Yield closures with those of general joints before those of curves, as rows count them."""
    own = {closure.name: closure for closure in closures if closure.general}
    yield from (c for c in closures if not (c.general or c.curve))
    for joint in generals:
        yield own[joint.name] if joint.turned is None else _caught_closure(joint)
    yield from (c for c in closures if c.curve)


def _caught_closure(joint: GeneralJoint) -> Closure:
    directions, points = tuple(range(1, joint.rows + 1)), (joint.P_j.r0, joint.P_i.r0)
    a, b = (tuple(point.tolist()) for point in points)
    return Closure(
        joint.name,
        joint.j,
        joint.i,
        directions,
        a_point=a,
        b_point=b,
        place=joint.place,
        general=joint,
        turned=joint.turned,
    )


def caught(joint: GeneralJoint, places: np.ndarray, axes: np.ndarray) -> GeneralJoint:
    """Return a joint that holds two bodies as they stand, at places (bodies, 3) with axes (bodies, 3, 3).

    The point of the first body is where that of the second lies.
    """
    (r_i, A_i), (r_j, A_j) = (
        (places[k], axes[k]) if k >= 0 else (np.zeros(3), np.eye(3)) for k in (joint.i, joint.j)
    )
    own = joint.P_j if isinstance(joint.P_j, tuple) else joint.P_j.r0
    point = A_i.T @ (r_j + A_j @ np.array(own) - r_i)
    x, y, z = point.tolist()
    P_i = (x, y, z) if isinstance(joint.P_i, tuple) else replace(joint.P_i, r0=point)
    return replace(joint, P_i=P_i, turned=A_j.T @ A_i)


def shifted(driver: Any, gap: float) -> Any:
    """Return a driver or motion whose function is larger by `gap`, rad or m."""
    constant = MotionFunction(POLYNOMIAL, (gap, 0.0, 0.0, 0.0))
    return replace(driver, function=sum_of((driver.function, constant)))
