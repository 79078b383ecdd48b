"""Limits of the formulation of a tree in absolute coordinates."""

from typing import TYPE_CHECKING, Any

from ...errors import Fault, ModelError
from ..tree import INERTIAL, ROTATION, Hinge, Tree

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..tree import Motor, Spring

OTHERWISE = "run the deck by --formulation kane"


def refuse_foreign(tree: Tree) -> None:
    """Raise ModelError with every item of the tree that only Kane's equations can treat here."""
    faults = [fault for find in (_one_way, _weights, _dampers, _motors) for fault in find(tree)]
    if faults:
        raise ModelError(faults)


def _one_way(tree: Tree) -> "Iterator[Any]":
    if tree.one_way:
        message = (
            "the one-way assumption (UNCO) is no equation of mechanics that absolute coordinates could "
            f"share; {OTHERWISE}, or leave out UNCO"
        )
        yield Fault("error", message, id="MODEL-006")


def _weights(tree: Tree) -> "Iterator[Any]":
    """Yield a fault for geometric stiffening by gravity: the floating frame has that by rotation only."""
    for body in tree.bodies:
        stiffened = body.elastic is not None and body.elastic.stiffened_from is not None
        if stiffened and any(tree.gravity):
            message = (
                "GSTF with gravity: in absolute coordinates a beam is stiffened by turning only; set GRAV "
                f"to zero, or {OTHERWISE}"
            )
            yield Fault("error", message, body.place, body.name, id="MODEL-007")


def _dampers(tree: Tree) -> "Iterator[Any]":
    for spring in tree.springs:
        if spring.motion == ROTATION and len(tree.hinges[spring.body].rotations) == 3:
            yield _foreign_hinge(tree, spring, "damper", "three free rotations")


def _motors(tree: Tree) -> "Iterator[Any]":
    """The angular velocities of three free rotations are no rates of coordinates."""
    for motor in tree.motors:
        hinge = tree.hinges[motor.body]
        if hinge.parent != INERTIAL and motor.motion == ROTATION and len(hinge.rotations) == 3:
            yield _foreign_hinge(tree, motor, "motor", "a moving parent and three free rotations")


def has_fixed_axis(tree: Tree, motor: "Motor") -> bool:
    """Return whether a motor's axis rests, or is shared by both bodies of its hinge at all times."""
    hinge = tree.hinges[motor.body]
    alone = motor.motion == ROTATION or len(hinge.translations) == 1
    return hinge.parent == INERTIAL or (alone and has_shared_axis(hinge, motor.axis))


def has_shared_axis(hinge: Hinge, axis: int) -> bool:
    """Return whether an axis of P_k is fixed in the body, too: nothing turns, or only about that axis."""
    return hinge.rotations in ((), (axis,))


def _foreign_hinge(tree: Tree, item: "Motor | Spring", kind: str, what: str) -> Fault:
    message = f"a {kind} in a hinge with {what} is not carried over to absolute coordinates; {OTHERWISE}"
    return Fault("error", message, item.place, f"{kind} of {tree.bodies[item.body].name}", id="MODEL-008")
