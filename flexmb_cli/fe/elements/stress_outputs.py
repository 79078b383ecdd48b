"""Stresses that a deck reports, per unit of each mode: of nodes and elements by their numbers."""

import numpy as np

from ...errors import Fault, ModelError
from ...model.fe_model import StressSelection, VsdfModel
from ...model.flexible_body import FlexibleBody
from ...model.flexible_mechanism import FloatingBody, StressOutput
from .stress_shapes import point_stresses


def stress_outputs(model: VsdfModel, bodies: list[FloatingBody]) -> tuple[StressOutput, ...]:
    """Return what the model reports of its bodies.  Raises ModelError for an element that a body lacks."""
    return tuple(_output(selection, bodies[selection.body].flexible) for selection in model.stresses)  # type: ignore[arg-type]


def _output(selection: StressSelection, body: FlexibleBody) -> StressOutput:
    nodes = np.array(selection.nodes, dtype=np.int64)
    order = np.argsort(body.numbers)
    rows = order[np.searchsorted(body.numbers[order], nodes)]
    named = _rows(body, _named_elements(selection, body))
    chosen = np.arange(len(body.stress.numbers)) if selection.every_element else named  # type: ignore[union-attr]
    elements = body.stress.numbers[chosen]  # type: ignore[union-attr]
    points, volumes = point_stresses(body, chosen)
    return StressOutput(
        selection.body,
        nodes,
        body.stress.nodal[rows],  # type: ignore[union-attr]
        elements,
        points,
        volumes,
        selection.largest,
    )


def _named_elements(selection: StressSelection, body: FlexibleBody) -> np.ndarray:
    """Return the numbers of the elements that the deck names.  Raises ModelError where the body lacks one."""
    numbers = body.stress.numbers  # type: ignore[union-attr]
    elements = np.array(selection.elements, dtype=np.int64)
    faults = [
        Fault(
            "error",
            f"{body.name} has no element {elements[k]}; its elements are {numbers.min()} to {numbers.max()}",
            selection.places[k],
            "OUTS",
            id="FE-071",
        )
        for k in np.flatnonzero(~np.isin(elements, numbers))
    ]
    if faults:
        raise ModelError(faults)
    return elements


def _rows(body: FlexibleBody, elements: np.ndarray) -> np.ndarray:
    """Return the rows of elements in the body's table."""
    numbers = body.stress.numbers  # type: ignore[union-attr]
    order = np.argsort(numbers)
    return order[np.searchsorted(numbers[order], elements)]
