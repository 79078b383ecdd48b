"""Cards of joint drivers, motors, springs, stops, bushings, couplings and friction to elements.

A dialect says by a subclass of `ElementMaker` how its cards name joints and ends, and by a dictionary like
`JOINT_CARDS` which of its sections give which elements.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ...deck.record import Record
from ...model.diagnostics import Findings
from ...model.joint_elements import (
    COORDINATES_OF,
    Bushing,
    Coupling,
    EndStop,
    JointDriver,
    JointElements,
    JointFriction,
    JointMotor,
    JointRate,
    JointSpring,
    LineSpring,
)
from ...model.joints import ANGLE, STROKE
from .functions import Functions

_COORDINATES = {1: ANGLE, 2: STROKE}
_A = {ANGLE: "an angle", STROKE: "a stroke"}
_ONE_OF = {  # what there may be one of, and by what it is distinguished
    "driven": lambda item: item.item,
    "supports": lambda item: item.item,
    "drivers": lambda item: (item.joint, item.coordinate),
    "rates": lambda item: (item.joint, item.coordinate),
    "frictions": lambda item: item.joint,
}
MOST_ELEMENTS = 20_000  # of a deck; one takes up to 6 kB
_FRICTION = ("dynamic", "static", "stribeck", "creep", "radius", "preload")


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
            other = item if item is None else first.setdefault(key(item), item)
            if other is not item:
                message = f"{other.name} already gives this; remove one of them"  # type: ignore[union-attr]
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

    def _joint(self, record: Record, coordinate: str, key: str) -> Any:
        number = record[key]
        if not 1 <= number <= len(self.joints):
            message = f"joint number {number} is outside 1..{len(self.joints)}"
            self.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-003")
            return None
        joint = self.joints[number - 1]
        if coordinate not in (None, *COORDINATES_OF[joint.kind]):
            has = " and ".join(_A[one] for one in COORDINATES_OF[joint.kind]) or "neither angle nor stroke"
            other = "the card for it" if COORDINATES_OF[joint.kind] else "a joint that has one"
            message = f"joint {number} ({joint.name}) has {has}, not {_A[coordinate]}; take {other}"
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
        joint = self._joint(record, None, "joint")  # type: ignore[arg-type]
        if joint is None:
            return None
        kinds = COORDINATES_OF[self.joints[joint].kind]
        if not kinds:
            message = f"{self.joints[joint].name} turns about no axis: it takes no friction"
            self.findings.error(record.subject, message, record.at("joint").place, id="ELEMENTS-006")
            return None
        return joint, ANGLE in kinds


def build_elements(
    maker: ElementMaker,
    sections: Callable[..., Any],
    cards: Mapping[str, Sequence[tuple[str, Callable[..., Any]]]],
    **more: Any,
) -> JointElements:
    """The elements of the records `sections(name)`, by `cards`: fields of `JointElements`, pairs of a
    section and what makes one of its records.
    """
    if _refuse_too_many(maker, sections, cards):
        return JointElements(**more)
    found = {name: [make(maker, record) for section, make in makers for record in sections(section)]
             for name, makers in cards.items()}  # fmt: skip
    for name, key in _ONE_OF.items():
        maker.refuse_twice(found.get(name, ()), key)
    kept = {name: tuple(item for item in items if item is not None) for name, items in found.items()}
    return JointElements(**kept, **more)  # type: ignore[arg-type]


def _refuse_too_many(maker: ElementMaker, sections: Callable[..., Any], cards: Mapping[str, Any]) -> bool:
    """Report more elements than are held in the memory that a deck may take; whether there are."""
    found = [sections(section) for makers in cards.values() for section, _ in makers]
    count = sum(map(len, found))
    if count <= MOST_ELEMENTS:
        return False
    most = max(found, key=len)
    last = most[min(MOST_ELEMENTS, len(most) - 1)]
    message = (
        f"the deck has {count} elements of drivers, springs and the like; at most {MOST_ELEMENTS} are taken"
    )
    maker.findings.error(last.subject, message, last.place, id="ELEMENTS-024")
    return True


def joint_driver(coordinate: str | None) -> Callable[..., Any]:
    """Return what makes drivers of a coordinate."""

    def make(maker: Any, record: Record) -> Any:
        where, function = maker.where(record, coordinate), maker.functions.motion(record, maker.start)
        return JointDriver(record.subject, *where, function, record.place) if where and function else None  # type: ignore[call-arg]

    return make


def motor(coordinate: str | None) -> Callable[..., Any]:
    """Return what makes motors in a coordinate."""

    def make(maker: Any, record: Record) -> Any:
        where, function = maker.where(record, coordinate), maker.functions.function(record)
        return JointMotor(record.subject, *where, function, record.place) if where and function else None  # type: ignore[call-arg]

    return make


def _spring_data(maker: Any, record: Record) -> Any:
    return {
        "stiffness": float(record["stiffness"]),
        "rest": float(record["rest"]),
        "damping": float(record["damping"]),
        "preload": float(record["preload"]),
        "curve": maker.functions.curve(record, "curve"),
        "damper": maker.functions.curve(record, "damper"),
        "place": record.place,
    }


def joint_spring(coordinate: str | None) -> Callable[..., Any]:
    """Return what makes springs in a coordinate."""

    def make(maker: Any, record: Record) -> Any:
        where, data = maker.where(record, coordinate), _spring_data(maker, record)
        return JointSpring(record.subject, *where, **data) if where else None

    return make


def line_spring(maker: ElementMaker, record: Record) -> LineSpring | None:
    """A spring between two bodies."""
    ends, data = maker.ends(record), _spring_data(maker, record)
    return LineSpring(record.subject, **ends, **data) if ends else None


def cable(maker: ElementMaker, record: Record) -> LineSpring | None:
    """A cable between two bodies."""
    maker.not_negative(record, "stiffness", "rest", "damping")
    data = {key: float(record[key]) for key in ("stiffness", "rest", "damping")}
    ends = maker.ends(record)
    return LineSpring(record.subject, **ends, **data, slack=True, place=record.place) if ends else None  # type: ignore[arg-type]


def stop(coordinate: str | None) -> Callable[..., Any]:
    """Return what makes stops of a coordinate."""

    def make(maker: Any, record: Record) -> Any:
        maker.not_negative(record, "stiffness", "damping")
        if not record["lower"] < record["upper"]:
            message = f"upper must be larger than lower, {record['lower']:g}; read {record['upper']:g}"
            maker.findings.error(record.subject, message, record.at("upper").place, id="ELEMENTS-007")
        numbers = (float(record[key]) for key in ("lower", "upper", "stiffness", "damping"))
        where = maker.where(record, coordinate)
        return EndStop(record.subject, *where, *numbers, record.place) if where else None  # type: ignore[call-arg]

    return make


def bushing(maker: ElementMaker, record: Record) -> Bushing | None:
    """A bushing between two bodies."""
    stiffness, damping = (
        (*record.vector(along), *record.vector(about)) for along, about in (("k", "kr"), ("c", "cr"))
    )
    for key in ("k", "kr", "c", "cr"):
        maker.not_negative(record, *(f"{key}.{axis}" for axis in "xyz"))
    ends = maker.ends(record)
    if ends is None:
        return None
    return Bushing(record.subject, **ends, stiffness=stiffness, damping=damping, place=record.place)


def coupling(maker: ElementMaker, record: Record) -> Coupling | None:
    """A coupling of two joint coordinates or more."""
    terms = []
    for k in range(1, sum(number.key.startswith("factor") for number in record.numbers) + 1):
        where, factor = maker.where(record, None, str(k)), float(record[f"factor{k}"])
        if factor == 0.0:
            place = record.at(f"factor{k}").place
            maker.findings.error(record.subject, "a factor of 0 couples nothing", place, id="ELEMENTS-008")
        terms.append(None if where is None else (*where, factor))
    if None in terms:
        return None
    if len({(joint, coordinate) for joint, coordinate, _ in terms}) < len(terms):  # type: ignore[misc]
        maker.findings.error(
            record.subject, "names one coordinate twice; add its factors", record.place, id="ELEMENTS-009"
        )
    return Coupling(record.subject, tuple(terms), record.place)  # type: ignore[arg-type]


def friction(maker: ElementMaker, record: Record) -> JointFriction | None:
    """Friction in a joint."""
    maker.not_negative(record, "dynamic", "static", "radius", "preload")
    for key in ("stribeck", "creep"):
        if not record[key] > 0.0:
            message = f"{key} is a speed above 0; read {record[key]:g}"
            maker.findings.error(record.subject, message, record.at(key).place, id="ELEMENTS-010")
    if record["static"] < record["dynamic"]:
        message = f"sticks with {record['static']:g}, less than it slides with: are the numbers exchanged?"
        maker.findings.warn(record.subject, message, record.at("static").place, id="ELEMENTS-027")
    found = maker.sliding(record)
    if found is None:
        return None
    joint, revolutions = found
    if revolutions and not record["radius"] > 0.0:
        message = "a joint that turns needs the radius of its bearing"
        maker.findings.error(record.subject, message, record.at("radius").place, id="ELEMENTS-011")
        return None
    return JointFriction(record.subject, joint, *(float(record[key]) for key in _FRICTION), record.place)  # type: ignore[arg-type, call-arg]


def rate(maker: ElementMaker, record: Record) -> JointRate | None:
    """The rate of a joint coordinate at the start."""
    where = maker.where(record, None)
    return JointRate(record.subject, *where, float(record["rate"]), record.place) if where else None


# Sections of dialects whose cards name joints, the angle or the stroke.
JOINT_CARDS = {
    "motors": [("tmotor", motor(ANGLE)), ("amotor", motor(STROKE))],
    "springs": [("tspring", joint_spring(ANGLE)), ("aspring", joint_spring(STROKE))],
    "lines": [("lspring", line_spring), ("cable", cable)],
    "stops": [("tstop", stop(ANGLE)), ("astop", stop(STROKE))],
    "bushings": [("bushing", bushing)],
    "couplings": [("coupling", coupling)],
    "frictions": [("friction", friction)],
    "rates": [("rate", rate)],
}
