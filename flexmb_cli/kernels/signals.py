"""Values and rates of signals, and of the states that blocks add to the motion.

Records are those of `model.arrays.signals.SIGNAL`; formulas are in `model.signals`.  The limited integral of
a PID stands still while it drives the value beyond the limits: Åström and Hägglund, Advanced PID Control
(2006), section 3.5, conditional integration.
"""

from typing import TYPE_CHECKING

import numpy as np

from ._jit import kernel
from .constrained.time_functions import function_values

if TYPE_CHECKING:
    from ..model.arrays.signals import Signals

# The codes of model.signals; a test compares them.
SENSOR_SIGNAL, ELEMENT_SIGNAL, TIME_SIGNAL, TABLE_SIGNAL, SUM_SIGNAL, PRODUCT_SIGNAL = 1, 2, 3, 4, 5, 6
LIMIT_SIGNAL, DEADZONE_SIGNAL, SWITCH_SIGNAL, RATE_SIGNAL, STATE_SIGNAL, SAMPLE_SIGNAL = 7, 8, 9, 10, 11, 12
VALUE, SLOPE = 0, 1  # columns of the values of signals
SAMPLE, GIVE_OUT = 1, 2  # bits of what is due: a sample is taken, a value is given out


@kernel
def evaluate_signals(
    signals: "Signals", functions: np.ndarray, knots: np.ndarray, answers: np.ndarray, t: float
) -> None:
    """Fill values (S, 2) of all signals, and the rates of their states, which are at hand.

    answers (E, columns): those of force elements; those of sensors are at hand.  What follows a signal as a
    function finds its value in the first column of `knots`.
    """
    for i in range(signals.order.shape[0]):
        k = signals.order[i]
        record = signals.records[k]
        value, rate = _value(signals, record, functions, knots, answers, min(t, record["until"]))
        if record["kind"] >= LIMIT_SIGNAL:
            value, rate = _limited(record, value, rate)
        signals.values[k, VALUE], signals.values[k, SLOPE] = value, rate
        if record["knot"] >= 0:
            knots[record["knot"], 0] = value
        if record["due"] != 0:
            _sample(signals, record)
            signals.values[k, VALUE] = signals.states[record["state"] + record["states"] - 1]
            if record["knot"] >= 0:
                knots[record["knot"], 0] = signals.values[k, VALUE]
    for k in range(signals.records.shape[0]):
        if signals.records[k]["kind"] == STATE_SIGNAL:
            _fill_rates(signals, signals.records[k])


@kernel
def _input(signals: "Signals", record: np.void, i: int) -> tuple[float, float]:
    """Value and rate of an input."""
    k = signals.inputs[record["first"] + i]
    return signals.values[k, VALUE], signals.values[k, SLOPE]


@kernel
def _value(
    signals: "Signals",
    record: np.void,
    functions: np.ndarray,
    knots: np.ndarray,
    answers: np.ndarray,
    t: float,
) -> tuple[float, float]:
    """Value and rate of a signal without its limits; a rate that is not known is 0."""
    kind, source, column = record["kind"], record["source"], record["column"]
    if kind == SENSOR_SIGNAL:
        return signals.sensed[source, column], signals.sensed[source, column + 1] if column == 0 else 0.0
    if kind == ELEMENT_SIGNAL:
        return answers[source, column], answers[source, column + 1] if column == 0 else 0.0
    if kind == TIME_SIGNAL:
        value, rate, _ = function_values(functions, knots, source, t)
        return value, rate
    if kind == SUM_SIGNAL:
        return _sum(signals, record)
    if kind == PRODUCT_SIGNAL:
        return _product(signals, record)
    if kind == SWITCH_SIGNAL:
        return _switched(signals, record)
    if kind == STATE_SIGNAL:
        return _output(signals, record), 0.0
    if kind == SAMPLE_SIGNAL:
        return signals.states[record["state"] + record["states"] - 1], 0.0
    value, rate = _input(signals, record, 0)
    if kind == TABLE_SIGNAL:
        value, slope, _ = function_values(functions, knots, source, value)
        return value, slope * rate
    return (rate, 0.0) if kind == RATE_SIGNAL else (value, rate)


@kernel
def _sum(signals: "Signals", record: np.void) -> tuple[float, float]:
    first = record["number"]
    total, change = signals.numbers[first], 0.0
    for i in range(record["inputs"]):
        value, rate = _input(signals, record, i)
        total += signals.numbers[first + 1 + i] * value
        change += signals.numbers[first + 1 + i] * rate
    return total, change


@kernel
def _product(signals: "Signals", record: np.void) -> tuple[float, float]:
    first = record["number"]
    total, change = signals.numbers[first], 0.0
    for i in range(record["inputs"]):
        value, rate = _input(signals, record, i)
        if signals.numbers[first + 1 + i] < 0.0:
            value = 1.0 / value
            rate *= -value * value
        change = change * value + total * rate
        total *= value
    return total, change


@kernel
def _switched(signals: "Signals", record: np.void) -> tuple[float, float]:
    """The second input below a value of the first, the third above, joined by 3 s² - 2 s³."""
    at, width = signals.numbers[record["number"]], signals.numbers[record["number"] + 1]
    x, slope = _input(signals, record, 0)
    low, low_rate = _input(signals, record, 1)
    high, high_rate = _input(signals, record, 2)
    if x - at >= 0.5 * width:
        return high, high_rate
    if x - at <= -0.5 * width:
        return low, low_rate
    s = (x - at) / width + 0.5
    share, change = s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) * slope / width
    return low + share * (high - low), low_rate + share * (high_rate - low_rate) + change * (high - low)


@kernel
def _limited(record: np.void, value: float, rate: float) -> tuple[float, float]:
    low, high = record["lower"], record["upper"]
    if record["kind"] == DEADZONE_SIGNAL:
        if value > high:
            return value - high, rate
        return (value - low, rate) if value < low else (0.0, 0.0)
    if value > high:
        return high, 0.0
    return (low, 0.0) if value < low else (value, rate)


@kernel
def _output(signals: "Signals", record: np.void) -> float:
    """C x + D e + E de/dt, without limits."""
    n, m, x = record["size"], record["inputs"], record["state"]
    first, total = record["number"] + n * n + n * m, 0.0
    for i in range(n):
        total += signals.numbers[first + i] * signals.states[x + i]
    for i in range(m):
        by_value, by_rate = signals.numbers[first + n + i], signals.numbers[first + n + m + i]
        # What no block feeds through may not be known yet.
        if by_value != 0.0 or by_rate != 0.0:
            value, rate = _input(signals, record, i)
            total += by_value * value + by_rate * rate
    return total


@kernel
def _next(signals: "Signals", record: np.void, i: int) -> float:
    """A x + B e in row i."""
    n, m, x, total = record["size"], record["inputs"], record["state"], 0.0
    for j in range(n):
        total += signals.numbers[record["number"] + n * i + j] * signals.states[x + j]
    for j in range(m):
        total += signals.numbers[record["number"] + n * n + m * i + j] * _input(signals, record, j)[0]
    return total


@kernel
def _fill_rates(signals: "Signals", record: np.void) -> None:
    n, m, x = record["size"], record["inputs"], record["state"]
    for i in range(n):
        signals.rates[x + i] = _next(signals, record, i)
    if record["stops"] != 0:
        value = _output(signals, record)
        push = signals.numbers[record["number"] + n * n + n * m] * signals.rates[x]
        if (value > record["upper"] and push > 0.0) or (value < record["lower"] and push < 0.0):
            signals.rates[x] = 0.0


@kernel
def _sample(signals: "Signals", record: np.void) -> None:
    """Take a sample of a SAMPLE_SIGNAL signal, give out the one that is due, or both.

    Its states are x, the samples, the last one first, and the value that is given out.
    """
    n, x, last = record["size"], record["state"], record["state"] + record["states"] - 1
    if record["due"] & SAMPLE:
        value = _limited(record, _output(signals, record), 0.0)[0]
        beyond = _output(signals, record) != value
        # No state but those of this signal depends on the next ones, which may stand in their rates so long.
        for i in range(n):
            signals.rates[x + i] = _next(signals, record, i)
        for i in range(n):
            if not (i == 0 and record["stops"] != 0 and beyond):
                signals.states[x + i] = signals.rates[x + i]
            signals.rates[x + i] = 0.0
        for i in range(last - 1, x + n, -1):
            signals.states[i] = signals.states[i - 1]
        signals.states[x + n] = value
    if record["due"] & GIVE_OUT:
        signals.states[last] = signals.states[last - 1]


@kernel
def take_states(signals: "Signals", z: np.ndarray, first: int) -> None:
    """Take the states of signals from z, from `first` on."""
    for i in range(signals.states.shape[0]):
        signals.states[i] = z[first + i]


@kernel
def take_known(signals: "Signals", known: np.ndarray, first: int, ahead: float) -> None:
    """Have states of bristles in the next evaluation follow from `known`, from `first` on, and from rates."""
    for i in range(signals.known.shape[0]):
        signals.known[i] = known[first + i]
    signals.ahead[0] = ahead


@kernel
def give_rates(signals: "Signals", dz: np.ndarray, first: int) -> None:
    """Give the rates of the states of signals to dz, from `first` on."""
    for i in range(signals.rates.shape[0]):
        dz[first + i] = signals.rates[i]
