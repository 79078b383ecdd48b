"""Joints and pins of a VSDF deck, at nodes."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...deck.many_records import DeckValues
from ...deck.record import Number, Record
from ...model.diagnostics import Findings, no_such
from ...model.driver_angles import LARGEST_ANGLE, MANY_REVOLUTIONS, NO_ANGLE
from ...model.fe_model import End, NodeJoint, Pin, VsdfBody
from ...model.joints import ANGLE, BY_NAME, PITCH, STROKE, JointType
from ...model.mechanism import GROUND, TimeGrid
from ...model.time_functions import Motion, MotionFunction
from . import DIALECT
from .bodies import end_of_body
from .many_bodies import ManyJoints

_COINCIDENT = 1e-12
WELD_GAP = 1e-2  # of the distance of two nodes: what meshes and typed decimals leave
BY_WORD = {word: BY_NAME[name] for word, name in DIALECT.joints.items()}
# Those with nothing else come first.
_BY_COORDINATES = sorted(BY_WORD.values(), key=lambda kind: len(kind.coordinates))
TURNING, SLIDING = (
    tuple(kind.name for kind in _BY_COORDINATES if wanted in kind.coordinates) for wanted in (ANGLE, STROKE)
)


def find_end(
    bodies: Sequence[VsdfBody], ground: VsdfBody, body: Number, node: Number, subject: str, findings: Findings
) -> End | None:
    """The end that the deck's numbers `body` and `node` name; None, and a fault, when there is none."""
    if not 0 <= body.value <= len(bodies):
        findings.error(subject, no_such("body", body.value, len(bodies), 0), body.place, id="VSDF-041")
        return None
    index = end_of_body(body.value)
    owner = ground if index == GROUND else bodies[index]
    if not owner.nodes:
        # A body whose node table failed has a fault of its own.
        if index == GROUND:
            findings.error(subject, f"the ground has no node {node.value}", node.place, id="VSDF-042")
        elif owner.rigid is not None:
            findings.error(
                subject,
                f"{owner.name} has no node {node.value}; cards NODE give some",
                node.place,
                id="VSDF-043",
            )
        return None
    if not owner.members(node.value):
        name = "the ground" if index == GROUND else owner.name
        findings.error(subject, f"{name} has no node {node.value}", node.place, id="VSDF-044")
        return None
    return End(index, node.value)


def build_joints(
    values: DeckValues, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> Sequence[NodeJoint]:
    """The joints whose bodies and nodes exist."""
    given = (_joint(record, bodies, ground, findings) for record in values.section("joint"))
    joints = (joint for joint in given if joint is not None)
    return ManyJoints(joints) if values.many else tuple(joints)


def _joint(
    record: Record, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> NodeJoint | None:
    kind = BY_WORD[record["kind"]]
    if record["a"] == record["b"]:
        which = "the ground" if record["a"] == 0 else f"body {record['a']}"
        findings.error(
            record.subject,
            f"a and b are both {which}; two bodies are needed",
            record.at("b").place,
            id="VSDF-045",
        )
        return None
    before = len(findings.faults)
    a = _side(record, "a", kind.points_on("i"), bodies, ground, findings)
    b = _side(record, "b", kind.points_on("j"), bodies, ground, findings)
    if len(findings.faults) > before or (a is None and b is None):
        return None
    if a is None or b is None:
        a, b = _with_ground(record, kind, a, b, bodies, findings)
    if not a or not b:
        return None
    _check_axis(record, "a", a, bodies, ground, findings)
    _check_axis(record, "b", b, bodies, ground, findings)
    if kind.name == "fixed" and len(findings.faults) == before:
        _check_weld(record, _positions(a, bodies, ground), _positions(b, bodies, ground), findings)
    size = _size(record, kind, a, b, bodies, ground, findings)
    return NodeJoint(record.subject, kind.name, a, b, size, record.place)


def _side(
    record: Record, letter: str, count: int, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> tuple[End, ...] | None:
    """The ends on one body; None for the ground without nodes, which takes its points from the other body."""
    body = record.at(letter)
    nodes = [record.at(f"{letter}{i}") for i in range(1, count + 1)]
    if body.value == 0 and not any(node.value for node in nodes):
        return None
    ends = []
    for node in nodes:
        if node.value == 0:
            message = f"{record['kind']} needs {count} nodes on {letter}; {node.key} is missing"
            findings.error(record.subject, message, node.place, id="VSDF-046")
        else:
            end = find_end(bodies, ground, body, node, record.subject, findings)
            if not 0 <= body.value <= len(bodies):
                return ()
            ends.append(end)
    return tuple(end for end in ends if end is not None)


def _ground_at(x: float, y: float, z: float) -> End:
    return End(GROUND, 0, (float(x), float(y), float(z)))


def _with_ground(
    record: Record,
    kind: JointType,
    a: tuple[End, ...] | None,
    b: tuple[End, ...] | None,
    bodies: Sequence[VsdfBody],
    findings: Findings,
) -> tuple[tuple[Any, ...] | None, tuple[Any, ...] | None]:
    """The ground's points where those of the other body are at t = 0."""
    ends = a or b or ()
    if not kind.meets:
        letter = "a" if a is None else "b"
        message = f"{record['kind']} needs nodes on the ground, cards NODE of body 0; {letter}1 is missing"
        findings.error(record.subject, message, record.at(f"{letter}1").place, id="VSDF-047")
        return None, None
    points = tuple(_ground_at(*bodies[end.body].global_position(end.node)) for end in ends)
    return (points, b) if a is None else (a, points)


def _positions(ends: Any, bodies: Sequence[VsdfBody], ground: VsdfBody) -> list[np.ndarray]:
    owners = [ground if end.body == GROUND else bodies[end.body] for end in ends]
    return [
        np.array(end.point) if end.point is not None else owner.global_position(end.node)
        for end, owner in zip(ends, owners, strict=True)
    ]


def _check_axis(
    record: Record, letter: str, ends: Any, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> None:
    """P and Q must be apart, and H off their line."""
    if len(ends) < 2:
        return
    P, Q, *H = _positions(ends, bodies, ground)
    _check_arms(record, letter, ends, bodies, findings)
    length = np.linalg.norm(Q - P)
    names = f"nodes {letter}1 and {letter}2"
    if not length > _COINCIDENT:
        message = f"{names} are the same point, so the axis between them has no direction"
        findings.error(record.subject, message, record.at(f"{letter}2").place, id="VSDF-048")
    elif H and not np.linalg.norm(np.cross(Q - P, H[0] - P)) > _COINCIDENT * length:
        message = f"node {letter}3 lies on the axis through {names}; it must lie across it"
        findings.error(record.subject, message, record.at(f"{letter}3").place, id="VSDF-049")


def _check_arms(
    record: Record, letter: str, ends: Any, bodies: Sequence[VsdfBody], findings: Findings
) -> None:
    """An axis with an arm turns with one node."""
    if ends[0].body == GROUND or not bodies[ends[0].body].arms:
        return
    body = bodies[ends[0].body]
    if any(end.node in body.arms for end in ends) and len({body.members(end.node) for end in ends}) > 1:
        message = (
            f"nodes {letter}1 to {letter}{len(ends)} are arms of different nodes; the axis turns with one "
            "node: give all of them by ARMN on that node, or take the node itself"
        )
        findings.error(record.subject, message, record.at(f"{letter}2").place, id="VSDF-225")


def _check_weld(record: Record, a: Any, b: Any, findings: Findings) -> None:
    """The three nodes of a fixed joint meet: on both bodies they form the same triangle."""
    for m, n in ((1, 2), (1, 3), (2, 3)):
        on_a, on_b = (float(np.linalg.norm(side[n - 1] - side[m - 1])) for side in (a, b))
        if abs(on_a - on_b) > WELD_GAP * max(on_a, on_b):
            message = (
                f"nodes a{m} and a{n} are {on_a:.6g} m apart, b{m} and b{n} {on_b:.6g} m: the three nodes of "
                "a and those of b must be the same three points; add nodes that are"
            )
            findings.error(record.subject, message, record.at(f"b{n}").place, id="VSDF-210")
            return


def _size(
    record: Record,
    kind: JointType,
    a: tuple[End, ...],
    b: tuple[End, ...],
    bodies: Sequence[VsdfBody],
    ground: VsdfBody,
    findings: Findings,
) -> float:
    """Pitch or distance, nan where the deck leaves it to the positions at t = 0."""
    given = record.at("size")
    if kind.size == PITCH:
        if not given.text:
            message = "SCRW needs its pitch in size, m/rad; write 0.0 for a screw without advance"
            findings.error(record.subject, message, given.place, id="VSDF-050")
        return float(given.value)
    if not kind.size:
        return math.nan
    size = float(given.value)
    if not given.text:
        (P, *_), (R, *_) = _positions(a, bodies, ground), _positions(b, bodies, ground)
        size = float(np.linalg.norm(R - P))
    if not size > 0:
        message = "the distance must be above zero; for coinciding points take SPHE"
        findings.error(record.subject, message, given.place, id="VSDF-051")
    return size


def build_pins(
    values: DeckValues, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings
) -> tuple[Pin, ...]:
    """The cards PINN."""
    pins = [_pin(record, bodies, ground, findings) for record in values.section("pin")]
    return tuple(pin for pin in pins if pin is not None)


def _pin(record: Record, bodies: Sequence[VsdfBody], ground: VsdfBody, findings: Findings) -> Any:
    mask = record.at("mask")
    digits = f"{mask.value:03d}"
    if len(digits) != 3 or set(digits) - {"0", "1"} or digits == "000":
        message = f"mask {mask.text} must be three digits 0 or 1 for x y z, such as 111 or 101"
        findings.error(record.subject, message, mask.place, id="VSDF-052")
        return None
    if record["body"] == 0:
        findings.error(record.subject, "the ground is held already", record.place, id="VSDF-053")
        return None
    end = find_end(bodies, ground, record.at("body"), record.at("node"), record.subject, findings)
    given = [record.at(f"p.{axis}") for axis in "xyz"]
    point = record.vector("p") if any(number.text for number in given) else None
    x, y, z = (digit == "1" for digit in digits)
    if end and point is None:
        place = bodies[end.body].global_position(end.node)
        record.made.update(
            {f"p.{axis}": f"{value + 0.0:.9g}" for axis, value in zip("xyz", place, strict=True)}
        )
    return end and Pin(record.subject, end, (x, y, z), point, record.place)


LARGEST_RATE = 1e100  # its square still is a number
SAMPLES = 101  # even times of a run at which a function is evaluated


def check_motion_functions(motions: tuple[Motion, ...], grid: TimeGrid, findings: Findings) -> None:
    """Refuse functions that are no numbers, no angles; warn of `MANY_REVOLUTIONS` in a report step."""
    for motion in motions:
        values, rates, _ = reported = _sampled(motion.function, grid)
        if not (np.abs(reported) <= LARGEST_RATE).all():
            message = (
                f"its law or a derivative is beyond {LARGEST_RATE:.0e}, or no number; of a table, two points "
                "lie too close"
            )
            findings.error(motion.name, message, motion.place, id="VSDF-072")
        elif not motion.is_length and np.abs(values).max() > LARGEST_ANGLE:
            angle = np.abs(values).max()
            message = f"its angle reaches {angle:.3g} rad; {NO_ANGLE}: constants are in rad and s"
            findings.error(motion.name, message, motion.place, id="VSDF-073")
        elif (
            not motion.is_length
            and (revolutions := np.abs(rates).max() * grid.step / math.tau) > MANY_REVOLUTIONS
        ):
            message = (
                f"it turns {revolutions:.3g} times between two report times: are its constants in rad and s?"
            )
            findings.note(motion.name, message, motion.place, id="VSDF-074")


def _sampled(function: MotionFunction, grid: TimeGrid) -> np.ndarray:
    """Value, rate and acceleration of a function at even times, or at the points of its table, (3, times)."""
    # Each look into a table goes through all of its points.
    times = (grid.start, grid.end) if function.times else np.linspace(grid.start, grid.end, SAMPLES)
    try:
        reported = np.array([function.at(float(t)) for t in times]).T
    except ValueError:  # the sine of an infinite number
        return np.full((3, 1), np.nan)
    return np.hstack([reported, _at_points(function, grid)]) if function.times else reported


def _at_points(function: MotionFunction, grid: TimeGrid) -> np.ndarray:
    """The same at the points of a table that the run reaches; of the rates a bound."""
    t, f, g = (np.array(column) for column in (function.times, function.values, function.curvature))
    h = np.diff(t)
    with np.errstate(over="ignore"):
        rates = np.abs(np.diff(f)) / h + h * np.maximum(np.abs(g[:-1]), np.abs(g[1:])) / 2
    reached = (grid.start <= t) & (t <= grid.end)
    return np.array([f, np.append(rates, rates[-1]), g])[:, reached]
