"""Elements at hinges and between bodies of a DAFMS deck in the terms of `model.exchange`."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ....model.exchange.conversion import Conversion
from ....model.exchange.functions import moved
from ....model.joint_elements import Coupling, JointDriver
from ....model.joints import ANGLE, STROKE
from ....model.tree import ROTATION, Tree


class ConvertedElements(Conversion):
    """Converts the elements; a subclass makes joints of the hinges."""

    tree: Tree
    number: dict[int, int]  # of the joint of a body's hinge
    q: dict[tuple[int, str, int], float]  # coordinates at the start, by body, motion and axis

    def joint_of(self, joint: int) -> int | None:
        """Number of the joint of a body's hinge, None if it has none."""
        return self.number.get(joint)

    def _joint_drivers(self) -> "Iterator[JointDriver]":
        """Drivers by functions, from 0 at the start, as joint coordinates there are."""
        start = self.tree.time.start
        for item in self.tree.elements.drivers:
            if where := self.joint_coordinate(item, item.joint, item.coordinate):
                function = moved(item.function, start, item.function.at(start)[0])
                yield replace(item, joint=where[0], coordinate=where[1], function=function)

    def joint_coordinate(self, item: Any, body: int, coordinate: str) -> tuple[int, str, float] | None:
        """Number of the joint of a body's hinge, the coordinate there, and its value at the start."""
        hinge, (motion, axis) = self.tree.hinges[body], coordinate.split()
        free = len(hinge.rotations), len(hinge.translations)
        if body not in self.number or free not in ((1, 0), (0, 1), (1, 1)):
            message = "in a hinge with several free rotations or translations it is not converted"
            self.refusals.add(item, message, id="DAFMS-173")
            return None
        return self.number[body], ANGLE if motion == ROTATION else STROKE, self.q[body, motion, int(axis)]

    def _couplings(self) -> Iterator[Coupling]:
        for item in self.tree.elements.couplings:
            places = [self.joint_coordinate(item, body, name) for body, name, _ in item.terms]
            if None not in places:
                terms = zip(places, item.terms, strict=True)
                yield replace(item, terms=tuple((p[0], p[1], factor) for p, (_, _, factor) in terms if p))
