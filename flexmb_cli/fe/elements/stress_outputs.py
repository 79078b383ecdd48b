"""Stresses that a deck reports, per unit of each mode: of nodes and elements by their numbers."""

from collections.abc import Sequence

import numpy as np

from ...errors import Fault, ModelError
from ...model.fe_model import StressSelection, VsdfModel
from ...model.flexible_body import FlexibleBody
from ...model.flexible_mechanism import FloatingBody, StressOutput
from .stress_shapes import point_stresses


def stress_outputs(model: VsdfModel, bodies: Sequence[FloatingBody]) -> tuple[StressOutput, ...]:
    """Return what the model reports of its bodies.  Raises ModelError for an element that a body lacks."""
    return tuple(_output(selection, bodies[selection.body].flexible) for selection in model.stresses)


def _output(selection: StressSelection, body: FlexibleBody | None) -> StressOutput:
    assert body is not None and body.stress is not None, "a selection is of a flexible body with a material"
    nodes = np.array(selection.nodes, dtype=np.int64)
    order = np.argsort(body.numbers)
    rows = order[np.searchsorted(body.numbers[order], nodes)]
    numbers = body.stress.numbers
    named = _rows(numbers, _named_elements(selection, body.name, numbers))
    chosen = np.arange(len(numbers)) if selection.every_element else named
    elements = numbers[chosen]
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


def _named_elements(selection: StressSelection, name: str, numbers: np.ndarray) -> np.ndarray:
    """Return the numbers of the elements that the deck names.  Raises ModelError where the body lacks one."""
    elements = np.array(selection.elements, dtype=np.int64)
    faults = [
        Fault(
            "error",
            f"{name} has no element {elements[k]}; its elements are {numbers.min()} to {numbers.max()}",
            selection.places[k],
            "OUTS",
            id="FE-071",
        )
        for k in np.flatnonzero(~np.isin(elements, numbers))
    ]
    if faults:
        raise ModelError(faults)
    return elements


def _rows(numbers: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """Return the rows of elements in the table of all `numbers`."""
    order = np.argsort(numbers)
    found: np.ndarray = order[np.searchsorted(numbers[order], elements)]
    return found
