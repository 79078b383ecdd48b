"""The scene of a result as an animated figure of plotly.js: traces, frames, slider and buttons.

The figure is the plain data that `Plotly.newPlot` and `Plotly.addFrames` take.
"""

from html import escape

import numpy as np

from .scene import Scene
from .view import view_of

# Okabe and Ito's colours, told apart by everyone.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#B22222", "#6A3D9A")
GREY = "#808080"
MOST_FRAMES, FEWEST_FRAMES = 150, 20
# Places of all frames together: some 30 bytes of the page each.
MOST_PLACES = 200_000
MOST_TRAILS = 12
# More bodies than these share traces by their colours, so that the page stays quick.
MOST_BODIES = 40
# Shortest and longest time of the whole animation, s; between them it plays in its own time.
SHORTEST, LONGEST = 3.0, 15.0
# Longest side of a plane's box, diagonal of a box in space, and distance of the eye, that fill the picture.
FLAT, DEEP, DISTANCE = 1.7, 1.5, 1.9


def frame_rows(rows: int, places: int = 1) -> slice:
    """Every n-th row, so that there are at most `MOST_FRAMES`, fewer where each shows many `places`."""
    frames = min(MOST_FRAMES, max(FEWEST_FRAMES, MOST_PLACES // places))
    return slice(0, rows, -(-rows // frames) or 1)


def animation(scene: Scene) -> dict:
    """`data`, `layout` and `frames` of the figure; all texts are escaped, as plotly.js reads HTML in them."""
    moving, still = _moving_traces(scene), _still_traces(scene)
    frames = [
        {
            "name": str(k),
            "traces": list(range(len(moving))),
            "data": [{axis: trace["path"][axis][k] for axis in "xyz"} for trace in moving],
        }
        for k in range(len(scene.time))
    ]
    first = [
        trace["style"] | {axis: trace["path"][axis][0] for axis in "xyz"}
        for trace in moving
    ]  # fmt: skip
    return {"data": first + still, "layout": _layout(scene), "frames": frames}


def _moving_traces(scene):
    """Traces that change with time: style, and coordinates of every row by axis."""
    digits = _digits(scene)
    traces = []
    moving = [body for body in scene.bodies if not body.still]
    if len(moving) > MOST_BODIES:
        traces += [_trace(style, path, digits) for style, path in _crowd(moving)]
    for body in moving if not traces else ():
        style = _body_style(body, COLOURS[(body.number - 1) % len(COLOURS)])
        traces.append(_trace(style, _lines(body), digits))
        if _is_plate(body):
            traces.append(_trace(_plate_style(body, style["line"]["color"]), body.marks, digits))
    if scene.joints.shape[1]:
        names = [escape(name) for name in scene.joint_names]
        traces.append(_trace(_marker("joints", "#222222", 4, names), scene.joints, digits))
    if scene.points.shape[1]:
        names = [escape(name) for name in scene.point_names]
        traces.append(_trace(_marker("points", "#B22222", 3, names), scene.points, digits))
    if np.any(scene.axes):
        style = _line("joint axes", "#222222", 2)
        traces.append(_trace(style, _axis_lines(scene), digits))
    return traces


def _crowd(bodies):
    """Style and path (T, n, 3) of all bodies of a colour, nan between them."""
    gap = np.full((len(bodies[0].marks), 1, 3), np.nan)
    for k, colour in enumerate(COLOURS):
        group = bodies[k :: len(COLOURS)]
        path = np.concatenate([part for body in group for part in (_lines(body), gap)], axis=1)
        yield _line(f"bodies {escape(group[0].name)}, …", colour, 5), path


def _still_traces(scene):
    """Ground, and the paths of points."""
    digits = _digits(scene)
    traces = []
    for body in scene.bodies:
        if body.still:
            style = _body_style(body, GREY) | {"mode": "lines+markers"}
            style["marker"] = {"size": 5, "color": GREY, "symbol": "square"}
            traces.append(style | _coordinates(_lines(body)[0], digits))
    trails = _trails(scene)
    if trails is not None:
        style = _line("paths of points", "#E0A0A0", 2) | {"hoverinfo": "skip"}
        traces.append(style | _coordinates(trails, digits))
    return traces


def _trace(style, path, digits):
    return {"style": style, "path": _coordinates(path, digits)}


def _coordinates(path, digits):
    """Lists of x, y, z of `path` (..., 3); a gap in a line, nan, becomes null."""
    rounded = np.round(path, digits) + 0.0
    plain = np.where(np.isnan(rounded), None, rounded)
    return {axis: plain[..., k].tolist() for k, axis in enumerate("xyz")}


def _digits(scene):
    """Decimals that show a hundred-thousandth of the whole picture."""
    extent = float(np.ptp(scene.places, axis=0).max()) or 1.0
    return max(0, int(np.ceil(5 - np.log10(extent))))


def _lines(body):
    """Path (T, n, 3) through all edges of a body, nan between chains; lone marks as they are."""
    if not len(body.edges):
        return body.marks
    order = _chains(body.edges)
    path = body.marks[:, [max(k, 0) for k in order]].astype(float)
    path[:, [k < 0 for k in order]] = np.nan
    return path


def _chains(edges):
    """Marks in an order that draws every edge once, -1 between chains."""
    left = {tuple(edge) for edge in edges.tolist()}
    order: list[int] = []
    while left:
        edge = min(left)
        left.remove(edge)
        chain = list(edge)
        while following := [pair for pair in left if chain[-1] in pair]:
            pair = min(following)
            left.remove(pair)
            chain.append(pair[0] if pair[1] == chain[-1] else pair[1])
        order += ([-1] if order else []) + chain
    return order


def _is_plate(body):
    """Whether a rigid body's marks span a plane polygon, such as a link with three joints."""
    count = body.marks.shape[1]
    if body.flexible or not 3 <= count <= 6 or len(body.edges) < count:
        return False
    size = np.linalg.svd(body.marks[0] - body.marks[0].mean(axis=0), compute_uv=False)
    return size[1] > 1e-3 * size[0] and size[2] < 1e-6 * size[0]


def _plate_style(body, colour):
    """A fan of triangles round the polygon of a plane body."""
    centred = body.marks[0] - body.marks[0].mean(axis=0)
    _, _, axes = np.linalg.svd(centred)
    turn = np.argsort(np.arctan2(centred @ axes[1], centred @ axes[0])).tolist()
    fan = range(1, len(turn) - 1)
    return {
        "type": "mesh3d", "color": colour, "opacity": 0.35, "hoverinfo": "skip",
        "i": [turn[0] for _ in fan], "j": [turn[k] for k in fan], "k": [turn[k + 1] for k in fan],
    }  # fmt: skip


def _body_style(body, colour):
    lone = not len(body.edges)
    style = _line(escape(body.name), colour, 4 if body.flexible and body.marks.shape[1] > 12 else 8)
    return style | {"mode": "markers" if lone else "lines", "marker": {"size": 4, "color": colour}}


def _line(name, colour, width):
    return {
        "type": "scatter3d", "mode": "lines", "name": name, "line": {"color": colour, "width": width},
        "hoverinfo": "name",
    }  # fmt: skip


def _marker(name, colour, size, texts):
    return {
        "type": "scatter3d", "mode": "markers", "name": name, "marker": {"size": size, "color": colour},
        "text": texts, "hoverinfo": "text",
    }  # fmt: skip


def _axis_lines(scene):
    """Short lines (T, n, 3) along the axes of the joints, nan between them."""
    length = np.linalg.norm(scene.axes, axis=-1, keepdims=True)
    reach = 0.04 * float(np.ptp(scene.places, axis=0).max())
    along = reach * scene.axes / np.where(length > 0, length, 1.0)
    ends = np.stack([scene.joints[:, :, None] - along, scene.joints[:, :, None] + along], axis=3)
    gap = np.full((*ends.shape[:3], 1, 3), np.nan)
    lines = np.concatenate([ends, gap], axis=3)
    keep = length[0, :, :, 0] > 0
    return lines[:, keep].reshape(len(lines), -1, 3)


def _trails(scene):
    """Paths of the points that move, one behind the other with nan between; None: there are none."""
    moving = [k for k in range(scene.points.shape[1]) if np.ptp(scene.points[:, k], axis=0).max() > 0]
    if not moving or len(scene.time) < 2:
        return None
    kept = moving[:: -(-len(moving) // MOST_TRAILS)]
    gap = np.full((1, 3), np.nan)
    return np.concatenate([part for k in kept for part in (scene.points[:, k], gap)])


def _layout(scene):
    view = view_of(scene.places, scene.gravity)
    return {
        "margin": {"l": 0, "r": 0, "t": 0, "b": 30},
        "legend": {"x": 0, "y": 1},
        "scene": _box(scene.places, view) | {"camera": _camera(view), "dragmode": _drag(view)},
        "sliders": [_slider(scene.time)],
        "updatemenus": [_buttons(scene.time)],
    }


def _box(places, view):
    """Equal axes round all places at any time."""
    low, high = places.min(axis=0), places.max(axis=0)
    extent = float((high - low).max()) or 1.0
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, 0.1 * extent) + 0.05 * extent
    box = {
        f"{axis}axis": {"range": [middle[k] - half[k], middle[k] + half[k]]} | _name(axis, view.planar)
        for k, axis in enumerate("xyz")
    }
    if view.planar and max(map(abs, view.eye)) == 1.0:
        # The axis that is looked along would be a heap of numbers.
        box["xyz"[int(np.argmax(np.abs(view.eye)))] + "axis"]["visible"] = False
    ratio = FLAT * half / half.max() if view.planar else DEEP * half / np.linalg.norm(half)
    return box | {"aspectmode": "manual", "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True))}


def _name(axis, planar):
    """Name and unit of an axis: its title; seen flat, where a title lies on the numbers, its last number."""
    if not planar:
        return {"title": {"text": f"{axis} [m]"}}
    words = {"tickprefix": f"{axis} = ", "ticksuffix": " m"}
    return {"title": {"text": ""}, "showtickprefix": "last", "showticksuffix": "last"} | words


def _camera(view):
    return {
        "up": dict(zip("xyz", view.up, strict=True)),
        "eye": {axis: DISTANCE * part for axis, part in zip("xyz", view.eye, strict=True)},
        "projection": {"type": "orthographic" if view.planar else "perspective"},
    }


def _drag(view):
    """A turntable keeps z up; what is seen flat, or has another axis up, is turned freely."""
    return "turntable" if view.up == (0.0, 0.0, 1.0) and not view.planar else "orbit"


def _slider(time):
    stay = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    steps = [
        {"method": "animate", "label": f"{t:.6g}", "args": [[str(k)], stay]}
        for k, t in enumerate(time.tolist())
    ]
    prefix = {"prefix": "t = ", "suffix": " s", "visible": True}
    pad = {"t": 30, "b": 15}
    return {"steps": steps, "active": 0, "currentvalue": prefix, "x": 0.16, "len": 0.8, "pad": pad}


def _buttons(time):
    span = min(LONGEST, max(SHORTEST, float(time[-1] - time[0])))
    pace = {"duration": 1000.0 * span / len(time), "redraw": True}
    play = [None, {"frame": pace, "transition": {"duration": 0}, "fromcurrent": True, "mode": "immediate"}]
    stop = {"frame": {"duration": 0, "redraw": False}, "mode": "immediate", "transition": {"duration": 0}}
    return {
        "type": "buttons", "direction": "left", "showactive": False,
        "x": 0.01, "xanchor": "left", "y": 0, "yanchor": "top", "pad": {"t": 40},
        "buttons": [
            {"label": "▶ play", "name": "play", "method": "animate", "args": play},
            {"label": "❚❚ pause", "name": "pause", "method": "animate", "args": [[None], stop]},
        ],
    }  # fmt: skip
