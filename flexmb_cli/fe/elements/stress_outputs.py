"""Stresses that a deck reports, per unit of each mode: of nodes and elements by their numbers."""

from typing import Any

import numpy as np

from ...errors import Fault, ModelError
from ...model.fe_model import StressSelection, VsdfModel
from ...model.flexible_body import FlexibleBody
from ...model.flexible_mechanism import FloatingBody, StressOutput
from .stress_shapes import point_stresses


def stress_outputs(model: VsdfModel, bodies: list[FloatingBody]) -> tuple[StressOutput, ...]:
    """Return what the model reports of its bodies.  Raises ModelError for an element that a body lacks."""
    return tuple(_output(selection, bodies[selection.body].flexible) for selection in model.stresses)


def _output(selection: StressSelection, body: FlexibleBody | None) -> StressOutput:
    assert body is not None and body.stress is not None, "a selection is of a flexible body with a material"
    nodes = np.array(selection.nodes, dtype=np.int64)
    order = np.argsort(body.numbers)
    rows = order[np.searchsorted(body.numbers[order], nodes)]
    elements = _elements(selection, body)
    chosen = _places(selection, body, elements)
    points, volumes = point_stresses(body, chosen)
    return StressOutput(
        selection.body,
        nodes,
        body.stress.nodal[rows],
        elements,
        points,
        volumes,
        selection.largest,
    )


def _elements(selection: StressSelection, body: Any) -> np.ndarray:
    if selection.every_element:
        found: np.ndarray = body.stress.numbers
        return found
    return np.array(selection.elements, dtype=np.int64)


def _places(selection: StressSelection, body: Any, elements: Any) -> np.ndarray:
    """Rows of the body's table of elements."""
    order = np.argsort(body.stress.numbers)
    sorted_numbers = body.stress.numbers[order]
    found = order[np.minimum(np.searchsorted(sorted_numbers, elements), len(order) - 1)]
    missing = elements[body.stress.numbers[found] != elements]
    if missing.size:
        first, last = sorted_numbers[[0, -1]]
        message = f"{body.name} has no element {missing[0]}; its elements are {first} to {last}"
        raise ModelError([Fault("error", message, selection.place, "OUTS", id="FE-071")])
    made: np.ndarray = found
    return made
