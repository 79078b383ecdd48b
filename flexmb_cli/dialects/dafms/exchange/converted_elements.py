"""Elements at hinges and between bodies of a DAFMS deck in the terms of `model.exchange`."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ....model.exchange.conversion import Conversion, place_of
from ....model.exchange.functions import moved
from ....model.exchange.rigid_model import CoordinateSpring
from ....model.joint_elements import Bushing, Coupling, JointDriver, JointMotor, JointSpring
from ....model.joints import ANGLE, STROKE
from ....model.laws import JointLaw
from ....model.tree import ROTATION, Tree


class ConvertedElements(Conversion):
    """Converts the elements; a subclass makes joints of the hinges."""

    tree: Tree
    number: dict[int, int]  # of the joint of a body's hinge
    q: dict[tuple[int, str, int], float]  # coordinates at the start, by body, motion and axis

    def _elements(self) -> dict[str, tuple[Any, ...]]:
        """Elements in one joint coordinate, which count from the start."""
        found: dict[str, tuple[Any, ...]] = {}
        counted = {"drivers": (), "motors": (), "springs": ("rest",), "laws": ()}
        for kind, names in counted.items():
            items = [self._in_joint(item, names) for item in getattr(self.tree.elements, kind)]
            found[kind] = tuple(item for item in items if item)
        return found

    def _in_joint(self, item: Any, names: tuple[str, ...]) -> Any:
        where = self._joint_coordinate(item, item.joint, item.coordinate)
        if where is None:
            return None
        joint, coordinate, q = where
        changed = {name: getattr(item, name) - q for name in names}
        if isinstance(item, JointDriver):
            # From 0 at the start, as joint coordinates here are.
            start = self.tree.time.start
            changed["function"] = moved(item.function, start, item.function.at(start)[0])
        elif isinstance(item, JointMotor):
            changed["function"] = moved(item.function, self.tree.time.start)
        elif isinstance(item, JointLaw):
            changed["values"] = item.since(q)
        elif isinstance(item, JointSpring) and not (item.preload or item.curve or item.damper):
            law = item.stiffness, item.rest - q, item.damping
            return CoordinateSpring(item.name, joint, coordinate, *law, item.place)
        return replace(item, joint=joint, coordinate=coordinate, **changed)

    def _joint_coordinate(self, item: Any, body: int, coordinate: str) -> tuple[int, str, float] | None:
        """Number of the joint of a body's hinge, the coordinate there, and its value at the start."""
        hinge, (motion, axis) = self.tree.hinges[body], coordinate.split()
        free = len(hinge.rotations), len(hinge.translations)
        if body not in self.number or free not in ((1, 0), (0, 1), (1, 1)):
            message = "in a hinge with several free rotations or translations it is not converted"
            self.refusals.add(item, message, id="DAFMS-173")
            return None
        return self.number[body], ANGLE if motion == ROTATION else STROKE, self.q[body, motion, int(axis)]

    def _bushings(self) -> Iterator[Bushing]:
        for item in self.tree.elements.bushings:
            ends = (item.i, place_of(item.P_i)), (item.j, place_of(item.P_j))
            if found := self.bushing(item, ends, self.now):
                yield found

    def _couplings(self) -> Iterator[Coupling]:
        for item in self.tree.elements.couplings:
            places = [self._joint_coordinate(item, body, name) for body, name, _ in item.terms]
            if None not in places:
                terms = zip(places, item.terms, strict=True)
                yield replace(item, terms=tuple((p[0], p[1], factor) for p, (_, _, factor) in terms if p))
