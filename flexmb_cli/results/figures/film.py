"""A film of a result: the report's picture of the motion, frame by frame, as MP4 or GIF.

Faces of bodies are drawn from back to front by matplotlib and written by imageio.
"""

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...quick_dataclass import dataclass
from ..hdf5.stress import von_mises
from .element_bodies import ElementBody, element_bodies, largest_stress
from .element_faces import outer_faces, triangles
from .report_scene import GREY, LONGEST_ANIMATION, MOST_TRACES, SHORTEST_ANIMATION, TRACE, colour_of, rounded
from .scene import Scene, read_scene
from .view import view_of

FORMATS = ("mp4", "gif")
VIEWS = {"x": ((1, 0, 0), (0, 0, 1)), "y": ((0, -1, 0), (0, 0, 1)), "z": ((0, 0, 1), (0, 1, 0))}
MOST_FRAMES = 3000
# Of the largest size of the mechanism: radius of a tube; share of the picture that it fills.
TUBE_RADIUS, FILLED = 0.008, 1 / 1.12
# Tubes are cut into so many faces, so that each is before or behind other bodies as a whole.
PIECES = 8
AMBIENT = 0.55
DOTS = 72  # an inch
CONTOURS_BEGIN = 0.2  # of viridis, where contours begin: below it is as dark as a dark page


@dataclass(frozen=True)
class FilmLook:
    """Width and height in pixels, frames a second, and a view of `VIEWS`, else that of the report."""

    width: int = 960
    height: int = 540
    rate: int = 25
    view: str = "start"


def film_bytes(result: h5py.File, form: str, look: FilmLook) -> bytes:
    """The film of `result` in one of FORMATS; needs matplotlib and imageio, for MP4 imageio-ffmpeg.

    It has the length of the report's animation.  Raises `ResultError` where there is nothing to draw.
    """
    import imageio.v2 as imageio

    frames = film_frames(result, look)
    # Frames of video are whole blocks of two pixels.
    options = {"macro_block_size": 2} if form == "mp4" else {"loop": 0}
    rate = {"fps": look.rate} if form == "mp4" else {"duration": 1000 / look.rate}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"film.{form}"
        with imageio.get_writer(path, **options, **rate) as writer:  # type: ignore[arg-type]
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
    return np.clip(np.searchsorted(time, shown + 1e-9 * span, "right") - 1, 0, len(time) - 1).tolist()


def film_frames(result: h5py.File, look: FilmLook) -> Iterator[np.ndarray]:
    """Frames (height, width, 3) of bytes."""
    scene = read_scene(result)
    bodies = list(element_bodies(result, scene.body_names, slice(None)))
    canvas = _Canvas(scene, bodies, look)
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
        self.axes = np.stack([right / np.linalg.norm(right), np.cross(eye, right), eye]).astype(float)
        self.axes /= np.linalg.norm(self.axes, axis=1)[:, None]
        self.size = np.array([look.width, look.height])
        flat = places @ self.axes[:2].T
        low, high = flat.min(axis=0), flat.max(axis=0)
        self.extent = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
        spans = np.maximum(high - low, 0.04 * self.extent)
        self.scale = float(np.min(self.size / spans)) * FILLED
        self.middle = (low + high) / 2

    def seen(self, places: np.ndarray) -> Any:
        """Pixels from the lower left corner, and depth in pixels (..., 3)."""
        seen = places @ self.axes.T * self.scale
        seen[..., :2] += self.size / 2 - self.middle * self.scale
        return seen


class _Surface:
    """Triangles of a finite-element body or of shapes, their places and colours in every row."""

    def __init__(self, body: Any, most: float):
        self.body, self.most = body, most
        self.of_elements = isinstance(body, ElementBody)
        self.triangles = triangles(outer_faces(body.cells)) if self.of_elements else body.triangles

    def colours(self, row: Any, contours: Any) -> Any:
        """Colours (m, 3) of the triangles."""
        if not self.of_elements or not self.most:
            return np.tile(_rgb(colour_of(self.body)), (len(self.triangles), 1))
        stress = von_mises(self.body.stress(row))[self.triangles].mean(axis=1)
        return contours(CONTOURS_BEGIN + (1 - CONTOURS_BEGIN) * stress / self.most)[:, :3]


class _Canvas:
    """The picture: what does not move is made once."""

    def __init__(self, scene: Scene, bodies: list[ElementBody], look: FilmLook):
        from matplotlib import colormaps
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self.scene, self.contours = scene, colormaps["viridis"]
        self.camera = _Camera(_all_places(scene, bodies), scene.gravity, look)
        most = largest_stress(bodies)
        shown = {*(one.number for one in bodies), *(shape.number for shape in scene.shapes)}
        self.lines = [body for body in scene.bodies if body.number not in shown]
        self.surfaces = [_Surface(body, most) for body in (*bodies, *scene.shapes)]
        self.figure = Figure(figsize=self.camera.size / DOTS, dpi=DOTS)  # type: ignore[arg-type]
        self.axis = self.figure.add_axes((0, 0, 1, 1))
        self.axis.set(xlim=(0, look.width), ylim=(0, look.height))
        self.axis.set_axis_off()
        self.labels = rounded(scene.time)
        self._prepare(most)
        self.canvas = FigureCanvasAgg(self.figure)

    def _prepare(self, most: float) -> None:
        from matplotlib.collections import LineCollection, PolyCollection

        paths = np.swapaxes(self.scene.points, 0, 1)[:MOST_TRACES]
        moving = [path for path in paths if np.ptp(path, axis=0).any()]
        traces = [self.camera.seen(path)[:, :2] for path in moving]
        self.axis.add_collection(LineCollection(traces, colors=TRACE, linewidths=0.8))
        self.faces = self.axis.add_collection(PolyCollection([], linewidths=0.3))
        (self.joints,) = self.axis.plot(
            [], [], "o", color="#555555", markersize=self._points(3 * TUBE_RADIUS)
        )
        self.time = self.axis.text(12, 12, "", fontsize=13, color="#222222")
        if most:
            self.axis.text(
                12,
                self.camera.size[1] - 24,
                f"von Mises stress, 0 (dark) to {most:.3g} Pa (bright)",
                fontsize=11,
            )

    def _points(self, length: Any) -> Any:
        """Points of a length in parts of the mechanism's size."""
        return max(2.0, length * self.camera.extent * self.camera.scale)

    def frame(self, row: int) -> np.ndarray:
        """The picture of a row."""
        parts = [self._surface(surface, row) for surface in self.surfaces]
        parts += [self._tubes(body, row) for body in self.lines]
        polygons, depths, colours = (np.concatenate(part) for part in zip(*parts, strict=True))
        order = np.argsort(depths, kind="stable")
        self.faces.set_verts(polygons[order])  # type: ignore[attr-defined]
        self.faces.set_facecolor(colours[order])  # type: ignore[arg-type]
        self.faces.set_edgecolor(colours[order])  # type: ignore[arg-type]
        joints = self.camera.seen(self.scene.joints[row])
        self.joints.set_data(joints[:, 0], joints[:, 1])
        self.time.set_text(f"t = {self.labels[row]} s")
        self.canvas.draw()
        return np.array(self.canvas.buffer_rgba())[..., :3]

    def _surface(self, surface: Any, row: Any) -> Any:
        """Corners (m, 4, 2), depths (m,) and colours (m, 3) of the triangles that are seen."""
        corners = self.camera.seen(surface.body.places(row))[surface.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
        light = AMBIENT + (1 - AMBIENT) * np.abs(area)
        colours = surface.colours(row, self.contours) * light[:, None]
        # Elements face outwards; files of shapes may not.
        seen = area > 0 if surface.of_elements else area != 0
        flat = corners[seen][:, [0, 1, 2, 2], :2]
        return flat, corners[seen][..., 2].mean(axis=1), colours[seen]

    def _tubes(self, body: Any, row: Any) -> Any:
        marks = self.camera.seen(body.marks[row])
        start, end = (marks[body.edges[:, k]] for k in (0, 1))
        cuts = np.linspace(0, 1, PIECES + 1)[:, None, None]
        points = start + cuts * (end - start)
        p, q = points[:-1].reshape(-1, 3), points[1:].reshape(-1, 3)
        along = (q - p)[:, :2]
        length = np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
        radius = TUBE_RADIUS * self.camera.extent * self.camera.scale * (0.6 if body.still else 1.0)
        side = along[:, ::-1] * (-1, 1) / length * radius
        polygons = np.stack([p[:, :2] - side, q[:, :2] - side, q[:, :2] + side, p[:, :2] + side], axis=1)
        colour = _rgb(GREY if body.still else colour_of(body))
        return polygons, (p[:, 2] + q[:, 2]) / 2 + radius, np.tile(colour, (len(polygons), 1))


def _rgb(text: str) -> Any:
    return np.array([int(text[k : k + 2], 16) for k in (1, 3, 5)]) / 255


def _all_places(scene: Any, bodies: Any) -> Any:
    """Everything at all times; of finite-element bodies at some."""
    rows = np.unique(np.linspace(0, len(scene.time) - 1, 20).astype(int))
    return np.concatenate([scene.places, *(body.places(row) for body in bodies for row in rows)])
