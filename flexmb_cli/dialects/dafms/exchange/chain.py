"""A rigid model as a tree that is written as a DAFMS deck: its links, hinges, and the frames O_k and P_k."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ....model.exchange.rigid_model import Refusals, RigidJoint, RigidModel, across
from ....model.mechanism import GROUND

# Free rotations and translations of a hinge of each type; 0 is its axis, one of P_k.
FREE = {
    "fixed": ((), ()), "revolute": ((0,), ()), "universal": ((1, 2), ()), "spherical": ((1, 2, 3), ()),
    "translational": ((), (0,)), "cylindrical": ((0,), (0,)), "free": ((1, 2, 3), (1, 2, 3)),
}  # fmt: skip
_ALONG = 1e-12  # of a unit vector: an axis of the body that lies in that of its hinge


@dataclass(frozen=True)
class Link:
    """A body and the joint it hangs by on body `parent`; without one (None) it is free against the ground.

    `outward`: whether the joint's body j is this one.
    """

    body: int
    parent: int = GROUND
    joint: int | None = None
    outward: bool = True

    def ends(self, joint: RigidJoint) -> tuple[Any, ...]:
        """Points and vectors along the axis, P and s of the parent, then of the body.

        The axis of a joint that is turned round points the other way, so that its coordinates stay the same.
        """
        on_i, on_j = (joint.P_i, joint.s_i), (joint.P_j, joint.s_j)
        if self.outward:
            return *on_i, *on_j
        (P, s), (P_own, s_own) = on_j, on_i
        return P, tuple(-x for x in s), P_own, tuple(-x for x in s_own)


def chain_of(model: RigidModel, refusals: Refusals) -> list[Link]:
    """Return the links, parents first; joints that close loops go to the refusals."""
    links: list[Link] = []
    left, placed = list(range(len(model.bodies))), {GROUND}
    while left:
        link = next(filter(None, (_link(model, body, placed) for body in left)), None) or Link(left[0])
        links.append(link)
        placed.add(link.body)
        left.remove(link.body)
    used = {link.joint for link in links}
    for k, joint in enumerate(model.joints):
        if k not in used:
            refusals.add(joint, "the joint closes a loop; a tree of bodies is an open chain", id="MODEL-017")
    return links


def _link(model: RigidModel, body: int, placed: set[int]) -> Link | None:
    """The first joint that connects a body with those placed, None where there is none."""
    for k, joint in enumerate(model.joints):
        if joint.j == body and joint.i in placed:
            return Link(body, joint.i, k)
        if joint.i == body and joint.j in placed:
            return Link(body, joint.j, k, outward=False)
    return None


@dataclass(frozen=True, eq=False)
class Hanging:
    """A body of the tree: its link, type of hinge, P_k in the parent, and frames as matrices (3, 3).

    `own`: axes of O_k, `frame`: those of P_k, global at the start; `origin` (3,): O_k, global.  `axis`: the
    number of the axis of P_k that a hinge with one axis has.
    """

    link: Link
    kind: str
    point: np.ndarray
    own: np.ndarray
    frame: np.ndarray
    origin: np.ndarray
    axis: int = 3

    def free(self, which: int) -> tuple[int, ...]:
        """Numbers of the free rotations (0) or translations (1)."""
        return tuple(axis or self.axis for axis in FREE[self.kind][which])


def hinge_frame(
    kind: str, parent: int, s: tuple[float, float, float], own: np.ndarray, s_own: tuple[float, float, float]
) -> tuple[Any, Any]:
    """Axes of P_k, global (3, 3): those of the parent, or with the hinge's axes; and the number of one axis.

    `parent`, `own`: matrices of the bodies; s, s_own: vectors along the axis (or arms) in theirs.
    """
    if kind in ("spherical", "fixed"):
        return parent, 3
    first = parent @ np.array(s)
    first = first / np.linalg.norm(first)
    if kind == "universal":
        second = own @ np.array(s_own)
        second = second - (second @ first) * first
        second = second / np.linalg.norm(second)
        return np.column_stack([first, second, np.cross(first, second)]), 3
    for axis in (1, 2, 3):
        if np.linalg.norm(own[:, axis - 1] - first) < _ALONG:
            return own, axis
    side = across(first)
    return np.column_stack([side, np.cross(first, side), first]), 3
