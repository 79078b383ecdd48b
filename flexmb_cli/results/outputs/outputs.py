"""Quantities that lines OUTPUT compute from the rows of a run: relative motion, angles, formulas.

They are datasets `output/NAME` beside those of the analysis, whatever its model and formulation.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...deck.expansion.expressions import FORMULA, Formula, formula
from ...deck.record import Deck
from ...dialects.elements_block.line import OUTPUT, ElementLine, lines_of
from ...dialects.elements_block.words import OUTPUTS
from ...errors import Fault, ModelError, Place
from ..hdf5.layout import Layout, Series, Values
from ..hdf5.result_file import empty_result
from ..quantities.quantities import SHOWS_ALL, Quantity, ResultError, resolve
from . import relative_motion as motion

GROUP = "output"
_OF_POINTS: dict[str, Callable[..., np.ndarray]] = {
    "distance": motion.distance,
    "distance_rate": motion.distance_rate,
    "position": motion.position,
    "velocity": motion.velocity,
}
_ANGLES = {"cardan": motion.cardan, "roll_pitch_yaw": motion.roll_pitch_yaw}


def output_lines(deck: Deck) -> list[ElementLine]:
    """Return the lines OUTPUT of a deck."""
    return [line for line in lines_of(deck) if line.word == OUTPUT]


class Outputs:
    """The outputs of a deck, whose rows come block by block; angles continue those of the block before.

    Raises ModelError for bodies and quantities that the result lacks.
    """

    def __init__(self, deck: Deck, layout: Layout):
        self.lines = output_lines(deck)
        self._refuse_unknown_bodies(layout)
        series = tuple(map(_series, self.lines))
        self.layout = replace(layout, series=(*layout.series, *series))
        self._before = [motion.Continued() for _ in self.lines]
        variables = {name: float(number.value) for name, number in deck.variables.items()}
        self._formulas = _Formulas(deck, self.layout, self.lines, variables)

    def _refuse_unknown_bodies(self, layout: Layout) -> None:
        count = next((len(axis.values) for axis in layout.axes if axis.path == "body/body"), 0)
        faults = [
            Fault(
                "error",
                f"body {number.value} is outside 0..{count}",
                number.place,
                line.subject,
                id="RESULT-110",
            )
            for line in self.lines
            for number in line.numbers
            if number.key in ("body", "axes", "from.body", "to.body") and not 0 <= number.value <= count
        ]
        if faults:
            raise ModelError(faults)

    def of(self, values: Values) -> Values:
        """Return a block of values, by the paths of their datasets, with the outputs."""
        series = dict(values)
        for line, before in zip(self.lines, self._before, strict=True):
            if line.kind == FORMULA:
                rows = self._formulas.value(line, series)
            else:
                rows = _measured(line, series, before)
            series[_path(line)] = rows
        return series


def _path(line: ElementLine) -> str:
    return f"{GROUP}/{line.subject}"


def _place_of(line: ElementLine, name: str) -> Place | None:
    """Return where a formula names a quantity."""
    place = line.place_of(FORMULA)
    start = line.at(FORMULA).text.find(name)
    return place._replace(column=place.column + start, width=len(name)) if place and start >= 0 else place


def _series(line: ElementLine) -> Series:
    meaning, unit, vector = OUTPUTS[line.kind][:3]
    return Series(_path(line), ("xyz",) if vector else (), unit, meaning)


def _measured(line: ElementLine, values: Values, before: motion.Continued) -> np.ndarray:
    """Return rows of a relative motion."""
    frame = motion.motion_of(values, line["axes"])
    if line.kind in _OF_POINTS:
        ends = (motion.motion_of(values, line[f"{end}.body"], line.vector(end)) for end in ("from", "to"))
        return _OF_POINTS[line.kind](*ends, frame)
    body = motion.motion_of(values, line["body"])
    omega = motion.angular_velocity(body, frame)
    if line.kind == "angular_velocity":
        return omega
    turned = np.swapaxes(frame.axes, 1, 2) @ body.axes
    if line.kind in _ANGLES:
        angles, rates = _ANGLES[line.kind](turned, omega)
        return before.of(values["time"], angles, rates, motion.nearest_angles)
    return before.of(values["time"], motion.rotation_vector(turned), omega, motion.nearest_rotation)


class _Formulas:
    """The formulas, and where the quantities that they name stand.  Raises ModelError."""

    def __init__(self, deck: Deck, layout: Layout, lines: Sequence[ElementLine], variables: dict[str, float]):
        self.variables, self.lines = variables, [line for line in lines if line.kind == FORMULA]
        self.parsed: dict[str, Formula] = {line.subject: formula(line[FORMULA]) for line in self.lines}
        self.places: dict[str, Quantity] = {}
        lacking = {name for one in self.parsed.values() for name in one.names if name not in variables}
        if lacking:
            with empty_result(deck, layout) as result:
                faults = [fault for line in self.lines for fault in self._resolved(line, result, lines)]
            if faults:
                raise ModelError(faults)

    def _resolved(self, line: ElementLine, result: Any, lines: Sequence[ElementLine]) -> list[Fault]:
        """Look up what a formula names; return the faults."""
        faults = []
        outputs = [other.subject for other in lines]
        for name in self.parsed[line.subject].names:
            if name in self.variables:
                continue
            own = f"{GROUP}.{name}" if name.partition(".")[0] in outputs else name
            place = _place_of(line, name)
            try:
                quantities = resolve(result, [own])
            except ResultError as failure:
                message = f"the formula names {str(failure).removesuffix(SHOWS_ALL)}"
                faults.append(Fault("error", message, place, line.subject, id="RESULT-111"))
                continue
            if len(quantities) > 1:
                shown = ", ".join(quantity.name for quantity in quantities[:4])
                message = f"{name} is more than one number: {shown} …; name one"
                faults.append(Fault("error", message, place, line.subject, id="RESULT-112"))
            elif quantities[0].dataset in map(_path, lines[outputs.index(line.subject) :]):
                message = f"the output {name} must be given on a line above"
                faults.append(Fault("error", message, place, line.subject, id="RESULT-113"))
            self.places[name] = quantities[0]
        return faults

    def value(self, line: ElementLine, values: Values) -> np.ndarray:
        """Return the rows of a formula (rows,)."""

        def of(name: str) -> Any:
            if name in self.variables:
                return self.variables[name]
            place = self.places[name]
            index: tuple[Any, ...] = (slice(None), *place.index)
            return values[place.dataset][index]

        return np.broadcast_to(self.parsed[line.subject].value(of), len(values["time"])).astype(float)
