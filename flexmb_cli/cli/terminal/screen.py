"""Safe printing: texts of decks and file names control no terminal; tables reach pipes unchanged."""

import errno
import io
import os
import re
import sys
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click

from ...errors import lines_visible, visible
from ...run.outcome import StreamError

COLUMN_GAP = re.compile(r"\S {2,}\S")


class OutputText:
    """Standard output for the table of a run; what would steer a terminal behind it is marked.

    Its OSErrors become StreamErrors: they end the command, and not the deck alone.
    """

    def __init__(self, stream: Any):
        self._stream = stream
        self._shown = lines_visible if stream.isatty() else str

    def write(self, text: str) -> int:
        """Write `text`."""
        with _as_stream_error():
            self._stream.write(self._shown(text))
        return len(text)

    def flush(self) -> None:
        """Hand what is buffered to the reader."""
        with _as_stream_error():
            self._stream.flush()


@contextmanager
def _as_stream_error() -> Iterator[None]:
    try:
        yield
    except OSError as fault:
        raise StreamError(*fault.args) from fault


def wants_debug() -> bool:
    """Return whether faults of flexmb itself are to be shown with their traceback."""
    return "--debug" in sys.argv


def standard_output() -> OutputText:
    """Standard output as a text stream."""
    return OutputText(sys.stdout)


def notify(sentence: str) -> None:
    """A sentence on standard error; a line break within a file name is marked, too."""
    say(visible(sentence))


def say(text: str) -> None:
    """Messages on standard error; on a terminal their sentences wrap between words.

    Lines that begin with a blank are those of a deck, and the marks below them: they stay.
    """
    if sys.stderr.isatty():
        width = terminal_width(sys.stderr)
        lines = text.splitlines()
        text = "\n".join(line if line[:1].isspace() else _wrapped_line(line, width) for line in lines)
    click.echo(text, err=True)


def show(text: str, err: bool = False, whole: bool = False, prose: bool = False) -> None:
    """Lines of a report on standard output, or on standard error; a pipe may well lead to a terminal.

    `whole`: no column is left out at a narrow terminal.  `prose`: lines without columns wrap between words.
    """
    stream = sys.stderr if err else sys.stdout
    text = lines_visible(text)
    if stream.isatty() and not whole:
        width = terminal_width(stream)
        text = fitted(text if not prose else wrapped(text, width), width)
    click.echo(text, nl=False, err=err)


def terminal_width(stream: Any) -> int:
    """Return the columns of the terminal behind `stream`; COLUMNS overrules it, and 80 is the last resort."""
    given = os.environ.get("COLUMNS", "")
    if given.isdecimal() and int(given):
        return int(given)
    try:
        return os.get_terminal_size(stream.fileno()).columns or 80
    except (OSError, ValueError):
        return 80


def fitted(text: str, width: int) -> str:
    """Return `text` with the columns left out that do not fit, so that no number is broken at the edge.

    A line of a table is known by gaps of two blanks and more; lines of prose stay, since words may wrap.
    """
    return "".join(_fitted_line(line, width) for line in text.splitlines(keepends=True))


def wrapped(text: str, width: int) -> str:
    """Return `text` with lines of prose wrapped between words, two columns further in than they begin."""
    return "".join(_wrapped_line(line, width) for line in text.splitlines(keepends=True))


def _wrapped_line(line: str, width: int) -> str:
    bare = line.rstrip("\n")
    if len(bare) <= width or COLUMN_GAP.search(bare):
        return line
    indent = " " * (len(bare) - len(bare.lstrip()) + 2)
    parts = textwrap.wrap(
        bare, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
    return "\n".join(parts) + line[len(bare) :]


def _fitted_line(line: str, width: int) -> str:
    bare = line.rstrip("\n")
    if len(bare) <= width or not COLUMN_GAP.search(bare):
        return line
    # The gap after the last cell that fits, with room for the mark; a cell of prose is cut between words.
    end = bare.rfind("  ", 0, width)
    cell = re.split(r" {2,}", bare[end:].strip())[0] if end >= 0 else ""
    if len(cell.split()) > 2:
        end = bare.rfind(" ", 0, width - 1)
    return f"{bare[:end].rstrip()} …{line[len(bare) :]}" if end > 0 and bare[:end].strip() else line


class WrongCall(click.UsageError):
    """Options or arguments that a command refuses; `id` is the fault's.

    What click itself refuses, such as an unknown option, has the identifier of `_refuse_usage`.
    """

    def __init__(self, message: str, ctx: click.Context | None = None, *, id: str):
        super().__init__(message, ctx)
        self.id = id


CLOSED = "standard output is closed, so nothing can be printed"


class _ClosedFile(io.FileIO):
    """A file that cannot be written, open on the null device so that no other file gets its number."""

    def write(self, content: Any) -> int:
        """Refuse whatever is to be written."""
        if not len(content):  # click tries so what a stream takes
            return 0
        raise OSError(errno.EBADF, CLOSED)


def closed_output() -> io.TextIOWrapper:
    """Return a stream in the place of standard output; writing to it raises OSError at once."""
    file: Any = _ClosedFile(os.devnull, "w")
    return io.TextIOWrapper(file, encoding="utf-8", write_through=True)
