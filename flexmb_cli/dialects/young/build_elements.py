"""The cards of joint drivers, joint elements, composite joints and joint rates of a YOUNG deck."""

from ...deck.record import Deck, Record
from ...model.diagnostics import Findings
from ...model.joint_elements import (
    COORDINATES_OF,
    Bushing,
    CompositeJoint,
    Coupling,
    DrivenItem,
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
from ...model.mechanism import Mechanism
from .build_functions import Functions

_COORDINATES = {1: ANGLE, 2: STROKE}
_A = {ANGLE: "an angle", STROKE: "a stroke"}
_LINKS = {"revcyl": "revolute-cylindrical", "revsph": "revolute-spherical", "sphsph": "spherical-spherical"}


def build_elements(
    deck: Deck, mechanism: Mechanism, functions: Functions, findings: Findings
) -> JointElements:
    """All elements of the deck; faults go into `findings`."""
    made = _Maker(mechanism, functions, findings)
    found = {name: [make(made, record) for section, make in cards for record in deck.section(section)]
             for name, cards in _MAKERS.items()}  # fmt: skip
    for items in (found["driven"], found["supports"]):
        made.refuse_twice(items, lambda item: item.item)
    made.refuse_twice(found["drivers"], lambda item: (item.joint, item.coordinate))
    made.refuse_twice(found["rates"], lambda item: (item.joint, item.coordinate))
    made.refuse_twice(found["frictions"], lambda item: item.joint)
    kept = {name: tuple(item for item in items if item is not None) for name, items in found.items()}
    return JointElements(**kept, reported=bool(deck.section("joints")))


class _Maker:
    """Makes elements of records; None where a fault was found."""

    def __init__(self, mechanism, functions: Functions, findings: Findings):
        self.mechanism, self.functions, self.findings = mechanism, functions, findings
        self.start = mechanism.time.start

    def refuse_twice(self, items, key):
        """Refuse two items for one thing."""
        first: dict = {}
        for item in items:
            other = item if item is None else first.setdefault(key(item), item)
            if other is not item:
                message = f"{other.name} already gives this; remove one of them"
                self.findings.error(item.name, message, item.place, id="YOUNG-116")

    def joint(self, record: Record, coordinate: str | None = None, key: str = "joint"):
        """Number of the joint of a record, None unless it is there and has the coordinate."""
        joints, number = self.mechanism.joints, record[key]
        if not 1 <= number <= len(joints):
            message = f"joint number {number} is outside 1..{len(joints)}"
            self.findings.error(record.subject, message, record.at(key).place, id="YOUNG-117")
            return None
        joint = joints[number - 1]
        if coordinate not in (None, *COORDINATES_OF[joint.kind]):
            has = " and ".join(_A[one] for one in COORDINATES_OF[joint.kind]) or "neither angle nor stroke"
            message = f"joint {number} ({joint.name}) has {has}, not {_A[coordinate]}"
            self.findings.error(record.subject, message, record.at(key).place, id="YOUNG-118")
            return None
        return number - 1

    def coordinate(self, record, key="coordinate"):
        if record[key] not in _COORDINATES:
            self.findings.error(
                record.subject,
                f"must be 1 (angle) or 2 (stroke); read {record[key]}",
                record.at(key).place,
                id="YOUNG-119",
            )
            return None
        return _COORDINATES[record[key]]

    def ends(self, record):
        """Bodies (-1: ground) and points of an element between two bodies."""
        return {
            "i": record["I"] - 1, "j": record["J"] - 1,
            "P_i": record.vector("P_i"), "P_j": record.vector("P_j"),
        }  # fmt: skip

    def not_negative(self, record, *keys):
        for key in keys:
            if record[key] < 0.0:
                self.findings.error(
                    record.subject,
                    f"{key} must not be negative; read {record[key]:g}",
                    record.at(key).place,
                    id="YOUNG-120",
                )


def _driven(maker, record):
    number, drivers = record["driver"], maker.mechanism.drivers
    if not 1 <= number <= len(drivers):
        maker.findings.error(
            record.subject,
            f"driver number {number} is outside 1..{len(drivers)}",
            record.at("driver").place,
            id="YOUNG-121",
        )
        return None
    driver = drivers[number - 1]
    function = maker.functions.motion(record, maker.start, driver.C)
    return None if function is None else DrivenItem(record.subject, number - 1, function, record.place)


def _support(maker, record):
    number, held = record["simplified"], maker.mechanism.simplified
    if not 1 <= number <= len(held):
        message = f"simplified constraint {number} is outside 1..{len(held)}"
        maker.findings.error(record.subject, message, record.at("simplified").place, id="YOUNG-122")
        return None
    if held[number - 1].direction > 3:
        message = f"simplified constraint {number} holds an angle; x, y, z (directions 1 to 3) can be moved"
        maker.findings.error(record.subject, message, record.at("simplified").place, id="YOUNG-123")
        return None
    function = maker.functions.motion(record, maker.start)
    return None if function is None else DrivenItem(record.subject, number - 1, function, record.place)


def _joint_driver(coordinate):
    def make(maker, record):
        joint, function = maker.joint(record, coordinate), maker.functions.motion(record, maker.start)
        if joint is None or function is None:
            return None
        return JointDriver(record.subject, joint, coordinate, function, record.place)

    return make


def _motor(coordinate):
    def make(maker, record):
        joint, function = maker.joint(record, coordinate), maker.functions.function(record)
        if joint is None or function is None:
            return None
        return JointMotor(record.subject, joint, coordinate, function, record.place)

    return make


def _spring_data(maker, record):
    return {
        "stiffness": float(record["stiffness"]),
        "rest": float(record["rest"]),
        "damping": float(record["damping"]),
        "preload": float(record["preload"]),
        "curve": maker.functions.curve(record, "curve"),
        "damper": maker.functions.curve(record, "damper"),
        "place": record.place,
    }


def _joint_spring(coordinate):
    def make(maker, record):
        joint = maker.joint(record, coordinate)
        data = _spring_data(maker, record)
        return None if joint is None else JointSpring(record.subject, joint, coordinate, **data)

    return make


def _line_spring(maker, record):
    return LineSpring(record.subject, **maker.ends(record), **_spring_data(maker, record))


def _cable(maker, record):
    maker.not_negative(record, "stiffness", "rest", "damping")
    stiffness, rest, damping = (float(record[key]) for key in ("stiffness", "rest", "damping"))
    return LineSpring(record.subject, **maker.ends(record), stiffness=stiffness, rest=rest,
                      damping=damping, slack=True, place=record.place)  # fmt: skip


def _stop(coordinate):
    def make(maker, record):
        maker.not_negative(record, "stiffness", "damping")
        if not record["lower"] < record["upper"]:
            maker.findings.error(
                record.subject, "upper must be larger than lower", record.at("upper").place, id="YOUNG-124"
            )
        numbers = (float(record[key]) for key in ("lower", "upper", "stiffness", "damping"))
        joint = maker.joint(record, coordinate)
        return None if joint is None else EndStop(record.subject, joint, coordinate, *numbers, record.place)

    return make


def _bushing(maker, record):
    stiffness, damping = (
        (*record.vector(along), *record.vector(about)) for along, about in (("k", "kr"), ("c", "cr"))
    )
    for key in ("k", "kr", "c", "cr"):
        maker.not_negative(record, *(f"{key}.{axis}" for axis in "xyz"))
    return Bushing(
        record.subject, **maker.ends(record), stiffness=stiffness, damping=damping, place=record.place
    )


def _coupling(maker, record):
    terms = []
    for k in range(1, len(record.numbers) // 3 + 1):
        coordinate = maker.coordinate(record, f"coordinate{k}")
        joint = maker.joint(record, coordinate, f"joint{k}")
        factor = float(record[f"factor{k}"])
        if factor == 0.0:
            maker.findings.error(
                record.subject, "a factor of 0 couples nothing", record.at(f"factor{k}").place, id="YOUNG-125"
            )
        terms.append((joint, coordinate, factor))
    named = {(joint, coordinate) for joint, coordinate, _ in terms}
    if len(named) < len(terms) and not any(None in term for term in terms):
        maker.findings.error(
            record.subject, "names one coordinate twice; add its factors", record.place, id="YOUNG-126"
        )
    return (
        None if any(None in term for term in terms) else Coupling(record.subject, tuple(terms), record.place)
    )


def _friction(maker, record):
    joint = maker.joint(record)
    maker.not_negative(record, "dynamic", "static", "radius", "preload")
    for key in ("stribeck", "creep"):
        if not record[key] > 0.0:
            maker.findings.error(
                record.subject,
                f"{key} is a speed above 0; read {record[key]:g}",
                record.at(key).place,
                id="YOUNG-127",
            )
    if joint is None:
        return None
    kinds = COORDINATES_OF[maker.mechanism.joints[joint].kind]
    if not kinds:
        message = f"{maker.mechanism.joints[joint].name} turns about no axis: it takes no friction"
        maker.findings.error(record.subject, message, record.at("joint").place, id="YOUNG-128")
        return None
    if ANGLE in kinds and not record["radius"] > 0.0:
        maker.findings.error(
            record.subject,
            "a joint that turns needs the radius of its bearing",
            record.at("radius").place,
            id="YOUNG-129",
        )
    keys = ("dynamic", "static", "stribeck", "creep", "radius", "preload")
    return JointFriction(record.subject, joint, *(float(record[key]) for key in keys), record.place)


def _composite(maker, record):
    axes = {key: record.vector(key) for key in ("s_i", "s_j") if f"{key}.x" in record}
    for key, s in axes.items():
        if not any(s):
            maker.findings.error(
                record.subject, f"{key} has no length", record.at(f"{key}.x").place, id="YOUNG-130"
            )
            return None
    size = float(record["length"]) if "length" in record else 0.0
    if "length" in record and not size > 0.0:
        maker.findings.error(
            record.subject,
            f"the link's length must be above 0; read {size:g}",
            record.at("length").place,
            id="YOUNG-131",
        )
    # The other end of a link needs a direction that no equation uses.
    axes = {"s_i": (1.0, 0.0, 0.0), "s_j": (1.0, 0.0, 0.0)} | axes
    kind = _LINKS[record.section]
    return CompositeJoint(record.subject, kind, **maker.ends(record), **axes, size=size, place=record.place)


def _rate(maker, record):
    coordinate = maker.coordinate(record)
    joint = maker.joint(record, coordinate)
    if joint is None or coordinate is None:
        return None
    return JointRate(record.subject, joint, coordinate, float(record["rate"]), record.place)


_MAKERS = {
    "driven": [("drive", _driven)],
    "supports": [("support", _support)],
    "drivers": [("angle", _joint_driver(ANGLE)), ("stroke", _joint_driver(STROKE))],
    "motors": [("tmotor", _motor(ANGLE)), ("amotor", _motor(STROKE))],
    "springs": [("tspring", _joint_spring(ANGLE)), ("aspring", _joint_spring(STROKE))],
    "lines": [("lspring", _line_spring), ("cable", _cable)],
    "stops": [("tstop", _stop(ANGLE)), ("astop", _stop(STROKE))],
    "bushings": [("bushing", _bushing)],
    "couplings": [("coupling", _coupling)],
    "frictions": [("friction", _friction)],
    "composites": [(section, _composite) for section in _LINKS],
    "rates": [("rate", _rate)],
}
