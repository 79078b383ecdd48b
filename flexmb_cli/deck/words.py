"""List-directed reading: the words of a deck in order, each with its line and column.

Blanks, tabs and line ends separate words; `{...}` is a comment wherever it stands, over any number
of lines, and does not nest.
"""

import re
from array import array
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from typing import Any, NamedTuple, cast

from ..errors import Place
from .record import Lines, as_lines

_WORD_OR_COMMENT = re.compile(r"\{[^}]*\}?|[^\s{]+")
# Where a word begins it always matches.
_match = cast("Callable[[str, int], re.Match[str]]", _WORD_OR_COMMENT.match)
LONGEST_CARET = 40

UNCLOSED = "{"
"""The word that stands for a comment without end; nothing else yields a brace alone."""


class Word(NamedTuple):
    """A word of the deck."""

    text: str  # without blanks
    line: int  # from 1
    column: int  # of its first character, from 1

    @property
    def place(self) -> Place:
        """Return where the word stands, for messages."""
        return Place(self.line, self.column, min(len(self.text), LONGEST_CARET))


def words(lines: Sequence[str], skipped: int = 0) -> Iterator[Word]:
    """The words after the first `skipped` lines, as they are requested; the last may be `UNCLOSED`."""
    lines = as_lines(lines)
    return words_from(lines, lines.start_of(skipped))


def words_from(lines: Lines, offset: int) -> Iterator[Word]:
    """The words after so many characters, as they are requested; the last may be `UNCLOSED`."""
    return (_word(lines, start) for start in _offsets(lines.text, offset))


class Words:
    """The words of `lines` as in `words`, in large numbers: each is cut out only when it is looked at."""

    def __init__(self, lines: Sequence[str]):
        self._lines = as_lines(lines)
        self._starts = array("i")
        self._unread = _offsets(self._lines.text, 0)

    def __getstate__(self) -> dict[str, Any]:
        """For another process: what is read so far."""
        return vars(self) | {"_unread": iter(())}

    def __len__(self) -> int:
        return len(self._starts)

    def __getitem__(self, index: int) -> Word:
        return _word(self._lines, self._starts[index])

    def reach(self, count: int) -> None:
        """Read on until there are `count` words, or no more."""
        self._starts.extend(islice(self._unread, max(0, count - len(self))))

    def drop_last(self) -> None:
        """Forget the last word."""
        self._starts.pop()

    def texts(self, first: int, end: int) -> list[str]:
        """The words from `first` to before `end`, without their places; no more than there are."""
        starts = self._starts[first:end]
        if not starts:
            return []
        text = self._lines.text
        piece = text[starts[0] : _match(text, starts[-1]).end()]
        if "{" not in piece:
            return piece.split()
        return [
            word if word[0] != "{" else UNCLOSED for word in _WORD_OR_COMMENT.findall(piece) if _is_word(word)
        ]

    def upto(self, end: int) -> Iterator[Word]:
        """The first `end` words."""
        return (self[index] for index in range(min(end, len(self))))


def _word(lines: Lines, start: int) -> Word:
    text = lines.text
    word = UNCLOSED if text[start] == UNCLOSED else _match(text, start).group()
    return Word(word, *lines.place_of(start))


def _is_word(text: str) -> bool:
    return text[0] != "{" or text == "{" or text[-1] != "}"


def _offsets(text: str, start: int) -> Iterator[int]:
    """Return where the words of `text` begin, and a comment without end."""
    for match in _WORD_OR_COMMENT.finditer(text, start):
        first, end = match.span()
        if text[first] != "{" or end == first + 1 or text[end - 1] != "}":
            yield first


def end_of(lines: Sequence[str]) -> Place:
    """The place just after the last character of the deck that is no blank or line end."""
    return Place(*as_lines(lines).end())
