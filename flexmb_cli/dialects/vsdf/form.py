"""Questions of `flexmb new vsdf`, and the deck it gives: cards of the reader's table, in free form.

A flexible body needs its node table, a rigid one its mass; of all other cards, such as those of a flexible
body's two matrices, the dialogue asks how many there are.
"""

from collections.abc import Mapping, Sequence

from ...deck.dialogue import Entries, Form, Line, named, titled
from ...deck.questions import COUNT, INTEGER, MOST_ASKED, TEXT, Cell, Entry
from ...deck.record import DeckText, Record
from ...errors import Fault
from ..elements_block.questions import SECTION as ELEMENT_LINE
from ..elements_block.questions import block_lines, element_entries
from .build import build_vsdf
from .card import Card, Column
from .cards import BY_WORD, CARDS, END, FINAL
from .cards.analysis import ANALYSIS_CARDS
from .cards.bodies import BODY_CARDS
from .cards.joints_and_loads import JOINT_AND_LOAD_CARDS
from .reader import read_vsdf

_OF_BODIES = {"FLEX": BY_WORD["FEMN"], "RIGD": BY_WORD["RIGI"]}


def _cards(words: str) -> tuple[Card, ...]:
    return tuple(BY_WORD[word] for word in words.split())


# Answers piped from a file written before a card was there still give a deck: these lists stay as they are,
# and cards that stand in none of them are counted last.
_SINGLE = _cards("GRAV TIME INTG")
COUNTED = _cards(
    "BODY FEMM FEMK FEMP NODE NSET CLMP ATTM CRBN DAMP POSI EULP VELO PINN JOIN MOTN TABL FORC TORQ SPRI "
    "JSPR GEOS FEMG OUTN MATL OUTS PLAC"
)
ADDED = _cards("GEOM GSTL FEMX ELMT")
_ASKED = (*_SINGLE, *COUNTED, *ADDED, *_OF_BODIES.values())
NEWER = [card for card in (*BODY_CARDS, *JOINT_AND_LOAD_CARDS, *ANALYSIS_CARDS) if card not in _ASKED]


class VsdfForm(Form):
    """The questions of a VSDF deck."""

    dialect = "vsdf"

    def entries(self, values: Mapping[str, str]) -> Entries:
        """Title, counts, bodies with what each type needs, other cards, those of the whole deck, elements."""
        yield titled()
        counts = yield Entry("counts", 0, "counts", tuple(map(_count, COUNTED)))
        most = {"body": counts["BODY"], "a": counts["BODY"], "b": counts["BODY"], "joint": counts["JOIN"]}
        kinds = {}
        for k in range(1, counts["BODY"] + 1):
            kinds[k] = (yield _entry(BY_WORD["BODY"], k, most))["kind"]
        for k, kind in kinds.items():
            yield _entry(_OF_BODIES[kind], k, most)
        for card in COUNTED[1:]:
            for k in range(1, counts[card.word] + 1):
                yield _entry(card, k, most)
        for card in _SINGLE:
            yield _entry(card, 0, most)
        yield from _counted_cards("more", "shapes and further cards", ADDED, most)
        yield from element_entries()
        if NEWER:
            yield from _counted_cards("new", "newer cards", NEWER, most)

    def lines(self, records: Sequence[Record]) -> list[Line]:
        """A keyword before the records of its card; what the fields are stands in a comment."""
        lines: list[Line] = [[("VSDF ", ""), *named(records[0])]]
        lines.append([("* Lengths in m, angles in rad, times in s, masses in kg.", "")])
        cards, section = {card.section: card for card in CARDS}, ""
        for record in (record for record in records if record.section in cards):
            card = cards[record.section]
            if record.section != section:
                section = record.section
                fields = [c.key for c in (*card.columns, *([card.more] if card.more else []), *card.second)]
                lines += [[(f"* {' '.join(fields)}", "")], [(card.word, "")]]
            lines += _data_lines(card, record)
        return [
            *lines,
            *block_lines(records),
            *([(word.ljust(4) if word == END else word, "")] for word in FINAL),
        ]

    def read(self, source: DeckText, last: Record) -> Sequence[Fault]:
        """Read the deck, and build its model where all but elements is there."""
        deck = read_vsdf(source)
        whole = last.section == ELEMENT_LINE and last["line"]
        return [*deck.warnings, *(build_vsdf(deck, self.folder)[1] if whole else [])]


def _counted_cards(section: str, subject: str, cards: Sequence[Card], most: Mapping[str, int]) -> Entries:
    """Yield the question for the numbers of some cards, and those for the cards."""
    counts = yield Entry(section, 0, subject, tuple(map(_count, cards)), optional=True)
    for card in cards:
        for k in range(1, counts[card.word] + 1):
            yield _entry(card, k, most)


def _count(card: Card) -> Cell:
    what = card.subject.replace("{}", "").strip().removesuffix(" of body")
    default, within = (None, (1, MOST_ASKED)) if card.word == "BODY" else ("0", COUNT)
    return Cell(card.word, f"number of cards: {what}", "", INTEGER, default, within=within)


def _is_numbered(card: Card) -> bool:
    """Return whether the first field is the record's own number or body, which nobody needs to type."""
    return card.counted == "own" or card in _OF_BODIES.values()


def _entry(card: Card, k: int, most: Mapping[str, int]) -> Entry:
    columns = (*card.columns[_is_numbered(card) :], *card.second)
    cells = tuple(_cell(column, most) for column in columns)
    if card.more:
        default = None if card.more.default is None else ""
        cells += (Cell("nodes", f"{card.more.meaning}: all, between blanks", "", TEXT, default),)
    subject = card.subject.format(k) if _is_numbered(card) else f"card {card.word} {k}"
    return Entry(card.section, k, subject if k else card.word, cells)


def _cell(column: Column, most: Mapping[str, int]) -> Cell:
    # An empty field is more than a zero: a length without value is that of t = 0.
    default = None if column.default is None else ""
    if column.key == "method":
        default = column.words[0]  # what a deck without the card is solved by
    within = None
    if column.letter == INTEGER and column.key in most:
        within = (int("0: ground" not in column.meaning), most[column.key])
    return Cell(
        column.key,
        column.meaning,
        column.unit,
        column.letter,
        default,
        column.words,
        within,
        names=column.names,
    )


def _data_lines(card: Card, record: Record) -> list[Line]:
    pieces = list(named(record, ","))
    if card.more:
        text, name = pieces.pop()
        pieces += [(f"{part},", name) for part in text.split()]
    if _is_numbered(card):
        pieces.insert(0, (f"{record.number},", ""))
    first = len(pieces) - len(card.second)
    parts = [part for part in (pieces[:first], pieces[first:]) if part]
    # The blank in front keeps a word in the first field from being read as a keyword.
    return [[("    ", ""), *part[:-1], (part[-1][0].removesuffix(","), part[-1][1])] for part in parts]
