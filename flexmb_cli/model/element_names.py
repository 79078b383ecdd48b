"""Names and units of springs and elements in results, in the order of their loads."""

from collections.abc import Iterator

from .joints import ANGLE
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


def element_names(model: DynamicModel) -> list[tuple[str, str]]:
    """Name of every element and unit of its coordinate, "m" or "rad"."""
    return list(_names(model))


def _names(model) -> Iterator[tuple[str, str]]:
    elements = model.elements
    for item in model.springs:
        yield item.name, LENGTH
    for item in elements.springs:
        yield item.name, TURN if item.coordinate == ANGLE else LENGTH
    for item in elements.lines:
        yield item.name, LENGTH
    for item in elements.stops:
        yield item.name, TURN if item.coordinate == ANGLE else LENGTH
    for item in elements.bushings:
        for part, unit in _BUSHING:
            yield f"{item.name} {part}", unit
    for item in elements.frictions:
        yield item.name, LENGTH
