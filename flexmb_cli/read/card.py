"""List-directed reading: the words of a deck in order, each with its line and column.

Blanks, tabs and line ends separate words; `{...}` is a comment wherever it stands, over any number
of lines, and does not nest.
"""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ..errors import Place

_WORD_OR_COMMENT = re.compile(r"\{[^}]*\}?|[^\s{]+")
LONGEST_CARET = 40

UNCLOSED = "{"
"""The word that stands for a comment without end; nothing else yields a brace alone."""


class Word(NamedTuple):
    """A word of the deck; line and column count from 1."""

    text: str
    line: int
    column: int

    @property
    def place(self) -> Place:
        """Where the word stands, for messages."""
        return Place(self.line, self.column, min(len(self.text), LONGEST_CARET))


def words(lines: Sequence[str]) -> Iterator[Word]:
    """The words of `lines`, as far as they are asked for; the last may be `UNCLOSED`."""
    opened = None
    for number, line in enumerate(lines, start=1):
        start = 0
        if opened:
            start = line.find("}") + 1
            if not start:
                continue
            opened = None
        for found in _WORD_OR_COMMENT.finditer(line, start):
            text = found.group()
            if text[0] != "{":
                yield Word(text, number, found.start() + 1)
            elif text[-1] != "}":
                opened = Word(UNCLOSED, number, found.start() + 1)
    if opened:
        yield opened


def end_of(lines: Sequence[str]) -> Place:
    """The place just after the last character of the deck that is no blank or line end."""
    number = next((n for n in range(len(lines), 0, -1) if lines[n - 1].strip()), 1)
    last = lines[number - 1].rstrip() if lines else ""
    return Place(number, len(last) + 1)
