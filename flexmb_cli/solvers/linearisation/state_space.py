"""State space of a linearised motion: x' = A x + B u, y = C x + D u.

The states are the deviations of the independent coordinates and of their speeds, the inputs those of
drivers and loads, the outputs those of points, joints and drivers.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
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
    relative: list[Signal]  # relative displacements, rows of `displacements`

    @abstractmethod
    def respond(self, d: np.ndarray, w: np.ndarray, model: Any = None) -> np.ndarray:
        """Return u' (n,) and then the observed outputs where d, w and the model are changed."""

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
        return (*self.relative, *rates, *self.observed)

    def column(self, d: np.ndarray, w: np.ndarray, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the columns of A or B (2 f,) and of C or D (p,) of one change with its response."""
        motion, n = self.motion, self.motion.scale.size
        P, P_rate = self.displacements()
        speeds = P_rate @ d - P @ motion.turned(d) + P @ w
        y_rates = motion.position_rates(d) + motion.L @ w
        rates = np.concatenate([y_rates, motion.speed_rates(w, response[:n])])
        return rates, np.concatenate([P @ d, speeds, response[n:]])


def matrices(responses: Responses) -> list[np.ndarray]:
    """Return A (2 f, 2 f), B (2 f, inputs), C (outputs, 2 f) and D (outputs, inputs).

    They are in the units of the signals.
    """
    motion, p = responses.motion, len(responses.outputs)
    units = np.tile(motion.units, 2)
    state = [
        responses.column(d / unit, w / unit, motion.variation(responses.respond, d, w) / unit)
        for unit, (d, w) in zip(units, motion.tangents(), strict=True)
    ]
    inputs = [responses.column(one.d, one.w, _response(responses, one)) for one in responses.inputs]
    n = 2 * motion.dofs
    A, C = (_columns([column[k] for column in state], rows) for k, rows in ((0, n), (1, p)))
    B, D = (_columns([column[k] for column in inputs], rows) for k, rows in ((0, n), (1, p)))
    return [A, B, C, D]


def _columns(columns: list[np.ndarray], rows: int) -> np.ndarray:
    return np.column_stack(columns) if columns else np.zeros((rows, 0))


def _response(responses: Responses, one: Input) -> np.ndarray:
    def answer(amount: float) -> np.ndarray:
        return responses.respond(amount * one.d, amount * one.w, one.change(amount))

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
    return StateSpace(A, B, C, D, states, inputs, responses.outputs, responses.motion.axes, constant)


def _sizes(matrix: np.ndarray) -> np.ndarray:
    """Largest entry of each row (rows, 1), or 1."""
    return np.max(np.abs(matrix), axis=1, initial=1.0)[:, None] if matrix.size else np.ones((len(matrix), 1))


def state_signals(names: list[str], units: Any, parents: list[str]) -> tuple[Signal, ...]:
    """Return the signals of coordinates and then of their speeds."""
    y = [Signal(*item) for item in zip(names, units, parents, strict=True)]
    return (*y, *(Signal(f"{s.name} rate", SPEED_OF[s.unit], s.relative_to) for s in y))
