"""Models under a share of their loads, and at other times, for equilibria that loads are stepped to."""

from dataclasses import replace
from typing import Any

from ..model.joint_elements import JointElements
from ..model.laws import DRIVING, Element
from ..model.mechanism import TimeGrid
from ..model.time_functions import POLYNOMIAL, MotionFunction, is_signal, product_of
from ..model.tree import Body, Tree


def with_loads(model: Any, share: float) -> Any:
    """Return a dynamic model, flexible mechanism or tree under `share` times its loads.

    Loads are gravity, forces and torques, those of functions of time, too.  Springs, drivers and efforts
    that signals give stay as they are.
    """
    if share == 1.0:
        return model
    model = replace(model, gravity=_times(share, model.gravity), elements=_elements(share, model.elements))
    if isinstance(model, Tree):
        bodies = tuple(_body(share, body) for body in model.bodies)
        torques = tuple(replace(one, function=_function(share, one.function)) for one in model.torques)
        return replace(model, bodies=bodies, torques=torques)
    return replace(
        model,
        forces=tuple(replace(one, force=_times(share, one.force)) for one in model.forces),
        torques=tuple(replace(one, torque=_times(share, one.torque)) for one in model.torques),
    )


def with_grid(model: Any, grid: TimeGrid) -> Any:
    """Return a model with other report times."""
    if hasattr(model, "mechanism"):
        return replace(model, mechanism=replace(model.mechanism, time=grid))
    return replace(model, time=grid)


def grid_of(model: Any) -> TimeGrid:
    """Return the report times of a model."""
    return model.mechanism.time if hasattr(model, "mechanism") else model.time


def _times(share: float, vector: Any) -> Any:
    x, y, z = vector
    return share * x, share * y, share * z


def _function(share: float, function: MotionFunction) -> MotionFunction:
    constant = MotionFunction(POLYNOMIAL, (share, 0.0, 0.0, 0.0))
    return function if is_signal(function) else product_of((constant, function))


def _elements(share: float, elements: JointElements) -> JointElements:
    def scaled(item: Element) -> Element:
        if item.law not in DRIVING or item["function"] is None:
            return item
        return item.with_values(function=_function(share, item["function"]))

    return replace(elements, forces=tuple(scaled(item) for item in elements.forces))


def _body(share: float, body: Body) -> Body:
    elastic = body.elastic
    if elastic is not None:
        elastic = replace(elastic, forces=share * elastic.forces)
    force, torque = _times(share, body.force), _times(share, body.torque)
    return replace(body, elastic=elastic, force=force, torque=torque)
