"""Force elements, couplings and motions of a rigid chain as lines of a block of a DAFMS deck."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ....deck.fortran_fields import filled
from ....model.exchange.function_cards import FunctionCards
from ....model.exchange.functions import points_of
from ....model.joints import ANGLE
from ....model.laws import Element, Frames
from ....model.mechanism import GROUND
from ...elements_block.writer import BlockWriter, block, numbers
from ..cards import CARDS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....model.exchange.chain import Link
    from ....model.exchange.rigid_model import Refusals
    from ....model.loads import AppliedTorque
    from .hanging import Hanging


_SAME_AXES = 1e-9
_ROUND_OFF = 1e-15  # m, of frames


def integers(*values: int) -> str:
    """Return integers in five columns each."""
    return "".join(f"{value:5d}" for value in values)


class ElementLines(BlockWriter):
    """Writes the lines; a subclass places the bodies and numbers their hinges."""

    dialect, function_id = "DAFMS", "DAFMS-174"
    model: Any
    refusals: "Refusals"
    rounding: float  # the largest of numbers, relative
    functions: FunctionCards
    number: dict[int, int]  # of bodies in the tree
    hinge_of: dict[int | None, int]
    links: "list[Link]"
    hung: "dict[int, Hanging]"

    def hinge_elements(self) -> list[str]:
        """The block of force elements, couplings and prescribed motions."""
        for item in self.model.elements:
            if isinstance(item.measure, Frames):
                self._check_axes(item)
        lines = self.element_lines()
        for driver in self.model.joint_drivers:
            lines.append(self.driver_line(driver, f"at={self.coordinate(driver.joint, driver.coordinate)}"))
        return block([*self.function_lines(), *lines])

    def coordinate(self, joint: int, coordinate: str) -> str:
        """Return the spelling of a coordinate."""
        hinge = self.hinge_of[joint]
        return f"{hinge}.{'r' if coordinate == ANGLE else 't'}{self.hung[self.links[hinge - 1].body].axis}"

    def joint(self, joint: int) -> int:
        """Return the number of the body on whose hinge a joint lies."""
        return self.hinge_of[joint]

    def end(self, body: int, point: Any) -> str:
        """Return the spelling of an end."""
        place = [0.0 if abs(x) < _ROUND_OFF else x for x in self._point(body, point)]
        return f"{0 if body == GROUND else self.number[body]}({numbers(place, ',')})"

    @property
    def reserved(self) -> frozenset[str]:
        """Return names of sections of the deck."""
        return frozenset(card.section for card in CARDS.values())

    def _check_axes(self, item: Element) -> None:
        i = item.measure.i
        if i != GROUND and np.abs(self.hung[i].own - self.model.axes(i)).max() > _SAME_AXES:
            message = "a bushing acts along the axes of its first body, which DAFMS lays along its hinge"
            self.refusals.add(item, message, id="DAFMS-175")

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

    def entries(self, word: str, entries: "Sequence[str]") -> list[Any]:
        """Return a card with its records behind their number; none without records."""
        return [word, integers(len(entries)), *entries] if entries else []

    def real(self, value: float) -> Any:
        """Ten columns of a number; its rounding is kept for the notes."""
        value = float(value) + 0.0
        # Round-off of the frames, which would fill its columns by an exponent.
        text = "0.0" if abs(value) < _ROUND_OFF else filled(value, 10)
        if value and text != "0.0":
            self.rounding = max(self.rounding, abs(float(text) - value) / max(abs(value), 1e-3))
        return text.rjust(10)
