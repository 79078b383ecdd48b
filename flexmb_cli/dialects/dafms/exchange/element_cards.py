"""Springs, dampers, motors, motions, stops and friction of a rigid chain as cards of a DAFMS deck."""

from typing import TYPE_CHECKING, Any

from ....deck.fortran_fields import filled
from ....model.exchange.functions import points_of, polynomial_of, value_of
from ....model.joints import ANGLE
from ....model.mechanism import GROUND

if TYPE_CHECKING:
    from ....model.exchange.chain import Link
    from ....model.exchange.rigid_model import Refusals
    from .hanging import Hanging


def integers(*values: int) -> str:
    """Return integers in five columns each."""
    return "".join(f"{value:5d}" for value in values)


class ElementCards:
    """Makes the cards; a subclass places the bodies and numbers their hinges."""

    model: Any
    refusals: "Refusals"
    rounding: float  # the largest of numbers, relative
    number: dict[int, int]  # of bodies in the tree
    hinge_of: dict[int | None, int]
    links: "list[Link]"
    hung: "dict[int, Hanging]"

    def hinge_elements(self) -> Any:
        """Springs, dampers, motors and prescribed motions."""
        springs, dampers, motors, tables, motions = [], [], [], [], []
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
            else:
                k, which = self._place(item)
                tables.append(self.table(k, which, self.points_at(item, item.function)))
        for item in self.model.joint_drivers:
            c = polynomial_of(item.function)
            if c is None or len(c) > 3:
                message = "only motions C + B t + A t^2/2 are converted to DAFMS (PRES)"
                self.refusals.add(item, message)
                continue
            C, B, half = (*c, 0.0, 0.0)[:3]
            motions.append(self._dof(item) + "".join(self.real(x) for x in (C, B, 2.0 * half)))
        cards: list[tuple[str, list[Any]]] = [
            ("LSPR", list(map(self._spring, self.model.springs))),
            ("SPRI", springs), ("DAMP", dampers), ("MOTR", motors), ("TABM", tables), ("PRES", motions),
            ("HSTO", list(map(self._stop, self.model.stops))),
            ("FRIC", list(map(self._friction, self.model.frictions))),
        ]  # fmt: skip
        return [line for word, entries in cards for line in self.entries(word, entries)]

    def _stop(self, item: Any) -> str:
        numbers = item.lower, item.upper, item.stiffness, item.damping
        return str(self._dof(item)) + "".join(map(self.real, numbers))

    def _friction(self, item: Any) -> str:
        numbers = item.dynamic, item.static, item.stribeck, item.creep, item.radius, item.preload
        return integers(self.hinge_of[item.joint]) + "".join(map(self.real, numbers))

    def _spring(self, item: Any) -> str:
        """A spring and damper between points in the axes of O_k."""
        ends = (item.i, item.P_i), (item.j, item.P_j)
        numbers = [x for body, _ in ends for x in (0 if body == GROUND else self.number[body], 0)]
        points = [x for body, P in ends for x in self._point(body, P)]
        constants = item.stiffness, item.free_length, item.damping
        rows = points, constants
        return "\n".join([integers(*numbers, 0, 0), *("".join(map(self.real, row)) for row in rows)])

    def _point(self, body: int, P: Any) -> Any:
        """A point from O_k, axes of O_k; of the ground from the origin."""
        place = self.model.position(body, P)
        if body == GROUND:
            return place
        hung = self.hung[body]
        return hung.own.T @ (place - hung.origin)

    def points_at(self, item: Any, function: Any) -> Any:
        """Return the points of a table; another function is refused."""
        points = points_of(function)
        if points is None:
            self.refusals.add(item, "only tables of loads are converted to DAFMS; give the function as TABLE")
        return points or []

    def table(self, k: int, which: Any, points: Any) -> Any:
        """Return the records of a table: body, degree of freedom, points."""
        lines = [integers(k, which, len(points))]
        return "\n".join([*lines, *(self.real(t) + self.real(v) for t, v in points)])

    def _place(self, item: Any) -> Any:
        """Body of the hinge, and the number of its degree of freedom."""
        k = self.hinge_of[item.joint]
        axis = self.hung[self.links[k - 1].body].axis
        return k, axis if item.coordinate == ANGLE else axis + 3

    def _dof(self, item: Any) -> Any:
        return integers(*self._place(item))

    def entries(self, word: Any, entries: Any) -> Any:
        """Return a card with its records behind their number; none without records."""
        return [word, integers(len(entries)), *entries] if entries else []

    def real(self, value: Any) -> Any:
        """Ten columns of a number; its rounding is kept for the notes."""
        value = float(value) + 0.0
        # Round-off of the frames, which would fill its columns by an exponent.
        text = "0.0" if abs(value) < 1e-15 else filled(value, 10)
        if value and text != "0.0":
            self.rounding = max(self.rounding, abs(float(text) - value) / max(abs(value), 1e-3))
        return text.rjust(10)
