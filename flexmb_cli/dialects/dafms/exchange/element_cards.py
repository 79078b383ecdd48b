"""Springs, dampers, motors, motions, stops and friction of a rigid chain as cards of a DAFMS deck."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ....deck.fortran_fields import filled
from ....model.exchange.function_cards import Card, FunctionCards, without_card
from ....model.exchange.functions import points_of, polynomial_of, value_of
from ....model.joints import ANGLE
from ....model.laws import LAWS
from ....model.mechanism import GROUND
from ..elements.cards import FUNCTION_KINDS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....model.exchange.chain import Link
    from ....model.exchange.rigid_model import CoordinateSpring, Refusals
    from ....model.joint_elements import JointMotor
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
        """Springs, dampers, motors and prescribed motions."""
        springs, dampers, motors, tables, motions = [], [], [], [], []
        by_function: list[str] = []
        driven: list[str] = []
        for item in self.model.joint_springs:
            head = self._dof(item)
            if item.stiffness:
                springs.append(head + self.real(item.stiffness) + self.real(item.rest))
            if item.damping:
                dampers.append(head + self.real(item.damping))
        for item in self.model.motors:
            value = value_of(item.function)
            if value is not None:
                motors.append(self._dof(item) + self.real(value))
            elif points := points_of(item.function):
                tables.append(self.table(*self._place(item), points))
            else:
                by_function.append(self._dof(item) + integers(self._number(item.function, item)))
        for item in self.model.joint_drivers:
            c = polynomial_of(item.function)
            if c is None or len(c) > 3:
                driven.append(self._dof(item) + integers(*self._followed(item)))
                continue
            C, B, half = (*c, 0.0, 0.0)[:3]
            motions.append(self._dof(item) + "".join(self.real(x) for x in (C, B, 2.0 * half)))
        cards: list[tuple[str, list[Any]]] = [
            ("LSPR", [*map(self._spring, self.model.springs), *self._lines(slack=False)]),
            ("CABL", self._lines(slack=True)),
            ("SPRI", springs), ("DAMP", dampers), ("MOTR", motors), ("TABM", tables), ("PRES", motions),
            ("HSPR", list(map(self._preloaded, self.model.preloaded))),
            *((f"H{law.word}"[:4], [self._dof(i) + "".join(map(self.real, i.values))
                                    for i in self.model.laws if i.law is law]) for law in LAWS),
            ("BUSH", list(map(self._bushing, self.model.bushings))),
            ("COUP", [x for n, item in enumerate(self.model.couplings, 1) for x in self._terms(n, item)]),
            ("FRIC", list(map(self._friction, self.model.frictions))),
            ("MOTF", by_function), ("PREF", driven),
        ]  # fmt: skip
        cards.insert(0, ("FUNC", list(map(_function, self.functions.cards))))
        return [line for word, entries in cards for line in self.entries(word, entries)]

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

    def _preloaded(self, item: Any) -> str:
        numbers = item.stiffness, item.rest, item.damping, item.preload
        return str(self._dof(item)) + "".join(map(self.real, numbers)) + integers(*self._functions(item))

    def _functions(self, item: Any) -> list[int]:
        return [self._number(f, item) if f else 0 for f in (item.curve, item.damper)]

    def _lines(self, slack: bool) -> list[str]:
        """Cables, or springs in line with preloads or functions."""
        found = []
        for item in self.model.lines:
            if item.slack == slack:
                law = [item.stiffness, item.rest, item.damping, *([] if slack else [item.preload])]
                head = () if slack else self._functions(item)
                found.append(self._between(item, head, law))
        return found

    def _bushing(self, item: Any) -> str:
        if item.i != GROUND and np.abs(self.hung[item.i].own - self.model.axes(item.i)).max() > _SAME_AXES:
            message = "a bushing acts along the axes of its first body, which DAFMS lays along its hinge"
            self.refusals.add(item, message, id="DAFMS-175")
        return self._between(item, (), item.stiffness, item.damping)

    def _between(self, item: Any, head: Any, *rows: Any) -> str:
        """An element between two bodies: numbers, points, its law."""
        ends = (item.i, item.P_i), (item.j, item.P_j)
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

    def _stop(self, item: Any) -> str:
        numbers = item.lower, item.upper, item.stiffness, item.damping
        return str(self._dof(item)) + "".join(map(self.real, numbers))

    def _friction(self, item: Any) -> str:
        numbers = item.dynamic, item.static, item.stribeck, item.creep, item.radius, item.preload
        return integers(self.hinge_of[item.joint]) + "".join(map(self.real, numbers))

    def _spring(self, item: Any) -> str:
        """A spring and damper between points in the axes of O_k."""
        return self._between(item, (0, 0), (item.stiffness, item.free_length, item.damping))

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

    def _place(self, item: "CoordinateSpring | JointMotor") -> tuple[int, int]:
        """Body of the hinge, and the number of its degree of freedom."""
        return self._freedom(item.joint, item.coordinate)

    def _freedom(self, joint: int, coordinate: str) -> tuple[int, int]:
        k = self.hinge_of[joint]
        axis = self.hung[self.links[k - 1].body].axis
        return k, axis if coordinate == ANGLE else axis + 3

    def _dof(self, item: "CoordinateSpring | JointMotor") -> Any:
        return integers(*self._place(item))

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
