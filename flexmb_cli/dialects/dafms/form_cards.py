"""Cards of DAFMS as `flexmb new dafms` asks for them: those of every body, and those that were counted."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...deck.fortran_card import Edit, fortran_format
from ...deck.fortran_fields import filled
from ...deck.questions import INTEGER, REAL, Cell, Entry
from .card import Card
from .cards import CARDS
from .deck_writer import WIDE_REAL
from .form_blocks import Answers, counted

if TYPE_CHECKING:
    from ...deck.fortran_records import Item


TABLES = ("TABM", "TABL")
_WITHOUT_ZERO = ("MASS", "METH", "SPRI", "DAMP", "MOTR", *TABLES, "NROT")
_ASKED = ("K", "A", "KA", "IS", "SA")
MOST_POINTS = 1000


def body_entry(word: str, answers: Answers, k: int) -> Entry:
    """The card `word` of body `k`, in which the share of a beam in mass and inertia is offered."""
    entry = _card_entry(CARDS[word], k)
    beam = answers.beam(k) if answers.kind(k) == "BEAM" else None
    if beam is None or entry.section not in ("mass", "inertia"):
        return entry
    inertia = filled(beam.inertia, 10)
    offered = [filled(beam.mass, 10)] if entry.section == "mass" else [inertia, "0", inertia]
    cells = zip(entry.cells, offered, strict=True)
    changed = tuple(Cell(c.key, c.meaning, c.unit, c.letter, default) for c, default in cells)
    return Entry(entry.section, entry.number, entry.subject, changed)


def counted_entries(word: str, answers: Answers, bodies: range, counts: str = "counts") -> list[Entry]:
    """The records of the card `word`, as many as its count in the record `counts` says."""
    card, count = CARDS[word], answers.integer(f"{counts}.{word}")
    if not count or card.layout == "switch":
        return []
    if card.layout == "single":
        return [_card_entry(card, 0)]
    if card.layout == "bodies":
        return [_card_entry(card, k) for k in bodies]
    return [entry for n in counted(count) for entry in (_card_entry(card, n), *_rows(word, answers, n))]


def _rows(word: str, answers: Answers, n: int) -> Any:
    """The table that follows the `n`-th head of the card."""
    section = f"{CARDS[word].section}.{n}"
    if word in TABLES:
        return _points(section, answers.integer(f"{section}.NP"), f"{word} {n}")
    return _rotations(section, answers, f"{word} {n}") if word == "NROT" else []


def _points(section: str, count: int, subject: str) -> list[Any]:
    unit = "N m" if section.startswith("torque") else "N m or N"
    cells = (Cell("t", "time", "s"), Cell("f", "torque or force, linear between the points", unit))
    return [Entry(section, i, f"{subject}, point {i}", cells) for i in counted(min(count, MOST_POINTS))]


def _rotations(section: str, answers: Answers, subject: str) -> Any:
    """Rotations of a node per unit of each elastic coordinate; those of a beam are offered."""
    k, node = answers.integer(f"{section}.K"), answers.integer(f"{section}.I")
    axes, nodes = answers.axes(k)
    if not 1 <= node <= nodes:
        return []
    beam = answers.beam(k) if answers.kind(k) == "BEAM" else None
    known = np.zeros((3, len(axes) * nodes)) if beam is None else beam.nodal_rotation(node)
    entries = []
    for axis, row in enumerate(known, 1):
        cells = tuple(
            Cell(f"phi.{m}", f"per unit of elastic coordinate {m}: rotation about axis {axis}", "rad/m",
                 default=filled(value, WIDE_REAL) if value else "0")
            for m, value in enumerate(row.tolist(), 1)
        )  # fmt: skip
        entries.append(Entry(section, axis, f"{subject}, axis {axis}", cells))
    return entries


def _card_entry(card: Card, k: int) -> Entry:
    edits = fortran_format(card.format).edits[card.layout == "bodies" :]
    while card.head and len(edits) < len(card.items):
        edits += fortran_format(card.tail).edits
    skipped = card.word == "GRAV"  # its first number is not used
    pairs = list(zip(card.items, edits, strict=False))[skipped:]
    cells = tuple(_cell(card, item, edit) for item, edit in pairs)
    subject = f"{card.word.strip()} {k}" if k else card.word.strip()
    return Entry(card.section, k, subject, cells)


def _cell(card: Card, item: "Item", edit: Edit) -> Cell:
    letter = INTEGER if edit.letter == "I" else REAL
    default = None if card.word in _WITHOUT_ZERO or item.key in _ASKED else "0"
    if card.word == "TOLR":
        default = ""
    if item.key == "e4":
        default = "1"
    key = item.key
    # "PH.1" makes the three axes one question.
    if key[-1] in "123" and item.meaning.endswith(f"axis {key[-1]}") and not item.meaning.startswith("1:"):
        key = f"{key[:-1]}.{key[-1]}"
    return Cell(key, item.meaning, item.unit, letter, default)
