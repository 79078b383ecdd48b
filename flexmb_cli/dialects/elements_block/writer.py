"""Writer of the block ELEMENTS: the inverse of its reader, for conversion and `table --as-table`."""

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from ...model.exchange.function_cards import FunctionCards, without_card
from ...model.joint_elements import Coupling
from ...model.laws import FUNCTIONS, VECTOR, At, Cam, Element, Joint
from .text import BLOCK
from .words import key_of

_WIDTH = 100  # columns of a line
_NOT_OF_NAMES = re.compile(r"[^A-Za-z0-9_-]+")


def spline_block(functions: Sequence[tuple[int, str, list[Any]]]) -> str:
    """Return a block of splines, each a number, a heading and points (time, value)."""
    splines = ((number, numbers(x for p in points for x in p)) for number, _, points in functions)
    lines = (f"FUNCTION {number} spline {text}" for number, text in splines)
    return "".join(f"{line}\n" for line in block(lines))


def block(lines: Iterable[str]) -> list[str]:
    """Return a block of lines, nothing without any; long ones continue on lines that are indented further."""
    pieces = [piece for line in lines for piece in _pieces(line)]
    return [BLOCK, *pieces] if pieces else []


def numbers(values: Iterable[Any], between: str = " ") -> str:
    """Return numbers with all digits of a double, without negative zeros."""
    return between.join(str(x) if isinstance(x, int) else repr(float(x) + 0.0) for x in values)


def _pieces(line: str) -> Iterator[str]:
    text = " "
    for word in line.split(" "):
        if len(text) + len(word) >= _WIDTH:
            yield text
            text = "     "
        text = f"{text} {word}"
    yield text


class BlockWriter(ABC):
    """Writes lines of functions and elements; a subclass spells coordinates, joints and ends of its dialect.

    `model`: with `elements` and `couplings`.
    """

    model: Any
    functions: FunctionCards
    refusals: Any
    dialect = ""
    function_id = ""  # identifier of the fault of a function without a line
    reserved: frozenset[str]  # names of sections of the deck, which elements must not have

    @abstractmethod
    def coordinate(self, joint: int, coordinate: str) -> str:
        """Return the spelling of a coordinate."""

    @abstractmethod
    def joint(self, joint: int) -> int:
        """Return the number of a joint in the deck."""

    @abstractmethod
    def end(self, body: int, point: Any) -> str:
        """Return the spelling of an end at a point of a body of the model."""

    def function_number(self, function: Any, item: Any) -> int:
        """Number of a function of an item, whose lines are kept; 0 where it cannot be written."""
        number = self.functions.number(function)
        if not number:
            self.refusals.add(item, without_card(function, self.dialect), id=self.function_id)
        return number

    def element_lines(self) -> list[str]:
        """Return the lines of force elements and couplings."""
        forces = [self._force(item) for item in self.model.elements]
        return [*forces, *map(self._coupling, self.model.couplings)]

    def function_lines(self) -> list[str]:
        """Return the lines of all functions that have been numbered."""
        return [f"FUNCTION {n} {kind} {numbers(values)}" for n, kind, values in self.functions.cards]

    def driver_line(self, item: Any, what: str) -> str:
        """Return the line of a driver; `what`: the key that says what it drives."""
        number, rate = self.functions.driver(item.function)
        if not number:
            self.refusals.add(item, without_card(item.function, self.dialect), id=self.function_id)
        return f"DRIVE {self.name(item)} {what} {'rate' if rate else 'value'}={number}"

    def name(self, item: Any) -> str:
        """Return the name of an item in the deck, which no other one has."""
        names: set[str] = self.__dict__.setdefault("_names", set())
        base = _NOT_OF_NAMES.sub("-", item.name).strip("-") or "element"
        base = f"e{base}" if base.isdigit() else base
        free_name, count = base, 1
        while free_name.lower() in names or free_name.lower() in self.reserved:
            count += 1
            free_name = f"{base}-{count}"
        names.add(free_name.lower())
        return free_name

    def _cam(self, function: Any, item: Any, follower: str, cam: str) -> str:
        return f"from={cam} to={follower} function={self.function_number(function, item)}"

    def _force(self, item: Element) -> str:
        measure = item.measure
        if isinstance(measure, Cam):
            follower, cam = self.coordinate(*measure[:2]), self.coordinate(*measure[2:4])
            values = zip(item.law.parameters, item.values, strict=True)
            limits = (f"{p.name}={numbers([x])}" for p, x in values if math.isfinite(x))
            ends = self._cam(measure.function, item, follower, cam)
            return " ".join(["COUPLING", self.name(item), ends, *limits])
        if isinstance(measure, At):
            acts = f"at={self.coordinate(*measure)}"
        elif isinstance(measure, Joint):
            acts = f"joint={self.joint(measure.joint)}"
        else:
            acts = f"from={self.end(measure.i, measure.P_i)} to={self.end(measure.j, measure.P_j)}"
        return " ".join([item.law.word, self.name(item), acts, *self._law_keys(item)])

    def _law_keys(self, item: Element) -> Iterator[str]:
        for p, value in zip(item.law.parameters, item.values, strict=True):
            if p.kind in FUNCTIONS:
                if value is not None:
                    yield f"{key_of(p)}={self.function_number(value, item)}"
            elif value != p.default:
                text = f"({numbers(value, ',')})" if p.kind == VECTOR else numbers([value])
                yield f"{key_of(p)}={text}"

    def _coupling(self, item: Coupling) -> str:
        if item.function:
            follower, cam = (self.coordinate(joint, name) for joint, name, _ in item.terms)
            return f"COUPLING {self.name(item)} {self._cam(item.function, item, follower, cam)}"
        terms = (f"{self.coordinate(joint, name)}={numbers([factor])}" for joint, name, factor in item.terms)
        return f"COUPLING {self.name(item)} {' '.join(terms)}"
