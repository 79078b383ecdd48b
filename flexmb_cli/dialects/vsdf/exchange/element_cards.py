"""Elements at joints and between bodies as cards of a VSDF deck, in free form."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from ....model.exchange.function_cards import FunctionCards, without_card
from ....model.exchange.rigid_model import Refusals, RigidModel
from ....model.joint_elements import Coupling, JointFriction
from ....model.joints import ANGLE
from ....model.laws import LAWS
from ..elements.cards import FUNCTION_KINDS
from ..joints import SLIDING, TURNING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....model.exchange.rigid_model import CoordinateSpring
    from ....model.time_functions import MotionFunction


_KINDS = {kind: word for word, kind in FUNCTION_KINDS.items()}
FIRST_FUNCTION = 1001  # numbers of tables are smaller: functions have none of theirs


class ElementCards(ABC):
    """Makes the cards; a subclass numbers the nodes."""

    def __init__(self, model: RigidModel):
        self.model, self.refusals = model, Refusals()
        self.functions = FunctionCards(FIRST_FUNCTION)

    @abstractmethod
    def _node(self, body: int, place: "Sequence[float]") -> int:
        """Return the number of the node at a place of a body."""

    def function_records(self) -> list[str]:
        """Return the records of all functions that have been numbered."""
        return [record(n, _KINDS[kind], *numbers) for n, kind, numbers in self.functions.cards]

    def number(self, function: "MotionFunction", item: Any) -> int:
        """Number of the function card of an item; 0 where it cannot be written."""
        number = self.functions.number(function)
        if not number:
            self.refusals.add(item, without_card(function, "VSDF"), id="VSDF-170")
        return number

    def has_jspr(self, item: "CoordinateSpring") -> bool:
        """Return whether the older card JSPR holds a spring; it has none in strokes of joints that turn."""
        kind = self.model.joints[item.joint].kind
        return kind in TURNING if item.coordinate == ANGLE else kind in SLIDING and kind not in TURNING

    def elements(self) -> list[tuple[str, list[str]]]:
        """Cards of springs with functions, stops, cables, bushings, couplings and friction."""
        model = self.model
        springs: list[tuple[Any, tuple[Any, ...]]] = [
            (item, self._plain_spring(item)) for item in model.joint_springs if not self.has_jspr(item)
        ]
        springs += [(item, self._characteristics(item)) for item in model.preloaded]
        lines = [(item, self._nodes_of(item)) for item in model.lines]
        return [
            *(
                (word, [record(item.joint + 1, *numbers) for item, numbers in springs
                        if (item.coordinate == ANGLE) == turning])
                for word, turning in (("TSPR", True), ("ASPR", False))
            ),
            *self._motors(),
            *(
                (f"{letter}{law.word}"[:4], [record(i.joint + 1, *i.values) for i in model.laws
                                             if i.law is law and (i.coordinate == ANGLE) == (letter == "T")])
                for law in LAWS
                for letter in "TA"
            ),
            ("LSPR", [record(*ends, *self._characteristics(item)) for item, ends in lines if not item.slack]),
            ("CABL", [record(*ends, item.stiffness, item.rest, item.damping)
                      for item, ends in lines if item.slack]),
            ("BUSH", [record(*self._nodes_of(item), *item.stiffness, *item.damping)
                      for item in model.bushings]),
            ("COUP", [line for n, item in enumerate(model.couplings, 1) for line in _coupling(n, item)]),
            ("FRIC", [_friction(item) for item in model.frictions]),
        ]  # fmt: skip

    def _motors(self) -> list[tuple[str, list[str]]]:
        """Motors in angles, then in strokes."""
        found = [(item, self.number(item.function, item)) for item in self.model.motors]
        return [
            (word, [record(item.joint + 1, n) for item, n in found if (item.coordinate == ANGLE) == turning])
            for word, turning in (("TMOT", True), ("AMOT", False))
        ]

    def _nodes_of(self, item: Any) -> tuple[int, ...]:
        return item.i + 1, self._node(item.i, item.P_i), item.j + 1, self._node(item.j, item.P_j)

    def _plain_spring(self, item: Any) -> tuple[Any, ...]:
        return item.stiffness, item.rest, item.damping, 0.0, 0, 0

    def _characteristics(self, item: Any) -> tuple[Any, ...]:
        """Numbers of a spring and damper, those of its functions last."""
        functions = [self.number(f, item) if f else 0 for f in (item.curve, item.damper)]
        return item.stiffness, item.rest, item.damping, item.preload, *functions


def _coupling(number: int, item: Coupling) -> list[str]:
    return [
        record(number, joint + 1, 1 if coordinate == ANGLE else 2, factor)
        for joint, coordinate, factor in item.terms
    ]


def _friction(item: JointFriction) -> str:
    numbers = item.dynamic, item.static, item.stribeck, item.creep, item.radius, item.preload
    return record(item.joint + 1, *numbers)


def record(*values: Any) -> str:
    """A card in free form; the blank in front keeps a word from being read as a keyword."""
    return "    " + ",".join(_text(value) for value in values)


def _text(value: float | str) -> str:
    if isinstance(value, str | int):
        return str(value)
    # 0.0 and no negative zero; all digits of a double.
    return repr(float(value) + 0.0)
