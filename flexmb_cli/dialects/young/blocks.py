"""Blocks ELEMENTS of a YOUNG deck: right behind dT, or among the cards of DYNAMICS."""

import re

from ...deck.lines import Lines
from ...deck.record import DeckText
from ...errors import Fault, Place
from ..elements_block.reader import BlockReader
from ..elements_block.text import begins_block, element_follows, stray_lines, without_braces
from .cards import CARDS
from .sections import YOUNG_SECTIONS


def block_reader(source: DeckText) -> BlockReader:
    """The reader of the blocks of a deck."""
    sections = [*(section.name for section in YOUNG_SECTIONS), *(card.section for card in CARDS)]
    return BlockReader(source.lines, without_braces, [*sections, "dynamics", "geometry"])


def read_blocks_after(reader: BlockReader, last: int, marker: re.Pattern[str]) -> int:
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
        if begins_block(line) and (first or element_follows(lines, without_braces, n)):
            behind = reader.read(n) - 1
            reader.faults += _unclosed(lines, behind)
        else:
            prose.append((n, line))
        first = False
    reader.faults += stray_lines(prose)
    return behind


def _unclosed(lines: Lines, last: int) -> list[Fault]:
    """Refuse a comment that nothing closes, where it ends a block behind line `last`."""
    if next(without_braces(lines, last), "") != "{":
        return []
    place = Place(*lines.place_of(lines.text.find("{", lines.text.rfind("}") + 1)))
    message = "a comment is opened here and never closed with }"
    return [Fault("error", message, place, id="YOUNG-169")]
