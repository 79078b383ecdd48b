"""Lines JOINT of general joints, which hold some of six directions, and of their cases."""

from typing import Any

import numpy as np

from ...model.general_joints import GeneralJoint, frame_of
from ...model.joints import CASES, CONSTANT_ANGLE, DIRECTIONS
from .line import ElementLine
from .measures import Measures
from .words import GENERAL_KEYS

_VECTORS = ("axis_from", "axis_to", "across")
_ASIDE = 1e-6  # of unit vectors: what is less aside of an axis has no direction


def general_joint(line: ElementLine, measures: Measures) -> GeneralJoint | None:
    """Return the joint of a line; None where a fault was found."""
    before = len(measures.findings.faults)
    free, ends = _free(line, measures), None
    if _has_keys(line, measures):
        ends = measures.ends(line)
    if any(fault.severity == "error" for fault in measures.findings.faults[before:]) or ends is None:
        return None
    constant = line.kind == CONSTANT_ANGLE
    held = tuple(not constant and name not in free for name in DIRECTIONS)
    axes = _axes(line, measures, held)
    if axes is None:
        return None
    leaning: Any = None
    if constant:
        leaning = tuple((np.array(line.vector("axis_to")) / np.linalg.norm(line.vector("axis_to"))).tolist())
    joint = GeneralJoint(line.subject, *ends, axes, held, leaning, line.place)
    if joint.holds_turns:
        for key, body in (("from", joint.i), ("to", joint.j)):
            if body >= 0 and not measures.is_rigid(line, body, key):
                message = (
                    "at a node of a flexible body a joint holds displacements only; leave rx, ry and rz free"
                )
                measures.error(line, line.at(f"{key}.body"), message, id="ELEMENTS-204")
                return None
    return joint


def _has_keys(line: ElementLine, measures: Measures) -> bool:
    """Return whether the line has the keys of its type, and no other."""
    needed, may = GENERAL_KEYS[line.kind]
    given = {key for key in _VECTORS if f"{key}.x" in line}
    given |= {key for key in ("length",) if key in line} | ({"free"} if "free.1" in line else set())
    wrong = sorted((set(needed) - given) | (given - set(needed) - set(may)))
    if wrong:
        keys = [f"{key}=" for key in needed] + [f"[{key}=]" for key in may]
        message = f"{line.kind} takes {' '.join(['from=', 'to=', *keys])}; correct {' and '.join(wrong)}"
        measures.findings.error(line.subject, message, line.place, id="ELEMENTS-201")
    for key in given & set(_VECTORS):
        if not any(line.vector(key)):
            measures.error(line, line.at(f"{key}.x"), f"{key} has no length", id="ELEMENTS-203")
            return False
    return not wrong


def _free(line: ElementLine, measures: Measures) -> tuple[str, ...]:
    if line.kind in CASES:
        return CASES[line.kind]
    names = [number for number in line.numbers if number.key.startswith("free.")]
    for number in names:
        if number.value not in DIRECTIONS:
            message = f"free names directions, {', '.join(DIRECTIONS)}; read {number.value}"
            measures.error(line, number, message, id="ELEMENTS-202")
    free = tuple(number.value for number in names)
    if line.kind == "general" and set(free) == set(DIRECTIONS):
        measures.findings.error(
            line.subject, "all directions are free: it holds nothing", line.place, id="ELEMENTS-205"
        )
    return free


def _axes(line: ElementLine, measures: Measures, held: tuple[bool, ...]) -> Any:
    """Return the axes x, y, z of the joint in those of the first body."""
    z = np.array(line.vector("axis_from")) if "axis_from.x" in line else np.array([0.0, 0.0, 1.0])
    x = np.array(line.vector("across")) if "across.x" in line else None
    if x is None and "axis_from.x" not in line:
        x = np.array([1.0, 0.0, 0.0])
    alike = held[0] == held[1] and held[3] == held[4] and not (held[5] and not held[3])
    if x is None and not alike:
        message = "x and y differ, so that across= must say which is x"
        measures.findings.error(line.subject, message, line.place, id="ELEMENTS-206")
        return None
    if x is not None and np.linalg.norm(np.cross(x, z)) <= _ASIDE * np.linalg.norm(x) * np.linalg.norm(z):
        message = "across is along the axis; give a direction at an angle to it"
        measures.error(line, line.at("across.x"), message, id="ELEMENTS-207")
        return None
    return frame_of(z, x)
