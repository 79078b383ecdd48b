"""Springs, end stops, cables and links of a mechanism as lines of a script for Exudyn.

Exudyn's reference manual is the source of the calls; its connectors resist what their functions return.
Angles are 0 in Exudyn where the script places the bodies, at flexmb's start; strokes are distances.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.joint_elements import JointElements
from ...model.laws import BUSHING, CABLE, FRICTION, MOTOR, SPRING, STOP, At, Element, is_angle
from ...model.mechanism import Joint

# Names of a script's bodies, and points of them: local ones, and global ones at the start.
Word = Callable[[int], str]
Place = Callable[[int, Any], np.ndarray]

DEFINITIONS = '''

def pushed(depth, rate, k, b):
    """Force of a stop, or pull of a cable: Hunt and Crossley (1975), exponent 1."""
    return k * depth * max(0.0, 1.0 + b * rate) if depth > 0 else 0.0


def cable(mbs, t, number, stretch, rate, k, b, force):
    return pushed(stretch, rate, k, b)


def stops(lower, upper, k, b):
    return lambda mbs, t, number, x, v, *_: pushed(x - upper, v, k, b) - pushed(lower - x, -v, k, b)


def slide(bodies, places, axis, **law):
    markers = [
        mbs.AddMarker(dict(markerType="BodyRigid", bodyNumber=body, localPosition=place))
        for body, place in zip(bodies, places)
    ]
    spring = dict(objectType="ConnectorLinearSpringDamper", markerNumbers=markers, axisMarker0=axis)
    mbs.AddObject(spring | law)


'''
_REFUSED = {
    "drivers": ("drivers of joints do not convert", "RESULT-067"),
    "driven": ("drivers by functions do not convert", "RESULT-069"),
    "supports": ("supports by functions do not convert", "RESULT-070"),
    "couplings": ("couplings of joint coordinates do not convert", "RESULT-072"),
}
_REFUSED_LAWS = {
    MOTOR: ("motors by functions of time do not convert", "RESULT-068"),
    BUSHING: (
        "bushings do not convert: Exudyn's have other angles where a body turns about several axes",
        "RESULT-071",
    ),
    FRICTION: ("friction does not convert: Exudyn's has no normal force of the joint", "RESULT-073"),
}
LINK = "spherical-spherical"


def foreign_elements(elements: JointElements) -> Iterator[Fault]:
    """Yield the faults of elements that do not convert."""
    for kind, (message, name) in _REFUSED.items():
        for item in getattr(elements, kind):
            yield Fault("error", message, item.place, item.name, id=name)
    for force in elements.forces:
        if found := _refused(force):
            message, name = found
            yield Fault("error", message, force.place, force.name, id=name)
    for composite in elements.composites:
        if composite.kind != LINK:
            message = f"a {composite.kind} joint does not convert"
            yield Fault("error", message, composite.place, composite.name, id="RESULT-075")


def _refused(item: Element) -> tuple[str, str] | None:
    """Return why a force element does not convert, and the identifier of the fault."""
    if item.law in (SPRING, CABLE, STOP):
        if item.law is SPRING and (item["curve"] or item["damper"]):
            return "springs and dampers with functions do not convert", "RESULT-074"
        return None
    return _REFUSED_LAWS.get(item.law, (f"the law {item.law.word} does not convert", "RESULT-031"))


class ElementLines:
    """Makes the lines; `q`: joint coordinates at the start, by joint and coordinate."""

    def __init__(
        self, joints: tuple[Joint, ...], word: Word, local: Place, at: Place, turned: Callable[[int], Any],
        q: dict[tuple[int, str], float],
    ):  # fmt: skip
        self.joints, self.word, self.local, self.at, self.turned, self.q = joints, word, local, at, turned, q

    def lines(self, elements: JointElements, kept: list[bool]) -> Iterator[str]:
        """Yield definitions and a line for every element; `kept`: whether a link repeats no equation."""
        if not (elements.forces or elements.composites):
            return
        yield DEFINITIONS
        for item in elements.forces:
            if isinstance(item.measure, At):
                yield self._at_joint(item.measure, self._law(item.since(self._since(item.measure))))
                continue
            law = "referenceLength={1!r}, stiffness={0!r}, damping={2!r}".format(*item.values)
            last = "springForceUserFunction=cable" if item.law is CABLE else f"force={item['preload']!r}"
            yield f"mbs.CreateSpringDamper({self._ends(item.measure)}, {law}, {last})"
        for link, needed in zip(elements.composites, kept, strict=True):
            call = f"mbs.CreateDistanceConstraint({self._ends(link)}, distance={link.size!r})"
            yield call if needed else f"# {link.name} repeats equations of others"

    def _law(self, item: Element) -> str:
        """The law of a spring or of stops in a joint."""
        effort = "torque" if item.turning else "force"
        if item.law is STOP:
            return f"spring{effort.capitalize()}UserFunction=stops({', '.join(map(repr, item.values))})"
        stiffness, rest, damping, preload, *_ = item.values
        return f"stiffness={stiffness!r}, damping={damping!r}, offset={rest!r}, {effort}={preload!r}"

    def _since(self, item: Any) -> float:
        """Joint coordinate at the start, less Exudyn's: of angles 0, of strokes the advance of P_j."""
        q, joint = self.q[item.joint, item.coordinate], self.joints[item.joint]
        if is_angle(item.coordinate):
            return q
        axis = self.turned(joint.i) @ np.array(joint.s_i, float) / np.linalg.norm(joint.s_i)
        return q - float((self.at(joint.j, joint.P_j) - self.at(joint.i, joint.P_i)) @ axis)

    def _pair(self, item: Any) -> str:
        return f"itemNumbers=[{self.word(item.i)}, {self.word(item.j)}]"

    def _ends(self, item: Any) -> str:
        ends = ((item.i, item.P_i), (item.j, item.P_j))
        places = [f"localPosition{n}={_numbers(self.local(*end))}" for n, end in enumerate(ends)]
        return ", ".join([self._pair(item), *places])

    def _at_joint(self, item: Any, law: str) -> str:
        """A spring and damper in the angle or the stroke of its joint."""
        joint = self.joints[item.joint]
        axis = np.array(joint.s_i, float) / np.linalg.norm(joint.s_i)
        if is_angle(item.coordinate):
            place = f"position={_numbers(self.at(joint.i, joint.P_i))}"
            along = f"axis={_numbers(self.turned(joint.i) @ axis)}"
            return f"mbs.CreateTorsionalSpringDamper({self._pair(joint)}, {place}, {along}, {law})"
        bodies = f"[{self.word(joint.i)}, {self.word(joint.j)}]"
        places = [_numbers(self.local(*end)) for end in ((joint.i, joint.P_i), (joint.j, joint.P_j))]
        along = self.turned(joint.i) @ axis if self.word(joint.i) == "ground" else axis
        return f"slide({bodies}, [{', '.join(places)}], {_numbers(along)}, {law})"


def _numbers(values: Any) -> str:
    return repr([float(value) for value in values])
