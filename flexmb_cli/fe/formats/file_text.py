"""Text of a file and tables of numbers in it; what cannot be read is reported with its line.

The names of these files come from decks, which may be untrusted: only regular files are opened, and
nothing larger than `LARGEST_FILE` is read.  Names of included files are relative to the folder of the file
that names them: none may include itself, and depth, number and length are bounded.
"""

import codecs
import os
import re
import stat
from collections.abc import Iterator, Sequence
from itertools import compress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .matrix_file import FEFileFault

LARGEST_FILE = 2**31  # bytes
_SHOWN = 40
# Numbers of nodes, rows and columns fit into int64 with room for a product by 3.
_INTEGER = re.compile(r"[+-]?[0-9]{1,15}", re.ASCII)
_REAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([EeDd]?[+-][0-9]+|[EeDd][0-9]+)?", re.ASCII)
_EXACT = 2.0**53
_COMMENT = re.compile(rb"^[ \t]*[%*$#].*$", re.MULTILINE)
# A final ".0" is no digit that a format asks for: shortest forms of round numbers have it too.
_FRACTION = re.compile(rb"([0-9]*)\.(?!0?(?![0-9]))([0-9]+)")
# So much of a file shows its format, bytes.
_SAMPLE = 2**20


def bytes_of(path: Path, largest: int = LARGEST_FILE) -> bytes:
    """Return what the file holds.  Raises FEFileFault when it cannot be read or is not below `largest`."""
    try:
        # A pipe without a writer would be waited for.
        with open(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)), "rb") as stream:
            status = os.fstat(stream.fileno())
            _check_kind(path.name, status, largest)
            # Some files of /proc have no length and no end, or nothing to give just now.
            return stream.read(status.st_size) or b""
    except FileNotFoundError:
        raise FEFileFault(f"{path.name}: no such file in {path.parent or '.'}", id="FE-023") from None
    except (OSError, ValueError) as fault:
        reason = getattr(fault, "strerror", None) or "the name is not a file name"
        raise FEFileFault(f"{path.name} cannot be read: {reason}", id="FE-024") from None


def _check_kind(name: str, status: Any, largest: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        raise FEFileFault(f"{name} is not a regular file, but a folder, a pipe or a device", id="FE-025")
    if status.st_size >= largest:
        size = f"{largest // 2**30} GB" if largest >= 2**30 else f"{largest // 2**20} MB"
        raise FEFileFault(f"{name} is larger than the {size} that can be read", id="FE-026")


def integer(text: str) -> int:
    """The integer of at most 15 digits that `text` spells; ValueError for any other spelling."""
    if _INTEGER.fullmatch(text.strip()) is None:
        raise ValueError(text)
    return int(text)


def real(text: str) -> float:
    """The number that `text` spells, its exponent by E, D or a sign alone; nan and inf are read as such.

    ValueError for any other spelling.
    """
    try:  # Python's spellings are most; it has underlines and other scripts' digits as well
        if "_" not in text and text.isascii():
            return float(text)
    except ValueError:
        pass
    text = text.strip()
    match = _REAL.fullmatch(text)
    if match is None:
        raise ValueError(text)
    exponent = (match[2] or "").lstrip("EeDd")
    return float(f"{text[: match.end(1)]}e{exponent or 0}")


def printed_digits(path: Path) -> int:
    """Significant digits of the longest real number at the beginning of a file, 0 of a binary one."""
    with open(path, "rb") as stream:
        sample = stream.read(_SAMPLE)
    return 0 if is_binary(sample) else digits_in(_COMMENT.sub(b"", sample))


def digits_in(text: bytes) -> int:
    """Significant digits of the longest real number."""
    numbers = _FRACTION.finditer(text)
    return max((len((number[1] + number[2]).lstrip(b"0")) for number in numbers), default=0)


def is_binary(raw: bytes) -> bool:
    """Return whether the file's beginning holds what no text does."""
    return b"\0" in raw[:65536]


def text_of(path: Path) -> str:
    """The file's text.  Raises FEFileFault when there is none, or it is binary."""
    raw = bytes_of(path).removeprefix(codecs.BOM_UTF8)
    if is_binary(raw):
        raise FEFileFault(f"{path.name} is a binary file; let the program write it as text", id="FE-027")
    return raw.decode("latin-1")


def lines_of(path: Path) -> list[str]:
    """The file's lines."""
    return text_of(path).splitlines()


def table(
    name: str, lines: list[str], numbers: Sequence[int], columns: int, meaning: str, comma: bool = False
) -> np.ndarray:
    """The numbers of `lines`, (len, columns) float64; D exponents are read as E.

    `numbers` are those of the lines in the file `name`, `meaning` is what a line holds, for the messages
    of FEFileFault.
    """
    if not lines:
        return np.empty((0, columns))
    delimiter = "," if comma else None
    values = _loaded(lines, delimiter)
    if values is None:
        lines = "\n".join(lines).replace("D", "E").replace("d", "e").split("\n")
        values = _loaded(lines, delimiter)
    if values is None or values.shape != (len(lines), columns) or not np.isfinite(values).all():
        raise _fault_of_lines(name, lines, numbers, columns, meaning, delimiter)
    return values


def _loaded(lines: list[str], delimiter: str | None) -> np.ndarray | None:
    try:
        return np.loadtxt(lines, ndmin=2, comments=None, delimiter=delimiter)
    except ValueError:
        return None


def _fault_of_lines(
    name: str, lines: list[str], numbers: Sequence[Any], columns: int, meaning: str, delimiter: str | None
) -> FEFileFault:
    """Return what is wrong with the first line that cannot be read."""
    for number, line in zip(numbers, lines, strict=False):
        words = [word.strip() for word in line.split(delimiter)]
        if len(words) != columns:
            return line_fault(
                name, number, f"expected {meaning}, {columns} numbers; read '{_short(line)}'", id="FE-103"
            )
        for word in words:
            if not _is_finite(word):
                return line_fault(
                    name, number, f"expected {meaning}; '{_short(word)}' is not a finite number", id="FE-104"
                )
    return FEFileFault(f"{name} cannot be read as {meaning}", id="FE-028")


def line_fault(name: str, number: int, message: str, *, id: str) -> FEFileFault:
    """The fault of one line of the file `name`."""
    return FEFileFault(f"{name}, line {number}: {message}", id=id)


def _is_finite(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def _short(text: str) -> str:
    text = text.strip()
    return text if len(text) <= _SHOWN else text[: _SHOWN - 1] + "…"


def whole(name: str, values: np.ndarray, numbers: Sequence[int], meaning: str) -> np.ndarray:
    """`values` (k, n) as int64; FEFileFault at the first line that has a fraction in them."""
    is_whole = (np.abs(values) < _EXACT) & (values == np.rint(values))
    wrong = np.flatnonzero(~is_whole.all(axis=1))
    if wrong.size:
        raise line_fault(name, numbers[int(wrong[0])], f"{meaning} must be whole numbers", id="FE-105")
    return values.astype(np.int64)


def check_range(name: str, entries: np.ndarray, numbers: Sequence[int], size: int) -> None:
    """FEFileFault at the first line with an index outside 1..size."""
    wrong = np.flatnonzero(((entries < 1) | (entries > size)).any(axis=1))
    if wrong.size:
        row, column = entries[wrong[0]]
        message = f"entry ({row}, {column}) lies outside the matrix of {size} rows"
        raise line_fault(name, numbers[int(wrong[0])], message, id="FE-106")


def filled(lines: list[str], comment: str = "", before: int = 0) -> tuple[list[str], Sequence[int]]:
    """The lines that are neither blank nor begin with `comment`, and their numbers in a file where `before`
    others precede them.
    """
    numbers: Sequence[int] = range(before + 1, before + len(lines) + 1)
    if all(map(str.strip, lines)) and not (comment and any(line.startswith(comment) for line in lines)):
        return lines, numbers
    is_filled = [line.strip() != "" and not (comment and line.startswith(comment)) for line in lines]
    return list(compress(lines, is_filled)), list(compress(numbers, is_filled))


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
