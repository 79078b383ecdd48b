"""The dynamic cards of a YOUNG deck to masses, loads and first velocities of its mechanism."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...deck.lazy import Chained, Made
from ...deck.record import Deck, Record
from ...errors import Fault, ModelError
from ...model.arrays.dynamic import inertia_matrix
from ...model.diagnostics import Findings, no_such
from ...model.joint_elements import CompositeJoint, DrivenItem, JointElements
from ...model.laws import Element, Line, spring
from ...model.loads import AppliedForce, AppliedTorque, DynamicModel, InitialVelocity, MassProperties
from ...model.mechanism import GROUND, Mechanism
from ..elements_block.build import BlockBuilder
from ..elements_block.functions import Functions
from ..elements_block.line import ElementLine, lines_of, mass_lines
from ..elements_block.measures import JointMeasures
from ..elements_block.words import LINKS
from .build import build_young
from .dynamic_cards import FORWARD, analysis_of
from .integration_cards import check_method, check_time, integrator_of

ELEMENTS = ("Ixx", "Iyy", "Izz", "Ixy", "Iyz", "Izx")
_OF_BODIES = ("mass", "force", "torque", "velocity", "spring", "damper")
HERE = Path()
INERTIA_ROUND_OFF = 1e-9  # of the largest moment of inertia


def build_young_dynamics(deck: Deck, folder: Path = HERE) -> tuple[DynamicModel, list[Fault]]:
    """The dynamic model that `deck` describes, and the warnings about it; tables are files of `folder`.

    Raises ModelError with all faults found.
    """
    mechanism, warnings = build_young(deck)
    findings = Findings()
    lines = lines_of(deck)
    functions = Functions(lines, folder, findings)
    _check_bodies(deck, len(mechanism.bodies), findings)
    _check_once(deck, findings)
    check_method(deck, findings)
    analysis = analysis_of(deck)
    assert analysis is not None, "the deck has dynamic cards"
    model = DynamicModel(
        mechanism,
        analysis,
        _masses(deck, lines, len(mechanism.bodies), folder, findings),
        _made(deck, "force", partial(_force, functions=functions), findings),
        _made(deck, "torque", partial(_torque, functions=functions), findings),
        _one_of(_made(deck, "spring", _spring, findings), _made(deck, "damper", _damper, findings)),
        next((record.vector("g") for record in deck.section("gravity")), (0.0, 0.0, 0.0)),
        _made(deck, "velocity", _velocity, findings),
        integrator_of(deck, findings),
        block_elements(lines, mechanism, functions, findings),
    )
    functions.note_unused()
    check_time(model, findings)
    _warn_of_massless(model, findings)
    _warn_of_idle_velocities(model, findings)
    _note_loads_at_rest(model, findings)
    faults = [*warnings, *findings.in_order]
    if any(fault.severity == "error" for fault in faults):
        raise ModelError((*deck.warnings, *faults))
    return model, faults


def _made(deck: Deck, section: str, make: Callable[..., Any], findings: Findings) -> Sequence[Any]:
    """Return what the cards of a section describe; of a large deck it is made again when looked at."""
    records = deck.section(section)
    if isinstance(deck.records, tuple):
        return tuple(make(record, findings) for record in records)
    for record in records:
        make(record, findings)
    return Made(records, partial(_again, make))


def _again(make: Callable[..., Any], record: Record) -> Any:
    return make(record, Findings())


def _one_of(springs: Sequence[Element], dampers: Sequence[Element]) -> Sequence[Element]:
    many = not isinstance(springs, tuple)
    return Chained([springs, dampers]) if many else (*springs, *dampers)


def _check_bodies(deck: Deck, bodies: int, findings: Findings) -> None:
    for section in _OF_BODIES:
        for record in deck.section(section):
            keys = [key for key in ("body", "I", "J") if key in record]
            # An element between two bodies may end on the ground, body 0.
            least = 1 if len(keys) == 1 else 0
            for key in keys:
                if not least <= record[key] <= bodies:
                    ground = f"body 0 is the ground, which does not move; name one of 1..{bodies}"
                    message = no_such("body", record[key], bodies, least) if record[key] else ground
                    findings.error(record.subject, message, record.at(key).place, id="YOUNG-001")
            if len(keys) == 2 and record["I"] == record["J"]:
                message = f"I and J are both body {record['I']}; two bodies are needed"
                findings.error(record.subject, message, record.at("J").place, id="YOUNG-002")


def _check_once(deck: Deck, findings: Findings) -> None:
    """A body has one mass and one first velocity, a deck one of all else that is here."""
    for section in ("mass", "velocity", "gravity", "tolerance", "generalised-alpha", "radau"):
        first: dict[int | None, int] = {}
        cards = deck.section(section)
        for k, record in enumerate(cards):
            key = record["body"] if section in ("mass", "velocity") else None
            if first.setdefault(key, k) != k:
                other = cards[first[key]]
                what = f"body {key}" if key else "the deck"
                message = f"{what} already has {other.subject}; remove one of them"
                findings.error(record.subject, message, record.place, id="YOUNG-003")


def _masses(
    deck: Deck, lines: Sequence[ElementLine], bodies: int, folder: Path, findings: Findings
) -> Sequence[MassProperties]:
    """The masses of cards MASS, with those of lines of the block."""
    given: Sequence[MassProperties] = _made(deck, "mass", _mass, findings)
    if not mass_lines(lines):
        return given
    # Few decks have any.
    from ...fe.solid_masses import combined
    from ...model.fe_model import RigidMass
    from ..elements_block.masses import added_masses

    added = added_masses(lines, [True] * bodies, folder, findings)
    by_body = {item.body: item for item in given}
    for body, solids in added.items():
        item = by_body.get(body) or MassProperties(f"body {body + 1}", body, 0.0)
        whole = combined([RigidMass(item.mass, item.centre, inertia_matrix(item.inertia)), *solids])
        J = whole.inertia
        elements = J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[1, 2], J[2, 0]
        by_body[body] = replace(item, mass=whole.mass, centre=whole.centre, inertia=elements)
    return tuple(by_body.values())


def _mass(record: Record, findings: Findings) -> MassProperties:
    xx, yy, zz, xy, yz, zx = (float(record[element]) for element in ELEMENTS)
    inertia = xx, yy, zz, xy, yz, zx
    if not record["m"] >= 0.0:
        message = f"the mass must not be negative; read {record['m']:g}"
        findings.error(record.subject, message, record.at("m").place, id="YOUNG-004")
    _check_inertia(record, inertia, findings)
    return MassProperties(
        record.subject, record["body"] - 1, float(record["m"]), record.vector("centre"), inertia, record.place
    )


def _check_inertia(record: Record, inertia: tuple[float, ...], findings: Findings) -> None:
    """1. No principal moment is negative.  2. None exceeds the sum of the others."""
    moments = np.linalg.eigvalsh(inertia_matrix(inertia))
    slack = INERTIA_ROUND_OFF * max(abs(moments[0]), moments[2])
    shown = ", ".join(f"{moment:.6g}" for moment in moments)
    if moments[0] < -slack:
        message = f"the inertia tensor must have no negative principal moment; they are {shown} kg m^2"
        findings.error(record.subject, message, record.at("Ixx").place, id="YOUNG-005")
    elif moments[2] > moments[0] + moments[1] + slack:
        message = (
            f"no body has principal moments of inertia {shown} kg m^2: the largest exceeds the sum of "
            "the others"
        )
        findings.warn(record.subject, message, record.at("Ixx").place, id="YOUNG-006")


def _following(record: Record, findings: Findings) -> bool:
    following = record["following"]
    if following not in (0, 1):
        message = f"following must be 0 (global axes) or 1 (body axes); read {following}"
        findings.error(record.subject, message, record.at("following").place, id="YOUNG-007")
    return bool(following == 1)


def _force(record: Record, findings: Findings, functions: Any) -> AppliedForce:
    following = _following(record, findings)
    return AppliedForce(
        record.subject,
        record["body"] - 1,
        record.vector("F"),
        record.vector("P"),
        following,
        functions.function(record, "factor") if record["factor"] else None,
        record.place,
    )


def _torque(record: Record, findings: Findings, functions: Any) -> AppliedTorque:
    following = _following(record, findings)
    return AppliedTorque(
        record.subject,
        record["body"] - 1,
        record.vector("T"),
        following,
        functions.function(record, "factor") if record["factor"] else None,
        record.place,
    )


def _spring(record: Record, findings: Findings) -> Element:
    for key in ("stiffness", "free_length", "damping"):
        _warn_of_negative(record, key, findings)
    return _line(record, record["stiffness"], record["free_length"])


def _damper(record: Record, findings: Findings) -> Element:
    _warn_of_negative(record, "damping", findings)
    return _line(record, 0.0, 0.0)


def _line(record: Record, stiffness: float, free_length: float) -> Element:
    ends = Line(record["I"] - 1, record["J"] - 1, record.vector("P_i"), record.vector("P_j"))
    law = float(stiffness), float(free_length), float(record["damping"])
    return spring(record.subject, ends, *law, record.place)


def _warn_of_negative(record: Record, key: str, findings: Findings) -> None:
    if record[key] < 0.0:
        message = f"{key.replace('_', ' ')} {record[key]:g} is negative"
        findings.warn(record.subject, message, record.at(key).place, id="YOUNG-008")


def _velocity(record: Record, _findings: Findings) -> InitialVelocity:
    return InitialVelocity(
        record.subject, record["body"] - 1, record.vector("v"), record.vector("w"), record.place
    )


def _warn_of_massless(model: DynamicModel, findings: Findings) -> None:
    if model.without_masses:
        return
    reported = {ground.body for ground in model.mechanism.grounds} | {item.body for item in model.masses}
    for number, body in enumerate(model.mechanism.bodies):
        if number not in reported:
            findings.warn(body.name, "has no MASS card and is taken as massless", body.place, id="YOUNG-016")


def _loaded_bodies(
    model: DynamicModel,
) -> Iterator[tuple[AppliedForce | AppliedTorque | Element, tuple[int, ...]]]:
    for force in model.forces:
        yield force, (force.body,)
    for torque in model.torques:
        yield torque, (torque.body,)
    for item in model.springs:
        yield item, item.measure[:2]


def _note_loads_at_rest(model: DynamicModel, findings: Findings) -> None:
    """Note the loads that act on bodies at rest only."""
    at_rest = {GROUND, *(ground.body for ground in model.mechanism.grounds)}
    bodies = model.mechanism.bodies
    for item, numbers in _loaded_bodies(model):
        refused = numbers == (GROUND,) or len(set(numbers)) < len(numbers)
        if at_rest.issuperset(numbers) and not refused:
            names = " and ".join(bodies[n].name if n != GROUND else "the ground" for n in numbers)
            held = "is held" if len(numbers) == 1 else "are held"
            message = f"moves nothing: {names} {held} at rest by a ground constraint, which bears it"
            findings.note(item.name, message, item.place, id="YOUNG-017")


def _warn_of_idle_velocities(model: DynamicModel, findings: Findings) -> None:
    if model.analysis == FORWARD:
        return
    for item in model.velocities:
        findings.warn(
            item.name, "is not used: the drivers prescribe all velocities", item.place, id="YOUNG-018"
        )


_TYPES = {"revcyl": "revolute-cylindrical", "revsph": "revolute-spherical", "sphsph": "spherical-spherical"}
# The other end of a link needs a direction that no equation uses.
_ANY = (1.0, 0.0, 0.0)


def block_elements(
    lines: Sequence[ElementLine], mechanism: Mechanism, functions: Functions, findings: Findings
) -> JointElements:
    """The elements of the blocks; faults go into `findings`."""
    builder = BlockBuilder(_Measures(mechanism, findings), functions, mechanism.time.start)
    return builder.elements(lines, {"DRIVE": _drive, "SUPPORT": _support, "JOINT": _composite})


class _Measures(JointMeasures):
    """Joints of the mechanism, and ends at points of its bodies."""

    def __init__(self, mechanism: Mechanism, findings: Findings):
        super().__init__(mechanism.joints, findings)
        self.mechanism = mechanism

    def ends(self, line: ElementLine) -> tuple[int, int, Any, Any] | None:
        """Bodies (-1: ground) and points in their axes."""
        bodies = [self.body(line, key, len(self.mechanism.bodies)) for key in ("from", "to")]
        for key in ("from", "to"):
            if f"{key}.node" in line:
                message = "bodies have no nodes here; give the point in body axes, body(x,y,z)"
                self.error(line, line.at(f"{key}.node"), message, id="YOUNG-181")
                return None
        i, j = bodies
        if i is None or j is None or not self.two_bodies(line, i, j):
            return None
        return i, j, line.vector("from"), line.vector("to")


def _drive(builder: BlockBuilder, line: ElementLine) -> tuple[str, Any]:
    if "driver" not in line:
        return "drivers", builder.driver(line)
    measures: Any = builder.measures
    drivers, number = measures.mechanism.drivers, line.at("driver")
    if not 1 <= number.value <= len(drivers):
        measures.error(line, number, no_such("driver", number.value, len(drivers)), id="YOUNG-121")
        return "driven", None
    function = builder.motion(line, drivers[number.value - 1].C)
    return "driven", function and DrivenItem(line.subject, number.value - 1, function, line.place)


def _support(builder: BlockBuilder, line: ElementLine) -> tuple[str, Any]:
    measures: Any = builder.measures
    if "simplified" not in line:
        message = "YOUNG decks have no pins; name a simplified constraint by simplified="
        measures.error(line, line.at("pin"), message, id="YOUNG-182")
        return "supports", None
    held, number = measures.mechanism.simplified, line.at("simplified")
    if not 1 <= number.value <= len(held):
        message = "simplified constraint"
        measures.error(line, number, no_such(message, number.value, len(held)), id="YOUNG-122")
        return "supports", None
    if held[number.value - 1].direction > 3:
        message = (
            f"simplified constraint {number.value} holds an angle; x, y, z (directions 1 to 3) can be moved"
        )
        measures.error(line, number, message, id="YOUNG-123")
        return "supports", None
    function = builder.motion(line)
    return "supports", function and DrivenItem(line.subject, number.value - 1, function, line.place)


def _composite(builder: BlockBuilder, line: ElementLine) -> tuple[str, Any]:
    measures, keys = builder.measures, LINKS[line.kind]
    given = {key: key if key == "length" else f"{key}.x" for key in ("axis_from", "axis_to", "length")}
    wrong = [key for key, first in given.items() if (first in line) != (key in keys)]
    if wrong:
        message = (
            f"{line.kind} takes {' and '.join(f'{key}=' for key in keys)}, and no other of {', '.join(given)}"
        )
        builder.findings.error(line.subject, message, line.place, id="YOUNG-183")
        return "composites", None
    axes = {key: line.vector(key) for key in keys if key != "length"}
    for key, s in axes.items():
        if not any(s):
            measures.error(line, line.at(f"{key}.x"), f"{key} has no length", id="YOUNG-130")
            return "composites", None
    size = float(line["length"]) if "length" in line else 0.0
    if "length" in line and not size > 0.0:
        message = f"the link's length must be above 0; read {size:g}"
        measures.error(line, line.at("length"), message, id="YOUNG-131")
    ends = measures.ends(line)
    if ends is None:
        return "composites", None
    s_i, s_j = axes.get("axis_from", _ANY), axes.get("axis_to", _ANY)
    return "composites", CompositeJoint(
        line.subject, _TYPES[line.kind], *ends, s_i=s_i, s_j=s_j, size=size, place=line.place
    )
