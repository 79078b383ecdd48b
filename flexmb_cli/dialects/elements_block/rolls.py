"""Lines ROLL of the block ELEMENTS: discs, spheres and wheels that roll without slip."""

import math

from ...errors import Place
from ...model.joint_elements import Roll
from .line import ElementLine
from .measures import Measures
from .words import ROLL_KEYS

_KEYS = {key for keys in ROLL_KEYS.values() for key in keys}


def roll_of(line: ElementLine, measures: Measures) -> Roll | None:
    """Return what rolls; None where there is a fault."""
    errors = _Errors(line, measures)
    required = ROLL_KEYS[line.kind]
    given = {key for key in _KEYS if key in line or f"{key}.x" in line}
    for key in (key for key in required if key not in given):
        errors.add(f"{line.kind} needs {key}=; it has {' and '.join(required)}", line.place, "ELEMENTS-231")
    for key in sorted(given.difference(required)):
        message = f"{line.kind} has no {key}; it has {' and '.join(required)}"
        errors.add(message, line.place, "ELEMENTS-232")
    ends = measures.ends(line)
    if ends is None or errors.count:
        return None
    i, j, P_i, P_j = ends
    if j < 0:
        message = "the ground does not roll; write it as from=, and what rolls as to="
        errors.add(message, line.place_of("to.body"), "ELEMENTS-233")
    elif not (measures.is_rigid(line, j, "to") and (i < 0 or measures.is_rigid(line, i, "from"))):
        message = "bodies that roll, or are rolled on, are rigid; hinge a rigid wheel to the flexible body"
        errors.add(message, line.place, "ELEMENTS-234")
    axes = {key: _unit(line, key, errors) for key in ("normal", "axis_from", "axis_to") if key in required}
    radius, other = (float(line[key]) if key in required else 0.0 for key in ("radius_to", "radius_from"))
    if not radius > 0.0:
        message = f"radius_to must be larger than 0; read {radius:g}"
        errors.add(message, line.place_of("radius_to"), "ELEMENTS-235")
    elif "radius_from" in required and not (other > 0.0 or -other > radius):
        message = (
            f"radius_from must be larger than 0, or, of a ring in which the wheel rolls, less than "
            f"-{radius:g}; read {other:g}"
        )
        errors.add(message, line.place_of("radius_from"), "ELEMENTS-236")
    if errors.count:
        return None
    on = axes.get("normal", axes.get("axis_from", (0.0, 0.0, 0.0)))
    disc = axes.get("axis_to", (0.0, 0.0, 0.0))
    return Roll(line.subject, line.kind, i, j, P_i, P_j, on, disc, radius, other, line.place)


class _Errors:
    """Reports faults of a line, and counts them."""

    def __init__(self, line: ElementLine, measures: Measures):
        self.line, self.findings, self.count = line, measures.findings, 0

    def add(self, message: str, place: Place | None, identifier: str) -> None:
        self.findings.error(self.line.subject, message, place, id=identifier)
        self.count += 1


def _unit(line: ElementLine, key: str, errors: _Errors) -> tuple[float, float, float]:
    x, y, z = line.vector(key)
    size = math.hypot(x, y, z)
    if not size > 0.0:
        message = f"{key} must have a direction; read (0, 0, 0)"
        errors.add(message, line.place_of(f"{key}.x"), "ELEMENTS-237")
        return 0.0, 0.0, 0.0
    return x / size, y / size, z / size
