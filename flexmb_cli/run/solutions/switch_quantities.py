"""Quantities of the results at whose values joints and drivers are caught or let go."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...deck.record import Deck
from ...dialects.elements_block.line import has_outputs
from ...errors import Fault, ModelError
from ...model.general_joints import Switch
from ...results.hdf5.layout import Layout, Values
from ...results.hdf5.result_file import empty_result
from ...results.quantities.quantities import SHOWS_ALL, Quantity, ResultError, resolve

SAME_INSTANT = 1e-14  # of the time
OUTPUT_GROUP = "output/"


class Instants:
    """The instants of the switches of a `SwitchedMotion` that quantities cause.

    Raises ModelError for unknown ones.
    """

    def __init__(self, motion: Any, deck: Deck):
        self.motion = motion
        self.before = motion.stage.time  # time of the last row that was looked at, s
        self.looked = outputs_of(deck, motion.layout)
        self.quantities = _quantities(motion.model.elements.switches, deck, motion.layout)

    def _distances(self, block: Values, items: Sequence[Switch]) -> np.ndarray:
        """Return how far (rows, items) each quantity is beyond its value."""
        values = self.looked(block)
        distances = []
        for item in items:
            place = self.quantities[item.name]
            index: tuple[Any, ...] = (slice(None), *place.index)
            distances.append((values[place.dataset][index] - item.value) * (1.0 if item.rising else -1.0))
        return np.array(distances).reshape(len(items), -1).T

    def until_reached(
        self, block: dict[str, np.ndarray], waiting: Sequence[Switch], present: Mapping[str, Any]
    ) -> tuple[dict[str, np.ndarray], Any]:
        """The rows before a quantity reaches its value; the times of the last and the next row, switches."""
        items = [one for one in waiting if one.quantity and one.catches != (one.part in present)]
        if not items:
            return block, None
        beyond = self._distances(block, items) >= 0.0
        row = int(np.argmax(beyond.any(axis=1))) if beyond.any() else len(beyond)
        if row == len(beyond):
            self.before = float(block["time"][-1])
            return block, None
        last = self.before if row == 0 else float(block["time"][row - 1])
        hit = [item for item, reached in zip(items, beyond[row], strict=True) if reached]
        return {path: values[:row] for path, values in block.items()}, (last, float(block["time"][row]), hit)

    def of(self, last: float, row: float, hit: Sequence[Switch]) -> tuple[Values, list[Switch]]:
        """Bring the motion to the first instant between two rows; return its block, and switches there."""
        from scipy.optimize import brentq

        motion, stage = self.motion, self.motion.stage
        near, block = motion.moved_to(stage, sorted({stage.time, max(last, stage.time)}))
        if row <= near.time:
            return block, list(hit)

        def beyond(time: float, item: Switch) -> float:
            block = motion.moved_to(near, sorted({near.time, max(time, near.time)}))[1]
            return float(self._distances(block, [item])[-1, 0])

        crossings = [
            (float(brentq(beyond, near.time, row, (item,), xtol=SAME_INSTANT * abs(row))), k)
            for k, item in enumerate(hit)
        ]
        time = min(crossings)[0]
        block = motion.moved_to(near, sorted({near.time, max(time, near.time)}))[1]
        return block, [hit[k] for instant, k in crossings if instant == time]


def without_outputs(layout: Layout) -> Layout:
    """Return the layout without the outputs of the deck."""
    return replace(
        layout, series=tuple(one for one in layout.series if not one.path.startswith(OUTPUT_GROUP))
    )


def outputs_of(deck: Deck, layout: Layout) -> Any:
    """Return the function that adds the outputs of a deck to a block of values."""
    if not has_outputs(deck):
        return lambda values: values
    layout = without_outputs(layout)
    from ...results.outputs.outputs import Outputs

    return Outputs(deck, layout).of


def _quantities(switches: Sequence[Switch], deck: Deck, layout: Layout) -> dict[str, Quantity]:
    """Return the quantities of switches, by the names of these.  Raises ModelError."""
    of_name, faults = {}, []
    with empty_result(deck, layout) as result:
        for item in switches:
            if not item.quantity:
                continue
            own = f"{OUTPUT_GROUP}{item.quantity}".replace("/", ".")
            known = {series.path.replace("/", ".") for series in layout.series}
            try:
                one, *others = resolve(result, [own if own in known else item.quantity])
            except ResultError as failure:
                message = f"the line names {str(failure).removesuffix(SHOWS_ALL)}"
                faults.append(Fault("error", message, item.place, item.name, id="SOLVE-190"))
                continue
            if others:
                message = f"{item.quantity} is more than one number, {one.name} and others; name one"
                faults.append(Fault("error", message, item.place, item.name, id="SOLVE-191"))
            of_name[item.name] = one
    if faults:
        raise ModelError(faults)
    return of_name
