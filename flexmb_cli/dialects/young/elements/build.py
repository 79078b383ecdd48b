"""The cards of functions, drivers, supports, composite joints and elements of a YOUNG deck."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ....deck.record import Deck, Record
from ....model.diagnostics import Findings, no_such
from ....model.joint_elements import CompositeJoint, DrivenItem, JointElements
from ....model.joints import ANGLE, STROKE
from ....model.mechanism import Mechanism
from ...elements_block.build import joined, lines_of
from ...elements_block.function_lines import given_functions
from ...joint_elements.build import JOINT_CARDS, Cards, joint_driver
from ...joint_elements.build import build_elements as elements_of
from ...joint_elements.functions import Functions, GivenFunction
from ...joint_elements.maker import JointMaker
from ..block_elements import block_elements
from .cards import FUNCTION_CARDS

_SECTIONS = tuple(card.section for card in FUNCTION_CARDS)
_LINKS = {"revcyl": "revolute-cylindrical", "revsph": "revolute-spherical", "sphsph": "spherical-spherical"}


def build_functions(deck: Deck, folder: Path, findings: Findings) -> Functions:
    """The functions of the deck, files being relative to `folder`; faults go into `findings`."""
    return Functions([*_given(deck), *given_functions(lines_of(deck), folder, findings)], findings)


def _given(deck: Deck) -> Iterator[GivenFunction]:
    for record in deck.records:
        if record.section in _SECTIONS:
            place = _places(record)
            yield GivenFunction(record, record.at("number"), record.section, record.values[1:], place)


def _places(record: Record) -> Any:
    return lambda k: record.numbers[1 + k].place


def build_elements(
    deck: Deck, mechanism: Mechanism, functions: Functions, findings: Findings
) -> JointElements:
    """All elements of the deck; faults go into `findings`."""
    maker = _Maker(mechanism, functions, findings)
    older = elements_of(maker, deck.section, _CARDS, reported=bool(deck.section("joints")))
    return joined(older, block_elements(lines_of(deck), mechanism, functions, findings))


class _Maker(JointMaker):
    """Makes elements of records; None where a fault was found."""

    def __init__(self, mechanism: Mechanism, functions: Functions, findings: Findings):
        super().__init__(mechanism.joints, functions, findings, mechanism.time.start)
        self.mechanism = mechanism

    def ends(self, record: Record) -> dict[str, int | tuple[float, float, float]]:
        """Bodies (-1: ground) and points of an element between two bodies."""
        return {
            "i": record["I"] - 1, "j": record["J"] - 1,
            "P_i": record.vector("P_i"), "P_j": record.vector("P_j"),
        }  # fmt: skip


def _driven(maker: _Maker, record: Record) -> DrivenItem | None:
    number, drivers = record["driver"], maker.mechanism.drivers
    if not 1 <= number <= len(drivers):
        message = no_such("driver", number, len(drivers))
        maker.findings.error(record.subject, message, record.at("driver").place, id="YOUNG-121")
        return None
    driver = drivers[number - 1]
    function = maker.functions.motion(record, maker.start, driver.C)
    return None if function is None else DrivenItem(record.subject, number - 1, function, record.place)


def _support(maker: _Maker, record: Record) -> DrivenItem | None:
    number, held = record["simplified"], maker.mechanism.simplified
    if not 1 <= number <= len(held):
        message = no_such("simplified constraint", number, len(held))
        maker.findings.error(record.subject, message, record.at("simplified").place, id="YOUNG-122")
        return None
    if held[number - 1].direction > 3:
        message = f"simplified constraint {number} holds an angle; x, y, z (directions 1 to 3) can be moved"
        maker.findings.error(record.subject, message, record.at("simplified").place, id="YOUNG-123")
        return None
    function = maker.functions.motion(record, maker.start)
    return None if function is None else DrivenItem(record.subject, number - 1, function, record.place)


def _composite(maker: Any, record: Any) -> CompositeJoint | None:
    axes = {key: record.vector(key) for key in ("s_i", "s_j") if f"{key}.x" in record}
    for key, s in axes.items():
        if not any(s):
            place = record.at(f"{key}.x").place
            maker.findings.error(record.subject, f"{key} has no length", place, id="YOUNG-130")
            return None
    size = float(record["length"]) if "length" in record else 0.0
    if "length" in record and not size > 0.0:
        message = f"the link's length must be above 0; read {size:g}"
        maker.findings.error(record.subject, message, record.at("length").place, id="YOUNG-131")
    # The other end of a link needs a direction that no equation uses.
    axes = {"s_i": (1.0, 0.0, 0.0), "s_j": (1.0, 0.0, 0.0)} | axes
    kind = _LINKS[record.section]
    return CompositeJoint(record.subject, kind, **maker.ends(record), **axes, size=size, place=record.place)


_CARDS: Cards = {
    "driven": [("drive", _driven)],
    "supports": [("support", _support)],
    "drivers": [("angle", joint_driver(ANGLE)), ("stroke", joint_driver(STROKE))],
    **JOINT_CARDS,
    "composites": [(section, _composite) for section in _LINKS],
}
