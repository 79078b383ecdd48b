"""Loads on a tree of FMBD.DAT: pulses, tables, springs, dampers, motors, drives, closures."""

from collections.abc import Iterator, Sequence
from typing import Any

from ...deck.many_records import DeckValues
from ...deck.record import Record
from ...model.diagnostics import Findings
from ...model.joint_elements import JointElements
from ...model.laws import MOTOR, At, Element, spring
from ...model.piecewise_polynomials import linear_table, polynomial
from ...model.time_functions import MotionFunction, piecewise, pulse
from ...model.tree import INERTIAL, ROTATION, TRANSLATION, Body, BodyTorque, Closure, Hinge, Prescribed


def build_functions_of_time(
    values: DeckValues, bodies: tuple[Body, ...], hinges: tuple[Hinge, ...], findings: Findings
) -> dict[str, Any]:
    """Keyword arguments of `Tree` for everything that drives or loads it over time."""

    def hinged(section: str) -> Iterator[tuple[Record, tuple[int, str, int]]]:
        """Entries that name a free axis."""
        pairs = ((record, _where(record, hinges, findings)) for record in values.section(section))
        return ((record, where) for record, where in pairs if where is not None)

    springs = [
        spring(record.subject, _coordinate(where), stiffness, rest, place=record.place)
        for record, where in hinged("spring")
        for stiffness, rest in [_after_the_hinge(record)]
    ]
    springs += _dampers(hinged("damper"), findings)
    motors = [
        _motor(record, where, piecewise(polynomial(_after_the_hinge(record))))
        for record, where in hinged("motor")
    ]
    motors += [_motor(record, where, _table(record, findings)) for record, where in hinged("motor_table")]
    drives = [
        Prescribed(*where, C, B, A, record.place)
        for record, where in hinged("prescribed")
        for C, B, A in [_after_the_hinge(record)]
    ]
    _check_drives(drives, findings)
    _check_rotations(values, bodies, findings)
    return {
        "torques": tuple(_pulses(values, bodies, findings) + _torque_tables(values, bodies, findings)),
        "elements": JointElements(forces=(*springs, *motors)),
        "prescribed": tuple(drives),
    }


def _dampers(entries: Iterator[Any], findings: Findings) -> list[Element]:
    dampers = []
    for record, where in entries:
        (damping,) = _after_the_hinge(record)
        if damping < 0:
            message = f"CS = {damping}: a negative damper feeds energy in"
            findings.warn(record.subject, message, record.at("CS").place, id="DAFMS-056")
        dampers.append(spring(record.subject, _coordinate(where), damping=damping, place=record.place))
    return dampers


def _coordinate(where: tuple[int, str, int]) -> At:
    body, motion, axis = where
    return At(body, f"{motion} {axis}")


def _motor(record: Record, where: tuple[int, str, int], function: MotionFunction) -> Element:
    return Element(record.subject, MOTOR, _coordinate(where), (function,), record.place)


def _after_the_hinge(record: Record) -> list[Any]:
    """Return the values after K and A, by their places.

    Not by their keys: the table of keys that a record then makes takes 460 bytes, for up to 100,000 records.
    """
    return [number.value for number in record.numbers[2:]]


def _where(record: Record, hinges: tuple[Hinge, ...], findings: Findings) -> tuple[int, str, int] | None:
    """Body, motion and axis of an entry headed by K, A: the hinge of body K and its degree of freedom A."""
    body, dof = record.numbers[0], record.numbers[1]
    if not 1 <= body.value <= len(hinges):
        message = f"K = {body.value}: there are bodies 1 to {len(hinges)}"
        findings.error(record.subject, message, body.place, id="DAFMS-057")
        return None
    if not 1 <= dof.value <= 6:
        message = f"A = {dof.value}: 1-3 are rotations, 4-6 translations of a hinge"
        findings.error(record.subject, message, dof.place, id="DAFMS-058")
        return None
    motion, axis = (ROTATION, dof.value) if dof.value <= 3 else (TRANSLATION, dof.value - 3)
    hinge = hinges[body.value - 1]
    free = hinge.rotations if motion == ROTATION else hinge.translations
    if axis not in free:
        message = f"A = {dof.value}: {motion} {axis} of the hinge of body {body.value} is not free"
        findings.error(record.subject, message, dof.place, id="DAFMS-059")
        return None
    if motion == ROTATION and len(free) == 3 and record.section in ("spring", "prescribed"):
        message = f"the hinge of body {body.value} has three free rotations: none of them is an angle"
        findings.error(record.subject, message, body.place, id="DAFMS-060")
        return None
    return body.value - 1, motion, axis


def _table(record: Record, findings: Findings) -> MotionFunction:
    """Straight lines between the points; equal times make a jump, and the ends are held."""
    values = record.values
    times, efforts = values[3::2], values[4::2]
    for k in (k for k in range(1, len(times)) if times[k] < times[k - 1]):
        number, before = record.numbers[3 + 2 * k], record.numbers[1 + 2 * k]
        message = f"{number.key} = {number.value} lies before {before.key} = {before.value}"
        findings.error(record.subject, message, number.place, id="DAFMS-061")
    return piecewise(linear_table(times, efforts) if len(times) > 1 else polynomial(efforts))


def _check_drives(drives: list[Prescribed], findings: Findings) -> None:
    seen = set()
    for drive in drives:
        where = (drive.body, drive.motion, drive.axis)
        if where in seen:
            message = f"{drive.motion} {drive.axis} of the hinge of body {drive.body + 1} is prescribed twice"
            findings.error("PRES", message, drive.place, id="DAFMS-062")
        seen.add(where)


def _check_rotations(values: DeckValues, bodies: tuple[Body, ...], findings: Findings) -> None:
    """The reader has seen that K is a flexible body; `--set` may have changed it since."""
    seen: dict[Any, Any] = {}
    for record in values.section("nodal_rotation"):
        node, where = record.at("I"), (record["K"], record["I"])
        elastic = bodies[record["K"] - 1].elastic if 1 <= record["K"] <= len(bodies) else None
        if elastic is None or 3 * elastic.coordinates != len(record.numbers) - 2:
            message = f"K = {record['K']}: this is not the body whose rotations are given"
            findings.error(record.subject, message, record.place, id="DAFMS-063")
            continue
        count = len(elastic.masses)
        if not 1 <= node.value <= count:
            message = f"I = {node.value}: body {record['K']} has nodes 1 to {count}"
            findings.error(record.subject, message, node.place, id="DAFMS-064")
        if where in seen:
            message = f"node {where[1]} of body {where[0]} is given twice, first on line {seen[where]}"
            findings.error(record.subject, message, node.place, id="DAFMS-065")
        seen.setdefault(where, node.place.line if node.place else 0)


def _pulses(values: Any, bodies: Sequence[Body], findings: Findings) -> list[BodyTorque]:
    """DESN: +F1, nothing, -F1 for TIME each, about axis 1 (thesis 4.3)."""
    torques = []
    for k in range(1, len(bodies) + 1):
        function, height, length = values.values("pulse", k, (0, 0.0, 0.0))
        if not function:
            continue
        record = values.record("pulse", k)
        if function != 1:
            message = f"IDS = {function}: only law 1, the pulse, is known; it is taken, as DAFMS does"
            findings.warn(f"DESN of body {k}", message, record.place, id="DAFMS-066")
        if length <= 0:
            message = f"TIME = {length}: the pulse must last longer than zero"
            findings.error(f"DESN of body {k}", message, record.at("TIME").place, id="DAFMS-067")
            continue
        torques.append(BodyTorque(k - 1, 1, pulse(height, length), record.place))
    return torques


def _torque_tables(values: DeckValues, bodies: tuple[Body, ...], findings: Findings) -> list[BodyTorque]:
    torques = []
    for record in values.section("torque_table"):
        body, axis = record.at("K"), record.at("A")
        if not 1 <= body.value <= len(bodies):
            message = f"K = {body.value}: there are bodies 1 to {len(bodies)}"
            findings.error(record.subject, message, body.place, id="DAFMS-068")
        elif axis.value not in (1, 2, 3):
            message = f"A = {axis.value}: the torque acts about inertial axis 1, 2 or 3"
            findings.error(record.subject, message, axis.place, id="DAFMS-069")
        else:
            torques.append(BodyTorque(body.value - 1, axis.value, _table(record, findings), record.place))
    return torques


def build_closures(values: DeckValues, bodies: tuple[Body, ...], findings: Findings) -> tuple[Closure, ...]:
    """The cut joints of card LOOP."""
    return tuple(filter(None, (_closure(r, bodies, findings) for r in values.section("closure"))))


def _closure(record: Record, bodies: tuple[Body, ...], findings: Findings) -> Closure | None:
    first, second = record.at("KA"), record.at("KB")
    before = len(findings.faults)
    for number, least in ((first, 1), (second, 0)):
        if not least <= number.value <= len(bodies):
            message = f"{number.key} = {number.value}: there are bodies {least} to {len(bodies)}"
            message += "; the inertial frame goes second, as KB = 0" if number.value == 0 else ""
            findings.error(record.subject, message, number.place, id="DAFMS-070")
    if first.value == second.value:
        message = f"KA = KB = {first.value}: a closure joins two bodies"
        findings.error(record.subject, message, second.place, id="DAFMS-071")
    if len(findings.faults) > before:
        return None
    directions = tuple(axis for axis in (1, 2, 3) if _flag(record, axis, findings))
    if not directions and len(findings.faults) == before:
        findings.error(
            record.subject, "C1, C2, C3 are all 0: nothing is closed", record.at("C1").place, id="DAFMS-072"
        )
    return Closure(
        record.subject,
        first.value - 1,
        second.value - 1 if second.value else INERTIAL,
        directions,
        _closure_node(record, "NA", first.value, bodies, findings),
        _closure_node(record, "NB", second.value, bodies, findings),
        tuple(record[f"a{axis}"] for axis in (1, 2, 3)),
        tuple(record[f"b{axis}"] for axis in (1, 2, 3)),
        record.place,
    )


def _flag(record: Record, axis: int, findings: Findings) -> bool:
    number = record.at(f"C{axis}")
    if number.value not in (0, 1):
        findings.error(
            record.subject,
            f"{number.key} is a flag, 0 or 1, read {number.value}",
            number.place,
            id="DAFMS-073",
        )
    return bool(number.value == 1)


def _closure_node(
    record: Record, key: str, body: int, bodies: tuple[Body, ...], findings: Findings
) -> int | None:
    number = record.at(key)
    if number.value == 0:
        return None
    elastic = bodies[body - 1].elastic if body else None
    count = len(elastic.masses) if elastic else 0
    if not 1 <= number.value <= count:
        where = f"body {body} has {count} nodes" if body else "the inertial frame has no nodes"
        message = f"{key} = {number.value}, but {where}; 0 takes the vector"
        findings.error(record.subject, message, number.place, id="DAFMS-074")
        return None
    return number.value - 1
