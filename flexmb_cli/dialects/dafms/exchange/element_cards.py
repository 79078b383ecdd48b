"""Springs, dampers, motors, motions, stops and friction of a rigid chain as cards of a DAFMS deck."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ....deck.fortran_fields import filled
from ....model.exchange.function_cards import Card, FunctionCards, without_card
from ....model.exchange.functions import points_of, polynomial_of, value_of
from ....model.joints import ANGLE
from ....model.laws import MOTOR, NUMBER, SPRING, At, Element, Frames, Joint
from ....model.mechanism import GROUND
from ..elements.cards import FUNCTION_KINDS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ....model.exchange.chain import Link
    from ....model.exchange.rigid_model import Refusals
    from ....model.loads import AppliedTorque
    from ....model.time_functions import MotionFunction
    from .hanging import Hanging


_SAME_AXES = 1e-9
_ON_A_RECORD = 4  # numbers of a function
_KIND_NUMBERS = {kind: number for number, kind in FUNCTION_KINDS.items()}


def integers(*values: int) -> str:
    """Return integers in five columns each."""
    return "".join(f"{value:5d}" for value in values)


class ElementCards:
    """Makes the cards; a subclass places the bodies and numbers their hinges."""

    model: Any
    refusals: "Refusals"
    rounding: float  # the largest of numbers, relative
    functions: FunctionCards
    number: dict[int, int]  # of bodies in the tree
    hinge_of: dict[int | None, int]
    links: "list[Link]"
    hung: "dict[int, Hanging]"

    def hinge_elements(self) -> list[Any]:
        """Force elements, couplings and prescribed motions."""
        cards: dict[str, list[Any]] = {
            word: [] for word in ("LSPR", "CABL", "SPRI", "DAMP", "MOTR", "TABM", "PRES")
        }
        for item in self.model.elements:
            for word, text in self._element(item):
                cards.setdefault(word, []).append(text)
        for driver in self.model.joint_drivers:
            c, dof = polynomial_of(driver.function), self._dof(driver.joint, driver.coordinate)
            if c is None or len(c) > 3:
                cards.setdefault("PREF", []).append(dof + integers(*self._followed(driver)))
                continue
            C, B, half = (*c, 0.0, 0.0)[:3]
            cards["PRES"].append(dof + "".join(self.real(x) for x in (C, B, 2.0 * half)))
        cards["COUP"] = [x for n, item in enumerate(self.model.couplings, 1) for x in self._terms(n, item)]
        cards = {"FUNC": list(map(_function, self.functions.cards))} | cards
        return [line for word, entries in cards.items() for line in self.entries(word, entries)]

    def _element(self, item: Element) -> "Iterator[tuple[str, str]]":
        """Words of cards and the entries that an element has there."""
        measure = item.measure
        if isinstance(measure, At):
            yield from self._in_hinge(item, self._dof(*measure))
            return
        numbers = item.numbers(lambda function: self._number(function, item))
        if isinstance(measure, Joint):
            yield "FRIC", integers(self.hinge_of[measure.joint]) + "".join(map(self.real, numbers))
        elif isinstance(measure, Frames):
            self._check_axes(item)
            yield "BUSH", self._between(measure, (), numbers[:6], numbers[6:])
        elif item.law is SPRING:
            yield "LSPR", self._between(measure, numbers[4:], numbers[:4])
        else:
            yield item.law.word[:4], self._between(measure, (), numbers)

    def _in_hinge(self, item: Element, dof: str) -> "Iterator[tuple[str, str]]":
        if item.law is MOTOR:
            yield self._motor(item, dof)
        elif item.linear:
            if item["stiffness"]:
                yield "SPRI", dof + self.real(item["stiffness"]) + self.real(item["rest"])
            if item["damping"]:
                yield "DAMP", dof + self.real(item["damping"])
        else:
            numbers = item.numbers(lambda function: self._number(function, item))
            reals = sum(p.kind == NUMBER for p in item.law.parameters)
            yield (
                "HSPR" if item.law is SPRING else f"H{item.law.word}"[:4],
                dof + "".join(map(self.real, numbers[:reals])) + integers(*numbers[reals:]),
            )

    def _motor(self, item: Element, dof: str) -> tuple[str, str]:
        value = value_of(item["function"])
        if value is not None:
            return "MOTR", dof + self.real(value)
        if points := points_of(item["function"]):
            return "TABM", self.table(*self._freedom(*item.measure), points)
        return "MOTF", dof + integers(self._number(item["function"], item))

    def _number(self, function: "MotionFunction", item: Any) -> int:
        """Number of the function card of an item; 0 where it cannot be written."""
        number = self.functions.number(function)
        if not number:
            self.refusals.add(item, without_card(function, "DAFMS"), id="DAFMS-174")
        return number

    def _followed(self, item: Any) -> tuple[int, int]:
        """Number of the function card of a driver, 0 where it cannot be written; 1 if its rate follows it."""
        number, rate = self.functions.driver(item.function)
        if not number:
            self.refusals.add(item, without_card(item.function, "DAFMS"), id="DAFMS-174")
        return number, int(rate)

    def _check_axes(self, item: Element) -> None:
        i = item.measure.i
        if i != GROUND and np.abs(self.hung[i].own - self.model.axes(i)).max() > _SAME_AXES:
            message = "a bushing acts along the axes of its first body, which DAFMS lays along its hinge"
            self.refusals.add(item, message, id="DAFMS-175")

    def _between(self, measure: Any, head: Any, *rows: Any) -> str:
        """An element between two bodies: numbers, points, its law."""
        ends = (measure.i, measure.P_i), (measure.j, measure.P_j)
        numbers = [x for body, _ in ends for x in (0 if body == GROUND else self.number[body], 0)]
        points = [x for body, P in ends for x in self._point(body, P)]
        lines = ["".join(map(self.real, row)) for row in (points, *rows)]
        return "\n".join([integers(*numbers, *head), *lines])

    def _terms(self, number: int, item: Any) -> list[str]:
        """The terms of a coupling."""
        found = []
        for joint, coordinate, factor in item.terms:
            freedom = self._freedom(joint, coordinate)
            found.append(integers(number, *freedom) + self.real(factor))
        return found

    def _point(self, body: int, P: Any) -> Any:
        """A point from O_k, axes of O_k; of the ground from the origin."""
        place = self.model.position(body, P)
        if body == GROUND:
            return place
        hung = self.hung[body]
        return hung.own.T @ (place - hung.origin)

    def points_at(self, item: "AppliedTorque", function: Any) -> Any:
        """Return the points of a table; another function is refused."""
        points = points_of(function)
        if points is None:
            self.refusals.add(
                item,
                "only tables of loads are converted to DAFMS; give the function as TABLE",
                id="DAFMS-176",
            )
        return points or []

    def table(self, k: int, which: int, points: "Sequence[tuple[float, float]]") -> str:
        """Return the records of a table: body, degree of freedom, points."""
        lines = [integers(k, which, len(points))]
        return "\n".join([*lines, *(self.real(t) + self.real(v) for t, v in points)])

    def _freedom(self, joint: int, coordinate: str) -> tuple[int, int]:
        """Body of the hinge, and the number of its degree of freedom."""
        k = self.hinge_of[joint]
        axis = self.hung[self.links[k - 1].body].axis
        return k, axis if coordinate == ANGLE else axis + 3

    def _dof(self, joint: int, coordinate: str) -> str:
        return integers(*self._freedom(joint, coordinate))

    def entries(self, word: str, entries: "Sequence[str]") -> list[Any]:
        """Return a card with its records behind their number; none without records."""
        return [word, integers(len(entries)), *entries] if entries else []

    def real(self, value: float) -> Any:
        """Ten columns of a number; its rounding is kept for the notes."""
        value = float(value) + 0.0
        # Round-off of the frames, which would fill its columns by an exponent.
        text = "0.0" if abs(value) < 1e-15 else filled(value, 10)
        if value and text != "0.0":
            self.rounding = max(self.rounding, abs(float(text) - value) / max(abs(value), 1e-3))
        return text.rjust(10)


def _function(card: Card) -> str:
    """The records of a function: number, type, how many numbers; the numbers with all their digits."""
    number, kind, values = card
    rows = [values[k : k + _ON_A_RECORD] for k in range(0, len(values), _ON_A_RECORD)]
    head = integers(number, _KIND_NUMBERS[kind], len(values))
    return "\n".join([head, *("".join(f"{x:20.12E}" for x in row) for row in rows)])
