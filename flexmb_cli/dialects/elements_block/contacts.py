"""Lines CONTACT of the block ELEMENTS: the shapes that may touch."""

import math
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

from ...model.laws import Touch
from .line import ElementLine
from .measures import Measures
from .words import OF_FIRST, OF_SECOND

MOST_SHAPES = 20_000  # at one end
MOST_CORNERS = 2_000  # of the convex hull of a mesh
_OF_END = ("body", "last", "node", "x", "y", "z", "radius", "axis")
_KEYS = (
    "normal",
    *(f"{what}_{end}" for end in ("from", "to") for what in ("file", "unit")),
    *(f"{what}_{end}" for end in ("from", "to") for what in ("radius", "axis", "size")),
)


def touch_of(line: ElementLine, measures: Measures, folder: Path) -> Touch | None:
    """Return the shapes of a contact, meshes from files in `folder`; None where there is a fault."""
    first, second = line.kind.split("-")
    keys = (*OF_FIRST[first], *OF_SECOND[second])
    given = [key for key in _KEYS if key in line or f"{key}.x" in line]
    before = _errors(measures)
    for key in keys:
        if key not in given:
            message = f"{line.kind} needs {key}=; its shapes have {' and '.join(keys)}"
            measures.findings.error(line.subject, message, line.place, id="ELEMENTS-070")
    for key in given:
        if key not in keys:
            message = f"{line.kind} has no {key}; its shapes have {' and '.join(keys)}"
            measures.findings.error(line.subject, message, line.place, id="ELEMENTS-067")
    _check_law(line, measures)
    if _errors(measures) > before:
        return None
    shapes: dict[str, Any] = {}
    for key in keys:
        shapes[key] = line.vector(key) if f"{key}.x" in line else line[key]
    for key, value in shapes.items():
        _check_size(line, measures, key, value)
    if _errors(measures) > before:
        return None
    fields = _fields(line, measures, folder, shapes)
    ends = _ends(line, measures)
    if ends is None or _errors(measures) > before:
        return None
    (i, P_i), *more_i = ends["from"]
    (j, P_j), *more_j = ends["to"]
    same = first == second and all(_texts(line, "from", key) == _texts(line, "to", key) for key in _OF_END)
    if first == "mesh" and more_i and more_j:
        message = "a line takes one mesh with several spheres, or several with one; split the line"
        return measures.error(line, line.at("file_from"), message, id="ELEMENTS-273")
    mutual = bool(more_i) and same
    return Touch(
        i, j, P_i, P_j, first, second, **fields, more_i=tuple(more_i), more_j=tuple(more_j), mutual=mutual
    )


def _fields(line: ElementLine, measures: Measures, folder: Path, shapes: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of `Touch` of the keys of its shapes, with what their files hold."""
    fields: dict[str, Any] = {}
    for key, value in shapes.items():
        if key == "normal":
            fields["axis_i"] = tuple(x / math.hypot(*value) for x in value)
        elif not key.startswith(("file", "unit")):
            fields[key.replace("from", "i").replace("to", "j")] = value
    if name := shapes.get("file_to"):
        fields["corners"] = _corners(line, measures, _path(folder, name), shapes["unit_to"])
    if name := shapes.get("file_from"):
        fields["triangles"] = _triangles(line, measures, _path(folder, name), shapes["unit_from"])
    return fields


def _corners(line: ElementLine, measures: Measures, file: Path, unit: float) -> Any:
    """Return the corners (n, 3) of the convex hull of a mesh, m; a fault if there are none, or too many."""
    from ...fe.formats.matrix_file import FEFileFault  # few decks have meshes
    from ...fe.formats.stl import hull_corners

    try:
        corners = unit * hull_corners(file)
    except FEFileFault as fault:
        return measures.error(line, line.at("file_to"), str(fault), id=fault.id)
    if not len(corners):
        message = f"the mesh of {file.name} is flat; a mesh that touches has a volume"
        return measures.error(line, line.at("file_to"), message, id="ELEMENTS-142")
    if len(corners) > MOST_CORNERS:
        message = (
            f"the convex hull of {file.name} has {len(corners)} corners, {MOST_CORNERS} at most; give a "
            "coarser mesh, or a sphere or capsule for what is round"
        )
        return measures.error(line, line.at("file_to"), message, id="ELEMENTS-143")
    return corners


def _triangles(line: ElementLine, measures: Measures, file: Path, unit: float) -> Any:
    """Return the corners (n, 9) of the triangles of a mesh, m; a fault if the file has none."""
    from ...fe.formats.matrix_file import FEFileFault
    from ...fe.formats.stl import read_stl

    try:
        vertices, triangles = read_stl(file)
    except FEFileFault as fault:
        return measures.error(line, line.at("file_from"), str(fault), id=fault.id)
    return unit * vertices[triangles].reshape(-1, 9)


def _path(folder: Path, name: object) -> Path:
    return folder / str(name).replace("\\", "/")


def _texts(line: ElementLine, end: str, key: str) -> list[Any]:
    """Return the values of an end, or of a key of its shape."""
    names = {f"{end}.{key}", f"{key}_{end}", *(f"{key}_{end}.{axis}" for axis in "xyz")}
    return [number.value for number in line.numbers if number.key in names]


def _ends(line: ElementLine, measures: Measures) -> dict[str, list[tuple[int, Any]]] | None:
    """Return the bodies of each end, and points on them; None where there is a fault."""
    bodies = {end: _range(line, measures, end, "body", "last") for end in ("from", "to")}
    shapes: dict[str, list[tuple[int, Any]]] = {"from": [], "to": []}
    for side, (end, other) in enumerate((("from", "to"), ("to", "from"))):
        for body, node in product(bodies[end], _range(line, measures, end, "node", "last_node")):
            # The other end stands for all others: any body but this one.
            against = next((k for k in bodies[other] if k != body), body)
            values = {f"{end}.body": body, f"{other}.body": against, f"{end}.node": node}
            ends = measures.ends(_with_values(line, values))
            if ends is None:
                return None
            shapes[end].append((ends[side], ends[side + 2]))
    return shapes if shapes["from"] and shapes["to"] else None


def _with_values(line: ElementLine, values: dict[str, int]) -> ElementLine:
    changed = [
        replace(one, value=values[one.key]) if one.key in values else one
        for one in line.numbers
        if one.key.startswith(("from.", "to."))
    ]
    return line.with_numbers(changed)


def _range(line: ElementLine, measures: Measures, end: str, name: str, last: str) -> range:
    """Return the numbers of the bodies, or of the nodes, of an end; (0) where it has none."""
    numbers = {one.key: one for one in line.numbers}
    if f"{end}.{name}" not in numbers:
        return range(1)
    first = int(numbers[f"{end}.{name}"].value)
    until = int(numbers.get(f"{end}.{last}", numbers[f"{end}.{name}"]).value)
    if not first <= until < first + MOST_SHAPES or (until > first == 0):
        message = f"{end} counts from 1 on, the smaller first, {MOST_SHAPES} at most; read {first}-{until}"
        measures.error(line, numbers[f"{end}.{last}"], message, id="ELEMENTS-141")
        return range(0)
    return range(first, until + 1)


def _errors(measures: Measures) -> int:
    return sum(fault.severity == "error" for fault in measures.findings.faults)


def _check_size(line: ElementLine, measures: Measures, key: str, value: Any) -> None:
    if key.startswith("file"):
        return
    is_vector = isinstance(value, tuple)
    if key.startswith(("normal", "axis")):
        wrong = not math.hypot(*value) > 0.0
    else:
        wrong = not all(x > 0.0 for x in (value if is_vector else (value,)))
    if wrong:
        rule = "have a direction" if key.startswith(("normal", "axis")) else "be larger than 0"
        message = f"{key} must {rule}; read {value if is_vector else format(value, 'g')}"
        place = line.place_of(f"{key}.x" if is_vector else key)
        measures.findings.error(line.subject, message, place, id="ELEMENTS-068")


def _check_law(line: ElementLine, measures: Measures) -> None:
    """Refuse a coefficient of restitution that is none, that has no speed, or that damping contradicts.

    Numbers of which the law takes no notice are named.
    """
    findings, sliding = measures.findings, line["friction"]
    if 0.0 < line["static"] < sliding:
        message = (
            f"static {line['static']:g} is less than friction {sliding:g}, which then holds at all speeds; "
            "are the numbers exchanged?"
        )
        findings.warn(line.subject, message, line.place_of("static"), id="ELEMENTS-071")
    if line["restitution"] == 1.0:
        if line["speed"]:
            message = "speed has no effect if restitution is 1"
            findings.note(line.subject, message, line.place_of("speed"), id="ELEMENTS-072")
        return
    if line["restitution"] > 1.0:
        message = f"restitution must not be larger than 1; read {line['restitution']:g}"
    elif not line["speed"] > 0.0:
        message = "restitution needs the speed of approach at which it holds: speed="
    elif line["damping"]:
        message = "damping and restitution say the same; remove one of them"
    else:
        return
    findings.error(line.subject, message, line.place_of("restitution"), id="ELEMENTS-069")
