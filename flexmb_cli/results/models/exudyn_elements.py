"""Springs, end stops, cables and links of a mechanism as lines of a script for Exudyn.

Exudyn's reference manual is the source of the calls; its connectors resist what their functions return.
Angles are 0 in Exudyn where the script places the bodies, at flexmb's start; strokes are distances.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ...errors import Fault
from ...model.joint_elements import JointElements, JointSpring, LineSpring, is_angle
from ...model.laws import STOP
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
    "motors": ("motors by functions of time do not convert", "RESULT-068"),
    "driven": ("drivers by functions do not convert", "RESULT-069"),
    "supports": ("supports by functions do not convert", "RESULT-070"),
    "bushings": (
        "bushings do not convert: Exudyn's have other angles where a body turns about several axes",
        "RESULT-071",
    ),
    "couplings": ("couplings of joint coordinates do not convert", "RESULT-072"),
    "frictions": ("friction does not convert: Exudyn's has no normal force of the joint", "RESULT-073"),
}
LINK = "spherical-spherical"


def foreign_elements(elements: JointElements) -> Iterator[Fault]:
    """Yield the faults of elements that do not convert."""
    for kind, (message, name) in _REFUSED.items():
        for item in getattr(elements, kind):
            yield Fault("error", message, item.place, item.name, id=name)
    for law in elements.laws:
        if law.law is not STOP:
            message = f"the law {law.law.word} does not convert"
            yield Fault("error", message, law.place, law.name, id="RESULT-031")
    springs: tuple[JointSpring | LineSpring, ...] = (*elements.springs, *elements.lines)
    for spring in springs:
        if spring.curve or spring.damper:
            message = "springs and dampers with functions do not convert"
            yield Fault("error", message, spring.place, spring.name, id="RESULT-074")
    for composite in elements.composites:
        if composite.kind != LINK:
            message = f"a {composite.kind} joint does not convert"
            yield Fault("error", message, composite.place, composite.name, id="RESULT-075")


class ElementLines:
    """Makes the lines; `q`: joint coordinates at the start, by joint and coordinate."""

    def __init__(
        self, joints: tuple[Joint, ...], word: Word, local: Place, at: Place, turned: Callable[[int], Any],
        q: dict[tuple[int, str], float],
    ):  # fmt: skip
        self.joints, self.word, self.local, self.at, self.turned, self.q = joints, word, local, at, turned, q

    def lines(self, elements: JointElements, kept: list[bool]) -> Iterator[str]:
        """Yield definitions and a line for every element; `kept`: whether a link repeats no equation."""
        if not any((elements.springs, elements.lines, elements.laws, elements.composites)):
            return
        yield DEFINITIONS
        for spring in elements.springs:
            rest = spring.rest - self._since(spring)
            law = f"stiffness={spring.stiffness!r}, damping={spring.damping!r}, offset={rest!r}"
            effort = "torque" if is_angle(spring.coordinate) else "force"
            yield self._at_joint(spring, f"{law}, {effort}={spring.preload!r}")
        for stop in elements.laws:
            limits = ", ".join(map(repr, stop.since(self._since(stop))))
            effort = "Torque" if is_angle(stop.coordinate) else "Force"
            yield self._at_joint(stop, f"spring{effort}UserFunction=stops({limits})")
        for line in elements.lines:
            law = f"referenceLength={line.rest!r}, stiffness={line.stiffness!r}, damping={line.damping!r}"
            last = "springForceUserFunction=cable" if line.slack else f"force={line.preload!r}"
            yield f"mbs.CreateSpringDamper({self._ends(line)}, {law}, {last})"
        for link, needed in zip(elements.composites, kept, strict=True):
            call = f"mbs.CreateDistanceConstraint({self._ends(link)}, distance={link.size!r})"
            yield call if needed else f"# {link.name} repeats equations of others"

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
