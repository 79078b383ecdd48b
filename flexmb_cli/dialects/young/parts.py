"""Records of a YOUNG deck to the parts of a mechanism, each checked by itself.

Liang Yong, YOUNG dissertation (1996), chapters 4 and 5: s = Q - P along a joint's axis, h = H - P
across it.
"""

import math
from collections.abc import Callable
from typing import Any

from ...deck.record import Record
from ...errors import Fault
from ...model.diagnostics import LARGEST_NUMBER, Findings, no_such
from ...model.joints import PITCH, JointType
from ...model.mechanism import (
    SINE_OF_PARALLELS,
    Body,
    Distance,
    Driver,
    Ground,
    Joint,
    Point,
    Simplified,
    TimeGrid,
    Vector,
)
from ...model.time_checks import MOST_ROWS
from .sections import YOUNG_JOINTS

DOUBTFUL_LENGTH = 1e-3
DOUBTFUL_ANGLE = 20 * math.pi
_FIRST_ANGLE = 4
_EULER = ("e0", "e1", "e2", "e3")
_GROUND = ("x", "y", "z", "alpha", "beta", "gamma")


def part_of(record: Record, bodies: int) -> tuple[object, list[Fault]]:
    """Return the part that a record describes in a mechanism of so many bodies, with its errors and warnings.

    None where its bodies or its direction do not exist, its numbers are too large, or it is no part of a
    mechanism.
    """
    findings = Findings()
    if not _fits_doubles(record, findings) or record.section not in _MAKERS:
        return None, findings.faults
    named = _names_bodies(record, bodies, findings) & _names_direction(record, findings)
    part = _MAKERS[record.section](record, findings) if named else None
    return part, findings.faults


def _fits_doubles(record: Record, findings: Findings) -> bool:
    """Products of huge numbers leave the doubles, and no mechanism is that large."""
    if not [value for value in record.values if isinstance(value, float) and abs(value) > LARGEST_NUMBER]:
        return True
    huge = [
        number
        for number in record.numbers
        # Euler parameters are scaled to length one, whatever their size.
        if isinstance(number.value, float) and abs(number.value) > LARGEST_NUMBER and number.key not in _EULER
    ]
    for number in huge:
        spelling = f"{number.key} is {number.text or number.value}"
        message = f"{spelling}; numbers beyond {LARGEST_NUMBER:g} cannot be computed with"
        findings.error(record.subject, message, number.place, id="YOUNG-032")
    return not huge


def _names_bodies(record: Record, bodies: int, findings: Findings) -> bool:
    keys = [key for key in ("body", "I", "J") if key in record]
    outside = [key for key in keys if not 1 <= record[key] <= bodies]
    for key in outside:
        message = no_such("body", record[key], bodies)
        findings.error(record.subject, message, record.at(key).place, id="YOUNG-033")
    if outside:
        return False
    if "J" in keys and record["I"] == record["J"]:
        message = f"I and J are both body {record['I']}; two bodies are needed"
        findings.error(record.subject, message, record.at("J").place, id="YOUNG-034")
        return False
    return True


def _names_direction(record: Record, findings: Findings) -> bool:
    if "direction" not in record or 1 <= record["direction"] <= 6:
        return True
    message = f"direction {record['direction']} is outside 1..6 (1 2 3: along x y z; 4 5 6: about x y z)"
    findings.error(record.subject, message, record.at("direction").place, id="YOUNG-035")
    return False


def _body(record: Record, findings: Findings) -> Body:
    r = record["x"], record["y"], record["z"]
    p = tuple(map(record.__getitem__, _EULER))
    # Scaled by the largest first: squares of very large or small parameters leave the doubles.
    length = math.hypot(*p)
    if length == 0.0:
        findings.error(
            record.subject,
            "the Euler parameters are all zero; write 1 0 0 0 for a body that is not turned",
            record.at("e0").place,
            id="YOUNG-036",
        )
        return Body(record.subject, r, (1.0, 0.0, 0.0, 0.0), record.place)
    if abs(length - 1.0) > DOUBTFUL_LENGTH:
        message = f"the Euler parameters have length {length:.6g} and are scaled to length 1"
        findings.warn(record.subject, message, record.at("e0").place, id="YOUNG-037")
    scale = max(map(abs, p))
    q = [e / scale for e in p]
    length = math.hypot(*q)
    return Body(record.subject, r, tuple(e / length for e in q), record.place)


def _time(record: Record, findings: Findings) -> TimeGrid:
    grid = TimeGrid(record["start"], record["end"], record["step"], record.place)
    span = grid.end - grid.start
    if grid.step <= 0.0:
        message = f"the step dT must be greater than zero; read {record.at('step').text}"
        findings.error("time", message, record.at("step").place, id="YOUNG-038")
    elif span < 0.0:
        message = f"the end Te = {grid.end:.15g} s lies before the start Ti = {grid.start:.15g} s"
        findings.error("time", message, record.at("end").place, id="YOUNG-039")
    elif span / grid.step + 1.0 > MOST_ROWS + 0.5:
        findings.error("time", _too_many_rows(grid, span), record.at("step").place, id="YOUNG-040")
    elif span > 0.0 and grid.start + grid.step == grid.start:
        message = f"the step dT = {grid.step:.15g} s is lost in the round-off of Ti = {grid.start:.15g} s"
        findings.error("time", message, record.at("step").place, id="YOUNG-041")
    return grid


def _too_many_rows(grid: TimeGrid, span: float) -> str:
    rows = span / grid.step
    number = f"{grid.rows}" if rows < 1e15 else f"{rows:.3g}"
    return f"Ti, Te and dT give {number} rows; at most {MOST_ROWS} are computed; a larger dT is needed"


def _joint(kind: JointType) -> Callable[..., Any]:
    def make(record: Record, findings: Findings) -> Joint:
        points = {name: record.vector(name) for name in kind.points}
        vectors = _vectors(record, points, findings)
        _across_the_axis(record, vectors, findings)
        pitch = record["pitch"] if kind.size == PITCH else 0.0
        i, j = record["I"] - 1, record["J"] - 1
        return Joint(
            kind.name,
            record.subject,
            i,
            j,
            points["P_i"],
            points["P_j"],
            **vectors,
            pitch=pitch,
            place=record.place,
        )

    return make


def _vectors(record: Record, points: Any, findings: Findings) -> dict[str, Vector]:
    """s_i, s_j, h_i, h_j as far as the joint has them."""
    vectors = {}
    for name, tip in points.items():
        letter, side = name.split("_")
        if letter == "P":
            continue
        vector = tuple(a - b for a, b in zip(tip, points[f"P_{side}"], strict=True))
        _check_vector(record, name, side, vector, findings)
        vectors[f"{'s' if letter == 'Q' else 'h'}_{side}"] = vector
    return vectors


def _check_vector(record: Record, name: str, side: str, vector: Any, findings: Findings) -> None:
    place = record.at(f"{name}.x").place
    if not any(vector):
        message = f"{name} and P_{side} are the same point, so the vector between them has no direction"
        findings.error(record.subject, message, place, id="YOUNG-042")


def _across_the_axis(
    record: Record, vectors: dict[str, tuple[float, float, float]], findings: Findings
) -> None:
    for side in "ij":
        s, h = vectors.get(f"s_{side}"), vectors.get(f"h_{side}")
        if s and h and _parallel(s, h):
            message = f"H_{side} lies on the axis from P_{side} to Q_{side}; h_{side} must point across it"
            findings.error(record.subject, message, record.at(f"H_{side}.x").place, id="YOUNG-043")


def _parallel(a: Any, b: Any) -> bool:
    """Return whether two vectors lie along one line; zero and infinite ones are faults of their own."""
    a, b = _unit(a), _unit(b)
    if a is None or b is None:
        return False
    cross = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return math.hypot(*cross) <= SINE_OF_PARALLELS


def _unit(vector: tuple[float, float, float]) -> list[float] | None:
    scale = max(map(abs, vector))
    if scale == 0.0 or not math.isfinite(scale):
        return None
    scaled = [component / scale for component in vector]
    length = math.hypot(*scaled)
    return [component / length for component in scaled]


def _simplified(record: Record, findings: Findings) -> Simplified:
    if record["direction"] >= _FIRST_ANGLE:
        _warn_of_degrees(record, "value", findings)
    return Simplified(record.subject, record["body"] - 1, record["direction"], record["value"], record.place)


def _ground(record: Record, findings: Findings) -> Ground:
    for key in _GROUND[3:]:
        _warn_of_degrees(record, key, findings)
    values = tuple(map(record.__getitem__, _GROUND))
    return Ground(record.subject, record["body"] - 1, values, record.place)


def _warn_of_degrees(record: Record, key: str, findings: Findings) -> None:
    angle = record[key]
    if abs(angle) > DOUBTFUL_ANGLE:
        message = f"angles are in rad; {key} {angle:.6g} would be {angle / math.tau:.3g} turns"
        findings.warn(record.subject, message, record.at(key).place, id="YOUNG-044")


def _distance(record: Record, findings: Findings) -> Distance:
    if record["direction"] >= _FIRST_ANGLE and abs(record["value"]) > 2.0:
        message = f"Euler parameters differ by 2 at most; read {record.at('value').text}"
        findings.error(record.subject, message, record.at("value").place, id="YOUNG-045")
    return Distance(
        record.subject, record["I"] - 1, record["J"] - 1, record["direction"], record["value"], record.place
    )


def _driver(record: Record, _findings: Findings) -> Driver:
    return Driver(
        record.subject,
        record["body"] - 1,
        record["direction"],
        record["C"],
        record["B"],
        record["A"],
        record.place,
    )


def _point(record: Record, _findings: Findings) -> Point:
    return Point(record.subject, record["body"] - 1, (record["x"], record["y"], record["z"]), record.place)


_MAKERS = {
    **{kind.name: _joint(kind) for kind in YOUNG_JOINTS},
    "simplified": _simplified,
    "distance": _distance,
    "driver": _driver,
    "ground": _ground,
    "point": _point,
    "body": _body,
    "time": _time,
}
