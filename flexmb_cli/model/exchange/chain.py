"""Open chains: a rigid model ordered outward from the ground, a joint for each body."""

from dataclasses import dataclass
from typing import Any

from ..mechanism import GROUND
from .rigid_model import Refusals, RigidJoint, RigidModel


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


def _link(model: RigidModel, body: int, placed: set[int]) -> "Link | None":
    """The first joint that connects a body with those placed, None where there is none."""
    for k, joint in enumerate(model.joints):
        if joint.j == body and joint.i in placed:
            return Link(body, joint.i, k)
        if joint.i == body and joint.j in placed:
            return Link(body, joint.j, k, outward=False)
    return None
