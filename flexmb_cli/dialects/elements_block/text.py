"""Text of the block ELEMENTS: its lines without comments, cut into pieces, and where it ends."""

import re
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from itertools import chain

from ...deck.record import Lines
from ...deck.words import Word
from ...errors import Fault, Place

BLOCK = "ELEMENTS"
# A piece has no blanks outside its parentheses.
_PIECE = re.compile(r"(?:\([^()]*\)|[^\s()])+|[()]")
_BRACES = re.compile(r"\{[^}]*\}?")
_MENTIONED = re.compile(rf"{BLOCK}|=|^[ \t]*FUNCTION\b", re.IGNORECASE | re.MULTILINE)
_LIKENESS = 0.75  # of ELEMENTS: two letters changed


def mentions_block(text: str, start: int = 0) -> bool:
    """Return whether a text may hold a block, or a line of one, from a character on."""
    return _MENTIONED.search(text, start) is not None


def begins_block(line: str) -> bool:
    """Return whether a line, without comments, opens a block: the word alone, in column 1."""
    return line[:1] in "Ee" and line.strip().upper() == BLOCK


def is_like_block(line: str) -> bool:
    """Return whether a line in column 1 is a misspelt opening of a block."""
    from difflib import SequenceMatcher

    word = line.strip().upper()
    if line[:1].isspace() or not word.isalpha() or not 6 <= len(word) <= 10 or word == BLOCK:
        return False
    return SequenceMatcher(None, word, BLOCK).ratio() >= _LIKENESS


def without_braces(lines: Lines, first: int) -> Iterator[str]:
    """The lines from one on, comments in braces being blank.

    The line of a comment that nothing closes is a brace alone, in column 1, which ends a block.
    """
    unclosed = lines.text.find("{", lines.text.rfind("}") + 1)
    last = lines.place_of(unclosed)[0] if unclosed >= 0 else 0
    inside = False
    for n, line in enumerate(lines.after(first), first + 1):
        if n == last:
            yield "{"
            return
        line = "{" + line if inside else line
        blank = _BRACES.sub(lambda found: " " * len(found[0]), line)
        opening = line.rfind("{")
        yield blank[1:] if inside else blank
        inside = opening >= 0 and "}" not in line[opening:]


def without_starred(lines: Lines, first: int) -> Iterator[str]:
    """The lines from one on; those that begin with an asterisk are blank."""
    return ("" if line.startswith("*") else line for line in lines.after(first))


def uncommented(lines: Lines, first: int) -> Iterator[str]:
    """The lines from one on, of a dialect without comments."""
    return lines.after(first)


def statements(code: Iterator[str], first: int) -> Iterator[tuple[list[Word], int]]:
    """The pieces of each element of the block whose lines without comments `code` gives from line `first` on.

    Lines that are indented further than that on which an element begins continue it.  With each goes the
    number of the line after it; the last, without pieces, has that of the line which ends the block.
    """
    words: list[Word] = []
    indent, n = 0, first - 1
    for n, line in enumerate(chain(code, ["END"]), first):
        if not line.strip():
            continue
        if not line[0].isspace():
            break
        depth = len(line.expandtabs()) - len(line.expandtabs().lstrip())
        if words and depth <= indent:
            yield words, n
            words = []
        if not words:
            indent = depth
        words += [Word(match[0], n, match.start() + 1) for match in _PIECE.finditer(line)]
    if words:
        yield words, n
    yield [], n


@cache
def _element_pattern() -> re.Pattern[str]:
    """Return what lines of elements look like: a word, a name, and a key or what the word takes."""
    from .words import WORDS

    ways = []
    for word in WORDS:
        keys = [f"{key.name}=" for key in word.keys] or [r"[0-9]+\.(?:angle[12]?|stroke|[rt][1-3])="]
        kinds = [rf"{kind}\b" for kind in word.kinds]
        ways.append(rf"{word.word}(?:[ \t]+[\w-]+)?[ \t]+(?:{'|'.join([*kinds, *keys])})")
    return re.compile(rf"[ \t]*({'|'.join(ways)})")


def is_element_line(line: str) -> bool:
    """Return whether a line has the form of an element's."""
    return _element_pattern().match(line) is not None


def stray_lines(lines: Iterable[tuple[int, str]]) -> Iterator[Fault]:
    """Refuse lines of elements among numbered lines outside blocks."""
    for n, line in lines:
        if is_element_line(line):
            word = line.split(maxsplit=1)[0]
            message = f"{word} stands outside a block; a line {BLOCK} before it, in column 1, opens one"
            yield Fault("error", message, Place(n, line.index(word) + 1, len(word)), id="ELEMENTS-035")


def element_follows(lines: Lines, code: Callable[[Lines, int], Iterator[str]], opening: int) -> bool:
    """Return whether the line after another one that is not blank has the form of an element's."""
    line = next((line for line in code(lines, opening) if line.strip()), "")
    return line[:1].isspace() and is_element_line(line)


def refuse_after(
    lines: Lines, code: Callable[[Lines, int], Iterator[str]], last: int, word: str
) -> Iterator[Fault]:
    """Refuse blocks and lines of elements after line `last`, after whose `word` nothing is read."""
    if not mentions_block(lines.text, lines.start_of(last)):
        return
    inside = False
    for n, line in enumerate(code(lines, last), last + 1):
        if begins_block(line) and element_follows(lines, code, n):
            message = f"{BLOCK} stands after {word}, where nothing is read; put the block before {word}"
            yield Fault("error", message, Place(n, 1, len(BLOCK)), id="ELEMENTS-036")
            inside = True
        elif line.strip() and not (inside and line[0].isspace()):
            inside = False
            yield from stray_lines([(n, line)])
