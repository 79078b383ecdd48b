"""Texts of a film's frames: the time and the legend of its colours, in letters that fit the picture."""

from typing import Any

import numpy as np

DOTS = 72  # an inch, so that a point is a pixel
# Height of letters: their usual share of the picture's height, and least and largest, pixels.
LETTERS, LEAST, LARGEST = 1 / 45, 7.0, 40.0
# By the height of letters: a line, and height and width of the legend's colours.
LINE_PITCH, BAR = 1.35, (0.8, 15.0)
MOST_MARGIN = 1 / 16  # of the picture's width


class Texts:
    """The texts of pictures of `width` by `height` pixels; `legend` stands below its `colours` (k, 3).

    `letters` is the height of letters as a share of that of the picture.
    """

    def __init__(self, width: int, height: int, legend: str, colours: np.ndarray, letters: float = LETTERS):
        self.letters = float(np.clip(letters * height, LEAST, LARGEST))
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
        lines: list[str] = []
        for word in text.split():
            longer = f"{lines[-1]} {word}" if lines else word
            if lines and self._width(longer) <= self.room:
                lines[-1] = longer
            else:
                lines.append(word)
        return lines

    def _width(self, text: str) -> float:
        from matplotlib.textpath import TextPath

        return float(TextPath((0, 0), text, size=self.letters).get_extents().x1)

    def _write(self, picture: np.ndarray, lines: list[str], top: int) -> None:
        """Write `lines` into `picture`, the first from row `top` on."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        room = picture[top : top + round(LINE_PITCH * self.letters * len(lines)) + 1, self.margin :]
        high, wide = room.shape[:2]
        figure = Figure(figsize=(wide / DOTS, high / DOTS), dpi=DOTS)
        for k, line in enumerate(lines):
            base = 1 - (k + 1) * LINE_PITCH * self.letters / high
            figure.text(0, base, line, fontsize=self.letters, color="black", va="bottom")
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        room[:] = room * (np.array(canvas.buffer_rgba())[..., :1] / 255)
