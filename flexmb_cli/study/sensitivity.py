"""Sensitivities: derivatives of quantities of a run by numbers of its deck, in every report row.

Kinematics are differentiated directly (`solvers.kinematics.sensitivities`).  Motions that are integrated are
differences of two runs by the steps of the first (`solvers.step_sequence`), the jumps at contacts and stops
included, by implicit methods of four; equilibria and modes are differences of fourth order.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..deck.record import Number
from ..dialects.settings import SettableDeck
from ..errors import Fault, FlexmbError, ModelError
from ..model.general_joints import refuse_switches
from ..result import OpenDeck, Result
from ..results.hdf5.layout import Layout, Series
from ..results.hdf5.result_file import empty_result
from ..results.quantities.quantities import SHOWS_ALL, Quantity, ResultError, resolve
from ..run.model import model_of
from ..run.outcome import Listener, Outcome, Run, RunOptions
from ..run.python_options import refuse_foreign_method
from ..run.solution import solution_of, with_outputs
from ..run.solutions import Solution
from ..solvers.kinematics.analysis import KinematicAnalysis
from ..solvers.kinematics.inverse_dynamics import InverseDynamics
from ..solvers.kinematics.rows import rows_of
from ..solvers.kinematics.sensitivities import ForkedEquations, neighbouring_states
from ..solvers.linearisation.motion import STENCIL, differentiated, sum_of_pairs
from ..solvers.step_sequence import StepSequence
from .mode_quantities import ModeQuantities, is_mode

# Of a number: steps of differences between motions by the same steps, whose only noise is round-off, on one
# side and on both; of those by implicit methods, whose iterations leave some more; of smooth functions.
OF_ONE_SIDE, OF_EXPLICIT, OF_IMPLICIT, OF_EQUILIBRIUM, OF_KINEMATICS = 1e-7, 3e-6, 1e-4, 1e-3, 2e-4
LEAST_RELATIVE_LENGTH = 0.01  # of the largest length: shorter ones are zeros that were measured or rounded
LEAST_SIZE = {"rad": 0.3, "rad or m": 0.1, "-": 0.1, "": 0.1}  # of angles and pure numbers
OF_ZERO = 0.1  # of the middle one of the numbers in the same unit
Values = Callable[[float], np.ndarray]


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of quantities of a deck's motion by numbers of the deck, in SI units.

    `time` (rows,), s; `of`: the quantities, `to`: the numbers by their names; `values` (rows, of);
    `derivatives` (rows, of, to).
    """

    deck: OpenDeck
    time: np.ndarray
    of: tuple[Quantity, ...]
    to: Mapping[str, Number]
    values: np.ndarray
    derivatives: np.ndarray
    warnings: tuple[Fault, ...] = ()

    @property
    def relative(self) -> np.ndarray:
        """Return p/Q dQ/dp (rows, of, to), the relative change of Q by that of p; nan where Q is 0."""
        p = np.array([float(number.value) for number in self.to.values()])
        with np.errstate(divide="ignore", invalid="ignore"):
            relative_derivatives: np.ndarray = self.derivatives * p / self.values[:, :, None]
        relative_derivatives[~np.isfinite(relative_derivatives)] = np.nan
        return relative_derivatives

    @cached_property
    def result(self) -> Result:
        """Return the same as a Result to save, plot and tabulate: `value.Q`, `derivative.Q.p` and so on."""
        series, arrays = [], {"time": self.time}
        for i, quantity in enumerate(self.of):
            name, unit = quantity.name, quantity.unit
            series.append(Series(f"value/{name}", (), unit, f"{name} of the run"))
            arrays[series[-1].path] = self.values[:, i]
            for k, (number, known) in enumerate(self.to.items()):
                units = _ratio(unit, known.unit)
                series.append(Series(f"derivative/{name}/{number}", (), units, f"d {name}/d {number}"))
                arrays[series[-1].path] = self.derivatives[:, i, k]
                meaning = f"relative change of {name} by that of {number}"
                series.append(Series(f"relative/{name}/{number}", (), "1", meaning))
                arrays[series[-1].path] = self.relative[:, i, k]
        layout = Layout("sensitivity", len(self.time), (), tuple(series))
        return Result(self.deck, arrays, layout, warnings=self.warnings)


def _ratio(*units: str) -> str:
    """Return the unit of a derivative."""
    above, below = (f"({unit})" if set(unit) & set("/ ") else unit.replace("-", "") or "1" for unit in units)
    return above if below == "1" else f"{above}/{below}"


def sensitivity(
    deck: OpenDeck,
    of: Sequence[str],
    to: Sequence[str],
    options: RunOptions | None = None,
    listener: Listener | None = None,
    equilibrium: bool = False,
    at: float | None = None,
) -> Sensitivity:
    """Return the derivatives of the quantities `of` by the numbers `to`; see `interface.sensitivity`.

    of: names as of `flexmb table`, or `mode.1.frequency` and `mode.1.damping` of the state at the time `at`;
    to: names as of `--set`.  equilibrium: of the quantities at rest there.  Raises FlexmbError.
    """
    options = replace(options or RunOptions(), from_equilibrium=equilibrium)
    numbers = _numbers(deck, to)
    of_modes = [name for name in of if is_mode(name)]
    if of_modes and len(of_modes) < len(of):
        message = "frequencies and damping are of one state, other quantities of a run: ask for them apart"
        raise ModelError([Fault("error", message, id="RUN-160")])
    neighbours = _Neighbours(deck, options, numbers, listener or Listener())
    if of_modes:
        solver: Any = ModeQuantities(neighbours.model, of, equilibrium, at)
    elif at is not None:
        message = "a time is for frequencies and damping: other quantities have a row at each report time"
        raise ModelError([Fault("error", message, id="RUN-161")])
    else:
        solution = neighbours.solution()
        quantities = _quantities(neighbours, solution, of)
        solver = (OfEquilibrium if equilibrium else type_of(solution))(
            neighbours.solution, quantities, solution
        )
        neighbours.faults += solution.warnings
    columns = [solver.derivative(name, _scale(deck, number)) for name, number in numbers.items()]
    warnings = (*deck.warnings, *neighbours.faults)
    return Sensitivity(
        deck, solver.time, tuple(solver.quantities), numbers, solver.values, np.stack(columns, axis=2),
        tuple(dict.fromkeys(warnings)),
    )  # fmt: skip


def _numbers(deck: OpenDeck, to: Sequence[str]) -> dict[str, Number]:
    """Return the numbers of these names.  Raises ModelError for unknown ones and for integers."""
    settable, known = SettableDeck(deck.deck), dict(deck.deck.numbers()) | dict(deck.deck.variables)
    faults = []
    for name in to:
        if name not in settable:
            message = f"{settable.unknown(name)}; derivatives are by names of --set"
            faults.append(Fault("error", message, about=name, id="RUN-162"))
        elif not isinstance(known[name].value, float):
            message = f"{name} is a count or a word, by which nothing can be differentiated"
            faults.append(Fault("error", message, known[name].place, about=name, id="RUN-163"))
    if faults:
        raise ModelError(faults)
    return {name: known[name] for name in to}


def _scale(deck: OpenDeck, number: Number) -> float:
    """Return the size of a number: its magnitude; of one near zero a share of others in its unit."""
    same = [one.value for _, one in deck.deck.numbers() if one.unit == number.unit]
    sizes = np.abs([value for value in same if isinstance(value, float) and value != 0.0] or [1.0])
    size = abs(float(number.value))
    if number.unit == "m":
        return max(size, LEAST_RELATIVE_LENGTH * float(sizes.max()))
    return max(size, LEAST_SIZE.get(number.unit, 0.0)) or OF_ZERO * float(np.median(sizes))


@dataclass
class _Neighbours:
    """Models of the deck with another value of one number; `faults`: warnings about the deck's own model."""

    deck: OpenDeck
    options: RunOptions
    numbers: Mapping[str, Number]
    listener: Listener

    def __post_init__(self) -> None:
        self.faults: list[Fault] = []
        self._settable = SettableDeck(self.deck.deck)

    def run(self) -> Run:
        """Return a run whose outcome nobody reads."""
        return Run(Outcome(self.deck.path), self.options, self.listener)

    def model(self, name: str = "", change: float = 0.0) -> tuple[Any, Run]:
        """Return the model with a number larger by a change, and its run.  Raises FlexmbError."""
        value = float(self.numbers[name].value) + float(change) if name else 0.0
        deck, run = self._settable.with_settings([f"{name}={value!r}"] if name else []), self.run()
        refuse_foreign_method(deck, self.options)
        model = model_of(deck, run)
        refuse_switches(getattr(model, "elements", None), "sensitivity")
        if not name:
            self.faults += run.outcome.faults
        return model, run

    def solution(self, name: str = "", change: float = 0.0) -> Solution:
        """Return the run with a number larger by a change, ready to be solved.  Raises FlexmbError."""
        model, run = self.model(name, change)
        solution = with_outputs(solution_of(model, run), self.deck.deck)
        if not name:
            self.faults += solution.model_warnings()
        return solution


class OfRun:
    """Quantities of a run whose motion is integrated: `values` (rows, of) at the times `time`, s.

    neighbour(name, change): the run with a number larger by a change, ready to be solved.
    `one_neighbour`: whether one run, of implicit methods two, are enough, which leaves errors of 1e-7.
    """

    one_neighbour = False

    def __init__(
        self, neighbour: Callable[[str, float], Solution], of: Sequence[Quantity], solution: Solution
    ):
        self.neighbour, self.solution, self.quantities = neighbour, solution, of
        self.steps = StepSequence()
        self.blocks = list(self._blocks(solution, self.steps))
        self.time = np.concatenate([block["time"] for block in self.blocks])
        self.values = self.columns(self.blocks)

    def _blocks(self, solution: Solution, steps: StepSequence) -> Iterator[Mapping[str, np.ndarray]]:
        if hasattr(solution.analysis, "step_sequence"):
            solution.analysis.step_sequence = steps
        return solution.blocks()

    def columns(self, blocks: Sequence[Mapping[str, np.ndarray]]) -> np.ndarray:
        """Return the quantities (rows, of) of blocks of values."""
        places: list[tuple[Any, ...]] = [(slice(None), *one.index) for one in self.quantities]
        named = [(one.dataset, place) for one, place in zip(self.quantities, places, strict=True)]
        return np.concatenate(
            [np.column_stack([block[path][place] for path, place in named]) for block in blocks]
        )

    def derivative(self, name: str, scale: float) -> np.ndarray:
        """Return the derivatives (rows, of) by a number whose size is `scale`.  Raises FlexmbError."""

        def values(change: float) -> np.ndarray:
            return self._changed_values(name, change)

        h = (OF_EXPLICIT if self._is_explicit else OF_IMPLICIT) * scale
        try:
            if self.one_neighbour and self._is_explicit:
                return np.asarray((values(OF_ONE_SIDE * scale) - self.values) / (OF_ONE_SIDE * scale))
            if not (self._is_explicit or self.one_neighbour):
                return np.asarray(differentiated(values, h))
            below = values(-h)
        except FlexmbError:  # of a number at the end of its range, or a motion that locks
            return _one_sided(values, h, self.values)
        try:
            return np.asarray((values(h) - below) / (2.0 * h))
        except FlexmbError:
            return _one_sided(values, -h, self.values)

    @property
    def _is_explicit(self) -> bool:
        """Return whether the steps are those of DOP853."""
        analysis: Any = self.solution.analysis
        if hasattr(analysis, "integrator"):
            return not analysis.integrator.type.implicit
        return bool(analysis.tree.integration.method == "dop853") if hasattr(analysis, "tree") else False

    def _changed_values(self, name: str, change: float) -> np.ndarray:
        solution = self.neighbour(name, change)
        blocks = list(self._blocks(solution, StepSequence(self.steps)))
        times = np.concatenate([block["time"] for block in blocks])
        if not np.array_equal(times, self.time):
            message = f"{name} changes the report times, at which the values are compared; leave it out"
            raise ModelError([Fault("error", message, about=name, id="RUN-164")])
        return self.columns(blocks)


def _one_sided(values: Values, h: float, here: np.ndarray) -> np.ndarray:
    """Return the derivative of values(change) by those at 0, h and 2 h; raises FlexmbError."""
    return (4.0 * values(h) - values(2.0 * h) - 3.0 * here) / (2.0 * h)


class OfEquilibrium(OfRun):
    """Quantities in the equilibrium: those of the first row of a run that begins there."""

    def _blocks(self, solution: Solution, steps: StepSequence) -> Iterator[Mapping[str, np.ndarray]]:
        for block in solution.blocks():
            yield {path: values[:1] for path, values in block.items()}
            return

    def derivative(self, name: str, scale: float) -> np.ndarray:
        """Return the derivatives (1, of) by a number whose size is `scale`.  Raises FlexmbError."""
        return differentiated(lambda change: self._changed_values(name, change), OF_EQUILIBRIUM * scale)


class OfKinematics(OfRun):
    """Quantities of a motion that drivers prescribe, and of its forces: differentiated directly."""

    def derivative(self, name: str, scale: float) -> np.ndarray:
        """Return the derivatives (rows, of) by a number whose size is `scale`.  Raises FlexmbError."""
        h = OF_KINEMATICS * scale
        try:
            neighbours = {place: self.neighbour(name, place * h) for place, _ in STENCIL}
            return self._along(neighbours, h)
        except (ForkedEquations, FlexmbError):
            return super().derivative(name, scale)

    def _along(self, neighbours: Mapping[float, Solution], h: float) -> np.ndarray:
        """Return the derivatives from `neighbours`, with a number larger by each place of STENCIL times h."""
        motions = {place: _motion(one) for place, one in neighbours.items()}
        closed = isinstance(self.solution.analysis, InverseDynamics)
        motion = _motion(self.solution)
        states = neighbouring_states(motion, self.time, self._states, motions, h, closed=closed)

        def values(place: float) -> np.ndarray:
            solution, motion = neighbours[place], motions[place]
            audit = np.zeros((len(self.time), 3))
            rows = rows_of(motion.mechanism, self.time, states[place], audit, motion.joints.with_turns)
            if isinstance(solution.analysis, InverseDynamics):
                rows = solution.analysis.with_forces(rows)
            return self.columns([solution.values(rows)])

        return sum_of_pairs(values) / h

    @cached_property
    def _states(self) -> np.ndarray:
        """States (T, 3, n): coordinates, their rates and second rates."""
        names = (
            ("position", "euler_parameters"), ("velocity", "euler_parameter_rates"),
            ("acceleration", "euler_parameter_accelerations"),
        )  # fmt: skip
        parts = [
            [np.concatenate([block[f"body/{name}"] for block in self.blocks]) for name in pair]
            for pair in names
        ]
        return np.stack([np.concatenate(pair, axis=2).reshape(len(self.time), -1) for pair in parts], axis=1)


def _motion(solution: Solution) -> KinematicAnalysis:
    """Return the kinematic analysis of a motion that drivers prescribe."""
    analysis: Any = solution.analysis
    return analysis.motion if isinstance(analysis, InverseDynamics) else analysis


def type_of(solution: Solution) -> type[OfRun]:
    """Return the class that differentiates the motion of a run."""
    return OfKinematics if isinstance(solution.analysis, KinematicAnalysis | InverseDynamics) else OfRun


def _quantities(neighbours: _Neighbours, solution: Solution, of: Sequence[str]) -> list[Quantity]:
    """Return the quantities of these names; raises ModelError."""
    with empty_result(neighbours.deck.deck, solution.layout()) as result:
        try:
            return resolve(result, of)
        except ResultError as failure:
            faults = [
                replace(fault, message=fault.message.removesuffix(SHOWS_ALL)) for fault in failure.faults
            ]
            raise ModelError(faults) from None
