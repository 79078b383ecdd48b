"""Messages about redundant closures of a tree: directions that other closures hold, too."""

import numpy as np

from ...errors import Fault
from ...model.tree import Tree
from ...model.tree_as_mechanism.planar_tree import repeated_in_planar_tree

SHOWN = 6


def repetition(tree: Tree, repeated: np.ndarray) -> Fault | None:
    """A note where a planar tree repeats what it must, else a warning; None where nothing is repeated.

    `repeated` (R,): which of the closed directions, in their order, depend on others.
    """
    count = int(np.sum(repeated))
    if not count:
        return None
    if count == repeated_in_planar_tree(tree):
        message = (
            f"planar tree: {count} of {repeated.size} closed directions repeat{'s' * (count == 1)} others, "
            "the one across the plane of each loop; the motion is unique, forces along it are taken as 0"
        )
        return Fault("note", message, id="SOLVE-035")
    rows = [(closure, axis) for closure in tree.closures for axis in closure.directions]
    found = [row for row, again in zip(rows, repeated, strict=True) if again]
    names = [f"{closure.name} direction {axis}" for closure, axis in found]
    shown = ", ".join(names[:SHOWN]) + (" and others" if count > SHOWN else "")
    message = (
        f"{count} of {repeated.size} closed directions repeat{'s' * (count == 1)} others: {shown}; the "
        "motion is unique, forces along them are taken as 0; leave their flags out"
    )
    return Fault("warning", message, found[0][0].place, found[0][0].name, id="SOLVE-036")
