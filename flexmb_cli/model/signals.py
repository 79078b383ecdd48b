"""Signals: what is measured, what follows from other signals, and blocks with states of their own.

A `Signal` is a number that changes with time.  It is of one of these types:

| type | value |
|---|---|
| SENSOR_SIGNAL | x of a measure, as elements have it, or its rate |
| ELEMENT_SIGNAL | x, rate or effort of a force element |
| TIME_SIGNAL | a function of time |
| TABLE_SIGNAL | a function of the input |
| SUM_SIGNAL | n0 + n1 input 1 + n2 input 2 … of its `numbers` |
| PRODUCT_SIGNAL | n0 times the inputs, each to the power n1, n2 …, 1 or -1 |
| LIMIT_SIGNAL, DEADZONE_SIGNAL | the input kept within limits; how far it lies beyond them |
| SWITCH_SIGNAL | the second input up to n0, and then the third, joined by a cubic over the width n1 |
| RATE_SIGNAL | the rate of the input |
| STATE_SIGNAL | y = C x + D e + E de/dt of the inputs e, with dx/dt = A x + B e |
| SAMPLE_SIGNAL | y = C x + D e every `period`, with x = A x + B e after it; held, and late by `delay` |

Inputs are numbers of other signals of the same list.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import Place
from .time_functions import MotionFunction

SENSOR_SIGNAL, ELEMENT_SIGNAL, TIME_SIGNAL, TABLE_SIGNAL, SUM_SIGNAL, PRODUCT_SIGNAL = 1, 2, 3, 4, 5, 6
LIMIT_SIGNAL, DEADZONE_SIGNAL, SWITCH_SIGNAL, RATE_SIGNAL, STATE_SIGNAL, SAMPLE_SIGNAL = 7, 8, 9, 10, 11, 12
SAME_SAMPLE = 1e-9  # of a period: times this near to each other are one


@dataclass(frozen=True)
class Block:
    """Matrices of a STATE_SIGNAL or SAMPLE_SIGNAL with n states and m inputs, SI units."""

    A: np.ndarray  # (n, n)
    B: np.ndarray  # (n, m)
    C: np.ndarray  # (n,)
    D: np.ndarray  # (m,)
    E: np.ndarray  # (m,) of the rates of the inputs, s
    start: np.ndarray  # (n,) first state
    stops_at_limits: bool = False  # whether the first state stands still while it drives the value beyond
    period: float = 0.0  # s, 0: of a STATE_SIGNAL
    delay: float = 0.0  # s
    held: float = 0.0  # value of a SAMPLE_SIGNAL before its first sample

    @property
    def queue(self) -> int:
        """Return how many samples wait, the last one among them."""
        return int(self.delay / self.period + SAME_SAMPLE) + 1

    @property
    def initial(self) -> np.ndarray:
        """Return the first states; of a SAMPLE_SIGNAL with its samples and its value, (n + queue + 1,)."""
        if not self.period:
            return self.start
        return np.concatenate([self.start, np.full(self.queue + 1, self.held)])

    def due(self, t: float) -> int:
        """Return what is due so long after the start: 1 a sample, 2 a value given out, 3 both, 0 nothing."""
        counts = t / self.period, (t - self.delay) / self.period
        sample, value = (x > -SAME_SAMPLE and abs(x - round(x)) <= SAME_SAMPLE for x in counts)
        return sample + 2 * value


@dataclass(frozen=True)
class Signal:
    """A signal; one without a name is part of another."""

    name: str
    kind: int
    inputs: tuple[int, ...] = ()
    numbers: tuple[float, ...] = ()
    measure: Any = None  # of a SENSOR_SIGNAL: At, Line or Along
    element: str = ""  # of an ELEMENT_SIGNAL: name of the element, or of its part
    column: str = "coordinate"  # coordinate, rate or effort: of SENSOR_SIGNAL and ELEMENT_SIGNAL
    function: MotionFunction | None = None
    block: Block | None = None
    lower: float = -np.inf
    upper: float = np.inf
    unit: str = "1"
    place: Place | None = None

    @property
    def states(self) -> int:
        """Return how many states it adds to those of the motion."""
        return 0 if self.block is None else self.block.initial.size

    @property
    def feeds_through(self) -> bool:
        """Return whether its value needs those of its inputs at the same time."""
        return self.block is None or (
            self.kind == STATE_SIGNAL and bool(self.block.D.any() or self.block.E.any())
        )


def in_order(signals: Sequence[Signal]) -> tuple[list[int], list[int]]:
    """Return the order in which signals follow from each other, and a circle of them, an algebraic loop.

    Inputs of signals that do not feed through come before them where they can.
    """
    state = [0] * len(signals)  # 1: its inputs are being looked at, 2: in order
    order: list[int] = []
    for first in range(len(signals)):
        path = [] if state[first] else [(first, iter(signals[first].inputs))]
        state[first] = max(state[first], 1)
        while path:
            k, inputs = path[-1]
            following = next(inputs, None)
            if following is None:
                state[k] = 2
                order.append(k)
                path.pop()
            elif state[following] == 0:
                state[following] = 1
                path.append((following, iter(signals[following].inputs)))
            elif state[following] == 1:
                numbers = [number for number, _ in path]
                circle = numbers[numbers.index(following) :]
                if all(signals[number].feeds_through for number in circle):
                    return order, circle
    return order, []


def has_rate(signals: Sequence[Signal], order: Sequence[int]) -> list[bool]:
    """Return whether the rate of each signal is known, without accelerations and rates of rates."""
    known = [False] * len(signals)
    for k in order:
        signal = signals[k]
        if signal.kind in (SENSOR_SIGNAL, ELEMENT_SIGNAL):
            known[k] = signal.column == "coordinate"
        elif signal.kind == TIME_SIGNAL:
            known[k] = True
        elif signal.kind not in (RATE_SIGNAL, STATE_SIGNAL, SAMPLE_SIGNAL):
            known[k] = all(known[i] for i in signal.inputs)
    return known


def initial_states(signals: Sequence[Signal]) -> np.ndarray:
    """Return the states (n,) of all signals at the start."""
    return np.concatenate([np.zeros(0), *(s.block.initial for s in signals if s.block is not None)])


def is_sampled(signals: Sequence[Signal], t: float) -> bool:
    """Return whether a signal is sampled or given out so long after the start, s."""
    return any(s.block.due(t) for s in signals if s.block is not None and s.block.period)


def sampling_times(signals: Sequence[Signal], start: float, end: float) -> Iterator[float]:
    """Yield the times in [start, end], from the start of a run on, at which signals are sampled or given out.

    In no order, some several times.
    """
    for block in (s.block for s in signals if s.block is not None and s.block.period):
        for late in {0.0, block.delay}:
            count = int((end - start - late) / block.period + SAME_SAMPLE) + 1
            yield from (start + late + k * block.period for k in range(max(count, 0)))
