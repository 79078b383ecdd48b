"""Springs, stops, bushings and couplings of a YOUNG deck in the terms of `model.exchange`."""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ....model.exchange.conversion import Conversion, Pose, coordinate_since, place_of
from ....model.exchange.functions import constant
from ....model.exchange.rigid_model import CoordinateSpring
from ....model.joint_elements import Bushing, Coupling, JointMotor, JointSpring, LineSpring
from ....model.laws import JointLaw
from ....model.loads import DynamicModel, SpringDamper
from ....model.mechanism import GROUND, Mechanism

if TYPE_CHECKING:
    from ....model.time_functions import MotionFunction


class ConvertedElements(Conversion):
    """Converts the elements; a subclass numbers bodies and joints anew and moves points and functions."""

    deck: DynamicModel
    mechanism: Mechanism
    number: dict[int, int]  # new numbers of bodies
    joints: dict[int, int]  # new numbers of joints
    first: list[Pose]  # in which joint coordinates are 0

    @abstractmethod
    def _point(self, body: Any, point: tuple[float, float, float]) -> Any:
        """Return a point of a body on its new body."""

    @abstractmethod
    def _function(self, function: "MotionFunction") -> Any:
        """Return a function of time from the start on."""

    def _offset(self, number: int, coordinate: str) -> Any:
        """A joint coordinate at the start: YOUNG counts it from the estimates."""
        joint = self.mechanism.joints[number]
        axis = joint.s_i, joint.P_i, joint.P_j
        return coordinate_since(coordinate, axis, (joint.i, joint.j), (self.first, self.now))

    def _law(self, item: JointLaw) -> JointLaw:
        values = item.since(self._offset(item.joint, item.coordinate))
        return replace(item, joint=self.joints[item.joint], values=values)

    def _motors(self) -> Iterator[Any]:
        for item in self.deck.elements.motors:
            if item.joint in self.joints:
                yield replace(item, joint=self.joints[item.joint], function=self._function(item.function))

    def _preloaded(self) -> Iterator[JointSpring]:
        """Springs with forces by functions."""
        for item in self.deck.elements.springs:
            if (item.curve or item.damper) and item.joint in self.joints:
                rest = item.rest - self._offset(item.joint, item.coordinate)
                yield replace(item, joint=self.joints[item.joint], rest=rest)

    def _lines(self) -> Iterator[LineSpring]:
        """Cables, and springs in line that a spring and damper without functions cannot stand for."""
        for item in self.deck.elements.lines:
            i, j = self.number[item.i], self.number[item.j]
            if _is_of_its_own(item) and not i == GROUND == j:
                ends = self._point(item.i, place_of(item.P_i)), self._point(item.j, place_of(item.P_j))
                yield replace(item, i=i, j=j, P_i=ends[0], P_j=ends[1])

    def _bushings(self) -> Iterator[Bushing]:
        for item in self.deck.elements.bushings:
            i, j = (
                (self.number[body], self._point(body, place_of(P)))
                for body, P in ((item.i, item.P_i), (item.j, item.P_j))
            )
            found = self.bushing(item, (i, j), self.first)
            if found and not i[0] == GROUND == j[0]:
                yield found

    def _couplings(self) -> Iterator[Coupling]:
        for item in self.deck.elements.couplings:
            if all(joint in self.joints for joint, _, _ in item.terms):
                terms = tuple((self.joints[joint], name, factor) for joint, name, factor in item.terms)
                yield replace(item, terms=terms)
            else:
                self.refusals.add(
                    item, "a coupling of a joint between grounded bodies is not converted", id="YOUNG-163"
                )

    def _joint_springs(self) -> tuple[Any, Any]:
        """Springs without preload, and motors with the preload of those without stiffness."""
        springs, motors = [], []
        for item in self.deck.elements.springs:
            if not (item.curve or item.damper) and item.joint in self.joints:
                joint, name = self.joints[item.joint], item.name
                rest = item.rest - self._offset(item.joint, item.coordinate)
                if item.preload and not item.stiffness:
                    function = constant(-item.preload)
                    motors.append(JointMotor(name, joint, item.coordinate, function, item.place))
                elif item.preload:
                    rest -= item.preload / item.stiffness
                springs.append(
                    CoordinateSpring(
                        name, joint, item.coordinate, item.stiffness, rest, item.damping, item.place
                    )
                )
        return tuple(springs), tuple(motors)

    def _springs(self) -> tuple[Any, ...]:
        found = [self._spring(item, item.free_length) for item in self.deck.springs]
        for item in self.deck.elements.lines:
            if not _is_of_its_own(item):
                shift = item.preload / item.stiffness if item.preload else 0.0
                found.append(self._spring(item, item.rest - shift))
        return tuple(spring for spring in found if not spring.i == GROUND == spring.j)

    def _spring(self, item: Any, rest: Any) -> SpringDamper:
        i, j = self.number[item.i], self.number[item.j]
        ends = self._point(item.i, place_of(item.P_i)), self._point(item.j, place_of(item.P_j))
        return SpringDamper(item.name, i, j, *ends, item.stiffness, rest, item.damping, item.place)


def _is_of_its_own(item: LineSpring) -> bool:
    """Return whether an element in line is more than a spring with another length at rest."""
    return bool(item.slack or item.curve or item.damper or (item.preload and not item.stiffness))
