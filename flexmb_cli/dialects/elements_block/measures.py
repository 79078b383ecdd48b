"""Measures of the elements of a block: coordinates of joints and hinges, and ends on bodies."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

from ...deck.record import Number
from ...model.diagnostics import Findings, no_such
from ...model.joint_elements import COORDINATES_OF, OF_ELEMENTS
from ...model.joints import ANGLE, ANGLES_OF_CROSS
from .line import ElementLine

_A = {"angle": "an angle", "stroke": "a stroke"}
# Joints whose parts turn about several axes: none of their angles is the angle of an element.
_SEVERAL_ANGLES = {"spherical": "three angles"}


class Measures(ABC):
    """Finds what the lines of a block name; None where a fault was found, which goes into `findings`."""

    def __init__(self, findings: Findings):
        self.findings = findings

    @abstractmethod
    def named(self, line: ElementLine, number: Number, text: str) -> tuple[int, str] | None:
        """Joint or hinge, from 0, and the coordinate that a text names; faults at the place of a number."""

    @abstractmethod
    def sliding(self, line: ElementLine) -> tuple[int, bool] | None:
        """Joint or hinge whose parts slide on each other, from 0, and whether they turn."""

    @abstractmethod
    def ends(self, line: ElementLine) -> tuple[int, int, Any, Any] | None:
        """Bodies i and j, -1 being the ground, and the ends on them."""

    def is_rigid(self, line: ElementLine, body: int, key: str) -> bool:
        """Return whether the end `key` keeps its place and attitude in a body: points do."""
        return True

    def turns(self, line: ElementLine, body: int) -> bool:
        """Return whether the end `to`, on a body, turns with it: points do."""
        return True

    def at(self, line: ElementLine) -> tuple[int, str] | None:
        """Joint or hinge and coordinate of the key `at`."""
        number = line.at("at")
        return self.named(line, number, number.value)

    def error(self, line: ElementLine, number: Number, message: str, *, id: str) -> Any:
        """Report what is wrong with a number of a line."""
        self.findings.error(line.subject, message, number.place or line.place, id=id)

    def body(self, line: ElementLine, key: str, bodies: int) -> int | None:
        """Body of an end, from 0, -1 for the ground."""
        number = line.at(f"{key}.body")
        if not 0 <= number.value <= bodies:
            self.error(line, number, no_such("body", number.value, bodies, 0), id="ELEMENTS-033")
            return None
        return int(number.value) - 1

    def two_bodies(self, line: ElementLine, i: int, j: int) -> bool:
        """Return whether ends are on two bodies; else a fault says so."""
        if i != j:
            return True
        what = f"body {i + 1}" if i >= 0 else "the ground, body 0"
        self.error(
            line, line.at("to.body"), f"both ends are on {what}; two bodies are needed", id="ELEMENTS-034"
        )
        return False


class JointMeasures(Measures):
    """Coordinates of joints: the angle or the stroke, joints counted through the deck."""

    def __init__(self, joints: Sequence[Any], findings: Findings):
        """Take the joints, with `name` and `kind`, in the order of their numbers."""
        super().__init__(findings)
        self.joints = joints

    def named(self, line: ElementLine, number: Number, text: str) -> tuple[int, str] | None:
        """Joint, from 0, and its coordinate."""
        count, _, coordinate = text.partition(".")
        if coordinate not in (*_A, *ANGLES_OF_CROSS):
            message = (
                f"a joint has the coordinates angle and stroke, a universal joint angle1 and angle2, such as "
                f"{count}.angle; read {text}"
            )
            self.error(line, number, message, id="ELEMENTS-046")
            return None
        joint = self._joint(line, number, int(count))
        if joint is None:
            return None
        kind = self.joints[joint].kind
        if coordinate not in OF_ELEMENTS[kind]:
            self.error(line, number, self._lacks(joint, kind, coordinate), id="ELEMENTS-045")
            return None
        return joint, coordinate

    def _lacks(self, joint: int, kind: str, coordinate: str) -> str:
        name, others = f"joint {joint + 1} ({self.joints[joint].name})", OF_ELEMENTS[kind]
        turning = "a joint that turns about one axis, such as revolute joints with bodies between them"
        if ANGLES_OF_CROSS[0] in others:
            first, second = (f"{joint + 1}.{one}" for one in ANGLES_OF_CROSS)
            return f"{name} turns by two angles, {first} and {second}; take one of them"
        if kind in _SEVERAL_ANGLES:
            return f"{name} turns by {_SEVERAL_ANGLES[kind]}, not by one; take {turning}"
        if not others:
            return (
                f"{name} has neither an angle nor a stroke of its own; take a joint that turns about one "
                "axis, or slides along one"
            )
        asked = _A.get(coordinate, "two angles")
        return f"{name} has {_A[others[0]]}, not {asked}; take {joint + 1}.{others[0]}"

    def _joint(self, line: ElementLine, number: Number, count: int) -> int | None:
        if not 1 <= count <= len(self.joints):
            self.error(line, number, no_such("joint", count, len(self.joints)), id="ELEMENTS-003")
            return None
        return count - 1

    def sliding(self, line: ElementLine) -> tuple[int, bool] | None:
        """Joint with an axis, and whether it turns about it."""
        number = line.at("joint")
        joint = self._joint(line, number, number.value)
        if joint is None:
            return None
        kinds = COORDINATES_OF[self.joints[joint].kind]
        if not kinds:
            message = f"{self.joints[joint].name} turns about no axis: it takes no friction"
            self.error(line, number, message, id="ELEMENTS-006")
            return None
        return joint, ANGLE in kinds
