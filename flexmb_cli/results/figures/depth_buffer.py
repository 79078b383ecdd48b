"""A picture with a depth buffer: triangles, tubes and lines hide each other pixel by pixel, by arrays alone.

Places are in pixels from the upper left corner, (x, y, depth), y downwards; depth grows towards the viewer.
A pixel shows what is nearest at its middle.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

AMBIENT = 0.55  # part of the light that falls from everywhere
LEVELS = 64  # of light
# Pixels that are worked on at a time, and pixels of a picture up to which each is the mean of four.
MOST_AT_ONCE, MOST_SMOOTH = 2**20, 2_100_000


class DepthBuffer:
    """Pixels of a picture, finer than the picture so that edges are smooth."""

    def __init__(self, width: int, height: int):
        self.fine = 2 if width * height <= MOST_SMOOTH else 1
        self.width, self.height = width * self.fine, height * self.fine
        self.depth = np.zeros(self.width * self.height, np.float32)
        self.pixels = np.zeros(self.width * self.height, np.uint32)  # red, green, blue, nothing

    def begin(self) -> None:
        """Begin a white picture."""
        self.depth[:] = -np.inf
        self.pixels[:] = 0xFFFFFFFF

    def picture(self) -> np.ndarray:
        """Return the picture (height, width, 3) as bytes."""
        fine = self.pixels.view(np.uint8).reshape(self.height, self.width, 4)[..., :3].astype(np.uint16)
        parts = [fine[i :: self.fine, j :: self.fine] for i in range(self.fine) for j in range(self.fine)]
        return np.asarray(sum(parts) // len(parts), np.uint8)

    def triangles(
        self, corners: np.ndarray, colours: np.ndarray, values: np.ndarray | None = None, closed: bool = False
    ) -> None:
        """Draw triangles of `corners` (m, 3, 3), of closed surfaces those alone that face the viewer.

        `values` (m, 3) at the corners go from 0, the first of `colours` (k, 3), to 1, the last one.
        """
        corners = corners * self.fine
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        # Rows go down: what is anticlockwise to the viewer is clockwise in pixels.
        seen = normal[:, 2] < 0 if closed else normal[:, 2] != 0
        corners, normal = corners[seen], normal[seen]
        light = AMBIENT + (1 - AMBIENT) * np.abs(normal[:, 2]) / np.linalg.norm(normal, axis=1)
        k, row, first, last = _triangle_rows(corners, self.width, self.height)
        middle = np.stack([first + 0.5, row + 0.5], axis=1)
        depth, slope = _linear(corners, corners[:, :, 2], k, middle)
        level = (light * LEVELS).astype(np.int32)[k] * len(colours)
        shade, change = level.astype(np.float32), None
        if values is not None:
            shade, change = _linear(corners, values[seen] * (len(colours) - 1) + 0.5, k, middle)
        palette, begin = _palette(colours), row * self.width + first
        for r, step in _spans(last - first):
            at = begin[r] + step
            won = self._nearer(at, depth[r] + slope[r] * step)
            r, at = r[won], at[won]
            chosen = level[r]
            if change is not None:
                chosen += np.clip(shade[r] + change[r] * step[won], 0, len(colours) - 1).astype(np.int32)
            self.pixels[at] = palette[chosen]

    def tubes(self, start: np.ndarray, end: np.ndarray, radius: float, colour: np.ndarray) -> None:
        """Draw tubes with round ends from `start` to `end` (m, 3); where these are one place, spheres."""
        start, end, radius = start * self.fine, end * self.fine, radius * self.fine
        along, palette = end - start, _palette(colour[None])
        k, row, first, last = _tube_rows(start, end, radius, self.width, self.height)
        # Of rows: their first pixels from the start, and the direction by the square of its length.
        x, y = first + 0.5 - start[k, 0], row + 0.5 - start[k, 1]
        dx, dy, dz = along[k].T
        square = np.maximum(dx**2 + dy**2, 1e-30)
        begin, rate, z = (x * dx + y * dy) / square, dx / square, start[k, 2]
        pixel = row * self.width + first
        for r, step in _spans(last - first):
            part = np.clip(begin[r] + rate[r] * step, 0, 1)
            gap = (x[r] + step - part * dx[r]) ** 2 + (y[r] - part * dy[r]) ** 2
            above = np.sqrt(np.maximum(radius**2 - gap, 0))
            depth = np.where(gap < radius**2, z[r] + part * dz[r] + above, -np.inf)
            at = pixel[r] + step
            won = self._nearer(at, depth)
            light = AMBIENT + (1 - AMBIENT) * above[won] / radius
            self.pixels[at[won]] = palette[(light * LEVELS).astype(np.int32)]

    def path(self, places: np.ndarray, colour: np.ndarray) -> None:
        """Draw a line through `places` (n, 3)."""
        start, along = places[:-1] * self.fine, np.diff(places * self.fine, axis=0)
        across = np.abs(along[:, 0]) < np.abs(along[:, 1])
        counts = np.ceil(np.abs(along[:, :2]).max(axis=1, initial=0.0)).astype(int) + 1
        for k, step in _spans(counts):
            points = start[k] + along[k] * (step / counts[k])[:, None]
            for wide in range(self.fine):
                moved = wide - (self.fine - 1) / 2
                x = np.floor(points[:, 0] + np.where(across[k], moved, 0)).astype(int)
                y = np.floor(points[:, 1] + np.where(across[k], 0, moved)).astype(int)
                inside = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
                at = y[inside] * self.width + x[inside]
                self.pixels[at[self._nearer(at, points[inside, 2])]] = _palette(colour[None])[-1]

    def _nearer(self, at: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Return the rows of `at` that are nearest at their pixels, and keep their depths."""
        depth = depth.astype(np.float32)
        above = np.flatnonzero(depth > self.depth[at])
        places, depth = at[above], depth[above]
        np.maximum.at(self.depth, places, depth)
        # The first of equals is drawn last.
        return above[depth == self.depth[places]][::-1]


def _palette(colours: np.ndarray) -> np.ndarray:
    """Return packed `colours` (k, 3) at all levels of light, those of a level side by side."""
    levels = np.arange(LEVELS + 1)[:, None, None] / LEVELS
    shades = np.full((LEVELS + 1, len(colours), 4), 255, np.uint8)
    shades[..., :3] = 255 * levels * colours + 0.5
    return shades.reshape(-1, 4).view(np.uint32)[:, 0]


def _spans(counts: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Return for `counts` pixels of spans each, in parts: whose they are, and which of them, from 0."""
    counts = np.maximum(counts, 0)
    firsts = np.arange(0, counts.sum(), MOST_AT_ONCE)
    ends = np.append(np.searchsorted(np.cumsum(counts), firsts, "right"), len(counts))
    for low, high in pairwise(ends.tolist()):
        owner, step = _counted(counts[low:high])
        yield owner + low, step


def _counted(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return for all of `counts` things each: whose it is, and which of them, from 0."""
    owner = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(owner), dtype=np.int32) - np.repeat(np.cumsum(counts) - counts, counts)
    return owner, step.astype(np.int32)


def _linear(
    corners: np.ndarray, values: np.ndarray, k: np.ndarray, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what `values` (m, 3) of corners are at `places` (n, 2) of triangles `k`, and rates along x."""
    (ux, uy), (vx, vy) = ((corners[:, i] - corners[:, 0])[:, :2].T for i in (1, 2))
    du, dv, area = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0], ux * vy - uy * vx
    along_x, along_y = (du * vy - dv * uy) / area, (dv * ux - du * vx) / area
    x, y = (places - corners[k, 0, :2]).T
    at_origin = values[k, 0] + along_x[k] * x + along_y[k] * y
    return at_origin.astype(np.float32), along_x[k].astype(np.float32)


def _triangle_rows(corners: np.ndarray, width: int, height: int) -> tuple[np.ndarray, ...]:
    """Return triangle, row, first column and the one behind the last of all rows of pixels of triangles."""
    order = np.argsort(corners[:, :, 1], axis=1, kind="stable")
    upper, middle, lower = (
        np.take_along_axis(corners, order[:, k, None, None], axis=1)[:, 0] for k in range(3)
    )
    k, row = _rows(upper[:, 1], lower[:, 1], height)
    y = row + 0.5
    whole = _side_at(upper, lower, k, y)
    part = np.where(y < middle[k, 1], _side_at(upper, middle, k, y), _side_at(middle, lower, k, y))
    return k, row, *_columns(np.minimum(whole, part), np.maximum(whole, part), width)


def _side_at(p: np.ndarray, q: np.ndarray, k: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return where sides from p to q, both (m, 3), are at heights y of sides k."""
    # Triangles that share a side compute it alike, so that there is no gap between them.
    rise = q[:, 1] - p[:, 1]
    slope = np.divide(q[:, 0] - p[:, 0], rise, out=np.zeros(len(p)), where=rise > 0)
    return p[k, 0] + (y - p[k, 1]) * slope[k]


def _tube_rows(
    p: np.ndarray, q: np.ndarray, radius: float, width: int, height: int
) -> tuple[np.ndarray, ...]:
    """Return tube, row, first column and the one behind the last of all rows of pixels of tubes."""
    left, right = np.minimum(p, q)[:, :2] - radius, np.maximum(p, q)[:, :2] + radius
    k, row = _rows(left[:, 1], right[:, 1], height)
    along = q - p
    steep = np.abs(along[k, 1]) > 1e-9
    rise = np.where(steep, along[k, 1], 1.0)
    middle = p[k, 0] + (row + 0.5 - p[k, 1]) * along[k, 0] / rise
    # The round ends reach as far as the radius beyond the sides.
    half = np.where(steep, radius * np.hypot(along[k, 0], rise) / np.abs(rise) + radius, np.inf)
    least, most = np.maximum(left[k, 0], middle - half), np.minimum(right[k, 0], middle + half)
    return k, row, *_columns(least, most, width)


def _rows(least: np.ndarray, most: np.ndarray, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Return owner and row of all rows whose middles are between `least` and `most`."""
    low, high = _columns(least, most, height)
    owner, step = _counted(np.maximum(high - low, 0))
    return owner, low[owner] + step


def _columns(least: np.ndarray, most: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the first pixel whose middle is not before `least`, and the one behind the last."""
    return tuple(np.ceil(np.clip(edge, 0, width) - 0.5).astype(int) for edge in (least, most))
