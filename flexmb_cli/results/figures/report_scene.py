"""The scene of a result as the plain data that the report's viewer takes.

Finite-element bodies go as surface nodes, modes and amplitudes, so that hundreds of instants take little
space; the viewer superposes them.  Arrays are 32-bit numbers, little-endian, in base64.
"""

import base64
from typing import Any

import h5py
import numpy as np

from .contours import (
    DEFAULT_LOOK,
    ENERGY,
    BodyLook,
    Ranges,
    check_look,
    contour_ranges,
    largest_scale,
    resting_row,
    shown_colours,
    shown_unit,
)
from .element_bodies import ElementBody, element_bodies, face_edges, outer_faces_of_elements, triangles
from .look import COLOURS, GREY, JOINT, TRACE
from .scene import GROUND_SYMBOL, BodyShape, DrawnBody, Scene, read_scene, view_of

MOST_SCENE_FRAMES, FEWEST_FRAMES = 500, 20
# Places of all frames together: 16 bytes of the page each; what moves by modes or as a whole stores none.
MOST_PLACES = 100_000
MOST_TRACES = 12
# Shortest and longest time of the whole animation, s; between them it plays in its own time.
SHORTEST_ANIMATION, LONGEST_ANIMATION = 3.0, 15.0


def frame_rows(rows: int, places: int = 1) -> slice:
    """Every n-th row, so that there are at most `MOST_SCENE_FRAMES`, fewer where each shows many `places`.

    The last row is among them where a stride up to twice as long as needed leads to it.  There are at
    least `FEWEST_FRAMES`, or all rows.
    """
    frames = min(MOST_SCENE_FRAMES, max(FEWEST_FRAMES, MOST_PLACES // max(1, places)))
    longest = max(1, (rows - 1) // (FEWEST_FRAMES - 1))
    least = min(-(-rows // frames) or 1, longest)
    strides = range(least, min(2 * least, longest + 1))
    ending = (stride for stride in strides if (rows - 1) % stride == 0)
    return slice(0, rows, next(ending, least))


def report_scene(result: h5py.File, look: BodyLook = DEFAULT_LOOK) -> dict[str, Any] | None:
    """Bodies, joints, traces, view and times of `result`; None when it has nothing to draw.

    Raises `ResultError` where bodies cannot be shown as `look` wants it.
    """
    rows = len(result["time"])
    if not rows or "body/position" not in result:
        return None
    look = look.of(result)
    first = read_scene(result, slice(0, 1), every_node=False)
    bodies = list(element_bodies(result, first.body_names, slice(None)))
    every = frame_rows(rows, stored_places(first, bodies))
    scene, ranges = read_scene(result, every, every_node=False), contour_ranges(bodies)
    check_look(result.filename, look, ranges, scene.size)
    return scene_data(scene, bodies, every, look, ranges)


def stored_places(scene: Scene, surfaces: list[ElementBody]) -> int:
    """Return how many places a frame stores: those of bodies drawn as lines, of joints and of traces."""
    marks = sum(body.marks.shape[1] for body in scene.lined(surfaces))
    return int(marks + len(scene.joint_names) + min(len(scene.point_names), MOST_TRACES))


def scene_data(
    scene: Scene,
    surfaces: list[ElementBody],
    rows: slice = slice(None),
    look: BodyLook = DEFAULT_LOOK,
    ranges: Ranges | None = None,
) -> dict[str, Any]:
    """The viewer's data of a scene, whose bodies among `surfaces` are drawn by their elements.

    The scene is at `rows` of those of the surfaces; colours reach to the largest values of all rows.
    """
    every = scene.places
    view = view_of(every, scene.gravity)
    ranges = contour_ranges(surfaces) if ranges is None else ranges
    shown = [body.at(rows) for body in surfaces]
    seconds = float(scene.time[-1] - scene.time[0])
    return {
        "time": scene.time.tolist(),
        "labels": rounded(scene.time),
        "rest": resting_row(shown),
        "seconds": min(max(seconds, SHORTEST_ANIMATION), LONGEST_ANIMATION),
        "box": {"low": every.min(axis=0).tolist(), "high": every.max(axis=0).tolist()},
        "view": {"eye": list(view.eye), "up": list(view.up)},
        "bodies": [_lines(body) for body in scene.lined(surfaces)],
        "surfaces": [*(_surface(body, ranges) for body in shown), *map(_rigid_surface, scene.shapes)],
        "ranges": {
            name: dict(
                zip(("low", "high", "unit", "factor"), (*ends, *shown_unit(name, ends, look)), strict=True)
            )
            for name, ends in ranges.items()
        },
        "look": {
            "colours": shown_colours(look, ranges),
            "ends": list(look.ends) if look.ends else None,
            "scale": look.scale,
            "largest": largest_scale(ranges, scene.size),
        },
        "joints": {"marks": _numbers(scene.joints), "names": list(scene.joint_names), "colour": JOINT},
        "ground": {"lines": GROUND_SYMBOL, "joints": scene.supports.tolist(), "colour": GREY},
        "traces": _traces(scene),
    }


def rounded(times: np.ndarray) -> list[str]:
    """Return times with enough digits to distinguish frames."""
    step = float(np.min(np.diff(times))) if len(times) > 1 else 0.0
    digits = 9 if step <= 0 else int(min(9, max(0, 2 - np.floor(np.log10(step)))))
    return [
        f"{round(time, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".") or "0" for time in times.tolist()
    ]


def _lines(body: DrawnBody) -> dict[str, Any]:
    marks = body.marks[:1] if body.still else body.marks
    colour = GREY if body.still else colour_of(body)
    data = {"name": body.name, "colour": colour, "still": body.still, "places": body.marks.shape[1]}
    return data | {"marks": _numbers(marks), "edges": _integers(body.edges)}


def _surface(body: ElementBody, ranges: Ranges) -> dict[Any, Any]:
    faces, elements = outer_faces_of_elements(body.cells)
    nodes = np.unique(faces)
    place = np.zeros(len(body.undeformed), int)
    place[nodes] = np.arange(len(nodes))
    faces = place[faces]
    drawn = _fans(faces, len(nodes)) if faces.shape[1] == 8 else triangles(faces)
    return {
        "name": body.name,
        "colour": colour_of(body),
        "modes": body.amplitude.shape[1],
        "numbers": body.node_numbers[nodes].tolist(),
        "nodes": _numbers(with_centres(body.undeformed[nodes], faces)),
        "shape": _numbers(with_centres(body.shape[nodes], faces)),
        "stress": ""
        if body.stress_shape is None
        else _numbers(with_centres(body.stress_shape[nodes], faces)),
        "amplitude": _numbers(body.amplitude),
        "origin": _numbers(body.origin),
        "turn": _numbers(body.turn),
        "triangles": _integers(drawn),
        "edges": _integers(face_edges(faces)),
        "material": [body.material.young, body.material.poisson] if body.material else None,
        **_energies(body, np.repeat(elements, len(drawn) // len(faces)), ranges),
    }


def _energies(body: ElementBody, elements: np.ndarray, ranges: Ranges) -> dict[str, Any]:
    """Energies of selected elements (T, e), and which of them each triangle shows, -1: none.

    As square roots, of the largest one's, in 65535 steps: small energies keep their first digits.
    """
    if not body.of_elements or body.selected is None:
        return {"energy": "", "elements": [], "shown": ""}
    energy, most = body.of_elements["strain_energy"], ranges[ENERGY][1]
    outside = np.flatnonzero(np.isin(body.selected, elements))
    column = np.full(len(body.cells), -1, np.int32)
    column[body.selected[outside]] = np.arange(len(outside))
    part = np.clip(np.nan_to_num(energy[:, outside]) / (most or 1.0), 0, 1)
    levels = np.round(65535 * np.sqrt(part)).astype("<u2")
    numbers = body.element_numbers[body.selected[outside]].tolist()
    return {"energy": _bytes(levels), "elements": numbers, "shown": _integers(column[elements])}


def _rigid_surface(shape: BodyShape) -> dict[Any, Any]:
    """A surface without modes; triangles of files may face either way, and their edges are not drawn."""
    missing = dict.fromkeys(("shape", "stress", "amplitude", "edges", "energy", "shown"), "")
    return {
        **missing,
        "name": shape.name,
        "colour": colour_of(shape),
        "modes": 0,
        "numbers": [],
        "nodes": _numbers(shape.vertices),
        "origin": _numbers(shape.origin),
        "turn": _numbers(shape.turn),
        "triangles": _integers(shape.triangles),
        "material": None,
        "elements": [],
    }


def colour_of(body: DrawnBody | ElementBody | BodyShape) -> str:
    """Return the colour of a body: its own among eight, grey for the ground."""
    return COLOURS[(body.number - 1) % len(COLOURS)] if body.number else GREY


def with_centres(values: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Values at nodes (n, ...) and, behind them, at the middles of faces of eight nodes.

    The shape functions of eight nodes give the middle -1/4 of each corner and 1/2 of each middle of an edge.
    """
    if faces.shape[1] != 8:
        return values
    return np.concatenate(
        [values, values[faces[:, 1::2]].sum(axis=1) / 2 - values[faces[:, ::2]].sum(axis=1) / 4]
    )


def _fans(faces: np.ndarray, first: int) -> Any:
    """Eight triangles round the middle of every face; the middles are numbered from `first`."""
    centres = np.arange(first, first + len(faces))
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    fans = np.concatenate([pairs, np.broadcast_to(centres[:, None, None], (*faces.shape, 1))], axis=-1)
    return fans.reshape(-1, 3)


def _traces(scene: Scene) -> list[dict[str, str]]:
    """Paths of the points that move."""
    paths = np.swapaxes(scene.points, 0, 1)[:MOST_TRACES]
    pairs = zip(scene.point_names, paths, strict=False)
    return [
        {"name": name, "colour": TRACE, "marks": _numbers(path)}
        for name, path in pairs if len(path) > 1 and np.ptp(path, axis=0).any()
    ]  # fmt: skip


def _numbers(values: np.ndarray) -> str:
    return _bytes(np.ascontiguousarray(values, "<f4"))


def _integers(values: np.ndarray) -> str:
    return _bytes(np.ascontiguousarray(values, "<i4"))


def _bytes(values: np.ndarray) -> str:
    return base64.b64encode(values.tobytes()).decode("ascii")
