"""Lines of a file and of the files that it includes, each with its own file and number.

Names are relative to the folder of the file that names them.  They come from files that may be untrusted:
each is opened as `file_text` opens files, none may include itself, and depth, number and length are bounded.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from .file_text import LARGEST_FILE, line_fault, lines_of
from .matrix_file import FEFileFault

DEEPEST_INCLUSION, MOST_FILES = 10, 1000


class Line(NamedTuple):
    """A line of a file."""

    name: str  # of the file, without its folder
    number: int  # from 1
    text: str  # without its line end

    def fault(self, message: str, *, id: str) -> FEFileFault:
        """Return the fault of this line."""
        return line_fault(self.name, self.number, message, id=id)


def _lines(path: Path) -> Iterator[Line]:
    return iter([Line(path.name, i, text) for i, text in enumerate(lines_of(path), start=1)])


class IncludedLines:
    """An iterator of lines, into which a reader puts those of other files."""

    def __init__(self, path: Path) -> None:
        """Begin with the lines of `path`.  Raises FEFileFault."""
        self._files = [(path.resolve(), _lines(path))]
        self._left = [MOST_FILES, LARGEST_FILE]  # files and bytes still allowed

    def __iter__(self) -> Iterator[Line]:
        return self

    def __next__(self) -> Line:
        while (line := next(self._files[-1][1], None)) is None and len(self._files) > 1:
            self._files.pop()
        if line is None:
            raise StopIteration
        return line

    def include(self, name: str, line: Line) -> None:
        """Continue with the lines of the file `name`, which `line` names.  Raises FEFileFault."""
        path = self._files[-1][0].parent / name.replace("\\", "/")
        if len(self._files) > DEEPEST_INCLUSION or min(self._left) <= 0:
            limits = f"{DEEPEST_INCLUSION} files deep, {MOST_FILES} files or {LARGEST_FILE // 2**30} GB"
            raise line.fault(f"inclusions go beyond {limits}; join the files to one", id="FE-150")
        try:
            lines = _lines(path)
        except FEFileFault as fault:
            raise line.fault(f"the file included here: {fault}", id="FE-151") from None
        if path.resolve() in [file for file, _ in self._files]:
            message = f"{path.name} includes itself, at once or by other files; remove this line"
            raise line.fault(message, id="FE-152")
        self._left = [self._left[0] - 1, self._left[1] - path.stat().st_size]
        self._files.append((path.resolve(), lines))
