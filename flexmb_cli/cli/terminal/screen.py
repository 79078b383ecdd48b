"""What is printed: strangers' texts and file names command no terminal; tables reach pipes unchanged."""

import sys
from contextlib import contextmanager

import click

from ...errors import lines_visible, visible
from ...run.exit_status import StreamError


class OutputText:
    """Standard output for the table of a run; what would steer a terminal behind it is marked.

    Its OSErrors become StreamErrors: they end the command, and not the deck alone.
    """

    def __init__(self, stream):
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
def _as_stream_error():
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


def tell(sentence: str) -> None:
    """A sentence on standard error; a line break within a file name is marked, too."""
    click.echo(visible(sentence), err=True)


def show(text: str, err: bool = False) -> None:
    """Lines of a report on standard output, or on standard error; a pipe may well lead to a terminal."""
    click.echo(lines_visible(text), nl=False, err=err)
