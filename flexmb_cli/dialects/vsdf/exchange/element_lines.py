"""Elements at joints and between bodies as lines of a block, and cards of a VSDF deck in free form."""

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from ....model.exchange.function_cards import FunctionCards
from ....model.exchange.rigid_model import Refusals, RigidModel
from ....model.mechanism import GROUND
from ...elements_block.writer import BlockWriter, numbers
from ..cards import BY_WORD

if TYPE_CHECKING:
    from collections.abc import Sequence


FIRST_FUNCTION = 1001  # numbers of tables are smaller: functions have none of theirs


class ElementLines(BlockWriter):
    """Writes the lines; a subclass numbers the nodes."""

    dialect, function_id = "VSDF", "VSDF-170"

    def __init__(self, model: RigidModel):
        self.model, self.refusals = model, Refusals()
        self.functions = FunctionCards(FIRST_FUNCTION)

    @abstractmethod
    def _node(self, body: int, place: "Sequence[float]") -> int:
        """Return the number of the node at a place of a body."""

    @property
    def reserved(self) -> frozenset[str]:
        """Return names of sections of the deck."""
        return frozenset(card.section for card in BY_WORD.values())

    def coordinate(self, joint: int, coordinate: str) -> str:
        """Return the spelling of a coordinate."""
        return f"{joint + 1}.{coordinate}"

    def joint(self, joint: int) -> int:
        """Return the number of a joint in the deck."""
        return joint + 1

    def end(self, body: int, point: Any) -> str:
        """Return the spelling of an end: a point of the ground, or a node."""
        return f"0({numbers(point, ',')})" if body == GROUND else f"{body + 1}:{self._node(body, point)}"


def record(*values: Any) -> str:
    """A card in free form; the blank in front keeps a word from being read as a keyword."""
    return "    " + ",".join(_text(value) for value in values)


def _text(value: float | str) -> str:
    if isinstance(value, str | int):
        return str(value)
    # 0.0 and no negative zero; all digits of a double.
    return repr(float(value) + 0.0)
