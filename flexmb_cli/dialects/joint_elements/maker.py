"""Makers of elements: how the cards of a dialect name joints and ends, and what they must not give."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

from ...deck.record import Record
from ...model.diagnostics import Findings, no_such
from ...model.joint_elements import COORDINATES_OF
from ...model.joints import ANGLE, STROKE
from .functions import Functions

_COORDINATES = {1: ANGLE, 2: STROKE}
_A = {ANGLE: "an angle", STROKE: "a stroke"}
# Joints whose parts turn about several axes: none of their angles is the angle of an element.
_SEVERAL_ANGLES = {"universal": " two angles", "spherical": " three angles"}


class ElementMaker(ABC):
    """Makes elements of records; None where a fault was found."""

    def __init__(self, functions: Functions, findings: Findings, start: float):
        self.functions, self.findings, self.start = functions, findings, start

    @abstractmethod
    def where(self, record: Record, coordinate: str | None, suffix: str = "") -> tuple[int, str] | None:
        """Joint and coordinate that a card means, by keys that end in `suffix`; None where there is none."""

    @abstractmethod
    def sliding(self, record: Record) -> tuple[int, bool] | None:
        """Joint whose parts slide on each other, and whether they turn; None where there is none."""

    @abstractmethod
    def ends(self, record: Record) -> dict[str, Any] | None:
        """Bodies i and j (-1: ground) and ends P_i, P_j of an element between two bodies."""

    def refuse_twice(self, items: Sequence[Any], key: Callable[..., Any]) -> None:
        """Refuse two items for one thing."""
        first: dict[str, Any] = {}
        for item in items:
            if item is None:
                continue
            other = first.setdefault(key(item), item)
            if other is not item:
                message = f"{other.name} already gives this; remove one of them"
                self.findings.error(item.name, message, item.place, id="ELEMENTS-001")

    def not_negative(self, record: Record, *keys: str) -> None:
        """Refuse numbers below 0."""
        for key in keys:
            if record[key] < 0.0:
                message = f"{key} must not be negative; read {record[key]:g}"
                self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-002")


class JointMaker(ElementMaker):
    """Makes elements of cards that name a joint by its number, and its angle or stroke."""

    def __init__(self, joints: Sequence[Any], functions: Functions, findings: Findings, start: float):
        """Take the joints, with `name` and `kind`, in the order of their numbers."""
        super().__init__(functions, findings, start)
        self.joints = joints

    def where(self, record: Record, coordinate: str | None, suffix: str = "") -> tuple[int, str] | None:
        """Joint and coordinate; the card gives the coordinate where it is None."""
        coordinate = coordinate or self._coordinate(record, f"coordinate{suffix}")
        joint = self._joint(record, coordinate, f"joint{suffix}")
        return None if joint is None or coordinate is None else (joint, coordinate)

    def _joint(self, record: Record, coordinate: str | None, key: str) -> Any:
        number = record[key]
        if not 1 <= number <= len(self.joints):
            message = no_such("joint", number, len(self.joints))
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-003")
            return None
        joint = self.joints[number - 1]
        if coordinate is not None and coordinate not in COORDINATES_OF[joint.kind]:
            kinds = COORDINATES_OF[joint.kind]
            has = " and ".join(_A[one] for one in kinds) or "neither an angle nor a stroke of its own"
            message = f"joint {number} ({joint.name}) has {has}" + f", not {_A[coordinate]}" * bool(kinds)
            other = "a joint that turns about one axis, or slides along one"
            if joint.kind in _SEVERAL_ANGLES:
                message = f"joint {number} ({joint.name}) turns by{_SEVERAL_ANGLES[joint.kind]}, not by one"
                other = "a joint that turns about one axis, such as revolute joints with bodies between them"
            elif kinds:
                code = next(code for code, one in _COORDINATES.items() if one in COORDINATES_OF[joint.kind])
                chosen = f"coordinate{key.removeprefix('joint')}" in record
                other = f"coordinate {code}" if chosen else "the card for it"
            message += f"; take {other}"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-004")
            return None
        return number - 1

    def _coordinate(self, record: Record, key: str) -> Any:
        if record[key] not in _COORDINATES:
            message = f"must be 1 (angle) or 2 (stroke); read {record[key]}"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-005")
            return None
        return _COORDINATES[record[key]]

    def sliding(self, record: Record) -> tuple[int, bool] | None:
        """Joint with an axis, and whether it turns about it."""
        joint = self._joint(record, None, "joint")
        if joint is None:
            return None
        kinds = COORDINATES_OF[self.joints[joint].kind]
        if not kinds:
            message = f"{self.joints[joint].name} turns about no axis: it takes no friction"
            self.findings.error(record.subject, message, record.at("joint").place, id="ELEMENTS-006")
            return None
        return joint, ANGLE in kinds
