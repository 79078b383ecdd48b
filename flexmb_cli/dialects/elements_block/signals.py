"""Lines SIGNAL of the block ELEMENTS to signals of the model."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...deck.record import Number
from ...model.laws import FRICTION, FUNCTIONS, Along, At, Element, Line
from ...model.signals import (
    DEADZONE_SIGNAL,
    ELEMENT_SIGNAL,
    LIMIT_SIGNAL,
    PRODUCT_SIGNAL,
    RATE_SIGNAL,
    SAMPLE_SIGNAL,
    SENSOR_SIGNAL,
    STATE_SIGNAL,
    SUM_SIGNAL,
    SWITCH_SIGNAL,
    TABLE_SIGNAL,
    TIME_SIGNAL,
    Block,
    Signal,
    has_rate,
    in_order,
)
from ...model.time_functions import POLYNOMIAL, MotionFunction, is_signal
from .functions import Functions, listed
from .line import ElementLine
from .measures import Measures
from .reader import COORDINATES
from .words import SIGNAL_KEYS

_TIME = MotionFunction(POLYNOMIAL, (0.0, 1.0, 0.0, 0.0))
_COLUMNS = ("coordinate", "rate", "effort")
# What ends names of quantities that are no inputs, and what to measure in its place.
_FROM_FORCES = (
    "accelerations and reactions follow from forces that signals drive, an algebraic loop; measure a rate or "
    "the effort of a stiff SPRING in the place of the joint"
)
_AFTER_RUN = (
    "stresses and strains are computed after the run; measure the distance of two nodes, as a strain gauge "
    "does: SIGNAL name measure from=1:2 to=1:3"
)
_NOT_MEASURED = dict.fromkeys(("acceleration", "reaction", "force", "torque", "moment"), _FROM_FORCES)
_NOT_MEASURED |= dict.fromkeys(("stress", "strain"), _AFTER_RUN)
_OTHER_KEYS = ("number",)  # that lines of all types may have


def built_signals(
    lines: Sequence[ElementLine], measures: Measures, functions: Functions, forces: Sequence[Element]
) -> tuple[Signal, ...]:
    """Return the signals of lines, none after a fault; those that lines name within others follow them."""
    own = [line for line in lines if line.word == "SIGNAL"]
    before = _errors(measures)
    builder = _Builder(own, measures, functions, forces)
    signals = builder.signals()
    if _errors(measures) > before:
        return ()
    order, circle = in_order(signals)
    if circle:
        names = [signals[k].name or "…" for k in circle]
        line = own[min(circle)]
        message = (
            f"{' follows from '.join([*names, names[0]])}: an algebraic loop; put a state into it, such as "
            "SIGNAL transfer of a lag, or a sample"
        )
        measures.findings.error(line.subject, message, line.place, id="ELEMENTS-083")
        return ()
    builder.refuse_missing_rates(signals, has_rate(signals, order))
    return () if _errors(measures) > before else tuple(signals)


def _errors(measures: Measures) -> int:
    return sum(fault.severity == "error" for fault in measures.findings.faults)


class _Builder:
    """Makes signals of lines; those that lines name within others are collected after them."""

    def __init__(
        self, lines: list[ElementLine], measures: Measures, functions: Functions, forces: Sequence[Element]
    ):
        self.lines, self.measures, self.functions, self.forces = lines, measures, functions, forces
        self.numbers = {line.subject: k for k, line in enumerate(lines)}
        self.more: list[Signal] = []

    def signals(self) -> list[Signal]:
        """Return the signals, not all where there are faults."""
        built = [self._signal(line) for line in self.lines]
        return [*(signal for signal in built if signal is not None), *self.more]

    def _signal(self, line: ElementLine) -> Signal | None:
        before = _errors(self.measures)
        self._check_keys(line)
        if _errors(self.measures) > before:
            return None
        fields = _MAKERS[line.kind](self, line)
        if fields is None or _errors(self.measures) > before:
            return None
        limits: dict[str, Any] = {key: float(line[key]) for key in ("lower", "upper") if key in line}
        if limits.get("lower", -np.inf) > limits.get("upper", np.inf):
            message = f"upper must not be less than lower, {limits['lower']:g}; read {limits['upper']:g}"
            self._error(line, line.at("upper"), message, id="ELEMENTS-084")
        return Signal(line.subject, place=line.place, **limits, **fields)

    def _error(self, line: ElementLine, number: Number | None, message: str, *, id: str) -> None:
        self.measures.error(line, number or Number("", "", "", "", line.place), message, id=id)

    def _check_keys(self, line: ElementLine) -> None:
        needed, optional = SIGNAL_KEYS[line.kind]
        given = list(dict.fromkeys(one.key.partition(".")[0] for one in line.numbers))
        terms = line.kind in ("sum", "product")
        for key in given:
            if not (terms and key[-1:].isdigit()) and key not in (*needed, *optional, *_OTHER_KEYS):
                has = " and ".join((*needed, *optional)) or "terms only"
                message = f"{line.kind} has no {key}; it has {has}"
                number = next(one for one in line.numbers if one.key.partition(".")[0] == key)
                self._error(line, number, message, id="ELEMENTS-085")
        missing = [key for key in needed if key not in given]
        if missing or (terms and not given):
            message = f"{line.kind} needs {' and '.join(f'{key}=' for key in missing) or 'terms'}"
            self._error(line, None, message, id="ELEMENTS-086")

    # What signals follow from

    def _named(self, line: ElementLine, key: str) -> list[Number]:
        return [one for one in line.numbers if one.key.partition(".")[0] == key]

    def _inputs(self, line: ElementLine, *keys: str) -> tuple[int, ...]:
        """Return the numbers of the signals of some keys, each of which names one."""
        inputs = []
        for key in keys:
            numbers = self._named(line, key)
            if len(numbers) > 1:
                self._error(line, numbers[1], f"{line.kind} takes one signal, {key}=", id="ELEMENTS-087")
            inputs.append(self._input(line, numbers[0]))
        return tuple(inputs)

    def _input(self, line: ElementLine, number: Number) -> int:
        """Return the number of a signal, or of what is measured, at whose name a fault would stand."""
        text = str(number.value)
        if text in self.numbers:
            return self.numbers[text]
        base, _, last = text.rpartition(".")
        signal: Signal | None = None
        if COORDINATES.fullmatch(text) or (last == "rate" and COORDINATES.fullmatch(base)):
            coordinate = text if last != "rate" else base
            at = self.measures.named(line, number, coordinate.lower())
            column = "rate" if last == "rate" else "coordinate"
            signal = Signal("", SENSOR_SIGNAL, measure=At(*at), column=column) if at else None
        elif last == "rate" and base in self.numbers:
            signal = Signal("", RATE_SIGNAL, (self.numbers[base],))
        elif base and last in _COLUMNS:
            signal = self._of_element(line, number, base, last)
        elif last in _NOT_MEASURED:
            self._error(
                line, number, f"{text} is not an input of signals: {_NOT_MEASURED[last]}", id="ELEMENTS-274"
            )
        elif text == "time":
            signal = Signal("", TIME_SIGNAL, function=_TIME)
        elif text in self.functions:
            function = self.functions.named(text)
            signal = Signal("", TIME_SIGNAL, function=function) if function else None
        else:
            message = (
                f"there is no signal {text}; the deck has {listed(self.numbers) or 'none'}; measures are "
                "2.angle, 2.angle.rate, spring.effort or time"
            )
            self._error(line, number, message, id="ELEMENTS-088")
        if signal is None:
            return 0
        self.numbers[text] = len(self.lines) + len(self.more)
        self.more.append(signal)
        return self.numbers[text]

    def _of_element(self, line: ElementLine, number: Number, base: str, column: str) -> Signal | None:
        """Return what an element answers; this must follow neither from signals nor from reactions."""
        element = next((item for item in self.forces if item.name == base), None)
        values = zip(element.law.parameters, element.values, strict=True) if element else ()
        if element is None:
            message = f"there is no element {base}; {column} is that of a force element"
        elif any(p.kind in FUNCTIONS and is_signal(value) for p, value in values):
            message = f"{base} follows a signal; take that signal in place of its {column}"
        elif element.law is FRICTION or len(element.parts) > 1:
            why = "follows from reaction forces" if element.law is FRICTION else "has several parts"
            message = f"{base} {why}, and gives no signal"
        else:
            return Signal("", ELEMENT_SIGNAL, element=base, column=column)
        self._error(line, number, message, id="ELEMENTS-089")
        return None

    def refuse_missing_rates(self, signals: Sequence[Signal], known: Sequence[bool]) -> None:
        """Refuse rates of what has none, of signals and for the gain kd."""
        for k, signal in enumerate(signals):
            derived = signal.kind == RATE_SIGNAL or (
                signal.kind == STATE_SIGNAL and signal.block is not None and bool(signal.block.E.any())
            )
            lacking = [i for i in signal.inputs if derived and not known[i]]
            if lacking:
                user = next((line for line in self.lines if self.numbers[line.subject] == k), None)
                user = user or next(
                    line for line in self.lines if k in signals[self.numbers[line.subject]].inputs
                )
                what = signals[lacking[0]].name or "what it measures"
                message = f"the rate of {what} is not known; give kd with filter=, or measure the rate itself"
                self._error(user, None, message, id="ELEMENTS-090")

    # Types of signals

    def measure(self, line: ElementLine) -> Any:
        """A coordinate, the distance of two points, or the displacement along an axis."""
        if "at" in line:
            at = self.measures.at(line)
            return at and {"kind": SENSOR_SIGNAL, "measure": At(*at)}
        if not self._named(line, "from") or not self._named(line, "to"):
            self._error(line, None, "measure takes at=, or from= and to=", id="ELEMENTS-091")
            return None
        ends = self.measures.ends(line)
        if not ends:
            return None
        measure = Along(*ends, "xyz".index(line["along"].lower())) if "along" in line else Line(*ends)
        return {"kind": SENSOR_SIGNAL, "measure": measure}

    def sum(self, line: ElementLine) -> Any:
        """A constant and signals, each times a factor."""
        constant, factors, inputs = 0.0, [], []
        for one in line.numbers:
            if one.key.startswith("c"):
                constant += one.value
            elif one.key.startswith("factor"):
                factors.append(one.value)
            elif one.key.startswith("term"):
                inputs.append(self._input(line, one))
        return {"kind": SUM_SIGNAL, "inputs": tuple(inputs), "numbers": (constant, *factors)}

    def product(self, line: ElementLine) -> Any:
        """A constant factor, and signals or what is divided by them."""
        constant, powers, inputs = 1.0, [], []
        for one in line.numbers:
            if one.key.startswith("c"):
                constant *= one.value
            elif one.key.startswith("power"):
                powers.append(one.value)
            elif one.key.startswith("term"):
                inputs.append(self._input(line, one))
        return {"kind": PRODUCT_SIGNAL, "inputs": tuple(inputs), "numbers": (constant, *powers)}

    def table(self, line: ElementLine) -> Any:
        """A function of a signal."""
        function = self.functions.function(line, "function")
        if is_signal(function):
            message = f"{line['function']} is a signal; a table is a FUNCTION"
            self._error(line, line.at("function"), message, id="ELEMENTS-092")
        return function and {"kind": TABLE_SIGNAL, "inputs": self._inputs(line, "of"), "function": function}

    def limit(self, line: ElementLine) -> Any:
        """A signal within limits, or how far it lies beyond them."""
        return {
            "kind": LIMIT_SIGNAL if line.kind == "limit" else DEADZONE_SIGNAL,
            "inputs": self._inputs(line, "of"),
        }

    def switch(self, line: ElementLine) -> Any:
        """One signal or another, by a third."""
        width = float(line["width"]) if "width" in line else 0.0
        if width < 0.0:
            message = f"width must not be negative; read {width:g}"
            self._error(line, line.at("width"), message, id="ELEMENTS-093")
        inputs = self._inputs(line, "of", "below", "above")
        return {"kind": SWITCH_SIGNAL, "inputs": inputs, "numbers": (float(line["level"]), width)}

    # Blocks with states

    def _list(self, line: ElementLine, key: str, size: int | None = None) -> np.ndarray:
        """Numbers of a key, zeros without it; refused if they are not so many."""
        numbers = self._named(line, key)
        if size is not None and numbers and len(numbers) != size:
            message = f"{key} takes {size} number{'s' * (size != 1)}; read {len(numbers)}"
            self._error(line, numbers[0], message, id="ELEMENTS-094")
            return np.zeros(size)
        return np.array([one.value for one in numbers], float) if numbers else np.zeros(size or 0)

    def _block(self, line: ElementLine, A: Any, B: Any, C: Any, D: Any, **more: Any) -> Any:
        """The fields of a block; with `period` its matrices are those from sample to sample."""
        period, delay = (float(line[key]) if key in line else 0.0 for key in ("period", "delay"))
        if "period" in line and not period > 0.0:
            message = f"period must be larger than 0; read {period:g}"
            self._error(line, line.at("period"), message, id="ELEMENTS-095")
            return None
        if delay < 0.0 or (delay and not period):
            message = f"delay must not be negative; read {delay:g}" if period else "a delay needs period="
            self._error(line, line.at("delay"), message, id="ELEMENTS-096")
            return None
        D = np.asarray(D, float)
        parts: dict[str, Any] = {"E": np.zeros(D.size), "start": np.zeros(len(A)), **more}
        block = Block(A, np.asarray(B, float), np.asarray(C, float), D, period=period, delay=delay, **parts)
        return {"kind": SAMPLE_SIGNAL if period else STATE_SIGNAL, "block": block}

    def integral(self, line: ElementLine) -> Any:
        """The integral of a signal over time, which stands still at its limits."""
        start = self._list(line, "start", 1)
        fields = self._block(line, np.zeros((1, 1)), [[1.0]], [1.0], [0.0], start=start, stops_at_limits=True)
        return {**fields, "inputs": self._inputs(line, "of")}

    def pid(self, line: ElementLine) -> Any:
        """kp e + ki times the integral of e + kd times its rate, which a time constant may filter."""
        kp, ki, kd, lag = (float(line[key]) if key in line else 0.0 for key in ("kp", "ki", "kd", "filter"))
        if lag < 0.0:
            message = f"filter must not be negative; read {lag:g}"
            self._error(line, line.at("filter"), message, id="ELEMENTS-097")
            return None
        start, inputs = self._list(line, "start", 1), self._inputs(line, "of")
        if "period" in line:
            fields = self._sampled_pid(line, kp, ki, kd, lag, start[0])
        elif lag:
            A, B = np.diag([0.0, -1.0 / lag]), [[1.0], [1.0 / lag]]
            first = np.array([start[0], 0.0])
            C, D = [ki, -kd / lag], [kp + kd / lag]
            fields = self._block(line, A, B, C, D, start=first, stops_at_limits=True)
        else:
            E = np.array([kd])
            fields = self._block(
                line, np.zeros((1, 1)), [[1.0]], [ki], [kp], E=E, start=start, stops_at_limits=True
            )
        return fields and {**fields, "inputs": inputs}

    def _sampled_pid(
        self, line: ElementLine, kp: float, ki: float, kd: float, lag: float, start: float
    ) -> Any:
        """The same from sample to sample: the integral by the rectangle after each, the rate by differences.

        The lag of the rate is that of backward differences.
        """
        T = float(line["period"])
        if not T > 0.0:
            return self._block(line, np.zeros((0, 0)), np.zeros((0, 1)), [], [0.0])
        # States: sum of the samples times T; sample before; filtered rate before.
        b = lag / (lag + T)
        A = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -(1.0 - b) / T, b]])
        B = [[T], [1.0], [(1.0 - b) / T]]
        C, D = [ki, -kd * (1.0 - b) / T, kd * b], [kp + ki * T + kd * (1.0 - b) / T]
        first = np.array([start, 0.0, 0.0])
        return self._block(line, A, B, C, D, start=first, stops_at_limits=True)

    def transfer(self, line: ElementLine) -> Any:
        """A transfer function in controllable form, with all states 0 at the start."""
        above, below = self._list(line, "numerator"), self._list(line, "denominator")
        n = len(below) - 1
        if not below.size or below[0] == 0.0 or len(above) > n + 1:
            message = (
                "the denominator begins with a number other than 0, and the numerator is not longer than it"
            )
            self._error(line, self._named(line, "denominator")[0], message, id="ELEMENTS-098")
            return None
        a = below[1:] / below[0]
        b = np.concatenate([np.zeros(n + 1 - len(above)), above]) / below[0]
        A = np.eye(n, k=-1)
        A[:1] = -a
        B = np.eye(n)[:, :1]
        fields = self._block(line, A, B, b[1:] - b[0] * a, b[:1])
        return fields and {**fields, "inputs": self._inputs(line, "of")}

    def state(self, line: ElementLine) -> Any:
        """dx/dt = A x + B e, y = C x + D e for one or more signals e."""
        inputs = tuple(self._input(line, one) for one in self._named(line, "of"))
        n, m = len(self._named(line, "c")), len(inputs)
        A, B = self._list(line, "a", n * n).reshape(n, n), self._list(line, "b", n * m).reshape(n, m)
        D, start = self._list(line, "d", m), self._list(line, "start", n)
        fields = self._block(line, A, B, self._list(line, "c"), D, start=start)
        return fields and {**fields, "inputs": inputs}

    def sample(self, line: ElementLine) -> Any:
        """A signal as it was at the last sample."""
        held = float(self._list(line, "start", 1)[0])
        fields = self._block(line, np.zeros((0, 0)), np.zeros((0, 1)), np.zeros(0), [1.0], held=held)
        return fields and {**fields, "inputs": self._inputs(line, "of")}


_MAKERS: dict[str, Callable[[_Builder, ElementLine], Any]] = {
    kind: getattr(_Builder, {"deadzone": "limit"}.get(kind, kind)) for kind in SIGNAL_KEYS
}
