"""VSDF deck → VsdfModel: what its cards mean, all faults collected."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...deck.many_records import DeckValues
from ...deck.record import Deck, Number, Record
from ...errors import Fault, ModelError
from ...fe.build_mechanism import flexible_mechanism
from ...model.diagnostics import Findings
from ...model.fe_model import End, Pin, VsdfBody, VsdfModel
from ...model.flexible_mechanism import FlexibleMechanism
from ...model.integrators import METHODS, Integrator
from ...model.joint_elements import JointElements
from ...model.joints import ANGLES_OF_CROSS
from ...model.mechanism import GROUND, TimeGrid
from ...model.time_checks import MOST_ROWS, unsteppable
from ..elements_block.build import BlockBuilder
from ..elements_block.functions import Functions
from ..elements_block.line import ElementLine, mass_lines
from ..elements_block.measures import JointMeasures
from .bodies import build_bodies, build_ground
from .cards.analysis import SHAPES, WITHOUT_CARD
from .joints import build_joints, build_pins, check_motion_functions, find_end
from .loads import Factors, build_forces, build_joint_springs, build_outputs, build_springs, build_torques
from .motions import build_motions, build_tables, motions_among, motions_of
from .stress_outputs import build_stresses
from .unused_fields import refuse_unread, warn_of_tables


def build_model(deck: Deck, folder: Path) -> tuple[FlexibleMechanism, list[Fault]]:
    """Return the mechanism and the warnings; file names are relative to `folder`.  Raises ModelError."""
    model, warnings = build_vsdf(deck, folder)
    try:
        mechanism, more = flexible_mechanism(model)
    except ModelError as failure:
        raise ModelError((*warnings, *failure.faults)) from failure
    return mechanism, [*warnings, *more]


def build_vsdf(deck: Deck, folder: Path) -> tuple[VsdfModel, list[Fault]]:
    """The model that `deck` describes, file names relative to `folder`, and what was doubtful.

    Node tables are read here; matrices are left to `fe.flexible_bodies`.  Raises ModelError with all
    faults found, the deck's own warnings among them.
    """
    values, findings = DeckValues(deck), Findings()
    refuse_unread(values, findings)
    lines: Any = values.section("elements")
    bodies = _with_masses(build_bodies(values, folder, findings), lines, folder, findings)
    ground = build_ground(values, findings)
    time = _time(values, findings)
    integrator = _integrator(values, findings)
    joints = build_joints(values, bodies, ground, findings)
    tables = build_tables(values, findings)
    warn_of_tables(values, tables, findings)
    functions = Functions(lines, folder, findings, tables)
    elements = block_elements(lines, (bodies, ground, joints), functions, findings)
    factors = Factors(tables, functions, findings)
    pins = build_pins(values, bodies, ground, findings)
    parts = {
        "joints": joints,
        "pins": moved_pins(lines, pins, len(values.section("pin")), functions, findings),
        "motions": build_motions(values, bodies, joints, tables, functions, findings)
        + motions_of(elements.drivers),
        "forces": build_forces(values, bodies, ground, factors, findings),
        "torques": build_torques(values, bodies, factors, findings),
        "springs": build_springs(values, bodies, ground, findings)
        + build_joint_springs(values, joints, findings),
        "outputs": build_outputs(values, bodies, ground, findings),
        "stresses": build_stresses(values, bodies, findings),
        "shapes": _shapes(values, bodies, folder, findings),
        "elements": replace(elements, drivers=(), later=motions_among(elements.later)),
    }
    functions.note_unused()
    if not bodies:
        findings.error("", "the deck has no body", None, id="VSDF-009")
    check_motion_functions(parts["motions"], time, findings)
    if any(fault.severity == "error" for fault in findings.faults):
        raise ModelError((*deck.warnings, *findings.in_order))
    gravity = values.record("gravity")
    g = gravity.vector("g") if gravity else (0.0, 0.0, 0.0)
    return VsdfModel(bodies, time, integrator, ground, gravity=g, **parts), findings.in_order


def _with_masses(bodies: Any, lines: Any, folder: Path, findings: Findings) -> Any:
    """The bodies with the masses of lines of the block."""
    if not mass_lines(lines):
        return bodies
    # Few decks have any.
    from ...fe.solid_masses import combined
    from ..elements_block.masses import added_masses

    added = added_masses(lines, [body.flexible is None for body in bodies], folder, findings)
    heavier = list(bodies)
    for k, solids in added.items():
        own = [bodies[k].rigid] if bodies[k].rigid else []
        heavier[k] = replace(bodies[k], rigid=combined([*own, *solids]))
    return tuple(heavier)


def _shapes(values: DeckValues, bodies: Sequence[VsdfBody], folder: Path, findings: Findings) -> Any:
    if not (values.section("shape") or values.section("shape_file")):
        return ()
    from ..body_shapes import Keys, build_shapes

    rigid = [values.number("body", k, "kind").value == "RIGD" for k in range(1, len(bodies) + 1)]
    return build_shapes(values, rigid, folder, findings, Keys(words=SHAPES))


def _time(values: DeckValues, findings: Findings) -> TimeGrid:
    record = values.record("time")
    if record is None:
        findings.error("", "card 'TIME' is missing", None, id="VSDF-010")
        return TimeGrid(0.0, 0.0, 1.0)
    end, output = float(record["end"]), float(record["output"])
    if end < 0:
        findings.error(
            "TIME", f"the last time must not be negative; read {end:g}", record.at("end").place, id="VSDF-011"
        )
    elif not output > 0:
        message = f"the time between rows must be above zero; read {record.at('output').text}"
        findings.error("TIME", message, record.at("output").place, id="VSDF-012")
    elif end / output + 1 > MOST_ROWS + 0.5:
        message = f"{end / output:.3g} rows are more than {MOST_ROWS}; take a larger time between rows"
        findings.error("TIME", message, record.at("output").place, id="VSDF-013")
    elif fault := unsteppable(end, output):
        findings.error("TIME", fault, record.place, id="VSDF-014")
    elif 0 < end < output:
        message = f"rows are {output:g} s apart and the run ends at {end:g} s: only that of t = 0 is written"
        findings.warn("TIME", message, record.at("output").place, id="VSDF-015")
    elif reported := TimeGrid(0.0, end, output).left_out:
        findings.note("TIME", reported, record.at("end").place, id="VSDF-016")
    return TimeGrid(0.0, end, output, record.place)


def _integrator(values: Any, findings: Findings) -> Integrator:
    record, time = values.record("integrator"), values.record("time")
    step = float(time["step"]) if time else 0.0
    if step < 0:
        findings.error(
            "TIME", f"a step must not be negative; read {step:g}", time.at("step").place, id="VSDF-017"
        )
    if record is None:
        return _integrator_of(WITHOUT_CARD, step)
    given, word = record.at("rho"), record["method"]
    method = METHODS[word]
    number = float(given.value) if given.text else None
    if number is not None and method.radius is not None and not 0 <= number <= 1:
        message = f"the spectral radius lies between 0 and 1; read {given.text}"
        findings.error("INTG", message, given.place, id="VSDF-018")
    if number is not None and method.radius is None and not 0 < number < 1:
        message = f"the tolerance lies between 0 and 1; read {given.text}"
        findings.error("INTG", message, given.place, id="VSDF-019")
    if not method.given_step and step > 0:
        message = f"{word} chooses its steps by the tolerance; the step of {step:g} s is not used"
        findings.warn("TIME", message, time.at("step").place, id="VSDF-020")
    if record["stabilise"]:
        message = "constraint stabilisation is not used: every step is projected onto the constraints"
        findings.warn("INTG", message, record.at("stabilise").place, id="VSDF-021")
    return _integrator_of(word, step, number, _tolerance_beside_radius(record, findings))


def _tolerance_beside_radius(record: Record, findings: Findings) -> float | None:
    """The tolerance of a method whose first number is its radius; None where the card gives none."""
    given = record.at("tolerance")
    if not given.text:
        return None
    tolerance = float(given.value)
    if METHODS[record["method"]].radius is None:
        message = f"{record['method']} has its tolerance in the second field; leave this one empty"
        findings.error("INTG", message, given.place, id="VSDF-111")
    elif not 0 < tolerance < 1:
        findings.error(
            "INTG", f"the tolerance lies between 0 and 1; read {given.text}", given.place, id="VSDF-112"
        )
    return tolerance


def _integrator_of(
    word: str, step: float, number: float | None = None, tolerance: float | None = None
) -> Integrator:
    """Return the integrator of a card INTG; its number is the spectral radius of a method that has one."""
    method = METHODS[word]
    if method.radius is None:
        return Integrator(word, step, method.tolerance if number is None else number)
    radius = method.radius if number is None else number
    return Integrator(word, step, method.tolerance if tolerance is None else tolerance, radius)


RUN_START = 0.0  # s, of every run


def block_elements(
    lines: Sequence[ElementLine], parts: tuple[Any, VsdfBody, Any], functions: Functions, findings: Findings
) -> JointElements:
    """The elements of the blocks; `parts`: bodies, ground and joints; faults go into `findings`."""
    builder = BlockBuilder(_Measures(*parts, findings), functions, RUN_START)
    elements = builder.elements(lines, {"SUPPORT": lambda _builder, _line: None})
    for item in (*elements.drivers, *elements.later):
        if getattr(item, "coordinate", "") in ANGLES_OF_CROSS:
            message = "VSDF decks drive no angle of a universal joint; drive one of two revolute joints"
            findings.error(item.name, message, item.place, id="ELEMENTS-246")
    return elements


class _Measures(JointMeasures):
    """Joints of the deck, and ends at nodes of its bodies."""

    def __init__(
        self, bodies: Sequence[VsdfBody], ground: VsdfBody, joints: Sequence[Any], findings: Findings
    ):
        super().__init__(joints, findings)
        self.bodies, self.ground = bodies, ground

    def ends(self, line: ElementLine) -> tuple[int, int, Any, Any] | None:
        """Bodies (-1: ground) and nodes."""
        a, b = (self._end(line, key) for key in ("from", "to"))
        if a is None or b is None:
            return None
        if a.body == b.body and (a.body == GROUND or self.bodies[a.body].flexible is None):
            what = "the ground" if a.body == GROUND else f"body {a.body + 1}, which is rigid"
            message = f"both ends are on {what}, so nothing changes between them"
            self.error(line, line.at("to.body"), message, id="VSDF-103")
            return None
        return a.body, b.body, a, b

    def is_rigid(self, line: ElementLine, body: int, key: str) -> bool:
        """Return whether an end keeps its place and attitude in a body: that of a FLEX body deforms."""
        return self.bodies[body].flexible is None

    def _end(self, line: ElementLine, key: str) -> End | None:
        body = line.at(f"{key}.body")
        if f"{key}.node" in line:
            return find_end(
                self.bodies, self.ground, body, line.at(f"{key}.node"), line.subject, self.findings
            )
        if body.value == 0:
            return End(GROUND, 0, line.vector(key))
        message = f"points of bodies are their nodes; write {body.value}:node, cards NODE give some"
        self.error(line, body, message, id="VSDF-217")
        return None


def moved_pins(
    lines: Sequence[ElementLine], pins: tuple[Pin, ...], count: int, functions: Functions, findings: Findings
) -> tuple[Pin, ...]:
    """The pins, some of which lines SUPPORT move; `count`: pins of the deck, some of which may be faulty."""
    moved, seen = list(pins), dict[int, str]()
    for line in lines:
        if line.word == "SUPPORT" and (number := _pin_of(line, count, seen, findings)):
            if len(moved) == count:
                k = number.value - 1
                moved[k] = replace(moved[k], functions=_functions(line, moved[k], functions, findings))
            seen.setdefault(number.value, line.subject)
    return tuple(moved)


def _pin_of(line: ElementLine, count: int, seen: dict[int, str], findings: Findings) -> Number | None:
    """The number of the pin that a line moves; None where a fault is found."""
    if "pin" not in line:
        message = "VSDF decks have no simplified constraints; name a pin by pin="
        findings.error(line.subject, message, line.at("simplified").place, id="VSDF-216")
        return None
    number = line.at("pin")
    if not 1 <= number.value <= count:
        message = f"pin number {number.value} is outside 1..{count}"
        message = message if count else "there are no pins; a card PINN holds a node, which SUPPORT can move"
        findings.error(line.subject, message, number.place, id="VSDF-215")
    elif number.value in seen:
        message = f"{seen[number.value]} already moves this pin; remove one of them"
        findings.error(line.subject, message, number.place, id="VSDF-106")
    else:
        return number
    return None


def _functions(line: ElementLine, pin: Pin, functions: Functions, findings: Findings) -> tuple[Any, ...]:
    for held, axis in zip(pin.directions, "xyz", strict=True):
        if axis in line and not held:
            message = (
                f"{pin.name} does not hold {axis}; add it to the mask of PINN, or leave the function out"
            )
            findings.error(line.subject, message, line.at(axis).place, id="VSDF-107")
    return tuple(functions.motion(line, axis) if axis in line else None for axis in "xyz")
