"""Elements at joints and between bodies as cards of a VSDF deck, in free form."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from ....model.exchange.function_cards import FunctionCards, without_card
from ....model.exchange.rigid_model import Refusals, RigidModel
from ....model.joint_elements import Coupling
from ....model.joints import ANGLE
from ....model.laws import SPRING, At, Element, Joint
from ..elements.cards import FUNCTION_KINDS
from ..joints import SLIDING, TURNING

if TYPE_CHECKING:
    from collections.abc import Sequence

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

    def elements(self) -> list[tuple[str, list[str]]]:
        """Words of cards of force elements and couplings, and their records."""
        found: dict[str, list[str]] = {}
        for item in self.model.elements:
            word = self._word(item)
            found.setdefault(word, []).append(self._record(word, item, len(found.get(word, ())) + 1))
        terms = [line for n, item in enumerate(self.model.couplings, 1) for line in _coupling(n, item)]
        return [*found.items(), ("COUP", terms)]

    def _word(self, item: Element) -> str:
        """Return the word of an element's card; the older ones SPRI and JSPR hold fewer springs."""
        old = item.linear and not any(value < 0.0 for value in (item["stiffness"], item["damping"]))
        if isinstance(item.measure, At):
            kind = self.model.joints[item.measure.joint].kind
            if old and (kind in TURNING if item.turning else kind in SLIDING and kind not in TURNING):
                return "JSPR"
            return f"{'T' if item.turning else 'A'}{item.law.word}"[:4]
        if item.law is SPRING:
            return "SPRI" if old and item["rest"] >= 0.0 else "LSPR"
        return item.law.word[:4]

    def _record(self, word: str, item: Element, number: int) -> str:
        measure = item.measure
        if isinstance(measure, At | Joint):
            head: tuple[int, ...] = (measure.joint + 1,)
        else:
            i, j, P_i, P_j = measure
            head = i + 1, self._node(i, P_i), j + 1, self._node(j, P_j)
        if word in ("SPRI", "JSPR"):
            law = item["stiffness"], item["damping"], item["rest"]
            return record(*([number] if word == "SPRI" else []), *head, *law)
        return record(*head, *item.numbers(lambda function: self.number(function, item)))


def _coupling(number: int, item: Coupling) -> list[str]:
    return [
        record(number, joint + 1, 1 if coordinate == ANGLE else 2, factor)
        for joint, coordinate, factor in item.terms
    ]


def record(*values: Any) -> str:
    """A card in free form; the blank in front keeps a word from being read as a keyword."""
    return "    " + ",".join(_text(value) for value in values)


def _text(value: float | str) -> str:
    if isinstance(value, str | int):
        return str(value)
    # 0.0 and no negative zero; all digits of a double.
    return repr(float(value) + 0.0)
