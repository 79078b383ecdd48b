"""Names and units of springs and elements in results, in the order of their loads; motors are the last."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from .joint_elements import JointElements, is_angle
from .joints import BY_NAME

if TYPE_CHECKING:
    from .flexible_mechanism import FlexibleMechanism
    from .loads import DynamicModel

LENGTH, TURN = "m", "rad"
_BUSHING = (
    ("x", LENGTH),
    ("y", LENGTH),
    ("z", LENGTH),
    ("about x", TURN),
    ("about y", TURN),
    ("about z", TURN),
)


def element_names(model: "DynamicModel | FlexibleMechanism") -> list[tuple[str, str]]:
    """Name of every spring and element and unit of its coordinate, "m" or "rad"."""
    found = [(item.name, LENGTH) for item in model.springs]
    # Asking for the class would import flexible bodies in runs that have none.
    joints = getattr(model, "joints", ())
    for item in getattr(model, "joint_springs", ()):
        found.append((item.name, _unit(BY_NAME[joints[item.joint].kind].sprung)))
    return found + list(names_of(model.elements))


def names_of(elements: JointElements) -> Iterator[tuple[str, str]]:
    """Name of every element and unit of its coordinate."""
    yield from ((spring.name, _unit(spring.coordinate)) for spring in elements.springs)
    yield from ((line.name, LENGTH) for line in elements.lines)
    yield from ((item.name, _unit(item.coordinate)) for item in elements.laws)
    yield from ((f"{item.name} {part}", unit) for item in elements.bushings for part, unit in _BUSHING)
    yield from ((friction.name, LENGTH) for friction in elements.frictions)
    yield from ((motor.name, _unit(motor.coordinate)) for motor in elements.motors)


def _unit(coordinate: str) -> str:
    return TURN if is_angle(coordinate) else LENGTH
