"""List-directed reading: the words of a deck in order, each with its line and column.

Blanks, tabs and line ends separate words; `{...}` is a comment wherever it stands, over any number
of lines, and does not nest.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import repeat
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
    for number, start, texts in _by_lines(lines):
        columns = _columns(lines[number - 1], start) if texts != [UNCLOSED] else [start + 1]
        for text, column in zip(texts, columns, strict=True):
            yield Word(text, number, column)


class Words:
    """The words of `lines` as in `words`, in large numbers: each is placed only when it is looked at."""

    def __init__(self, lines: Sequence[str]):
        self.texts: list[str] = []
        self._lines = lines
        self._unread = _by_lines(lines)
        self._first: list[int] = []  # of the words of each line that has any
        self._begun: list[tuple[int, int]] = []  # number of that line, and where its words begin
        self._placed: dict[int, list[int]] = {}

    def __getstate__(self):
        """For another process: what is read so far."""
        return vars(self) | {"_unread": iter(())}

    def reach(self, wanted: int) -> None:
        """Read on until there are `wanted` words, or no more."""
        while len(self.texts) < wanted and (line := next(self._unread, None)):
            number, start, texts = line
            self._first.append(len(self.texts))
            self._begun.append((number, start))
            self.texts += texts

    def __getitem__(self, index: int) -> Word:
        text, line = self.texts[index], bisect_right(self._first, index) - 1
        number, start = self._begun[line]
        is_first = index == self._first[line]
        if text == UNCLOSED or (is_first and self._lines[number - 1].startswith(text, start)):
            return Word(text, number, start + 1)
        if is_first:
            return Word(text, number, next(_columns(self._lines[number - 1], start)))
        return Word(text, number, self._columns_of(line)[index - self._first[line]])

    def upto(self, end: int) -> list[Word]:
        """The first `end` words."""
        found: list[Word] = []
        for line, first in enumerate(self._first[: bisect_right(self._first, end - 1)]):
            texts = self.texts[first : self._first[line + 1] if line + 1 < len(self._first) else None]
            found += map(Word, texts, repeat(self._begun[line][0]), self._columns_of(line))
        return found[:end]

    def _columns_of(self, line):
        # All of the line at once: it may hold the whole deck.
        if line not in self._placed:
            number, start = self._begun[line]
            self._placed[line] = list(_columns(self._lines[number - 1], start))
        return self._placed[line]


def _by_lines(lines) -> Iterator[tuple[int, int, list[str]]]:
    """Number of each line that has words, where in it they begin to stand, and the words."""
    opened = None
    for number, line in enumerate(lines, start=1):
        start = 0
        if opened:
            start = line.find("}") + 1
            if not start:
                continue
            opened = None
        texts = _WORD_OR_COMMENT.findall(line, start)
        if "{" in line:
            if texts and texts[-1][0] == "{" and texts[-1][-1] != "}":
                opened = number, len(line) - len(texts[-1]), [UNCLOSED]
            texts = [text for text in texts if text[0] != "{"]
        if texts:
            yield number, start, texts
    if opened:
        yield opened


def _columns(line, start):
    """Columns of the words that stand in `line` from `start` on."""
    for found in _WORD_OR_COMMENT.finditer(line, start):
        if found.group()[0] != "{":
            yield found.start() + 1


def end_of(lines: Sequence[str]) -> Place:
    """The place just after the last character of the deck that is no blank or line end."""
    number = next((n for n in range(len(lines), 0, -1) if lines[n - 1].strip()), 1)
    last = lines[number - 1].rstrip() if lines else ""
    return Place(number, len(last) + 1)
