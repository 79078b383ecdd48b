"""Cards of joint drivers, motors, springs, stops, bushings, couplings and friction to elements.

A dialect says by a subclass of `ElementMaker` how its cards name joints and ends, and by a dictionary like
`JOINT_CARDS` which of its sections give which elements.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from ...deck.record import Number, Record
from ...deck.records import DeckValues
from ...model.joint_elements import Coupling, JointDriver, JointElements, JointRate
from ...model.joints import ANGLE, STROKE
from ...model.laws import (
    BUSHING,
    CABLE,
    COORDINATE_LAWS,
    FRICTION,
    FUNCTIONS,
    MOTOR,
    NUMBER,
    OF_TIME,
    SPRING,
    VECTOR,
    At,
    Element,
    Frames,
    Joint,
    Law,
    Line,
    Parameter,
)
from ..elements_block.line import MOST_ELEMENTS
from .maker import ElementMaker

Cards = Mapping[str, Sequence[tuple[str, Callable[..., Any]]]]  # fields of `JointElements`: sections, makers
_ONE_OF = {  # what there may be one of, and by what it is distinguished
    "driven": lambda item: item.item,
    "supports": lambda item: item.item,
    "drivers": lambda item: (item.joint, item.coordinate),
    "rates": lambda item: (item.joint, item.coordinate),
}


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
    forces = [item for item in found["forces"] if item is not None]
    for item in (item for item in forces if item.idle):
        message = "does nothing: its coefficients are 0"
        maker.findings.note(item.name, message, item.place, id="ELEMENTS-030")
    for name, key in _ONE_OF.items():
        maker.refuse_twice(found.get(name, ()), key)
    maker.refuse_twice([item for item in forces if item.law is FRICTION], lambda item: item.measure.joint)
    kept: dict[str, Any] = {
        name: tuple(item for item in items if item is not None) for name, items in found.items()
    }
    return JointElements(**kept, **more)


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


def force(law: Law, measure: type = At, coordinate: str | None = None) -> Callable[..., Any]:
    """Return what makes elements; `coordinate`: that of At, None: the card names it."""

    def make(maker: ElementMaker, record: Record) -> Element | None:
        _check(maker, record, law, measure)
        values = tuple(_value(maker, record, p) for p in law.parameters)
        found = _measure(maker, record, measure, coordinate)
        if found is None or (law is MOTOR and values[0] is None):
            return None
        element = Element(record.subject, law, found, values, record.place)
        if element.turning and law is not SPRING:
            _note_degrees(maker, record, law)
        return element

    return make


def _measure(maker: ElementMaker, record: Record, measure: type, coordinate: str | None) -> Any:
    """Return what an element measures; None if a fault was found."""
    if measure is Joint:
        return _sliding(maker, record)
    if measure is At:
        where = maker.where(record, coordinate)
        return At(*where) if where else None
    ends = maker.ends(record)
    return measure(**ends) if ends else None


def _sliding(maker: ElementMaker, record: Record) -> Joint | None:
    found = maker.sliding(record)
    if found is None:
        return None
    joint, revolutions = found
    if revolutions and not record["radius"] > 0.0:
        message = "a joint that turns needs the radius of its bearing"
        maker.findings.error(record.subject, message, record.at("radius").place, id="ELEMENTS-011")
        return None
    return Joint(joint)


def _value(maker: ElementMaker, record: Record, p: Parameter) -> Any:
    if p.kind == OF_TIME:
        return maker.functions.function(record)
    if p.kind in FUNCTIONS:
        return maker.functions.curve(record, p.name)
    return record.vector(p.name) if p.kind == VECTOR else float(record[p.name])


def _check(maker: ElementMaker, record: Record, law: Law, measure: type) -> None:
    """Refuse values outside of their ranges, and note strange ones."""
    for p in law.parameters:
        if p.kind in (NUMBER, VECTOR) and not p.signed:
            maker.not_negative(record, *([p.name] if p.kind == NUMBER else [f"{p.name}.{a}" for a in "xyz"]))
        if isinstance(p.above, str) and not record[p.above] < record[p.name]:
            message = f"{p.name} must be larger than {p.above}, {record[p.above]:g}; read {record[p.name]:g}"
            maker.findings.error(record.subject, message, record.at(p.name).place, id="ELEMENTS-007")
        elif isinstance(p.above, float) and not record[p.name] > p.above:
            message = f"{p.name} must be above {p.above:g}; read {record[p.name]:g}"
            maker.findings.error(record.subject, message, record.at(p.name).place, id="ELEMENTS-010")
    if law is SPRING:
        _check_spring(maker, record, measure)
    if law is FRICTION and record["static"] < record["dynamic"]:
        message = f"sticks with {record['static']:g}, less than it slides with: are the numbers exchanged?"
        maker.findings.warn(record.subject, message, record.at("static").place, id="ELEMENTS-027")


def _check_spring(maker: ElementMaker, record: Record, measure: type) -> None:
    for key in ("stiffness", "damping"):
        if record[key] < 0.0:
            message = f"{key} {record[key]:g} is negative, which drives a motion on"
            maker.findings.warn(record.subject, message, record.at(key).place, id="ELEMENTS-029")
    if measure is Line and record["rest"] < 0.0:
        message = (
            f"rest {record['rest']:g} is negative, and lengths are not: its spring pulls at every length; "
            "a force at length 0 is a preload"
        )
        maker.findings.note(record.subject, message, record.at("rest").place, id="ELEMENTS-032")


def force_sections(prefixes: dict[str, str | None]) -> list[tuple[str, Callable[..., Any]]]:
    """Sections of force elements but motors: those in a coordinate by the beginnings of their names, a
    coordinate for each, and those between bodies.
    """

    def at(law: Law) -> list[tuple[str, Callable[..., Any]]]:
        return [(prefix + law.word.lower(), force(law, At, one)) for prefix, one in prefixes.items()]

    between = [("lspring", force(SPRING, Line)), ("cable", force(CABLE, Line))]
    others = [section for law in COORDINATE_LAWS for section in at(law)]
    return [*at(SPRING), *between, *others, ("bushing", force(BUSHING, Frames))]


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


def rate(maker: ElementMaker, record: Record) -> JointRate | None:
    """The rate of a joint coordinate at the start."""
    where = maker.where(record, None)
    return JointRate(record.subject, *where, float(record["rate"]), record.place) if where else None


# Sections of dialects whose cards name joints, the angle or the stroke.
JOINT_CARDS: Cards = {
    "forces": [
        *force_sections({"t": ANGLE, "a": STROKE}),
        ("friction", force(FRICTION, Joint)),
        ("tmotor", force(MOTOR, At, ANGLE)),
        ("amotor", force(MOTOR, At, STROKE)),
    ],
    "couplings": [("coupling", coupling)],
    "rates": [("rate", rate)],
}
