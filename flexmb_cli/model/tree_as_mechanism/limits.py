"""Limits of the formulation of a tree in absolute coordinates."""

from collections.abc import Iterator
from typing import Any

from ...errors import Fault, ModelError
from ..laws import MOTOR
from ..tree import Tree

OTHERWISE = "run the deck by --formulation kane"


def refuse_foreign(tree: Tree) -> None:
    """Raise ModelError with every item of the tree that only Kane's equations can treat here."""
    faults = [fault for find in (_one_way, _weights, _balls) for fault in find(tree)]
    if faults:
        raise ModelError(faults)


def _one_way(tree: Tree) -> Iterator[Any]:
    if tree.one_way:
        message = (
            "the one-way assumption (UNCO) is no equation of mechanics that absolute coordinates could "
            f"share; {OTHERWISE}, or leave out UNCO"
        )
        yield Fault("error", message, id="MODEL-006")


def _weights(tree: Tree) -> Iterator[Any]:
    """Yield a fault for geometric stiffening by gravity: the floating frame has that by rotation only."""
    for body in tree.bodies:
        stiffened = body.elastic is not None and body.elastic.stiffened_from is not None
        if stiffened and any(tree.gravity):
            message = (
                "GSTF with gravity: in absolute coordinates a beam is stiffened by turning only; set GRAV "
                f"to zero, or {OTHERWISE}"
            )
            yield Fault("error", message, body.place, body.name, id="MODEL-007")


def _balls(tree: Tree) -> Iterator[Any]:
    """Yield a fault for what acts about one of three free rotations: none is a coordinate of a position."""
    for item in tree.elements.forces:
        if item.turning and len(tree.hinges[item.measure.joint].rotations) == 3:
            message = (
                f"a {'motor' if item.law is MOTOR else 'damper'} in a hinge with three free rotations is not "
                f"carried over to absolute coordinates; {OTHERWISE}"
            )
            yield Fault("error", message, item.place, item.name, id="MODEL-008")
