"""The scene of a result as an animated figure of plotly.js: traces, frames, slider and buttons.

The figure is the plain data that `Plotly.newPlot` and `Plotly.addFrames` take.
"""

from html import escape

import numpy as np

from .report_camera import looked_at
from .scene import Scene

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


def frame_rows(rows: int, places: int = 1) -> slice:
    """Every n-th row, so that there are at most `MOST_FRAMES`, fewer where each shows many `places`.

    The last row is among them where a stride up to twice as long as needed leads to it.
    """
    frames = min(MOST_FRAMES, max(FEWEST_FRAMES, MOST_PLACES // places))
    least = -(-rows // frames) or 1
    ending = (stride for stride in range(least, 2 * least) if (rows - 1) % stride == 0)
    return slice(0, rows, next(ending, least))


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
    """Return whether a rigid body's marks span a plane polygon, such as a link with three joints."""
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
    return {
        "margin": {"l": 0, "r": 0, "t": 0, "b": 30},
        "legend": {"x": 0, "y": 1},
        "scene": looked_at(scene.places, scene.gravity),
        "sliders": [_slider(scene.time)],
        "updatemenus": [_buttons(scene.time)],
    }


def _slider(time):
    stay = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    steps = [
        {"method": "animate", "label": label, "args": [[str(k)], stay]}
        for k, label in enumerate(_rounded(time))
    ]
    shown = {"prefix": "t = ", "suffix": " s", "visible": True, "xanchor": "right"}
    pad = {"t": 30, "b": 15}
    return {"steps": steps, "active": 0, "currentvalue": shown, "x": 0.01, "len": 0.96, "pad": pad}


def _rounded(time):
    """Times as texts, to a hundredth of the time between frames."""
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    digits = max(0, int(np.ceil(2 - np.log10(step)))) if step > 0.0 else 9
    return [f"{round(t, digits) + 0.0:.12g}" for t in time.tolist()]


def _buttons(time):
    span = min(LONGEST, max(SHORTEST, float(time[-1] - time[0])))
    pace = {"duration": 1000.0 * span / len(time), "redraw": True}
    play = [None, {"frame": pace, "transition": {"duration": 0}, "fromcurrent": True, "mode": "immediate"}]
    stop = {"frame": {"duration": 0, "redraw": False}, "mode": "immediate", "transition": {"duration": 0}}
    return {
        "type": "buttons", "direction": "left", "showactive": False,
        "x": 0.01, "xanchor": "left", "y": 0, "yanchor": "top", "pad": {"t": 5},
        "buttons": [
            {"label": "▶ play", "name": "play", "method": "animate", "args": play},
            {"label": "❚❚ pause", "name": "pause", "method": "animate", "args": [[None], stop]},
        ],
    }  # fmt: skip
