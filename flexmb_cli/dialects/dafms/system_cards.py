"""The cards of TSYSIN, in any order up to END: DAFMS thesis (Zhao, 1992), appendix C."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...deck.fortran_card import fortran_format
from ...deck.fortran_records import Item, MissingRecord, Records
from ...deck.number_list import record_of
from ...deck.record import Number, Record, as_lines
from ...errors import Fault, Place
from ..elements_block.old_cards import DAFMS_FORMATS, refused
from ..elements_block.text import begins_block, uncommented
from .cards import CARDS, END, MACROS, PRINT_OFF, PRINT_ON, Card
from .skipped_lines import SkippedLines

if TYPE_CHECKING:
    from ..elements_block.reader import BlockReader


def old_card(word: str) -> Card | None:
    """Return the card of a word, its fields without names; None for other words."""
    if word not in DAFMS_FORMATS:
        return None
    head, tail, further = DAFMS_FORMATS[word]
    count = len(fortran_format(head).edits)
    items = tuple(Item(f"field {k}", "") for k in range(1, count + further + 1))
    return Card(word, word.lower(), "entries", head, items, tail, head=count if further else 0)


def refused_card(card: Card, entries: Sequence[Record], counts: dict[str, int]) -> Iterator[Fault]:
    """Refuse the entries of a card; `counts`: how many of each word the deck had before."""
    cards = [(record.numbers[0].place, [*_fields(card, record.numbers)]) for record in entries]
    return refused("dafms", card.word, cards, counts)


def _fields(card: Card, numbers: Sequence[Number]) -> Iterator[str]:
    """Spellings of numbers, with the point where a FORMAT implies it; not the count of a function's."""
    for k, number in enumerate(numbers):
        text = number.text.replace(" ", "") or "0"
        if not (card.word == "FUNC" and k == 2):
            yield text if isinstance(number.value, int) or "." in text else repr(number.value)


OF_BODIES = ("node", "nodal_force", "equations", "id", "bkp", "bmi", "body")  # sections of numbers of bodies
MOST_REPEATED = 1000  # each looks through all records


@dataclass
class Layout:
    """Lengths of the lists of a deck: counts per body, body 1 first."""

    bodies: int
    dimension: int
    translations: list[int] = field(default_factory=list)
    rotations: list[int] = field(default_factory=list)
    nodes: list[int] = field(default_factory=list)
    dofs: list[int] = field(default_factory=list)

    @property
    def coordinates(self) -> int:
        """NS, the number of generalized coordinates (thesis eq. 2.4)."""
        return sum(self.translations) + sum(self.rotations) + sum(map(self.elastic, range(self.bodies)))

    def elastic(self, body: int) -> int:
        """NMK, the number of elastic coordinates of a body counted from 0."""
        return self.nodes[body] * self.dofs[body]


def read_system(records: Records, layout: Layout, read: list[Record]) -> None:
    """Read TSYSIN's cards into `read`; `layout` gives the lengths of the lists."""
    system = _System(records, layout, read)
    while not records.exhausted:
        line = records.next_card()
        word = records.word()
        if begins_block(line):
            system.take_block()
            continue
        if word == END:
            system.skipped.flush()
            return
        if word in MACROS:
            system.skipped.flush()
            records.report(
                "error", "", f"card '{word}' stands before END: the card 'END ' is missing", id="DAFMS-167"
            )
            records.line -= 1
            return
        system.take(word, line)
    system.skipped.flush()
    records.end_of_deck("", "the card 'END '")


def _of_point(k: int) -> tuple[str, str, str]:
    """Key, meaning and unit of a table's number: times and efforts take turns."""
    point = k // 2 + 1
    return (f"f({point})", "torque or force", "N m or N") if k % 2 else (f"t({point})", "time", "s")


class _System:
    """Cards read by TSYSIN so far: the deck's records and the line of every card."""

    def __init__(self, records: Records, layout: Layout, read: list[Record]):
        self.records = records
        self.layout = layout
        self.read = read
        self.lines: dict[str, int] = {}
        self.repeated = 0
        self.skipped = SkippedLines(records, "among the TSYSIN cards")
        self.blocks: BlockReader | None = None
        self.old: dict[str, int] = {}  # cards of each word that the block replaces

    def take_block(self) -> None:
        """Read a block ELEMENTS, which the line read last opens."""
        # Few decks have any.
        from ..elements_block.reader import BlockReader

        self.skipped.flush()
        records = self.records
        if self.blocks is None:
            names = [card.section for card in CARDS.values()]
            reserved = [*names, "counts", "heading", "time", "run", "echo", "speed", "coordinate", *OF_BODIES]
            self.blocks = BlockReader(as_lines(records.lines), uncommented, reserved)
        n_records, n_faults = len(self.blocks.records), len(self.blocks.faults)
        records.line = min(self.blocks.read(records.line) - 1, len(records.lines))
        self.read += self.blocks.records[n_records:]
        for fault in self.blocks.faults[n_faults:]:
            records.report(fault.severity, fault.subject, fault.message, fault.place, id=fault.id)

    def take(self, word: str, line: str) -> None:
        """One line of the card level: a card with its records, a switch, or a line to skip."""
        if word in (PRINT_ON, PRINT_OFF):
            self.skipped.flush()
            self._add("echo", self.records.line, "echo", (self._switch("PRT", int(word == PRINT_ON)),))
        elif word in CARDS:
            self.skipped.flush()
            self.skipped.card = word
            self._forget_earlier(CARDS[word])
            self._read_card(CARDS[word])
        elif not self._refuse_old(word):
            self.skipped.add(line)

    def _refuse_old(self, word: str) -> bool:
        """Refuse a card that the block replaces; False for other words."""
        # Few decks have words that no card has.

        card = old_card(word)
        if card is None:
            return False
        self.skipped.flush()
        self.skipped.card = word
        before = len(self.read)
        self._read_card(card)
        entries = self.read[before:]
        del self.read[before:]
        for fault in refused_card(card, entries, self.old):
            self.records.report(fault.severity, fault.subject, fault.message, fault.place, id=fault.id)
        return True

    def _switch(self, key: str, value: int) -> Number:
        return Number(key, value, "switch", "", Place(self.records.line, 1, 4), self.records.word())

    def _add(self, section: str, number: int, subject: str, numbers: Sequence[Any]) -> None:
        self.read.append(Record(section, number, subject, tuple(numbers)))

    def _forget_earlier(self, card: Card) -> None:
        """A repeated card overwrites what the first one gave."""
        if card.word in self.lines:
            line = self.lines[card.word]
            self.repeated += 1
            if self.repeated > MOST_REPEATED:
                self.records.stop(
                    "", f"cards that replace earlier ones: more than {MOST_REPEATED}", id="DAFMS-168"
                )
            message = f"card '{card.word}' replaces the one on line {line}"
            self.records.report("warning", "", message, Place(self.records.line, 1, 4), id="DAFMS-169")
            sections = ("speed", "coordinate") if card.layout == "state" else (card.section,)
            self.read[:] = [record for record in self.read if record.section not in sections]
        self.lines[card.word] = self.records.line

    def _read_card(self, card: Card) -> None:
        readers = {
            "bodies": self._read_bodies,
            "list": self._read_list,
            "coordinates": self._read_coordinates,
            "state": self._read_state,
            "single": self._read_single,
            "switch": self._read_switch,
            "entries": self._read_entries,
        }
        try:
            readers[card.layout](card)
        except MissingRecord:
            # Reading continues at the card that stood in the place of a data record.
            return

    def _read_bodies(self, card: Card) -> None:
        for k in range(1, self.layout.bodies + 1):
            subject = f"{card.word.strip()} of body {k}"
            before = self.records.errors
            items = [Item("KK", "number of the body"), *card.items]
            index, *numbers = self.records.read(card.format, items, subject)
            if self.records.errors == before:
                self.records.check_index(index, k, subject, "records are stored in the order of the bodies")
            self._add(card.section, k, f"body {k}", numbers)

    def _read_list(self, card: Card) -> None:
        (item,) = card.items
        items = [Item(item.key, f"{item.meaning}, body {k}") for k in range(1, self.layout.bodies + 1)]
        for k, number in enumerate(self.records.read(card.format, items, card.word.strip()), 1):
            self._add(card.section, k, f"body {k}", (number,))

    def _read_coordinates(self, card: Card) -> None:
        items = [Item("X", "coordinate, superseded by Y(L)", "rad or m")] * self.layout.coordinates
        for m, number in enumerate(self.records.read(card.format, items, "X(L)"), 1):
            self._add(card.section, m, f"coordinate {m}", (number,))

    def _read_state(self, card: Card) -> None:
        count = self.layout.coordinates
        items = [Item("u", "initial speed", "rad/s or m/s")] * count
        items += [Item("q", "initial coordinate", "rad or m")] * count
        numbers = self.records.read(card.format, items, "Y(L)")
        for m, number in enumerate(numbers[:count], 1):
            self._add("speed", m, f"speed {m}", (number,))
        for m, number in enumerate(numbers[count:], 1):
            self._add("coordinate", m, f"coordinate {m}", (number,))

    def _read_single(self, card: Card) -> None:
        numbers = self.records.read(card.format, list(card.items), card.word)
        self._add(card.section, 0, card.word, numbers)

    def _read_switch(self, card: Card) -> None:
        self._add(card.section, 0, card.word, (self._switch(card.word, 1),))

    def _read_entries(self, card: Card) -> None:
        (count,) = self.records.read("I5", [Item("NL", "number of entries")], card.word)
        if count.value < 0:
            message = f"a count of {count.value} entries: 0 or more"
            self.records.report("error", card.word, message, count.place, id="DAFMS-170")
        for number in range(1, count.value + 1):
            subject = f"{card.section.replace('_', ' ')} {number}"
            self.read.append(record_of(card.section, number, subject, *self._read_entry(card, subject)))

    def _read_entry(self, card: Card, subject: str) -> tuple[list[Number], Sequence[Number]]:
        """The numbers of an entry, and the list that may follow them."""
        fields = card.head or len(card.items)
        numbers = list(self.records.read(card.format, list(card.items[:fields]), subject))
        if card.head:
            numbers += self.records.read(card.tail, list(card.items[fields:]), subject)
        elif card.word == "NROT":
            numbers += self._read_rotation(card, numbers, subject)
        elif card.tail:
            return numbers, self._read_table(card, numbers[-1], subject)
        return numbers, ()

    def _read_table(self, card: Card, count: Number, subject: str) -> Sequence[Number]:
        if count.value < 1:
            message = f"NP = {count.value} points, a table needs at least 1"
            self.records.stop(subject, message, count.place, id="DAFMS-171")
        each = 1 if card.word == "FUNC" else 2
        return self.records.read_list(card.tail, each * count.value, _of_point, subject)

    def _read_rotation(self, card: Card, head: list[Number], subject: str) -> list[Number]:
        """Three rows, rotation about axis 1, 2, 3 per unit of each elastic coordinate of the body."""
        body = head[0]
        if not 1 <= body.value <= self.layout.bodies or not self.layout.nodes[body.value - 1]:
            message = f"K = {body.value} is not a flexible body"
            self.records.stop(subject, message, body.place, id="DAFMS-172")
        size = self.layout.elastic(body.value - 1)
        numbers: list[Number] = []
        for axis in (1, 2, 3):
            items = [
                Item(f"phi{axis}({m})", f"rotation about axis {axis}", "rad/m") for m in range(1, size + 1)
            ]
            numbers += self.records.read(card.tail, items, subject)
        return numbers
