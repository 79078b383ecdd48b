"""State space of a linearised motion: x' = A x + B u, y = C x + D u.

The states are the deviations of the independent coordinates, of their speeds, and of the states of bristles
and signals, the inputs those of drivers and loads, the outputs those of points, joints, drivers and signals.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .motion import CONSTANT, DIFFERENCE_STEP, LinearisedMotion, differentiated

ADMISSIBLE = 1e-6  # share of a prescribed rate that equations or loops may fail to follow
MOVED_POINT = (("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s2"))

SPEED_OF = {"rad": "rad/s", "m": "m/s", "m or 1": "m/s or 1/s"}
ACCELERATION_OF = {"rad": "rad/s2", "m": "m/s2"}
MATRICES = ("A", "B", "C", "D")


@dataclass(frozen=True)
class Signal:
    """A state, input or output: its name and unit; `relative_to`: the parent body of a state, "" for none."""

    name: str
    unit: str
    relative_to: str = ""


@dataclass(frozen=True)
class StateSpace:
    """A (n, n), B (n, m), C (p, n), D (p, m) in the units of the signals.

    `axes`: what the states are resolved in; `constant`: which of the matrices stay the same along the motion.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    axes: str
    constant: dict[str, bool]


@dataclass(frozen=True)
class Input:
    """One input: a unit of it displaces by d (n,), changes the speeds by w (n,), and the model by `change`.

    `change` gives the model for so much of the input; `step` is a small amount of it.
    """

    signal: Signal
    d: np.ndarray
    w: np.ndarray
    change: Callable[..., Any]
    step: float = DIFFERENCE_STEP


class Responses(ABC):
    """Responses of a formulation to changes of state and inputs about a LinearisedMotion."""

    motion: LinearisedMotion
    inputs: list[Input]
    observed: list[Signal]  # what `respond` returns
    signals: Sequence[Any]  # `model.signals.Signal` of the deck
    shift: np.ndarray  # (s,) change of the states of bristles and signals
    relative: list[Signal]  # relative displacements, rows of `displacements`

    @abstractmethod
    def respond(self, d: np.ndarray, w: np.ndarray, model: Any = None) -> np.ndarray:
        """Return u' (n,) and then the observed outputs where d, w, the shift and the model are changed."""

    @abstractmethod
    def displacements(self) -> tuple[np.ndarray, np.ndarray]:
        """Return functionals P (r, n) of the relative displacements, and their rates (r, n)."""

    @staticmethod
    def inputs_of_driver(
        name: str, unit: str, d: np.ndarray, w: np.ndarray, changes: list[Callable[..., Any]]
    ) -> list[Input]:
        """Return the inputs of a driver and its rates; it displaces by d and changes the speeds by w."""
        still = np.zeros_like(d)
        return [
            Input(Signal(name, unit), d, w, changes[0]),
            Input(Signal(f"{name} rate", SPEED_OF[unit]), still, d, changes[1]),
            Input(Signal(f"{name} acceleration", ACCELERATION_OF[unit]), still, still, changes[2]),
        ]

    @property
    def outputs(self) -> tuple[Signal, ...]:
        """Return the signals of all outputs: relative displacements, their rates, what is observed."""
        rates = [Signal(f"{s.name} rate", SPEED_OF[s.unit]) for s in self.relative]
        named = [Signal(signal.name, signal.unit) for signal in self.signals if signal.name]
        return (*self.relative, *rates, *self.observed, *named)

    @property
    def states_of_signals(self) -> tuple[Signal, ...]:
        """Return the signals of the states of bristles, and of those of signals."""
        own = [f"{signal.name} state {k + 1}" for signal in self.signals for k in range(signal.states)]
        bristles = [f"bristle {k + 1}" for k in range(self.motion.signals.states.size - len(own))]
        return tuple(Signal(name, "1") for name in (*bristles, *own))

    def respond_with_signals(self, d: np.ndarray, w: np.ndarray, model: Any = None) -> np.ndarray:
        """Return what `respond` does, values of named signals, and the rates (s,) of their states."""
        response, arrays = self.respond(d, w, model), self.motion.signals
        values = [arrays.values[k, 0] for k, signal in enumerate(self.signals) if signal.name]
        return np.concatenate([response, values, arrays.rates])

    def respond_to_state(self, change: np.ndarray) -> np.ndarray:
        """Return the same where the states of bristles and signals are changed (s,)."""
        still = np.zeros(self.motion.scale.size)
        self.shift = change
        response = self.respond_with_signals(still, still)
        self.shift = 0.0 * change
        return response

    def column(self, d: np.ndarray, w: np.ndarray, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the columns of A or B (2 f + s,) and of C or D (p,) of one change with its response."""
        motion, n = self.motion, self.motion.scale.size
        P, P_rate = self.displacements()
        speeds = P_rate @ d - P @ motion.turned(d) + P @ w
        y_rates = motion.position_rates(d) + motion.L @ w
        end = response.size - motion.signals.states.size
        rates = np.concatenate([y_rates, motion.speed_rates(w, response[:n]), response[end:]])
        return rates, np.concatenate([P @ d, speeds, response[n:end]])


def matrices(responses: Responses) -> list[np.ndarray]:
    """Return A (n, n), B (n, inputs), C (outputs, n) and D (outputs, inputs), n = 2 f + s.

    They are in the units of the signals.
    """
    motion, p = responses.motion, len(responses.outputs)
    units = np.tile(motion.units, 2)
    state = [
        responses.column(d / unit, w / unit, motion.variation(responses.respond_with_signals, d, w) / unit)
        for unit, (d, w) in zip(units, motion.tangents(), strict=True)
    ]
    state += [_of_state(responses, one) for one in np.eye(motion.signals.states.size)]
    inputs = [responses.column(one.d, one.w, _response(responses, one)) for one in responses.inputs]
    n = 2 * motion.dofs + motion.signals.states.size
    A, C = (_columns([column[k] for column in state], rows) for k, rows in ((0, n), (1, p)))
    B, D = (_columns([column[k] for column in inputs], rows) for k, rows in ((0, n), (1, p)))
    return [A, B, C, D]


def _columns(columns: list[np.ndarray], rows: int) -> np.ndarray:
    return np.column_stack(columns) if columns else np.zeros((rows, 0))


def _of_state(responses: Responses, one: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the columns of A and C of a state of bristles or signals."""
    still = np.zeros(responses.motion.scale.size)
    response = differentiated(lambda amount: responses.respond_to_state(amount * one), DIFFERENCE_STEP)
    return responses.column(still, still, response)


def _response(responses: Responses, one: Input) -> np.ndarray:
    def answer(amount: float) -> np.ndarray:
        return responses.respond_with_signals(amount * one.d, amount * one.w, one.change(amount))

    return differentiated(answer, one.step)


def state_space(responses: Responses, later: Responses, states: tuple[Signal, ...]) -> StateSpace:
    """Return the state space of `responses`; `later`: the same a little later, which shows what changes."""
    here, there = matrices(responses), matrices(later)
    A, B, C, D = here
    constant = {
        name: bool(np.all(np.abs(b - a) <= CONSTANT * _sizes(a)))
        for name, a, b in zip(MATRICES, here, there, strict=True)
    }
    inputs = tuple(one.signal for one in responses.inputs)
    states = (*states, *responses.states_of_signals)
    return StateSpace(A, B, C, D, states, inputs, responses.outputs, responses.motion.axes, constant)


def _sizes(matrix: np.ndarray) -> np.ndarray:
    """Largest entry of each row (rows, 1), or 1."""
    return np.max(np.abs(matrix), axis=1, initial=1.0)[:, None] if matrix.size else np.ones((len(matrix), 1))


def state_signals(names: list[str], units: Any, parents: list[str]) -> tuple[Signal, ...]:
    """Return the signals of coordinates and then of their speeds."""
    y = [Signal(*item) for item in zip(names, units, parents, strict=True)]
    return (*y, *(Signal(f"{s.name} rate", SPEED_OF[s.unit], s.relative_to) for s in y))
