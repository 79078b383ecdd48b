"""Blocks ELEMENTS of a YOUNG deck: right behind dT, or among the cards of DYNAMICS."""

import re
from collections.abc import Iterator
from typing import Any

from ...deck.lines import Lines
from ...deck.record import DeckText
from ...errors import Fault, Place
from ..elements_block.reader import BlockReader
from ..elements_block.text import BLOCK, begins_block, is_element_line, stray_lines, without_braces
from .cards import CARDS
from .sections import YOUNG_SECTIONS

__all__ = ["block_reader", "read_blocks_behind", "refuse_behind_end", "stray_lines"]


def block_reader(source: DeckText) -> BlockReader:
    """The reader of the blocks of a deck."""
    sections = [*(section.name for section in YOUNG_SECTIONS), *(card.section for card in CARDS)]
    return BlockReader(source.lines, without_braces, [*sections, "dynamics", "geometry"])


def read_blocks_behind(reader: BlockReader, last: int, marker: re.Pattern[str]) -> int:
    """Read the blocks behind line `last`, that of dT, up to the line that opens cards.

    Return the last line that is read.  What stands there besides is prose, in which the word alone opens no
    block; lines of elements outside blocks are faults.
    """
    lines = reader.lines
    first, behind, prose = True, last, []
    for n, line in enumerate(without_braces(lines, last), last + 1):
        if n <= behind or not line.strip():
            continue
        if marker.fullmatch(line):
            break
        if begins_block(line) and (first or _element_follows(lines, n)):
            behind = reader.read(n) - 1
        else:
            prose.append((n, line))
        first = False
    reader.faults += stray_lines(prose)
    return behind


def _element_follows(lines: Lines, opening: int) -> bool:
    """Return whether a line of an element follows the word that would open a block."""
    following = (line for line in without_braces(lines, opening) if line.strip())
    line = next(following, "")
    return line[:1].isspace() and is_element_line(line)


def refuse_behind_end(lines: Lines, last: int) -> Iterator[Fault]:
    """Refuse blocks and lines of elements behind the line that holds END."""
    message = f"{BLOCK} stands behind END, where nothing is read; put the block before END"
    prose: list[Any] = []
    inside = False
    for n, line in enumerate(without_braces(lines, last), last + 1):
        if begins_block(line) and _element_follows(lines, n):
            yield Fault("error", message, Place(n, 1, len(BLOCK)), id="YOUNG-180")
            inside = True
        elif inside and (not line.strip() or line[0].isspace()):
            continue
        else:
            inside = False
            prose.append((n, line))
    yield from stray_lines(prose)
