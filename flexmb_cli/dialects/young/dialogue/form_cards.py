"""Questions of `flexmb new young` behind dT: an analysis, then card by card, and the lines they give."""

from collections.abc import Iterator, Sequence

from ....deck.questions import INTEGER, REAL, TEXT, WORD, Cell, Entry
from ....deck.record import Number, Record
from ....errors import Fault
from ...elements_block.form import LINES, block_lines, line_entries
from ...elements_block.text import BLOCK
from ..card import Card
from ..cards import BY_KEYWORD, CARDS
from ..dynamic_cards import FORWARD, INVERSE, LAST_CARD
from ..sections import Column
from ..shape_cards import SHAPE_CARDS

OPENING, NEXT_CARD, SHAPES = "opening", "card", "GEOMETRY"
_ANALYSES = (FORWARD.upper(), INVERSE.upper(), SHAPES)
_CARD_OF = {card.section: card for card in CARDS}
# Points of action and ends are at the origin of their body where nothing else is said.
_AT_ORIGIN = {f"{point}.{axis}" for point in ("P", "P_i", "P_j", "centre") for axis in "xyz"}
OPENING_ENTRY = Entry(
    OPENING,
    0,
    "cards behind dT",
    (
        Cell(
            "analysis",
            f"FORWARD or INVERSE dynamics, or {SHAPES}: shapes alone",
            letter=WORD,
            default=_ANALYSES[0],
            words=_ANALYSES,
        ),
    ),
)


def card_entries(values: dict[str, str]) -> Iterator[Entry]:
    """Yield the questions for the keywords of cards and for their numbers, as far as the answers go."""
    shapes = values.get(f"{OPENING}.analysis", "").upper() == SHAPES
    counted: dict[str, int] = {}
    lines = 0
    for k in range(1, len(values) + 2):
        asked = _which_card(k, shapes)
        yield asked
        word = values.get(f"{asked.prefix}.keyword", "").upper()
        if word == BLOCK:
            lines += 1
            yield list(line_entries(lines))[-1]
            continue
        card = BY_KEYWORD.get(word)
        if card is None:
            return
        counted[card.section] = counted.get(card.section, 0) + 1
        if card.columns:
            yield _card_entry(card, counted[card.section])


def _which_card(k: int, shapes: bool) -> Entry:
    words = (*(card.keyword for card in (SHAPE_CARDS if shapes else CARDS)), LAST_CARD)
    meaning = f"keyword of the next card, {LAST_CARD} behind the last"
    if not shapes:
        words, meaning = (BLOCK, *words), f"{meaning}, {BLOCK} for a line of that block"
    cell = Cell("keyword", meaning, "", WORD, LAST_CARD, words)
    return Entry(NEXT_CARD, k, f"card {k}", (cell,))


def _card_entry(card: Card, k: int) -> Entry:
    required = len(card.columns) - card.optional
    cells = tuple(_cell(column, index >= required) for index, column in enumerate(card.columns))
    return Entry(card.section, k, f"{card.section} {k}", cells)


def _cell(column: Column, optional: bool) -> Cell:
    letter = TEXT if column.is_text else INTEGER if column.is_integer else REAL
    default = "0" if optional or column.key in _AT_ORIGIN else None
    return Cell(column.key, column.meaning, column.unit, letter, default)


def is_card(record: Record) -> bool:
    """Return whether a record stands behind dT."""
    return record.section in _CARD_OF or record.section in (OPENING, NEXT_CARD, LINES)


def faults_of_card(record: Record, bodies: int) -> list[Fault]:
    """Body numbers; `flexmb check` finds all other faults."""
    faults = []
    for value in record.numbers:
        if value.key in ("body", "I", "J"):
            faults += _outside(record, value, bodies)
    return faults


def _outside(record: Record, value: Number, bodies: int) -> list[Fault]:
    least = 0 if "0: " in value.meaning else 1
    if least <= value.value <= bodies:
        return []
    message = f"body number {value.text} is outside {least}..{bodies}"
    return [Fault("error", message, value.place, record.subject, id="YOUNG-160")]


def card_lines(records: Sequence[Record]) -> Iterator[tuple[str, str]]:
    """Yield the lines of the records behind dT, with the prefix of each line's record."""
    analysis = next((record["analysis"] for record in records if record.section == OPENING), "")
    if not analysis:
        return
    yield "", ""
    yield (SHAPES if analysis == SHAPES else f"DYNAMICS {analysis.lower()}"), OPENING
    section = ""
    for record in records:
        if record.section in _CARD_OF:
            if record.section != section:
                section = record.section
                yield f"{{ {' '.join(value.key for value in record.numbers)} }}", ""
            texts = (value.text for value in record.numbers)
            yield f"{_CARD_OF[section].keyword} {' '.join(texts)}", record.prefix
        elif record.section == NEXT_CARD:
            yield from _bare(record)
    yield from block_lines(records)
    yield LAST_CARD, ""


def _bare(record: Record) -> Iterator[tuple[str, str]]:
    """Yield the line of a card without numbers."""
    card = BY_KEYWORD.get(record["keyword"])
    if card is not None and not card.columns:
        yield card.keyword, record.prefix
