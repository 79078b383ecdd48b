"""Lines of a file and of the files that it includes, each with its own file and number.

Names are relative to the folder of the file that names them.  They come from files that may be untrusted:
each is opened as `file_text` opens files, none may include itself, and depth, number and length are bounded.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from .file_text import LARGEST_FILE, line_fault, lines_of
from .matrix_file import FEFileFault

DEEPEST, MOST_FILES = 10, 1000


class Line(NamedTuple):
    """A line of a file."""

    name: str  # of the file, without its folder
    number: int  # from 1
    text: str

    def fault(self, message: str, *, id: str) -> FEFileFault:
        """Return the fault of this line."""
        return line_fault(self.name, self.number, message, id=id)


class Inclusion(NamedTuple):
    """A statement that names a file to be read in its place, or after it."""

    file: str
    lines: int  # that the statement takes
    kept: bool = False  # whether the statement itself is read, too


Finder = Callable[[list[str], int], Inclusion | None]


def lines_with_included(path: Path, find: Finder) -> Iterator[Line]:
    """Yield the lines of `path` and of the files that it includes.  Raises FEFileFault.

    `find` returns the inclusion that begins at a line, counted from 0, of all lines of its file.
    """
    yield from _lines(path, lines_of(path), find, (path.resolve(),), [MOST_FILES, LARGEST_FILE])


def _lines(
    path: Path, lines: list[str], find: Finder, above: tuple[Path, ...], left: list[int]
) -> Iterator[Line]:
    """Yield lines; `above`: the files that are being read, `left`: files and characters still allowed."""
    at = 0
    while at < len(lines):
        found = find(lines, at)
        first, at = at, at + (found.lines if found else 1)
        if found is None or found.kept:
            yield from (Line(path.name, i + 1, lines[i]) for i in range(first, at))
        if found:
            file = path.parent / found.file.replace("\\", "/")
            inner = _opened(path.name, first + 1, file, above, left)
            yield from _lines(file, inner, find, (*above, file.resolve()), left)


def _opened(name: str, number: int, file: Path, above: tuple[Path, ...], left: list[int]) -> list[str]:
    """Return the lines of `file`, which line `number` of the file `name` includes."""
    if len(above) > DEEPEST or min(left) <= 0:
        limits = f"{DEEPEST} files deep, {MOST_FILES} files or {LARGEST_FILE // 2**30} GB"
        message = f"inclusions go beyond {limits}; join the files to one"
        raise line_fault(name, number, message, id="FE-150")
    try:
        lines = lines_of(file)
    except FEFileFault as fault:
        raise line_fault(name, number, f"the file included here: {fault}", id="FE-151") from None
    if file.resolve() in above:
        message = f"{file.name} includes itself, at once or by other files; remove this line"
        raise line_fault(name, number, message, id="FE-152")
    left[0] -= 1
    left[1] -= sum(map(len, lines))
    return lines
