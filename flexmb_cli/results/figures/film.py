"""A film of a result: the report's picture of the motion, frame by frame, as MP4 or GIF.

Bodies are drawn with a depth buffer, texts by Pillow; imageio writes the frames.
"""

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..hdf5.stored_result import attribute
from .contours import (
    DEFAULT_LOOK,
    ENERGY,
    BodyLook,
    Ranges,
    check_look,
    contour_ranges,
    nodal_values,
    shown_colours,
    shown_unit,
)
from .depth_buffer import DepthBuffer
from .element_bodies import ElementBody, element_bodies, outer_faces_of_elements, triangles
from .label_fitting import Letters
from .look import GREY, JOINT, TRACE
from .report_scene import LONGEST_ANIMATION, MOST_TRACES, SHORTEST_ANIMATION, colour_of, rounded
from .scene import GROUND_SYMBOL, Scene, read_scene, view_of

DOTS = 72  # an inch, so that a point is a pixel
# Height of letters: their usual share of the picture's height, and least and largest, pixels.
LETTERS, LEAST, LARGEST = 1 / 45, 7.0, 40.0
# By the height of letters: length of the axes of the ground, and distance of their origin from the corner.
AXIS, CORNER = 2.4, 4.2
THIN, TIPS = 0.12, 1.35  # radius of an axis by the height of letters; place of its name by its length
# By the height of letters: a line, and height and width of the legend's colours.
LINE_PITCH, BAR = 1.35, (0.8, 15.0)
MOST_MARGIN = 1 / 16  # of the picture's width


class Texts:
    """The texts of pictures of `width` by `height` pixels; `legend` stands below its `colours` (k, 3).

    `letters` is the height of letters as a share of that of the picture.
    """

    def __init__(self, width: int, height: int, legend: str, colours: np.ndarray, letters: float = LETTERS):
        from matplotlib import font_manager
        from PIL import ImageFont

        self.letters = float(np.clip(letters * height, LEAST, LARGEST))
        self.measured = Letters(str(self.letters))
        self.font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), self.letters)
        self.margin = round(min(self.letters, MOST_MARGIN * width))
        self.room = width - 2 * self.margin
        self.legend, self.colours = self._fitting(legend), colours

    def written(self, picture: np.ndarray, time: str) -> np.ndarray:
        """Return the `picture` (height, width, 3) with `time` at its foot and the legend at its head."""
        lines = self._fitting(time)
        self._write(
            picture, lines, len(picture) - self.margin // 2 - round(LINE_PITCH * self.letters * len(lines))
        )
        if not self.legend:
            return picture
        tall, wide = (round(part * self.letters) for part in BAR)
        wide = min(wide, self.room)
        place = picture[self.margin : self.margin + tall, self.margin : self.margin + wide]
        place[:] = 255 * self.colours[np.arange(wide) * len(self.colours) // wide]
        self._write(picture, self.legend, self.margin + tall + 2)
        return picture

    def _fitting(self, text: str) -> list[str]:
        """Return `text` in lines at most as wide as the room, broken between words."""
        return self.measured.wrapped(text, self.room / DOTS).splitlines()

    def _write(self, picture: np.ndarray, lines: list[str], top: int) -> None:
        """Write `lines` into `picture`, the first from row `top` on."""
        from PIL import Image, ImageDraw

        image = Image.fromarray(picture)
        for k, line in enumerate(lines):
            place = self.margin, top + k * LINE_PITCH * self.letters
            ImageDraw.Draw(image).text(place, line, "black", self.font)
        picture[:] = np.asarray(image)

    def name_axes(self, picture: np.ndarray, ends: np.ndarray) -> None:
        """Write x, y and z at the `ends` (3, 2) of the axes of the ground."""
        from PIL import Image, ImageDraw

        image = Image.fromarray(picture)
        for name, end in zip("xyz", ends, strict=True):
            ImageDraw.Draw(image).text(tuple(end), name, GREY, self.font, anchor="mm")
        picture[:] = np.asarray(image)


# Behind the time of every frame with numbers of `run --as-printed`.
EMULATED = "with the known errors of the program of 1996 (--as-printed)"

FORMATS = ("mp4", "gif")
VIEWS = {"x": ((1, 0, 0), (0, 0, 1)), "y": ((0, -1, 0), (0, 0, 1)), "z": ((0, 0, 1), (0, 1, 0))}
MOST_FRAMES = 3000
# GIF files count hundredths of a second, and browsers show frames of less than two for ten.
MOST_OF_GIFS = 50
# Of the largest size of the mechanism: radius of a tube; share of the picture that it fills.
TUBE_RADIUS, FILLED = 0.008, 1 / 1.12
CONTOURS_BEGIN = 0.2  # of viridis, where contours begin: below it is as dark as a dark page


@dataclass(frozen=True)
class FilmLook:
    """Width and height in pixels, frames a second, a view of `VIEWS`, else that of the report, and bodies.

    `letters` is their height as a share of the picture's.
    """

    width: int = 960
    height: int = 540
    rate: int = 25
    view: str = "start"
    bodies: BodyLook = DEFAULT_LOOK
    letters: float = LETTERS


def film_bytes(result: h5py.File, form: str, look: FilmLook) -> bytes:
    """The film of `result` in one of FORMATS; needs matplotlib and imageio, for MP4 imageio-ffmpeg.

    It has the length of the report's animation.  Raises `ResultError` where there is nothing to draw.
    """
    import imageio.v2 as imageio

    frames = film_frames(result, look)
    first = next(frames)  # faults of the result come before all else
    # Frames of video are whole blocks of two pixels.
    options: dict[str, Any] = {"macro_block_size": 2, "fps": look.rate}
    if form == "gif":
        count = len(film_rows(result["time"][:], look.rate))
        options = {"loop": 0, "duration": gif_durations(count, look.rate)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"film.{form}"
        opened: Any = imageio.get_writer(path, **options)  # its context manager has no types
        with opened as writer:
            for frame in chain([first], frames):
                writer.append_data(frame)
        return path.read_bytes()


def gif_durations(count: int, rate: int) -> list[int]:
    """Durations, ms, of `count` frames, whole hundredths of a second that add up to `count` / `rate`."""
    ends = [round(100 * k / rate) for k in range(count + 1)]
    return [10 * (end - begin) for begin, end in pairwise(ends)]


def film_rows(time: np.ndarray, rate: int) -> list[int]:
    """The row of every frame: the last one that is not later; the last frame has the last row."""
    span = float(time[-1] - time[0])
    seconds = min(max(span, SHORTEST_ANIMATION), LONGEST_ANIMATION)
    count = min(MOST_FRAMES, max(2, round(seconds * rate) + 1))
    shown = np.linspace(time[0], time[-1], count)
    # Times are computed from the counts of rows, and differ by round-off.
    return np.clip(np.searchsorted(time, shown + 1e-9 * span, "right") - 1, 0, len(time) - 1).tolist()


def film_frames(result: h5py.File, look: FilmLook, rows: slice = slice(None)) -> Iterator[np.ndarray]:
    """Frames (height, width, 3) of bytes of the motion in `rows`; colours are those of all rows."""
    scene, look = read_scene(result, rows), replace(look, bodies=look.bodies.of(result))
    bodies = list(element_bodies(result, scene.body_names, slice(None)))
    ranges = contour_ranges(bodies)
    check_look(result.filename, look.bodies, ranges, scene.size)
    canvas = _Canvas(scene, [body.at(rows) for body in bodies], look, ranges)
    if attribute(result, "emulation"):
        canvas.labels = [f"{label} {EMULATED}" for label in canvas.labels]
    drawn, frame = None, np.zeros(0)
    for row in film_rows(scene.time, look.rate):
        if row != drawn:
            drawn, frame = row, canvas.frame(row)
        yield frame


class _Camera:
    """From places in m to pixels, depth towards the viewer."""

    def __init__(self, places: np.ndarray, gravity: np.ndarray, look: FilmLook):
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

    def triad(self, letters: float, places: np.ndarray) -> np.ndarray:
        """Origin and ends (4, 3), pixels, of the ground's axes in a right corner without `places` (n, 3).

        The lower corner comes first; there are no axes (0, 3) if both have places.
        """
        ends = np.concatenate([np.zeros((1, 3)), AXIS * letters * self.axes.T])
        away, seen = CORNER * letters, self.seen(places)[:, :2]
        for origin in (self.size - away, np.array([self.size[0] - away, away])):
            if (np.abs(seen - origin).max(axis=1) > away).all():
                ends[:, :2] += origin
                return ends
        return ends[:0]


class _Surface:
    """Triangles of a finite-element body or of shapes, and what they are coloured by."""

    def __init__(self, body: Any, contour: str, scale: float, ends: tuple[float, float] | None):
        self.body, self.contour, self.ends, self.scale = body, contour, ends, scale
        self.of_elements = isinstance(body, ElementBody)
        if self.of_elements:
            faces, elements = outer_faces_of_elements(body.cells)
            self.triangles = triangles(faces)
            self.elements = np.repeat(elements, len(self.triangles) // len(faces))
        else:
            self.triangles = body.triangles

    def values(self, row: int) -> np.ndarray | None:
        """Values (m, 3) of the corners of the triangles, 0: the first colour, 1: the last one.

        None where there is one colour; nan for elements that are not reported.
        """
        if not self.of_elements or not self.ends:
            return None
        of_row = self._energies(row) if self.contour == ENERGY else self._nodal(row)
        low, high = self.ends
        return None if of_row is None else (of_row - low) / ((high - low) or 1.0)

    def _nodal(self, row: int) -> np.ndarray | None:
        of_nodes = nodal_values(self.body, self.body.amplitude[row : row + 1]).get(self.contour)
        return None if of_nodes is None else of_nodes[:, 0][self.triangles]

    def _energies(self, row: int) -> np.ndarray | None:
        if not self.body.of_elements:
            return None
        of_cells = np.full(len(self.body.cells), np.nan)
        of_cells[self.body.selected] = self.body.of_elements["strain_energy"][row]
        return np.repeat(of_cells[self.elements, None], 3, axis=1)


class _Canvas:
    """The picture: what does not move is made once."""

    def __init__(self, scene: Scene, bodies: list[ElementBody], look: FilmLook, ranges: Ranges):
        from matplotlib import colormaps

        self.scene, bodies_look = scene, look.bodies
        self.contours = colormaps["viridis"](np.linspace(CONTOURS_BEGIN, 1, 256))[:, :3]
        # Everything at all times; of finite-element bodies at some.
        rows = np.unique(np.linspace(0, len(scene.time) - 1, 20).astype(int))
        of_bodies = (body.places(row, bodies_look.scale) for body in bodies for row in rows)
        places = np.concatenate([scene.places, *of_bodies])
        self.camera = _Camera(places, scene.gravity, look)
        self.buffer = DepthBuffer(look.width, look.height)
        contour = shown_colours(bodies_look, ranges)
        reached = ranges.get(contour)
        ends = reached and (bodies_look.ends or reached)
        self.lines = scene.lined(bodies)
        self.surfaces = [
            _Surface(body, contour, bodies_look.scale, ends) for body in (*bodies, *scene.shapes)
        ]
        paths = np.swapaxes(scene.points, 0, 1)[:MOST_TRACES]
        self.traces = [self.camera.seen(path) for path in paths if np.ptp(path, axis=0).any()]
        magnified = f", deformation × {bodies_look.scale:g}" if bodies_look.scale != 1 else ""
        self.labels = [f"t = {time} s{magnified}" for time in rounded(scene.time)]
        self.legend = _legend(contour, ends, reached, bodies_look) if ends and reached else ""
        self.texts = Texts(look.width, look.height, self.legend, self.contours, look.letters)
        self.triad = self.camera.triad(self.texts.letters, places)

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
        self._signs(joints)
        for trace in self.traces:
            self.buffer.path(trace, _rgb(TRACE))
        picture = self.texts.written(self.buffer.picture(), self.labels[row])
        if len(self.triad):
            origin, ends = self.triad[:1, :2], self.triad[1:, :2]
            self.texts.name_axes(picture, origin + TIPS * (ends - origin))
        return picture

    def _signs(self, joints: np.ndarray) -> None:
        """Draw the symbol of the ground at joints (J, 3) that rest, and its axes in the corner."""
        radius = self.camera.radius
        lines = np.reshape(GROUND_SYMBOL, (-1, 2, 2)) * radius
        for joint in joints[self.scene.supports]:
            places = np.zeros((len(lines), 2, 3))
            places[..., :2] = lines
            places += joint - (0, 0, 2 * radius)
            self.buffer.tubes(places[:, 0], places[:, 1], max(0.6, 0.3 * radius), _rgb(GREY))
        for end in self.triad[1:]:
            self.buffer.tubes(self.triad[:1], end[None], THIN * self.texts.letters, _rgb(GREY))

    def _surface(self, surface: _Surface, row: int) -> None:
        corners = self.camera.seen(surface.body.places(row, surface.scale))[surface.triangles]
        values, own = surface.values(row), _rgb(colour_of(surface.body))[None]
        known = np.zeros(len(corners), bool) if values is None else np.isfinite(values).all(axis=1)
        # Elements face outwards; files of shapes may not.
        closed = surface.of_elements
        if values is not None:
            self.buffer.triangles(corners[known], self.contours, values[known], closed)
        self.buffer.triangles(corners[~known], own, None, closed)


def _legend(contour: str, ends: tuple[float, float], reached: tuple[float, float], look: BodyLook) -> str:
    """Colours and values; where these are others than the smallest and the largest, these as well."""
    unit, factor = shown_unit(contour, reached, look)
    first, last, low, high = (factor * end for end in (*ends, *reached))
    words = f"{contour}, {first:.3g} to {last:.3g} {unit}".rstrip()
    return words if ends == reached else f"{words} (of {low:.3g} to {high:.3g})"


def _rgb(text: str) -> np.ndarray:
    return np.array([int(text[k : k + 2], 16) for k in (1, 3, 5)]) / 255
