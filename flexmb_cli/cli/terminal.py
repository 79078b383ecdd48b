"""What is printed: strangers' texts and file names command no terminal; files and pipes get every byte."""

import sys

import click

from ..errors import visible


class TerminalText:
    """A text stream that marks what would steer the terminal behind `stream`."""

    def __init__(self, stream):
        self._stream = stream

    def write(self, text: str) -> int:
        """Write `text` with marks."""
        self._stream.write(lines_visible(text))
        return len(text)

    def flush(self) -> None:
        """Hand what is buffered to the terminal."""
        self._stream.flush()


def wants_debug() -> bool:
    """Whether faults of flexmb itself are to be shown with their traceback."""
    return "--debug" in sys.argv


def standard_output():
    """Standard output; where it is a terminal, with marks."""
    return TerminalText(sys.stdout) if sys.stdout.isatty() else sys.stdout


def lines_visible(text: str) -> str:
    """`visible` of every line."""
    return "\n".join(map(visible, text.split("\n")))


def tell(sentence: str) -> None:
    """A sentence on standard error; a line break within a file name is marked, too."""
    click.echo(visible(sentence), err=True)


def show(text: str, err: bool = False) -> None:
    """Lines of a report on standard output, or on standard error."""
    stream = sys.stderr if err else sys.stdout
    click.echo(lines_visible(text) if stream.isatty() else text, nl=False, err=err)
