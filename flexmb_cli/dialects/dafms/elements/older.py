"""Cards SPRI, DAMP, MOTR and TABM of decks with newer elements, as elements like these.

So results and the energy audit hold all elements of a deck.
"""

from ....model.joint_elements import JointMotor, JointSpring
from ....model.time_functions import HELD_TABLE, POLYNOMIAL, MotionFunction
from ....model.tree import ROTATION, Motor, Spring, Table, Tree
from ....quick_dataclass import replace


def with_older_elements(tree: Tree) -> Tree:
    """Return the tree with its springs, dampers and motors before its elements of the same types."""
    springs = tuple(_joint_spring(item) for item in tree.springs if not _turns_freely(tree, item))
    motors = tuple(_joint_motor(item) for item in tree.motors if not _turns_freely(tree, item))
    elements = tree.elements
    return replace(
        tree,
        springs=tuple(item for item in tree.springs if _turns_freely(tree, item)),
        motors=tuple(item for item in tree.motors if _turns_freely(tree, item)),
        elements=replace(elements, springs=(*springs, *elements.springs), motors=(*motors, *elements.motors)),
    )


def _turns_freely(tree: Tree, item: Spring | Motor) -> bool:
    """Return whether an item acts about one of three free rotations: none of these is an angle."""
    return item.motion == ROTATION and len(tree.hinges[item.body].rotations) == 3


def _joint_spring(item: Spring) -> JointSpring:
    coordinate = f"{item.motion} {item.axis}"
    return JointSpring(
        item.name, item.body, coordinate, item.stiffness, item.rest, item.damping, place=item.place
    )


def _joint_motor(item: Motor) -> JointMotor:
    coordinate = f"{item.motion} {item.axis}"
    return JointMotor(item.name, item.body, coordinate, _function(item.function), item.place)


def _function(table: Table) -> MotionFunction:
    if len(table.times) == 1:
        return MotionFunction(POLYNOMIAL, (table.values[0], 0.0, 0.0, 0.0))
    # Past a jump at its end a table continues: its last piece must have a length.
    times, values = (*table.times, table.times[-1] + 1.0), (*table.values, table.values[-1])
    return MotionFunction(HELD_TABLE, times=times, values=values, curvature=(0.0,) * len(times))
