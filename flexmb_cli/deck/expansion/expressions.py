"""Formulas of numbers and names, parsed by a grammar of their own and never evaluated as Python.

    sum     = product {("+" | "-") product}
    product = sign {("*" | "/") sign}
    sign    = {"+" | "-"} power
    power   = atom [("^" | "**") sign]
    atom    = number | name | function "(" sum {"," sum} ")" | "(" sum ")"

Names are those of variables, with or without $, or of quantities, such as `body.1.z`; one with other
characters stands in double quotes.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import reduce
from math import isfinite, pi
from typing import Any, NamedTuple

MOST_CHARACTERS, MOST_NESTED = 4000, 50
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?)|\$?(?P<name>[A-Za-z_]\w*(?:\.\w+)*)"
    r'|"(?P<quoted>[^"]+)"|(?P<sign>\*\*|[-+*/^(),]))'
)
FORMULA = "formula"  # key of the text of one in a record
CONSTANTS = {"pi": pi}


class Function(NamedTuple):
    """A function of formulas."""

    of: str  # numpy's name
    least: int = 1  # arguments
    most: int = 1  # arguments, 0: any number


_SAME_NAME = (
    "sin", "cos", "tan", "sinh", "cosh", "tanh", "sqrt", "exp", "log", "log10", "abs", "sign",
    "floor", "ceil",
)  # fmt: skip
FUNCTIONS = {
    **{name: Function(name) for name in _SAME_NAME},
    **{name: Function(f"arc{name[1:]}") for name in ("asin", "acos", "atan")},
    "atan2": Function("arctan2", 2, 2),
    "hypot": Function("hypot", 2, 2),
    "min": Function("minimum", 2, 0),
    "max": Function("maximum", 2, 0),
}
_OPERATORS = {"+": "add", "-": "subtract", "*": "multiply", "/": "divide"}


class WrongFormula(ValueError):
    """A text is not a formula; `offset` is where, in characters."""

    def __init__(self, message: str, offset: int):
        super().__init__(message)
        self.offset = offset


@dataclass(frozen=True)
class Formula:
    """A parsed formula: `parts` in the order of evaluation, as a stack takes them.

    A part is a number, a name, or numpy's name of a function with the number of its arguments.
    """

    text: str
    parts: tuple[Any, ...]

    @property
    def names(self) -> list[str]:
        """Return the names in it, each once."""
        return list(dict.fromkeys(part for part in self.parts if isinstance(part, str)))

    def value(self, value_of: Callable[[str], Any]) -> Any:
        """Return the value, a number or an array; `value_of` gives those of names."""
        import numpy as np  # decks are read without it

        stack: list[Any] = []
        with np.errstate(all="ignore"):
            for part in self.parts:
                if isinstance(part, str):
                    stack.append(value_of(part))
                elif isinstance(part, tuple):
                    name, count = part
                    numbers = [np.asarray(each, float) for each in stack[-count:]]
                    function = getattr(np, name)
                    stack[-count:] = [reduce(function, numbers) if count > 1 else function(*numbers)]
                else:
                    stack.append(part)
        return stack[0]


def formula(text: str) -> Formula:
    """Return the formula in a text.  Raises WrongFormula."""
    if len(text) > MOST_CHARACTERS:
        raise WrongFormula(f"a formula has at most {MOST_CHARACTERS} characters", 0)
    parser = _Parser(text)
    parser.sum()
    if parser.sign:
        raise WrongFormula(f"'{parser.sign}' follows a complete formula", parser.start)
    if parser.kind:
        raise WrongFormula("an operator is missing here", parser.start)
    return Formula(text, tuple(parser.parts))


class _Parser:
    """The token at hand, and the parts so far."""

    def __init__(self, text: str):
        self.text, self.end, self.nested = text, 0, 0
        self.parts: list[Any] = []
        self.next()

    def next(self) -> None:
        """Go on to the next token."""
        self.start = self.end + len(self.text[self.end :]) - len(self.text[self.end :].lstrip())
        token = _TOKEN.match(self.text, self.end)
        if token is None and self.text[self.end :].strip():
            raise WrongFormula(f"'{self.text[self.start]}' belongs to no formula", self.start)
        self.kind = token.lastgroup if token else None
        self.word = token[token.lastgroup] if token and token.lastgroup else ""
        self.sign = ("^" if self.word == "**" else self.word) if self.kind == "sign" else ""
        self.end = token.end() if token else len(self.text)

    def sum(self) -> None:
        """Take a sum."""
        self.nested += 1
        if self.nested > MOST_NESTED:
            raise WrongFormula(f"more than {MOST_NESTED} parentheses or powers in each other", self.start)
        self._chain("+-", lambda: self._chain("*/", self._signed))
        self.nested -= 1

    def _chain(self, signs: str, operand: Callable[[], None]) -> None:
        operand()
        while self.sign and self.sign in signs:
            apply = _OPERATORS[self.sign]
            self.next()
            operand()
            self.parts.append((apply, 2))

    def _signed(self) -> None:
        negative = False
        while self.sign in ("+", "-"):
            negative ^= self.sign == "-"
            self.next()
        self._power()
        if negative:
            self.parts.append(("negative", 1))

    def _power(self) -> None:
        self._atom()
        if self.sign == "^":
            self.nested += 1
            if self.nested > MOST_NESTED:
                raise WrongFormula(f"more than {MOST_NESTED} powers in each other", self.start)
            self.next()
            self._signed()
            self.nested -= 1
            self.parts.append(("power", 2))

    def _atom(self) -> None:
        kind, word, start = self.kind, self.word, self.start
        if kind is None or (kind == "sign" and word != "("):
            before = f" before '{word}'" if word else ""
            raise WrongFormula(f"a number or a name is missing{before}", start)
        self.next()
        if kind == "sign":
            self.sum()
            self._close()
        elif kind == "number":
            self.parts.append(float(word.lower().replace("d", "e")))
        elif kind == "name" and self.sign == "(":
            self._call(word, start)
        else:
            self.parts.append(CONSTANTS.get(word.lower(), word) if kind == "name" else word)

    def _call(self, name: str, start: int) -> None:
        function = FUNCTIONS.get(name.lower())
        if function is None:
            raise WrongFormula(f"there is no function {name}, only {', '.join(FUNCTIONS)}", start)
        count = 0
        while count == 0 or self.sign == ",":
            self.next()
            self.sum()
            count += 1
        self._close()
        if not function.least <= count <= (function.most or count):
            arguments = f"{function.least}{' or more' * (not function.most)}"
            raise WrongFormula(f"{name} takes {arguments} of numbers; read {count}", start)
        self.parts.append((function.of, count))

    def _close(self) -> None:
        if self.sign != ")":
            raise WrongFormula("')' is missing", self.start)
        self.next()


def evaluated(formulas: dict[str, Formula], chosen: dict[str, float]) -> Iterator[tuple[str, float | str]]:
    """Yield the value of each named formula that names others, in any order, or what is wrong with it.

    `chosen`: values that take the places of formulas.
    """
    values: dict[str, float | str] = dict(chosen)
    for name in formulas:
        pending = [name]
        while pending:
            last = pending[-1]
            missing = [one for one in formulas[last].names if one not in values] if last not in values else []
            circle = next((one for one in missing if one in pending), None)
            unknown = next((one for one in missing if one not in formulas), None)
            if circle:
                values[last] = (
                    f"is defined by itself: {' → '.join([*pending[pending.index(circle) :], circle])}"
                )
            elif unknown:
                values[last] = f"names {unknown}, which no line SET defines"
            elif missing:
                pending.append(missing[0])
                continue
            elif last not in values:
                values[last] = _number(formulas[last], values)
            pending.pop()
        yield name, values[name]


def _number(one: Formula, values: dict[str, float | str]) -> float | str:
    if wrong := [name for name in one.names if isinstance(values[name], str)]:
        return f"names {wrong[0]}, which has no value"
    value = float(one.value(values.__getitem__))
    return value if isfinite(value) else f"is {value}, which no deck may hold"
