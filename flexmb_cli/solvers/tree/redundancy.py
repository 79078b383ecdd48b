"""Messages about redundant closures and couplings of a tree: rows that others hold, too."""

import numpy as np

from ...errors import Fault
from ...model.joint_elements import Coupling
from ...model.tree import Closure, Tree
from ...model.tree_as_mechanism.planar_tree import repeated_in_planar_tree

SHOWN = 6


def closed_rows(tree: Tree) -> list[tuple[str, Closure | Coupling]]:
    """Return names and owners of the closed directions and couplings, in the order of their rows."""
    directions = [(closure, axis) for closure in tree.closures for axis in closure.directions]
    rows: list[tuple[str, Closure | Coupling]] = [
        (f"{closure.name} direction {axis}", closure) for closure, axis in directions
    ]
    return rows + [(item.name, item) for item in tree.elements.couplings]


def repetition(tree: Tree, repeated: np.ndarray) -> Fault | None:
    """A note where a planar tree repeats what it must, else a warning; None where nothing is repeated.

    `repeated` (R,): which of the closed directions and couplings, in their order, depend on others.
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
    found = [row for row, again in zip(closed_rows(tree), repeated, strict=True) if again]
    shown = ", ".join(name for name, _ in found[:SHOWN]) + (" and others" if count > SHOWN else "")
    coupled = bool(tree.elements.couplings)
    message = (
        f"{count} of {repeated.size} closed directions{' and couplings' * coupled} "
        f"repeat{'s' * (count == 1)} others: {shown}; the motion is unique, forces along them are taken as "
        f"0; leave {'them' if coupled else 'their flags'} out"
    )
    return Fault("warning", message, found[0][1].place, found[0][1].name, id="SOLVE-036")
