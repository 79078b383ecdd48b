"""Signals → records, and the order in which they follow from each other."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..signals import (
    ELEMENT_SIGNAL,
    SAMPLE_SIGNAL,
    SENSOR_SIGNAL,
    TIME_SIGNAL,
    Signal,
    in_order,
    initial_states,
)
from .contacts import ANSWER_COLUMNS
from .records import NONE

if TYPE_CHECKING:
    from .function_table import FunctionTable

COLUMNS = {"coordinate": 0, "rate": 1, "effort": 2}  # of answers, as in `kernels.laws`

SIGNAL = np.dtype(
    [
        ("kind", np.int64),  # code of `model.signals`
        ("source", np.int64),  # number of its sensor, of its element's answer or of its function
        ("column", np.int64),  # of that answer: x, its rate or the effort
        ("first", np.int64),  # where the numbers of its inputs begin
        ("inputs", np.int64),  # how many it has
        ("number", np.int64),  # where its numbers, or its matrices A, B, C, D, E row by row, begin
        ("state", np.int64),  # its first state
        ("states", np.int64),  # how many it has
        ("size", np.int64),  # how many of them are x of its block
        ("lower", np.float64),  # least value, SI units
        ("upper", np.float64),  # largest value, SI units
        ("stops", np.int64),  # whether its first state stands still beyond the limits
        ("knot", np.int64),  # row of the knots from which functions take its value, -1: none
        ("until", np.float64),  # s: functions of time hold what they are just before it
        ("due", np.int64),  # bits of what is sampled and given out in this evaluation, else 0
    ]
)


class Signals(NamedTuple):
    """S signals, which depend on M sensors, and N states: those of bristles, then those of signals."""

    records: np.ndarray  # (S,) SIGNAL records
    order: np.ndarray  # (S,) numbers of the signals in the order in which they follow from each other
    inputs: np.ndarray  # flat, numbers of the inputs of all signals
    numbers: np.ndarray  # flat, numbers and matrices of all signals, SI units
    values: np.ndarray  # (S, 2) value and rate of each, as evaluated last, SI units
    states: np.ndarray  # (N,) states in the evaluation, SI units
    rates: np.ndarray  # (N,) and their rates, SI units a second, 1/s
    known: np.ndarray  # (N,) states in a stage of an implicit method less `ahead` times their rates, SI units
    ahead: np.ndarray  # (1,) s: of bristles the states follow from `known`, 0: they are at hand
    sensed: np.ndarray  # (M, 8) answers of the sensors, columns of `kernels.laws`, SI units


def signal_arrays(
    signals: Sequence[Signal],
    table: "FunctionTable | None" = None,
    parts: Iterable[str] = (),
    bristles: int = 0,
) -> Signals:
    """Return the arrays; functions join those of the table, parts are names of answers of elements.

    `bristles`: how many states friction has.
    """
    records = np.zeros(len(signals), SIGNAL)
    inputs: list[int] = []
    numbers: list[float] = []
    sensors, states = 0, bristles
    places = {name: k for k, name in enumerate(parts)}
    for record, (k, signal) in zip(records, enumerate(signals), strict=True):
        own = _numbers(signal)
        record["kind"], record["until"], record["knot"] = signal.kind, np.inf, NONE
        record["first"], record["inputs"] = len(inputs), len(signal.inputs)
        record["number"], record["state"], record["states"] = len(numbers), states, signal.states
        record["lower"], record["upper"] = signal.lower, signal.upper
        record["column"] = COLUMNS[signal.column]
        if signal.block is not None:
            record["size"], record["stops"] = signal.block.start.size, signal.block.stops_at_limits
        if signal.kind == SENSOR_SIGNAL:
            record["source"] = sensors
            sensors += 1
        elif signal.kind == ELEMENT_SIGNAL:
            record["source"] = places[signal.element]
        elif signal.function is not None and table is not None:
            record["source"] = table.function(signal.function, of_time=signal.kind == TIME_SIGNAL)
        if table is not None:
            record["knot"] = table.knot_of_signal(k)
        inputs += signal.inputs
        numbers += own
        states += signal.states
    return Signals(
        records,
        np.array(in_order(signals)[0], np.int64),
        np.array(inputs, np.int64),
        np.array(numbers, float),
        np.zeros((len(signals), 2)),
        np.concatenate([np.zeros(bristles), initial_states(signals)]),
        np.zeros(states),
        np.zeros(states),
        np.zeros(1),
        np.zeros((sensors, ANSWER_COLUMNS)),
    )


def _numbers(signal: Signal) -> list[float]:
    if signal.block is None:
        return [*signal.numbers]
    block = signal.block
    parts = map(np.ravel, (block.A, block.B, block.C, block.D, block.E))
    return [float(x) for part in parts for x in part]


def set_due(signals: Signals, model: Sequence[Signal], start: float, t: float) -> bool:
    """Mark what is sampled and given out at t by the evaluations that follow; return whether anything is."""
    for record, signal in zip(signals.records, model, strict=True):
        if signal.kind == SAMPLE_SIGNAL and signal.block is not None:
            record["due"] = signal.block.due(t - start)
    return bool(signals.records["due"].any())
