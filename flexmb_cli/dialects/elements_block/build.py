"""Lines of the block ELEMENTS to elements of the model.

What an element acts on is found by the `Measures` of a dialect; its force law is a record of `model.laws`.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ...deck.record import Number
from ...model.diagnostics import Findings
from ...model.general_joints import GeneralJoint, Switch, is_off_at_start
from ...model.joint_elements import (
    Coupling,
    Curve,
    JointDriver,
    JointElements,
    JointStart,
    StartAtRest,
    motors_last,
)
from ...model.laws import (
    BRISTLES,
    FRICTION,
    FUNCTIONS,
    OF_TIME,
    STOP,
    TORQUE,
    VECTOR,
    At,
    Cam,
    Element,
    Frames,
    Joint,
    Line,
    Push,
    Touch,
)
from ...model.time_functions import PERIODIC
from .bristles import check_bristles
from .contacts import touch_of
from .functions import Functions
from .general_joints import general_joint
from .line import MASS, OUTPUT, UNITS, ElementLine
from .measures import Measures
from .rolls import roll_of
from .signals import built_signals
from .words import BY_WORD, GENERAL_KEYS, key_of, usage

_MANY = ("from.last", "from.last_node", "to.last", "to.last_node")  # keys of ends that are several
_OF_CAMS = ("from", "to", "function", "stiffness", "damping", "lower", "upper")  # keys of COUPLING
Makers = Mapping[str, Callable[["BlockBuilder", ElementLine], Any]]
_ONE_OF: dict[str, Callable[..., Any]] = {  # what there may be one of, and by what it is distinguished
    "driven": lambda item: item.item,
    "supports": lambda item: item.item,
    "drivers": lambda item: (item.joint, item.coordinate),
    "starts": lambda item: (item.joint, item.coordinate),
    "switches": lambda item: (item.part, item.catches),
}


class BlockBuilder:
    """Makes elements of lines; faults go into the findings of `functions`."""

    def __init__(self, measures: Measures, functions: Functions, start: float):
        self.measures, self.functions, self.start = measures, functions, start
        self.findings: Findings = functions.findings

    def elements(self, lines: Sequence[ElementLine], more: Makers) -> JointElements:
        """The elements of all lines but functions; `more`: makers of those of the dialect, by their words."""
        of_law: dict[str, list[Any]] = {}
        for line in lines:
            if line.word in ("FUNCTION", "SIGNAL", OUTPUT, MASS, UNITS):
                continue
            field, item = self._element(line, more)
            if item is not None:
                of_law.setdefault(field, []).append(item)
        self._put_off(of_law, lines)
        self._refuse_twice(of_law)
        for item in of_law.get("starts", ()) if "rests" in of_law else ():
            message = "START equilibrium says how the motion begins; remove one of them"
            self.findings.error(item.name, message, item.place, id="ELEMENTS-200")
        self._refuse_driven(of_law.get("starts", ()), of_law.get("drivers", ()))
        groups: dict[str, Any] = {name: tuple(items) for name, items in of_law.items()}
        groups["forces"] = motors_last(groups.get("forces", ()))
        groups["signals"] = built_signals(lines, self.measures, self.functions, groups["forces"])
        return JointElements(**groups)

    def _element(self, line: ElementLine, more: Makers) -> tuple[str, Any]:
        """Field of `JointElements`, and an element; None where there is a fault."""
        if line.word == "JOINT" and line.kind in GENERAL_KEYS:
            return "generals", general_joint(line, self.measures)
        if line.word in more:
            return more[line.word](self, line) or ("", None)
        if BY_WORD[line.word].law is not None:
            return "forces", self._force(line)
        if line.word == "COUPLING":
            return self._coupling(line)
        makers = {
            "DRIVE": ("drivers", self.driver),
            "START": ("rests", self._at_rest) if line.begins_at_rest else ("starts", self._start),
            "CURVE": ("curves", self._curve),
            "ROLL": ("rolls", lambda line: roll_of(line, self.measures)),
            "RELEASE": ("switches", self._switch),
            "CATCH": ("switches", self._switch),
        }
        if line.word not in makers:
            message = f"decks of this dialect have no {line.word}; remove the line"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-040")
            return "", None
        field, make = makers[line.word]
        return field, make(line)

    def _refuse_twice(self, of_group: Mapping[str, Sequence[Any]]) -> None:
        frictions = [item for item in of_group.get("forces", ()) if item.law is FRICTION]
        groups: list[tuple[Sequence[Any], Callable[..., Any]]] = [(frictions, lambda item: item.measure)]
        groups += [(list(of_group.get(name, ())), key) for name, key in _ONE_OF.items()]
        for items, key in groups:
            first: dict[Any, Any] = {}
            for item in items:
                other = first.setdefault(key(item), item)
                if other is not item:
                    message = f"{other.name} already gives this; remove one of them"
                    self.findings.error(item.name, message, item.place, id="ELEMENTS-001")

    def _refuse_driven(self, starts: Iterable[JointStart], drivers: Iterable[JointDriver]) -> None:
        """Refuse starts of coordinates that drivers move."""
        driven = {(item.joint, item.coordinate): item.name for item in drivers}
        for item in starts:
            if name := driven.get((item.joint, item.coordinate)):
                message = f"the function of {name} already says how it begins; remove one of them"
                self.findings.error(item.name, message, item.place, id="ELEMENTS-161")

    # Force elements

    def _force(self, line: ElementLine) -> Element | None:
        law = BY_WORD[line.word].law
        assert law is not None, "the word has a law"
        before = len(self.findings.faults)
        self._check(line, law)
        measure = self._measure(line, law)
        values = {p.name: self._parameter(line, p) for p in law.parameters if not self._is_missing(line, p)}
        if BRISTLES[0] in law.parameters and measure is not None:
            check_bristles(line, self.measures, measure)
        if measure is None or any(f.severity == "error" for f in self.findings.faults[before:]):
            return None
        element = Element(line.subject, law, measure, law.values(**values), line.place)
        self._note(line, element)
        return element

    def _is_missing(self, line: ElementLine, parameter: Any) -> bool:
        key = key_of(parameter)
        return (f"{key}.x" if parameter.kind == VECTOR else key) not in line

    def _parameter(self, line: ElementLine, parameter: Any) -> Any:
        key = key_of(parameter)
        if parameter.kind == VECTOR:
            return line.vector(key)
        if parameter.kind == OF_TIME:
            return self.functions.function(line, key)
        return self.functions.curve(line, key) if parameter.kind in FUNCTIONS else float(line[key])

    def _measure(self, line: ElementLine, law: Any) -> Any:
        if "joint" in line:
            sliding = self.measures.sliding(line)
            if sliding and sliding[1] and not line["radius"] > 0.0:
                message = "a joint that turns needs the radius of its bearing"
                self.findings.error(line.subject, message, line.at("radius").place, id="ELEMENTS-011")
            return sliding and Joint(sliding[0])
        if "at" in line:
            at = self.measures.at(line)
            return at and At(*at)
        if Push in law.measures:
            return self._push(line, law)
        if Touch in law.measures:
            return touch_of(line, self.measures, self.functions.folder)
        if many := next((key for key in _MANY if key in line), None):
            message = "takes one body at each end; only contacts take several, as in 2-9(0,0,0)"
            self.findings.error(line.subject, message, line.place_of(many), id="ELEMENTS-140")
            return None
        ends = self.measures.ends(line)
        return ends and (Frames if Frames in law.measures else Line)(*ends)

    def _push(self, line: ElementLine, law: Any) -> Push | None:
        """The direction of a force or torque; its other end is the ground."""
        place = line.place_of("to.body")
        ground = [
            Number("from.body", 0, "", "", place),
            *(Number(f"from.{x}", 0.0, "", "", place) for x in "xyz"),
        ]
        ends = self.measures.ends(line.with_numbers([*line.numbers, *ground]))
        if ends is None:
            return None
        i, j, P_i, P_j = ends
        direction, axes = np.array(line.vector("direction")), line.at("axes")
        length = float(np.linalg.norm(direction))
        if not length > 0.0:
            message = "the direction has no length"
            self.findings.error(line.subject, message, line.place_of("direction.x"), id="ELEMENTS-191")
        elif axes.value not in (0, j + 1):
            message = f"the direction is in axes of the ground, 0, or of body {j + 1}; read {axes.value}"
            self.findings.error(line.subject, message, line.place_of("axes"), id="ELEMENTS-192")
        elif law is TORQUE and not self.measures.turns(line, j):
            message = "nodes of a flexible body do not turn; give a point of the body, or a pair of forces"
            self.findings.error(line.subject, message, place, id="ELEMENTS-193")
        else:
            x, y, z = (direction / length).tolist()
            return Push(i, j, P_i, P_j, (x, y, z), bool(axes.value), law is TORQUE)
        return None

    def _check(self, line: ElementLine, law: Any) -> None:
        """Check numbers against what the record of the law says."""
        for p in law.parameters:
            if p.kind in FUNCTIONS or self._is_missing(line, p):
                continue
            key = key_of(p)
            for one in [f"{key}.{axis}" for axis in "xyz"] if p.kind == VECTOR else [key]:
                if not p.signed and line[one] < 0.0:
                    message = f"{one} must not be negative; read {line[one]:g}"
                    self.findings.error(line.subject, message, line.place_of(one), id="ELEMENTS-002")
            self._check_above(line, p)

    def _check_above(self, line: ElementLine, p: Any) -> None:
        least = line[p.above] if isinstance(p.above, str) else p.above
        if least is None or least < line[p.name]:
            return
        than = f"{p.above}, {least:g}" if isinstance(p.above, str) else f"{least:g}"
        message = f"{p.name} must be larger than {than}; read {line[p.name]:g}"
        self.findings.error(line.subject, message, line.place_of(p.name), id="ELEMENTS-039")

    def _note(self, line: ElementLine, element: Element) -> None:
        """Note and warn of what is probably meant otherwise."""
        if element.idle:
            message = "does nothing: its coefficients are 0"
            self.findings.note(line.subject, message, line.place, id="ELEMENTS-030")
        self._note_signs(line, element)
        if element.law is FRICTION and line["static"] < line["dynamic"]:
            message = f"sticks with {line['static']:g}, less than it slides with: are the numbers exchanged?"
            self.findings.warn(line.subject, message, line.place_of("static"), id="ELEMENTS-027")
        if element.turning:
            self._note_degrees(line, element)

    def _note_signs(self, line: ElementLine, element: Element) -> None:
        for key, p in ((key_of(p), p) for p in element.law.parameters if p.resists or p.counted):
            if line[key] >= 0.0:
                continue
            if p.resists:
                message = f"{key} {line[key]:g} is negative, which drives a motion on"
                self.findings.warn(line.subject, message, line.place_of(key), id="ELEMENTS-029")
            elif isinstance(element.measure, Line):
                message = f"{key} {line[key]:g} is negative, and lengths are not: is its sign meant?"
                self.findings.note(line.subject, message, line.place_of(key), id="ELEMENTS-032")

    def _note_degrees(self, line: ElementLine, element: Element) -> None:
        """Note the first angle beyond a turn, which may have been meant in degrees."""
        for key in (p.name for p in element.law.parameters if p.counted):
            if abs(line[key]) > math.tau:
                message = (
                    f"{key} of {line[key]:g} rad is {abs(line[key]) / math.tau:.3g} turns; "
                    f"{line[key]:g} degrees would be {math.radians(line[key]):.6g} rad"
                )
                self.findings.note(line.subject, message, line.place_of(key), id="ELEMENTS-031")
                return

    # What is no force

    def motion(self, line: ElementLine, given: float = 0.0) -> Any:
        """The function that a coordinate follows: that of `value`, or the integral of that of `rate`."""
        if "rate" in line:
            return self.functions.integrated(line, "rate", self.start, given)
        return self.functions.motion(line, "value")

    def driver(self, line: ElementLine) -> JointDriver | None:
        """The driver of a joint or hinge coordinate."""
        if "at" not in line:
            message = "driver= numbers drivers of YOUNG decks; name a coordinate by at="
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-038")
            return None
        at, function = self.measures.at(line), self.motion(line)
        return JointDriver(line.subject, *at, function, line.place) if at and function else None

    def _coupling(self, line: ElementLine) -> tuple[str, Any]:
        """A sum of coordinates; a cam, whose follower is the first term; or the stop of a follower."""
        given = [key for key in _OF_CAMS if key in line]
        if not given:
            return "couplings", self._sum(line)
        loose, factors = "stiffness" in line, len(given) < len(line.numbers)
        if factors or not set(given) >= set(_OF_CAMS[:3]) or not (loose or len(given) == 3):
            message = (
                "a cam takes from=1.angle to=2.stroke function=name, all three and no factors; "
                "with stiffness= one side only, then damping=, lower= and upper=, too"
            )
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-065")
            return "couplings", None
        cam = self._cam(line)
        if cam and loose:
            return "forces", self._follower(line, cam)
        if cam is None:
            return "couplings", None
        terms = (cam.joint, cam.coordinate, 1.0), (cam.cam_joint, cam.cam_coordinate, -1.0)
        return "couplings", Coupling(line.subject, terms, line.place, cam.function)

    def _sum(self, line: ElementLine) -> Coupling | None:
        terms = [self._term(line, number) for number in line.numbers]
        if len(terms) < 2:
            message = f"couples two coordinates or more, 2.angle=1 3.angle=-2; read {len(terms)}"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-037")
        if None in terms:
            return None
        return Coupling(line.subject, tuple(term for term in terms if term), line.place)

    def _cam(self, line: ElementLine) -> Cam | None:
        follower, cam = (self.measures.named(line, line.at(key), line[key]) for key in ("to", "from"))
        function = self.functions.motion(line, "function")
        if follower is not None and follower == cam:
            message = "from and to are the same coordinate; name two"
            self.measures.error(line, line.at("to"), message, id="ELEMENTS-066")
            return None
        if follower is None or cam is None or function is None:
            return None
        return Cam(*follower, *cam, function)

    def _follower(self, line: ElementLine, cam: Cam) -> Element | None:
        """The stop of a follower that lifts off its cam."""
        limits = {"lower": -math.inf if "upper" in line else 0.0, "upper": math.inf}
        values = limits | {one.key: one.value for one in line.numbers if one.key in _OF_CAMS[3:]}
        for key in ("stiffness", "damping"):
            if values.get(key, 0.0) < 0.0:
                message = f"{key} must not be negative; read {values[key]:g}"
                self.findings.error(line.subject, message, line.place_of(key), id="ELEMENTS-002")
                return None
        if not values["lower"] < values["upper"]:
            than = f"lower, {values['lower']:g}"
            message = f"{'upper'} must be larger than {than}; read {values['upper']:g}"
            self.findings.error(line.subject, message, line.place_of("upper"), id="ELEMENTS-039")
            return None
        return Element(line.subject, STOP, cam, STOP.values(**values), line.place)

    def _curve(self, line: ElementLine) -> Curve | None:
        """A point on a curve."""
        before = len(self.findings.faults)
        ends, path = self.measures.ends(line), self._path(line)
        if ends is None or path is None:
            return None
        i, j, P_i, P_j = ends
        functions, begin, end = path
        curve = Curve(line.subject, i, j, P_i, P_j, functions, begin, end, line.place)
        if not begin < end:
            message = f"its end, {end:g}, must be larger than its beginning, {begin:g}"
            self.findings.error(line.subject, message, line.place_of("end"), id="ELEMENTS-122")
        elif curve.standstill is not None:
            message = (
                f"the curve stands still at the parameter {curve.standstill:g}: it has no direction there"
            )
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-123")
        elif curve.across is None:
            message = "the curve points into all directions; give its parts as curves of their own"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-124")
        return None if any(f.severity == "error" for f in self.findings.faults[before:]) else curve

    def _path(self, line: ElementLine) -> Any:
        """Functions of a curve, and its ends; None where there is a fault."""
        if "file" in line:
            return self.functions.paths(line)
        if not any(axis in line for axis in "xyz"):
            message = "a curve takes file=, or functions of a parameter, x=, y= and z=, 0 if one is left out"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-127")
            return None
        coordinates = tuple(self.functions.path(line, axis) for axis in "xyz")
        if None in coordinates:
            return None
        periods = {(f.pieces[0][0], f.c[0]) for f in coordinates if f is not None and f.kind == PERIODIC}
        if "begin" in line and "end" in line:
            return coordinates, float(line["begin"]), float(line["end"])
        if len(periods) != 1:
            message = "a curve of functions needs begin= and end=, unless all its functions have one period"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-125")
            return None
        ((begin, period),) = periods
        return coordinates, begin, begin + period

    def _term(self, line: ElementLine, number: Number) -> tuple[int, str, float] | None:
        if number.value == 0.0:
            self.measures.error(line, number, "a factor of 0 couples nothing", id="ELEMENTS-008")
        at = self.measures.named(line, number, number.key)
        return at and (*at, float(number.value))

    def _switch(self, line: ElementLine) -> Switch | None:
        sides, catches = [key for key in ("above", "below") if key in line], line.word == "CATCH"
        if len(sides) != ("when" in line):
            message = "when= takes above= or below=, and time= neither of them"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-209")
            return None
        if "time" in line:
            return Switch(line.subject, line["of"], catches, float(line["time"]), place=line.place)
        [side] = sides
        value, rising = float(line[side]), side == "above"
        return Switch(line.subject, line["of"], catches, None, line["when"], value, rising, line.place)

    def _put_off(self, of_group: dict[str, list[Any]], lines: Sequence[ElementLine]) -> None:
        """Move joints and drivers that are caught later to a group of their own; refuse unknown ones."""
        switches: dict[str, list[Switch]] = {}
        names = {item.name for key in ("generals", "drivers") for item in of_group.get(key, ())}
        for item in of_group.get("switches", ()):
            switches.setdefault(item.part, []).append(item)
            if item.part not in names:
                message = f"{item.part} names no line JOINT general, weld and so on, nor DRIVE at=…"
                self.findings.error(item.name, message, item.place, id="ELEMENTS-208")
        off = {name for name, own in switches.items() if name in names and is_off_at_start(own)}
        of_group["later"] = [item for key in ("generals", "drivers") for item in of_group.get(key, ())
                          if item.name in off]  # fmt: skip
        for key in ("generals", "drivers"):
            of_group[key] = [item for item in of_group.get(key, ()) if item.name not in off]
        for line in lines:
            joint = next((one for one in of_group["later"] if one.name == line.subject), None)
            if isinstance(joint, GeneralJoint):
                self._refuse_bending(line, joint)

    def _refuse_bending(self, line: ElementLine, joint: GeneralJoint) -> None:
        for key, body in (("from", joint.i), ("to", joint.j)):
            if body >= 0 and not self.measures.is_rigid(line, body, key):
                message = "a joint that is caught takes points of rigid bodies, not nodes of flexible ones"
                self.measures.error(line, line.at(f"{key}.body"), message, id="ELEMENTS-245")

    def _at_rest(self, line: ElementLine) -> StartAtRest:
        return StartAtRest(line.subject, line.place)

    def _start(self, line: ElementLine) -> JointStart | None:
        at = self.measures.at(line)
        value, rate = (float(line[key]) if key in line else None for key in ("value", "rate"))
        if value is None and rate is None:
            message = f"value, rate or both must be given: {usage(BY_WORD['START'])}"
            self.findings.error(line.subject, message, line.place, id="ELEMENTS-160")
            return None
        return JointStart(line.subject, *at, value, rate, line.place) if at else None
