"""Names and units of springs and elements in results, in the order of their loads."""

from collections.abc import Iterator

from .flexible_mechanism import FlexibleMechanism
from .joint_elements import JointElements, is_angle
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


def element_names(model: DynamicModel | FlexibleMechanism) -> list[tuple[str, str]]:
    """Name of every spring and element and unit of its coordinate, "m" or "rad"."""
    found = [(item.name, LENGTH) for item in model.springs]
    for item in getattr(model, "joint_springs", ()):
        found.append((item.name, LENGTH if model.joints[item.joint].kind == "translational" else TURN))
    return found + list(names_of(model.elements))


def names_of(elements: JointElements) -> Iterator[tuple[str, str]]:
    """Name of every element and unit of its coordinate."""
    for item in elements.springs:
        yield item.name, _unit(item.coordinate)
    for item in elements.lines:
        yield item.name, LENGTH
    for item in elements.stops:
        yield item.name, _unit(item.coordinate)
    for item in elements.bushings:
        for part, unit in _BUSHING:
            yield f"{item.name} {part}", unit
    for item in elements.frictions:
        yield item.name, LENGTH


def _unit(coordinate):
    return TURN if is_angle(coordinate) else LENGTH
