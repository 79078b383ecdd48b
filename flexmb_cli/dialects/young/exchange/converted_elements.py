"""Springs, stops, bushings and couplings of a YOUNG deck in the terms of `model.exchange`."""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ....model.exchange.conversion import Conversion, End, Pose, coordinate_since, place_of
from ....model.joint_elements import Coupling
from ....model.loads import DynamicModel
from ....model.mechanism import Mechanism


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

    def end(self, body: int, point: Any) -> End:
        """A body there, and the point on it."""
        return self.number[body], self._point(body, place_of(point))

    def joint_of(self, joint: int) -> int | None:
        """Number of a joint there; None of one between grounded bodies."""
        return self.joints.get(joint)

    def joint_coordinate(self, item: Any, joint: int, coordinate: str) -> tuple[int, str, float] | None:
        """A joint and its coordinate there, with its value at the start: YOUNG counts from the estimates."""
        if joint not in self.joints:
            return None
        given = self.mechanism.joints[joint]
        axis = given.s_i, given.P_i, given.P_j
        start = coordinate_since(coordinate, axis, (given.i, given.j), (self.first, self.now))
        return self.joints[joint], coordinate, start

    def _couplings(self) -> Iterator[Coupling]:
        for item in self.deck.elements.couplings:
            if all(joint in self.joints for joint, _, _ in item.terms):
                terms = tuple((self.joints[joint], name, factor) for joint, name, factor in item.terms)
                yield replace(item, terms=terms)
            else:
                self.refusals.add(
                    item, "a coupling of a joint between grounded bodies is not converted", id="YOUNG-163"
                )
