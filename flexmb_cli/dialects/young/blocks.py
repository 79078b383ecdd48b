"""Blocks ELEMENTS of a YOUNG deck: right after dT, or among the cards of DYNAMICS."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from ...deck.number import shown
from ...deck.record import DeckText, Lines
from ...errors import Fault, Place
from ..elements_block.old_cards import LINES, refused
from ..elements_block.reader import BlockReader
from ..elements_block.text import begins_block, element_follows, stray_lines, without_braces
from .cards import CARDS
from .sections import YOUNG_SECTIONS


def block_reader(source: DeckText) -> BlockReader:
    """The reader of the blocks of a deck."""
    sections = [*(section.name for section in YOUNG_SECTIONS), *(card.section for card in CARDS)]
    return BlockReader(source.lines, without_braces, [*sections, "dynamics", "geometry"])


def read_blocks_after(reader: BlockReader, last: int, marker: re.Pattern[str]) -> int:
    """Read the blocks after line `last`, that of dT, up to the line that opens cards.

    Return the last line that is read.  What stands there besides is prose, in which the word alone opens no
    block; lines of elements outside blocks are faults.
    """
    lines = reader.lines
    first, last_read, prose = True, last, []
    for n, line in enumerate(without_braces(lines, last), last + 1):
        if n <= last_read or not line.strip():
            continue
        if marker.fullmatch(line):
            break
        if begins_block(line) and (first or element_follows(lines, without_braces, n)):
            last_read = reader.read(n) - 1
            reader.faults += _unclosed(lines, last_read)
        else:
            prose.append((n, line))
        first = False
    reader.faults += stray_lines(prose)
    return last_read


def _unclosed(lines: Lines, last: int) -> list[Fault]:
    """Refuse a comment that nothing closes, where it ends a block after line `last`."""
    if next(without_braces(lines, last), "") != "{":
        return []
    place = Place(*lines.place_of(lines.text.find("{", lines.text.rfind("}") + 1)))
    message = "a comment is opened here and never closed with }"
    return [Fault("error", message, place, id="YOUNG-169")]


_COMMENT = re.compile(r"\{[^}]*\}")
_OPENING = "DYNAMICS"
# One word, one more after it, or anything where that is the name of an analysis.
_LIKE_OPENING = re.compile(
    r"^[ \t]*(([A-Z]{6,10})(?:[^\w\n]{1,9}(?:INVERSE|FORWARD)\b[^\n]*|[^\w\n]*|[^\w\n]{1,9}[A-Z]+[^\w\n]*))$",
    re.IGNORECASE | re.MULTILINE,
)
_LEAST_LIKENESS = 0.75  # of DYNAMICS: two letters changed
OLD_WORDS = LINES["young"]
_NUMBER = r"[-+]?\.?\d[-+.\deEdD]*"


def unread_lines(lines: Lines, last_read: int, keywords: Iterable[str]) -> Iterator[Fault]:
    """Warn of the lines after line `last_read` of a deck without dynamic cards that look like such cards."""
    slips = list(_like_openings(lines, last_read))
    message = (
        "is read as prose: a card needs the line DYNAMICS inverse, DYNAMICS forward or GEOMETRY before it"
    )
    # Cards after a misspelt opening line have that one cause.
    return iter(slips) if slips else _cards(lines, last_read, keywords, message, id="YOUNG-156")


def _like_openings(lines: Lines, last_read: int) -> Iterator[Any]:
    text, start = _without_comments(lines, last_read)
    for match in _LIKE_OPENING.finditer(text):
        if _is_like_opening(match[2]):
            message = (
                f"{shown(match[1].strip())} is read as prose; DYNAMICS inverse or DYNAMICS forward, alone on "
                "its line, opens cards with masses and loads"
            )
            place = Place(*lines.place_of(start + match.start(1)), len(match[1].rstrip()))
            yield Fault("warning", message, place, id="YOUNG-019")


def cards_after_end(lines: Lines, last_read: int, keywords: Iterable[str]) -> Iterator[Fault]:
    """Warn of cards after line `last_read`, which holds END."""
    message = "stands after END and is not read: put it before END"
    yield from _cards(lines, last_read, keywords, message, id="YOUNG-178")


def _cards(lines: Lines, last_read: int, keywords: Iterable[str], message: str, *, id: str) -> Iterator[Any]:
    text, start = _without_comments(lines, last_read)
    counts: dict[str, int] = {}
    card = rf"^[ \t]*({'|'.join((*keywords, *OLD_WORDS))})[ \t]+{_NUMBER}(?:[ \t]+{_NUMBER})*[ \t]*$"
    for match in re.finditer(card, text, re.IGNORECASE | re.MULTILINE):
        place = Place(*lines.place_of(start + match.start(1)), len(match[1]))
        word = match[1].upper()
        if word in OLD_WORDS:
            cards = refused("young", word, [(place, match[0].split()[1:])], counts)
            yield from (replace(fault, severity="warning") for fault in cards)
        else:
            yield Fault("warning", f"{word} {message}", place, id=id)


def _without_comments(lines: Lines, last_read: int) -> tuple[Any, Any]:
    """The text after a line with blanks for comments and one type of line end, and where it starts."""
    start = lines.start_of(last_read)
    text = lines.text[start:].replace("\r", "\n")
    # A crowd of braces that nothing closes would be searched to the end of the text, each of them.
    closed = text.rfind("}") + 1
    return _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), text[:closed]) + text[
        closed:
    ], start


def _is_like_opening(word: str) -> bool:
    from difflib import SequenceMatcher

    return SequenceMatcher(None, word.upper(), _OPENING).ratio() >= _LEAST_LIKENESS
