"""Questions of `flexmb new vsdf`, and the deck it gives: cards of the reader's table, in free form.

A flexible body needs its node table, a rigid one its mass; of all other cards, such as those of a flexible
body's two matrices, the dialogue asks how many there are.
"""

from collections.abc import Sequence
from typing import Any

from ...deck import number
from ...deck.questions import INTEGER, MOST_ASKED, TEXT, TITLE_ENTRY, Cell, Entry
from ...deck.record import Number, Record
from ...errors import Fault
from ..elements_block.form import COUNT as LINE_COUNT
from ..elements_block.form import LINES, block_lines, faults_of_line, line_entries
from .card import Card, Column
from .cards import BY_WORD, CARDS, END, FINAL

_BODY, _FLEXIBLE, _RIGID = BY_WORD["BODY"], ("FEMN",), ("RIGI",)


def _cards(words: str) -> tuple[Card, ...]:
    return tuple(BY_WORD[word] for word in words.split())


# Answers piped from a file written before a card was there still give a deck: these lists stay as they are,
# and cards that stand in none of them are counted last.
_SINGLE = _cards("GRAV TIME INTG")
COUNTED = _cards(
    "BODY FEMM FEMK FEMP NODE NSET CLMP ATTM CRBN DAMP POSI EULP VELO PINN JOIN MOTN TABL FORC TORQ SPRI "
    "JSPR GEOS FEMG OUTN MATL OUTS PLAC"
)
ADDED = _cards("GEOM GSTL")
_ASKED = (*_SINGLE, *COUNTED, *ADDED, *_cards(" ".join((*_FLEXIBLE, *_RIGID))))
LATER = tuple(card for card in CARDS if card not in _ASKED)


def _count_cell(card: Card) -> Cell:
    what = card.subject.replace("{}", "").strip().removesuffix(" of body")
    default = None if card is _BODY else "0"
    return Cell(card.word, f"number of cards: {what}", letter=INTEGER, default=default)


_COUNTS = Entry("counts", 0, "counts", tuple(_count_cell(card) for card in COUNTED))
_ELEMENTS = Entry(
    "elements", 0, "shapes and elements", (*(_count_cell(card) for card in ADDED), LINE_COUNT), True
)
_MORE = Entry("more", 0, "further cards", tuple(_count_cell(card) for card in LATER), True)


class VsdfForm:
    """The questions of a VSDF deck."""

    dialect = "vsdf"

    def entries(self, values: dict[str, str]) -> list[Entry]:
        """Title, counts, bodies with what each type needs, other cards, those of the whole deck, elements.

        Cards that are newer than these come last.
        """
        counts = _counts(values, _COUNTS)
        entries = [TITLE_ENTRY, _COUNTS]
        if not counts:
            return entries
        bodies = range(1, counts["BODY"] + 1)
        entries += [_entry(_BODY, k) for k in bodies]
        for k in bodies:
            kind = values.get(f"body.{k}.kind", "").upper()
            words = _FLEXIBLE if kind == "FLEX" else _RIGID
            entries += [_entry(BY_WORD[word], k) for word in words]
        for card in COUNTED[1:]:
            entries += [_entry(card, k) for k in range(1, counts[card.word] + 1)]
        entries += [*(_entry(card, 0) for card in _SINGLE), _ELEMENTS]
        added = _counts(values, _ELEMENTS)
        for card in ADDED if added else ():
            entries += [_entry(card, k) for k in range(1, added[card.word] + 1)]
        entries += line_entries(added.get(LINE_COUNT.key, 0))
        if not (added and LATER):
            return entries
        later = _counts(values, _MORE)
        entries.append(_MORE)
        for card in LATER if later else ():
            entries += [_entry(card, k) for k in range(1, later[card.word] + 1)]
        return entries

    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]:
        """Return faults of counts, body and joint numbers, node lists; `flexmb check` finds all others."""
        last = records[-1]
        if last.section in _OF_COUNTS:
            return [
                fault
                for count in last.numbers
                for fault in _outside(last, count, count.key == "BODY", MOST_ASKED)
            ]
        if last.section == LINES:
            return faults_of_line(records)
        faults = []
        more = _BY_SECTION[last.section].more if last.section != "title" else None
        for value in last.numbers if last.section != "title" else ():
            if value.key == "nodes" and more:
                faults += _faults_of_list(last, value)
            elif value.key == "body" or (value.key in ("a", "b") and last.section != "shape"):
                faults += _outside(last, value, "0: ground" not in value.meaning, records[1]["BODY"])
            elif value.key == "joint":
                faults += _outside(last, value, True, records[1]["JOIN"])
        return faults

    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]:
        """A keyword before the records of its card; what the fields are stands in a comment."""
        lines = [(f"VSDF {records[0]['text']}".rstrip(), records[0].prefix)]
        lines.append(("* Lengths in m, angles in rad, times in s, masses in kg.", ""))
        section = ""
        for record in records[2:]:
            if record.section in (*_OF_COUNTS, LINES):
                continue
            card = _BY_SECTION[record.section]
            if record.section != section:
                section = record.section
                fields = [c.key for c in (*card.columns, *([card.more] if card.more else []), *card.second)]
                lines += [(f"* {' '.join(fields)}", ""), (card.word, "")]
            lines += [(line, record.prefix) for line in _data_lines(card, record)]
        lines += block_lines(records)
        return [*lines, *((word.ljust(4) if word == END else word, "") for word in FINAL)]


_BY_SECTION = {card.section: card for card in CARDS}
_OF_COUNTS = (_COUNTS.section, _ELEMENTS.section, _MORE.section)


def _counts(values: dict[str, str], entry: Entry) -> dict[str, int]:
    """Return the counts that `entry` asked for, empty before all of them are known and sensible."""
    try:
        counts = {cell.key: number.integer(values[f"{entry.prefix}.{cell.key}"])[0] for cell in entry.cells}
    except (KeyError, number.Misspelt):
        return {}
    return counts if max(counts.values()) <= MOST_ASKED else {}


def _is_numbered(card: Card) -> bool:
    """Return whether the first field is the record's own number or body, which nobody needs to type."""
    return card.counted == "own" or card.word in (*_FLEXIBLE, *_RIGID)


def _entry(card: Card, k: int) -> Entry:
    columns = (*card.columns[_is_numbered(card) :], *card.second)
    cells = tuple(_cell(column) for column in columns)
    if card.more:
        default = None if card.more.default is None else ""
        cells += (Cell("nodes", f"{card.more.meaning}: all, between blanks", letter=TEXT, default=default),)
    subject = card.subject.format(k) if _is_numbered(card) else f"card {card.word} {k}"
    return Entry(card.section, k, subject if k else card.word, cells)


def _cell(column: Column) -> Cell:
    # An empty field is more than a zero: a length without value is that of t = 0.
    default = None if column.default is None else ""
    if column.key == "method":
        default = column.words[0]  # what a deck without the card is solved by
    return Cell(column.key, column.meaning, column.unit, column.letter, default, column.words)


def _data_lines(card: Card, record: Record) -> list[str]:
    texts = [n.text for n in record.numbers]
    if card.more:
        texts[-1:] = texts[-1].split()
    if _is_numbered(card):
        texts.insert(0, str(record.number))
    first = len(texts) - len(card.second)
    # The blank in front keeps a word in the first field from being read as a keyword.
    return ["    " + ",".join(part) for part in (texts[:first], texts[first:]) if part]


def _outside(record: Record, value: Number, least: bool, most: int) -> list[Any]:
    if int(least) <= value.value <= most:
        return []
    message = f"{value.key} must be within {int(least)}..{most}; read {value.text}"
    return [Fault("error", message, value.place, record.subject, id="VSDF-039")]


def _faults_of_list(record: Record, value: Number) -> list[Fault]:
    """Faults of a list of nodes."""
    faults = []
    for text in value.text.split():
        try:
            number.integer(text)
        except number.Misspelt as fault:
            message = f"each of the nodes {fault}"
            faults.append(Fault("error", message, value.place, record.subject, id="VSDF-040"))
    return faults
