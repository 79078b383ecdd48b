"""Names and units of springs and elements in results, in the order of their loads; motors are the last."""

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
        found.append((item.name, LENGTH if model.joints[item.joint].kind == "translational" else TURN))  # type: ignore[union-attr]
    return found + list(names_of(model.elements))


def names_of(elements: JointElements) -> Iterator[tuple[str, str]]:
    """Name of every element and unit of its coordinate."""
    for item in elements.springs:
        yield item.name, _unit(item.coordinate)
    for item in elements.lines:  # type: ignore[assignment]
        yield item.name, LENGTH
    for item in elements.stops:  # type: ignore[assignment]
        yield item.name, _unit(item.coordinate)
    for item in elements.bushings:  # type: ignore[assignment]
        for part, unit in _BUSHING:
            yield f"{item.name} {part}", unit
    for item in elements.frictions:  # type: ignore[assignment]
        yield item.name, LENGTH
    for item in elements.motors:  # type: ignore[assignment]
        yield item.name, _unit(item.coordinate)


def _unit(coordinate: str) -> str:
    return TURN if is_angle(coordinate) else LENGTH
