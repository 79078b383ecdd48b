"""Conversion of a dialect's model into a rigid model: the parts that all dialects share."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...errors import Place
from ..joint_elements import Coupling, JointDriver, JointElements
from ..joints import ANGLE
from ..laws import OF_TIME, At, Cam, Element, Frames, Joint, Parameter, Push, Touch
from ..mechanism import GROUND, Vector
from ..shapes import Shape, ShapeCard
from ..vectors import rotation_matrix
from .functions import transformed
from .rigid_model import Refusals, RigidBody, RigidModel, across, vector

Pose = tuple[np.ndarray, np.ndarray]  # origin (3,), m, and rotation matrix (3, 3), body to global axes
End = tuple[int, Vector]  # body of the new model, and a point on it
SAME_ATTITUDE = 1e-9  # rad
STILL = (np.zeros(3), np.eye(3))  # the pose of the ground, the last of those of bodies


@dataclass(frozen=True, eq=False)
class Start:
    """Bodies at the first time, as solved: r, v, omega (bodies, 3), p (bodies, 4), and coordinates q."""

    r: np.ndarray
    p: np.ndarray
    v: np.ndarray
    omega: np.ndarray
    q: np.ndarray


class Conversion(ABC):
    """Collects the parts of a rigid model, at the `start` of a model, and the items it cannot carry over.

    `now`: poses of the bodies and the ground at the start, `t_start`, s; `first`: those in which bushings
    have no torque.
    """

    first: list[Pose]
    t_start = 0.0

    def __init__(self, start: Start):
        self.start, self.refusals = start, Refusals()
        self.now: list[Pose] = poses(start.r, start.p)

    @abstractmethod
    def model(self) -> RigidModel:
        """Return the rigid model, but for the shapes of its bodies."""

    def converted(self, shapes: Iterable[Shape], elements: JointElements) -> RigidModel:
        """Return the model with the cards of `shapes`; raises ModelError with all that is not converted."""
        for joint in elements.generals:
            message = "lines JOINT of this type are not converted; write the joint by hand in the other deck"
            self.refusals.add(joint, message, id="SOLVE-184")
        for item in elements.on_crosses:
            message = "elements in angles of universal joints are not converted; write them by hand"
            self.refusals.add(item, message, id="SOLVE-215")
        for switch in elements.switches:
            message = "lines CATCH and RELEASE are not converted; give the other deck the parts of one stage"
            self.refusals.add(switch, message, id="SOLVE-213")
        for track in elements.tracks:
            message = "points on curves and rolling bodies are not converted; write them by hand"
            self.refusals.add(track, message, id="MODEL-030")
        cards = tuple(self.shape(shape.card) for shape in shapes if shape.card)
        model = replace(self.model(), shapes=cards)
        self.refusals.raise_faults()
        return model

    def shape(self, card: ShapeCard) -> ShapeCard:
        """Return the card of a shape in the new model."""
        return card

    @abstractmethod
    def joint_coordinate(self, item: Any, joint: int, coordinate: str) -> tuple[int, str, float] | None:
        """Number of the joint in the new model, the coordinate there and its value at the start, if any."""

    def joint_of(self, joint: int) -> int | None:
        """Return the number of a joint in the new model, None if it has none."""
        return joint

    def end(self, body: int, point: Any) -> End:
        """Return a body of the new model and the point on it."""
        return body, place_of(point)

    def function(self, function: Any) -> Any:
        """Return a function of time, or None, from `t_start` on."""
        return function and transformed(function, self.t_start)

    def elements(self, items: Iterable[Element]) -> tuple[Element, ...]:
        """Return force elements, whose functions of time begin at `t_start`, in terms of the new model."""
        elements = (self._element(item) for item in items)
        return tuple(item for item in elements if item)

    def joint_drivers(self, items: Iterable[JointDriver]) -> Iterator[JointDriver]:
        """Yield drivers from 0 at the start, whatever number of turns a function begins with."""
        for item in items:
            if where := self.joint_coordinate(item, item.joint, item.coordinate):
                function = transformed(item.function, self.t_start, item.function.at(self.t_start)[0])
                yield replace(item, joint=where[0], coordinate=where[1], function=function)

    def couplings(self, items: Iterable[Coupling]) -> Iterator[Coupling]:
        """Yield the couplings whose joints are all in the new model."""
        for item in items:
            places = [self.joint_coordinate(item, joint, name) for joint, name, _ in item.terms]
            terms = zip(places, item.terms, strict=True)
            if None not in places:
                moved = tuple((*p[:2], factor) for p, (_, _, factor) in terms if p)
                starts = [p[2] for p in places if p]
                function = item.function and transformed(item.function, starts[-1], starts[0])
                yield replace(item, terms=moved, function=function)

    def _element(self, item: Element) -> Element | None:
        measure = item.measure
        if isinstance(measure, Joint):
            joint = self.joint_of(measure.joint)
            return None if joint is None else replace(item, measure=Joint(joint))
        if isinstance(measure, At):
            where = self.joint_coordinate(item, *measure)
            if where is None:
                return None
            values = item.since(where[2]).changed(self._from_start)
            return replace(item, measure=At(*where[:2]), values=values)
        if isinstance(measure, Cam):
            ends = (self.joint_coordinate(item, *at) for at in (measure[:2], measure[2:4]))
            follower, cam = ends
            if follower is None or cam is None:
                return None
            function = transformed(measure.function, cam[2], follower[2])
            return replace(item, measure=Cam(*follower[:2], *cam[:2], function))
        if isinstance(measure, Touch):
            message = "contacts do not convert: their shapes are given in the axes of bodies"
            self.refusals.add(item, message, id="MODEL-023")
            return None
        if isinstance(measure, Push):
            message = f"lines {item.law.word} do not convert: their directions may be those of a body's axes"
            self.refusals.add(item, message, id="ELEMENTS-190")
            return None
        i, j = self.end(measure.i, measure.P_i), self.end(measure.j, measure.P_j)
        if i[0] == GROUND == j[0] or (isinstance(measure, Frames) and not self._is_like(item, i[0])):
            return None
        return replace(item, measure=type(measure)(i[0], j[0], i[1], j[1]))

    def _from_start(self, p: Parameter, value: Any) -> Any:
        return transformed(value, self.t_start) if p.kind == OF_TIME else value

    def _is_like(self, item: Element, i: int) -> bool:
        """Return whether other dialects have a bushing like one whose body i becomes body `i`.

        `first`: poses in which its frames coincide in attitude, which in the new deck do so at the start.
        """
        ends = item.measure
        first, now = (each[ends.i][1].T @ each[ends.j][1] for each in (self.first, self.now))
        turned = float(np.linalg.norm(first - now) / 2.0**0.5)
        if any((*item["kr"], *item["cr"])) and turned > SAME_ATTITUDE:
            message = f"the bodies of the bushing have turned by {turned:.3g} rad from where it has no torque"
            self.refusals.add(
                item, f"{message} at the start; other dialects begin without torque", id="MODEL-018"
            )
            return False
        if i == GROUND != ends.i and not np.allclose(self.now[ends.i][1], np.eye(3), atol=SAME_ATTITUDE):
            self.refusals.add(
                item,
                "the axes of a bushing are those of body I, which is grounded and turned",
                id="MODEL-019",
            )
            return False
        return True

    def rigid_body(self, k: int, name: str, masses: tuple[float, Any, Any], place: Place | None) -> RigidBody:
        """Return body k at the start; `masses`: mass, its centre (3,), moments (3, 3) about it, body axes."""
        start, (mass, centre, moments) = self.start, masses
        motion = start.r[k], start.p[k], start.v[k], start.omega[k]
        return RigidBody(name, *motion, mass, centre, moments, place)

    def coordinate_since(self, coordinate: str, axis: tuple[Any, Any, Any], i: int, j: int) -> float:
        """Return an angle or a stroke of a joint of bodies i and j at the start since the `first` poses.

        `axis`: s_i, P_i and P_j in the axes of their bodies.
        """
        s_i, P_i, P_j = (np.array(given, float) for given in axis)
        s = s_i / np.linalg.norm(s_i)
        first, now = ((*each[i], *each[j]) for each in (self.first, self.now))
        if coordinate == ANGLE:
            f, (_, A_i, _, A_j) = across(s), now
            h = A_j @ first[3].T @ first[1] @ f
            return math.atan2(h @ (A_i @ np.cross(s, f)), h @ (A_i @ f))
        at_first, at_start = (
            (r_j + A_j @ P_j - r_i - A_i @ P_i) @ (A_i @ s) for r_i, A_i, r_j, A_j in (first, now)
        )
        return float(at_start - at_first)


def poses(r: np.ndarray, p: np.ndarray) -> list[Pose]:
    """Return poses by origins (bodies, 3) and Euler parameters (bodies, 4), and that of the ground."""
    return [*((origin, rotation_matrix(e)) for origin, e in zip(r, p, strict=True)), STILL]


def place_of(point: Any) -> Vector:
    """Return a node's place, or a point of a rigid body, in the axes of its body."""
    return vector(getattr(point, "r0", point))


def about_centre(mass: float, centre: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Return moments of inertia (3, 3) about the mass centre (3,), of those about the origin (Steiner)."""
    c = centre
    return np.asarray(inertia, float) - mass * (c @ c * np.eye(3) - np.outer(c, c))
