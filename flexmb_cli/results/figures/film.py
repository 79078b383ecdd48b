"""A film of a result: the report's picture of the motion, frame by frame, as MP4 or GIF.

Bodies are drawn with a depth buffer, texts by matplotlib; imageio writes the frames.
"""

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...quick_dataclass import dataclass
from ..quantities.quantities import ResultError
from .contours import CONTOURS, ENERGY, VON_MISES, contour_ranges, nodal_values, unit_of
from .depth_buffer import DepthBuffer
from .element_bodies import ElementBody, element_bodies
from .element_faces import outer_faces, triangles
from .report_scene import GREY, LONGEST_ANIMATION, MOST_TRACES, SHORTEST_ANIMATION, TRACE, colour_of, rounded
from .scene import Scene, read_scene
from .view import view_of

FORMATS = ("mp4", "gif")
VIEWS = {"x": ((1, 0, 0), (0, 0, 1)), "y": ((0, -1, 0), (0, 0, 1)), "z": ((0, 0, 1), (0, 1, 0))}
MOST_FRAMES = 3000
COLOURS_OF_FILMS = (*(name for name in CONTOURS if name != ENERGY), "body")
# Of the largest size of the mechanism: radius of a tube; share of the picture that it fills.
TUBE_RADIUS, FILLED = 0.008, 1 / 1.12
JOINT = "#6B6B6B"
DOTS = 72  # an inch
TEXT_HEIGHT, LETTERS = 20, 12  # heights of a line of text and of its letters, pixels
BAR = (10, 180)  # height and width of the legend's colours, pixels
CONTOURS_BEGIN = 0.2  # of viridis, where contours begin: below it is as dark as a dark page


@dataclass(frozen=True)
class FilmLook:
    """Width and height in pixels, frames a second, a view of `VIEWS`, else that of the report, and colours.

    `colours`: one of CONTOURS, else each body has its own.
    """

    width: int = 960
    height: int = 540
    rate: int = 25
    view: str = "start"
    colours: str = VON_MISES


def film_bytes(result: h5py.File, form: str, look: FilmLook) -> bytes:
    """The film of `result` in one of FORMATS; needs matplotlib and imageio, for MP4 imageio-ffmpeg.

    It has the length of the report's animation.  Raises `ResultError` where there is nothing to draw.
    """
    import imageio.v2 as imageio

    frames = film_frames(result, look)
    # Frames of video are whole blocks of two pixels.
    options: dict[str, Any] = {"macro_block_size": 2} if form == "mp4" else {"loop": 0}
    rate: dict[str, Any] = {"fps": look.rate} if form == "mp4" else {"duration": 1000 / look.rate}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"film.{form}"
        with imageio.get_writer(path, **options, **rate) as writer:
            for frame in frames:
                writer.append_data(frame)  # type: ignore[attr-defined]
        return path.read_bytes()


def film_rows(time: np.ndarray, rate: int) -> list[int]:
    """The row of every frame: the last one that is not later; the last frame has the last row."""
    span = float(time[-1] - time[0])
    seconds = min(max(span, SHORTEST_ANIMATION), LONGEST_ANIMATION)
    count = min(MOST_FRAMES, max(2, round(seconds * rate) + 1))
    shown = np.linspace(time[0], time[-1], count)
    # Times are computed from the counts of rows, and differ by round-off.
    found: list[int] = np.clip(
        np.searchsorted(time, shown + 1e-9 * span, "right") - 1, 0, len(time) - 1
    ).tolist()
    return found


def film_frames(result: h5py.File, look: FilmLook) -> Iterator[np.ndarray]:
    """Frames (height, width, 3) of bytes."""
    scene = read_scene(result)
    bodies = list(element_bodies(result, scene.body_names, slice(None)))
    canvas = _Canvas(scene, bodies, look)
    if look.colours in CONTOURS and look.colours != VON_MISES and not canvas.legend:
        raise ResultError(
            result.filename, f"there is no body with elements to colour by {look.colours}", id="RESULT-028"
        )
    drawn, frame = None, np.zeros(0)
    for row in film_rows(scene.time, look.rate):
        if row != drawn:
            drawn, frame = row, canvas.frame(row)
        yield frame


class _Camera:
    """From places in m to pixels, depth towards the viewer."""

    def __init__(self, places: np.ndarray, gravity: Any, look: Any):
        view = view_of(places, gravity)
        eye, up = VIEWS.get(look.view, (view.eye, view.up))
        right = np.cross(up, eye)
        self.axes = np.stack([right / np.linalg.norm(right), np.cross(right, eye), eye]).astype(float)
        self.axes /= np.linalg.norm(self.axes, axis=1)[:, None]
        self.size = np.array([look.width, look.height])
        flat = places @ self.axes[:2].T
        low, high = flat.min(axis=0), flat.max(axis=0)
        self.extent = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
        widths = np.maximum(high - low, 0.04 * self.extent)
        self.scale = float(np.min(self.size / widths)) * FILLED
        self.middle = (low + high) / 2
        self.radius = max(1.0, TUBE_RADIUS * self.extent * self.scale)  # of tubes, pixels

    def seen(self, places: np.ndarray) -> Any:
        """Pixels from the upper left corner, and depth in pixels (..., 3)."""
        seen = places @ self.axes.T * self.scale
        seen[..., :2] += self.size / 2 - self.middle * self.scale
        return seen


class _Surface:
    """Triangles of a finite-element body or of shapes, and what they are coloured by."""

    def __init__(self, body: Any, contour: str, ends: tuple[float, float] | None):
        self.body, self.contour, self.ends = body, contour, ends
        self.of_elements = isinstance(body, ElementBody)
        self.triangles = triangles(outer_faces(body.cells)) if self.of_elements else body.triangles

    def values(self, row: int) -> np.ndarray | None:
        """Values (m, 3) from 0 to 1 of the corners of the triangles, None where there is one colour."""
        if not self.of_elements or not self.ends:
            return None
        found = nodal_values(self.body, self.body.amplitude[row : row + 1]).get(self.contour)
        low, high = self.ends
        return None if found is None else ((found[:, 0] - low) / ((high - low) or 1.0))[self.triangles]


class _Canvas:
    """The picture: what does not move is made once."""

    def __init__(self, scene: Scene, bodies: list[ElementBody], look: FilmLook):
        from matplotlib import colormaps

        self.scene = scene
        self.contours = colormaps["viridis"](np.linspace(CONTOURS_BEGIN, 1, 256))[:, :3]
        self.camera = _Camera(_all_places(scene, bodies), scene.gravity, look)
        self.buffer = DepthBuffer(look.width, look.height)
        ends = contour_ranges(bodies).get(look.colours)
        shown = {*(one.number for one in bodies), *(shape.number for shape in scene.shapes)}
        self.lines = [body for body in scene.bodies if body.number not in shown]
        self.surfaces = [_Surface(body, look.colours, ends) for body in (*bodies, *scene.shapes)]
        paths = np.swapaxes(scene.points, 0, 1)[:MOST_TRACES]
        self.traces = [self.camera.seen(path) for path in paths if np.ptp(path, axis=0).any()]
        self.labels = rounded(scene.time)
        self.legend = _legend(look.colours, *ends) if ends else ""

    def frame(self, row: int) -> np.ndarray:
        """The picture of a row."""
        self.buffer.begin()
        for surface in self.surfaces:
            self._surface(surface, row)
        for body in self.lines:
            marks = self.camera.seen(body.marks[row])
            radius = self.camera.radius * (0.6 if body.still else 1.0)
            colour = _rgb(GREY if body.still else colour_of(body))
            self.buffer.tubes(marks[body.edges[:, 0]], marks[body.edges[:, 1]], radius, colour)
        joints = self.camera.seen(self.scene.joints[row]) + (0, 0, self.camera.radius)
        self.buffer.tubes(joints, joints, 1.5 * self.camera.radius, _rgb(JOINT))
        for trace in self.traces:
            self.buffer.path(trace, _rgb(TRACE))
        picture = self.buffer.picture()
        _write(picture, f"t = {self.labels[row]} s", -26)
        if self.legend:
            width = min(BAR[1], picture.shape[1] - 24)
            bar = self.contours[np.arange(width) * len(self.contours) // width]
            picture[12 : 12 + BAR[0], 12 : 12 + width] = 255 * bar
            _write(picture, self.legend, 16 + BAR[0])
        return picture

    def _surface(self, surface: _Surface, row: int) -> None:
        corners = self.camera.seen(surface.body.places(row))[surface.triangles]
        values = surface.values(row)
        colours = _rgb(colour_of(surface.body))[None] if values is None else self.contours
        # Elements face outwards; files of shapes may not.
        self.buffer.triangles(corners, colours, values, surface.of_elements)


def _legend(contour: str, low: float, high: float) -> str:
    return f"{contour}, {low:.3g} to {high:.3g} {unit_of(contour)}".rstrip()


def _write(picture: np.ndarray, text: str, top: int) -> None:
    """Write `text` into `picture` (height, width, 3) at the left, at a row, from below where that is < 0."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    room = picture[top:][:TEXT_HEIGHT, 12:]
    figure = Figure(figsize=(room.shape[1] / DOTS, room.shape[0] / DOTS), dpi=DOTS)
    figure.text(0, 0.3, text, fontsize=LETTERS, color="black")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    room[:] = room * (np.array(canvas.buffer_rgba())[..., :1] / 255)


def _rgb(text: str) -> Any:
    return np.array([int(text[k : k + 2], 16) for k in (1, 3, 5)]) / 255


def _all_places(scene: Any, bodies: Any) -> Any:
    """Everything at all times; of finite-element bodies at some."""
    rows = np.unique(np.linspace(0, len(scene.time) - 1, 20).astype(int))
    return np.concatenate([scene.places, *(body.places(row) for body in bodies for row in rows)])
