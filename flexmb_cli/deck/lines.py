"""The lines of a large text, each cut out when it is looked at: a list of them takes many times the text."""

import re
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from typing import Any

from ..errors import Place

_LINE_END = re.compile(r"\r\n?|\n")
_AT_ONCE, _MOST_PIECES = 256, 8  # lines that are cut out at once, and how many such pieces are kept


class Lines(Sequence[str]):
    """The lines of `text` without their ends (LF, CR LF or CR); the last one ends with the text.

    `starts`: the offset of each line's first character; `located`: of an expanded text, function of a place
    in it: file, place and line as they were read.
    """

    def __init__(self, text: str, located: Callable[[Place], tuple[str, Place, str]] | None = None):
        self.text, self.located = text, located
        self.starts = array("i", [0])
        self._pieces: dict[int, list[str]] = {}
        self.starts.extend(found.end() for found in _LINE_END.finditer(text))

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        return Lines, (self.text, self.located)

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        piece, line = divmod(index % len(self), _AT_ONCE)
        # Readers go from line to line, builders through several sections at a time.
        if piece not in self._pieces:
            if len(self._pieces) >= _MOST_PIECES:
                self._pieces.pop(next(iter(self._pieces)))
            self._pieces[piece] = self._cut(piece * _AT_ONCE, min((piece + 1) * _AT_ONCE, len(self)))
        return self._pieces[piece][line]

    def __iter__(self) -> Iterator[str]:
        return self.after(0)

    def after(self, count: int) -> Iterator[str]:
        """Return the lines behind the first `count`."""
        ends = chain(range(count + _AT_ONCE, len(self), _AT_ONCE), (len(self),))
        pieces = zip(range(count, len(self), _AT_ONCE), ends, strict=False)
        return (line for first, end in pieces for line in self._cut(first, end))

    def between(self, first: int, end: int) -> str:
        """Return the text from line `first` to before line `end`, its lines ended by LF."""
        piece = self.text[self.start_of(first) : self.start_of(end)]
        return piece.replace("\r\n", "\n").replace("\r", "\n")

    def start_of(self, index: int) -> int:
        """Return where a line begins, the end of the text behind the last."""
        return self.starts[index] if index < len(self) else len(self.text)

    def place_of(self, offset: int) -> tuple[int, int]:
        """Return line and column of a character, counted from 1."""
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    def end(self) -> tuple[int, int]:
        """Return line and column just after the last character that is neither blank nor a line end."""
        return self.place_of(len(self.text.rstrip())) if self.text.strip() else (1, 1)

    def reported(self, place: Place) -> str:
        """Return the line of a place as it was read: its number, and the file where it is not the deck's."""
        file, read, _ = self.located(place) if self.located else ("", place, "")
        return f"{file}:{read.line}" if file else str(read.line)

    def _cut(self, first: int, end: int) -> list[str]:
        piece = self.text[self.starts[first] : self.start_of(end)]
        lines = piece.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        return lines[: end - first]


def as_lines(lines: Sequence[str]) -> Lines:
    """Return lines of any type as `Lines`."""
    return lines if isinstance(lines, Lines) else Lines("\n".join(lines))
