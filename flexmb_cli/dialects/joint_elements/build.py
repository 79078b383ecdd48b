"""Cards of joint drivers, motors, springs, stops, bushings, couplings and friction to elements.

A dialect says by a subclass of `ElementMaker` how its cards name joints and ends, and by a dictionary like
`JOINT_CARDS` which of its sections give which elements.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from ...deck.record import Number, Record
from ...deck.records import DeckValues
from ...model.joint_elements import (
    Bushing,
    Coupling,
    JointDriver,
    JointElements,
    JointFriction,
    JointMotor,
    JointRate,
    JointSpring,
    LineSpring,
    is_angle,
)
from ...model.joints import ANGLE, STROKE
from ...model.laws import LAWS, JointLaw, Law
from .maker import ElementMaker

Cards = Mapping[str, Sequence[tuple[str, Callable[..., Any]]]]  # fields of `JointElements`: sections, makers
_ONE_OF = {  # what there may be one of, and by what it is distinguished
    "driven": lambda item: item.item,
    "supports": lambda item: item.item,
    "drivers": lambda item: (item.joint, item.coordinate),
    "rates": lambda item: (item.joint, item.coordinate),
    "frictions": lambda item: item.joint,
}
MOST_ELEMENTS = 20_000  # of a deck; one takes up to 6 kB
LEAST_SPEED = 1e-100  # m/s, of friction: squares of speeds over it are still doubles
_FRICTION = ("dynamic", "static", "stribeck", "creep", "radius", "preload")


def build_elements(
    maker: ElementMaker,
    sections: Callable[..., Any],
    cards: Cards,
    **more: Any,
) -> JointElements:
    """The elements of the records `sections(name)`, by `cards`: fields of `JointElements`, pairs of a
    section and what makes one of its records.
    """
    if _refuse_too_many(maker, sections, cards):
        return JointElements(**more)
    found = {name: [make(maker, record) for section, make in makers for record in sections(section)]
             for name, makers in cards.items()}  # fmt: skip
    for item in (item for items in found.values() for item in items):
        if _is_idle(item):
            maker.findings.note(
                item.name, "does nothing: its coefficients are 0", item.place, id="ELEMENTS-030"
            )
    for name, key in _ONE_OF.items():
        maker.refuse_twice(found.get(name, ()), key)
    kept: dict[str, Any] = {
        name: tuple(item for item in items if item is not None) for name, items in found.items()
    }
    return JointElements(**kept, **more)


def _is_idle(item: Any) -> bool:
    """Return whether an element can never act; a spring without stiffness still shows its length."""
    if isinstance(item, Bushing):
        return not any((*item.stiffness, *item.damping))
    if isinstance(item, JointFriction):
        return not (item.dynamic or item.static)
    if isinstance(item, JointLaw):
        # A law without effort by all its parameters that make one.
        return not any(value for p, value in zip(item.law.parameters, item.values, strict=True) if p.effort)
    return isinstance(item, LineSpring) and item.slack and not item.stiffness


def _refuse_too_many(maker: ElementMaker, sections: Callable[..., Any], cards: Cards) -> bool:
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

    def make(maker: ElementMaker, record: Record) -> JointDriver | None:
        where, function = maker.where(record, coordinate), maker.functions.motion(record, maker.start)
        return JointDriver(record.subject, *where, function, record.place) if where and function else None

    return make


def motor(coordinate: str | None) -> Callable[..., Any]:
    """Return what makes motors in a coordinate."""

    def make(maker: ElementMaker, record: Record) -> JointMotor | None:
        where, function = maker.where(record, coordinate), maker.functions.function(record)
        return JointMotor(record.subject, *where, function, record.place) if where and function else None

    return make


def _spring_data(maker: Any, record: Record) -> dict[Any, Any]:
    for key in ("stiffness", "damping"):
        if record[key] < 0.0:
            message = f"{key} {record[key]:g} is negative, which drives a motion on"
            maker.findings.warn(record.subject, message, record.at(key).place, id="ELEMENTS-029")
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

    def make(maker: ElementMaker, record: Record) -> JointSpring | None:
        where, data = maker.where(record, coordinate), _spring_data(maker, record)
        return JointSpring(record.subject, *where, **data) if where else None

    return make


def line_spring(maker: ElementMaker, record: Record) -> LineSpring | None:
    """A spring between two bodies."""
    ends, data = maker.ends(record), _spring_data(maker, record)
    if data["rest"] < 0.0:
        message = (
            f"rest {data['rest']:g} is negative, and lengths are not: its spring pulls at every length; "
            "a force at length 0 is a preload"
        )
        maker.findings.note(record.subject, message, record.at("rest").place, id="ELEMENTS-032")
    return LineSpring(record.subject, **ends, **data) if ends else None


def cable(maker: ElementMaker, record: Record) -> LineSpring | None:
    """A cable between two bodies."""
    maker.not_negative(record, "stiffness", "rest", "damping")
    data: dict[str, Any] = {key: float(record[key]) for key in ("stiffness", "rest", "damping")}
    ends = maker.ends(record)
    return LineSpring(record.subject, **ends, **data, slack=True, place=record.place) if ends else None


def joint_law(law: Law, coordinate: str | None) -> Callable[..., Any]:
    """Return what makes elements of a law in a coordinate."""

    def make(maker: ElementMaker, record: Record) -> JointLaw | None:
        maker.not_negative(record, *(p.name for p in law.parameters if not p.signed))
        for p in law.parameters:
            if p.above and not record[p.above] < record[p.name]:
                message = (
                    f"{p.name} must be larger than {p.above}, {record[p.above]:g}; read {record[p.name]:g}"
                )
                maker.findings.error(record.subject, message, record.at(p.name).place, id="ELEMENTS-007")
        where = maker.where(record, coordinate)
        if where and is_angle(where[1]):
            _note_degrees(maker, record, law)
        values = tuple(float(record[p.name]) for p in law.parameters)
        return JointLaw(record.subject, *where, law, values, record.place) if where else None

    return make


def law_sections(prefixes: dict[str, str | None]) -> list[tuple[str, Callable[..., Any]]]:
    """Sections of all force laws by the beginnings of their names, a coordinate for each."""
    return [
        ((prefix + law.word).lower(), joint_law(law, at)) for law in LAWS for prefix, at in prefixes.items()
    ]


def _note_degrees(maker: ElementMaker, record: Record, law: Law) -> None:
    """Note the first angle beyond a turn, which may have been meant in degrees."""
    for key in (p.name for p in law.parameters if p.counted):
        if abs(record[key]) > math.tau:
            message = (
                f"{key} of {record[key]:g} rad is {abs(record[key]) / math.tau:.3g} turns; "
                f"{record[key]:g} degrees would be {math.radians(record[key]):.6g} rad"
            )
            maker.findings.note(record.subject, message, record.at(key).place, id="ELEMENTS-031")
            return


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
    terms: list[tuple[int, str, float]] = []
    unknown = False
    for k in range(1, sum(number.key.startswith("factor") for number in record.numbers) + 1):
        where, factor = maker.where(record, None, str(k)), float(record[f"factor{k}"])
        if factor == 0.0:
            place = record.at(f"factor{k}").place
            maker.findings.error(record.subject, "a factor of 0 couples nothing", place, id="ELEMENTS-008")
        if where is None:
            unknown = True
        else:
            terms.append((*where, factor))
    if unknown:
        return None
    if len(terms) < 2:
        message = "couples two joint coordinates or more; read one term"
        maker.findings.error(record.subject, message, record.place, id="ELEMENTS-028")
    if len({(joint, coordinate) for joint, coordinate, _ in terms}) < len(terms):
        maker.findings.error(
            record.subject, "names one coordinate twice; add its factors", record.place, id="ELEMENTS-009"
        )
    return Coupling(record.subject, tuple(terms), record.place)


def sections_of(values: DeckValues) -> Callable[[str], Sequence[Record]]:
    """Return what gives the records of a section; those of "coupling" hold all terms of their cards."""
    return lambda name: list(_couplings(values)) if name == "coupling" else values.section(name)


def _couplings(values: DeckValues) -> Iterator[Record]:
    """The couplings as records of all their terms."""
    terms: dict[int, list[Record]] = {}
    for record in values.section("coupling_term"):
        terms.setdefault(record["coupling"], []).append(record)
    for number, records in terms.items():
        numbers = [
            Number(f"{item.key}{k}", item.value, item.meaning, item.unit, item.place, item.text)
            for k, record in enumerate(records, 1)
            for item in record.numbers[1:]
        ]
        yield Record("coupling", number, f"coupling {number}", tuple(numbers))


def friction(maker: ElementMaker, record: Record) -> JointFriction | None:
    """Friction in a joint."""
    maker.not_negative(record, "dynamic", "static", "radius", "preload")
    for key in ("stribeck", "creep"):
        if not record[key] > LEAST_SPEED:
            message = f"{key} is a speed above {LEAST_SPEED:g}; read {record[key]:g}"
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
    data: dict[str, Any] = {key: float(record[key]) for key in _FRICTION}
    return JointFriction(record.subject, joint, **data, place=record.place)


def rate(maker: ElementMaker, record: Record) -> JointRate | None:
    """The rate of a joint coordinate at the start."""
    where = maker.where(record, None)
    return JointRate(record.subject, *where, float(record["rate"]), record.place) if where else None


# Sections of dialects whose cards name joints, the angle or the stroke.
JOINT_CARDS: Cards = {
    "motors": [("tmotor", motor(ANGLE)), ("amotor", motor(STROKE))],
    "springs": [("tspring", joint_spring(ANGLE)), ("aspring", joint_spring(STROKE))],
    "lines": [("lspring", line_spring), ("cable", cable)],
    "laws": law_sections({"t": ANGLE, "a": STROKE}),
    "bushings": [("bushing", bushing)],
    "couplings": [("coupling", coupling)],
    "frictions": [("friction", friction)],
    "rates": [("rate", rate)],
}
