"""Questions of `flexmb new dafms`: the records of the reader's table of cards, body by body.

A flexible body is typed number by number or made from a uniform beam (`beam.py`).  The deck itself is written
by `deck_writer.py`.
"""

from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...deck.dialogue import Entries, Form, Line, titled
from ...deck.fortran_card import fortran_format
from ...deck.fortran_fields import filled
from ...deck.questions import COUNT, INTEGER, MOST_ASKED, REAL, WORD, Cell, Entry
from ...deck.record import DeckText, Record
from ...errors import DeckError, Fault
from ..elements_block.questions import element_entries
from .beam import Beam
from .beam_cards import beam_block
from .build import build_dafms
from .cards import CARDS, Card
from .deck_writer import OF_EVERY_BODY, OPTIONAL, TABLES, beam_of, deck_lines
from .reader import read_dafms

MOST_TYPED = 60
"""Largest number of elastic coordinates whose stiffness is asked for entry by entry."""
MOST_POINTS = 1000
_FLAG = (0, 1)
_KINDS = ("RIGID", "BEAM", "TYPED")
_INTEGERS, _REALS, _WIDE = 5, 10, 13  # columns
_WITHOUT_ZERO = ("MASS", "METH", "SPRI", "DAMP", "MOTR", *TABLES, "NROT")
_ASKED = ("K", "A", "KA", "IS", "SA")


def _integer(key: str, meaning: str, default: str | None = None, within: tuple[int, int] = COUNT) -> Cell:
    return Cell(key, meaning, "", INTEGER, default, within=within)


def _real(key: str, meaning: str, unit: str, default: str | None = None, width: int = _REALS) -> Cell:
    return Cell(key, meaning, unit, REAL, default, width=width)


def _count_cell(card: Card) -> Cell:
    several = card.layout == "entries"
    what = "number of entries" if several else "1: with the card"
    without = "; without it 9.8 m/s^2 along +axis 2" if card.word == "GRAV" else ""
    meaning = f"{what}, {card.section.replace('_', ' ')}{without}"
    return _integer(card.word, meaning, "0", COUNT if several else _FLAG)


_COUNTS = (
    _integer("N", "number of bodies", within=(1, MOST_ASKED)),
    _integer("NDM", "dimension, 2 or 3", "3", (2, 3)),
    *(_count_cell(CARDS[word]) for word in OPTIONAL),
)
_TIME = (
    _integer("IT", "number of output intervals", within=(1, 99_999)),
    _real("H", "length of an interval", "s"),
)
_FREE = tuple(
    _integer(f"{letter}.{a}", f"{motion} of the hinge free, axis {a}; a flag", "0", _FLAG)
    for letter, motion in (("NT", "translation"), ("NR", "rotation"))
    for a in (1, 2, 3)
)
_KIND = Cell("kind", "RIGID, a uniform BEAM, or nodes and stiffness TYPED", "", WORD, "RIGID", _KINDS)
_BEAM = (
    Cell("length", "length, clamped at its first end, along axis 2", "m"),
    _integer("nodes", "elements, each with a node at its end", within=(1, 446)),
    Cell("EI", "bending stiffness for deflection along axis 3", "N m^2"),
    Cell("rho", "mass per length", "kg/m"),
    Cell("offset", "clamped end from O_k", "m", default="0"),
    Cell("EA", "axial stiffness; adds displacement along axis 2", "N", default=""),
    Cell("EI_1", "bending stiffness for deflection along axis 1; needs EA", "N m^2", default=""),
    Cell("tip_mass", "mass added to the last node", "kg", default="0"),
)
_NODES = (
    _integer("NUMNP", "number of nodes", within=(1, MOST_TYPED)),
    _integer("NDF", "elastic degrees of freedom of a node: 1 axis 3, 2 axes 2 and 3, 3 all", within=(1, 3)),
)


class DafmsForm(Form):
    """The questions of a DAFMS deck."""

    dialect = "dafms"

    def entries(self, values: Mapping[str, str]) -> Entries:
        """Title, counts, time, hinges, elastic blocks, the cards of each body, the start, other cards."""
        yield titled(width=75)
        counts = yield Entry("counts", 0, "counts", _COUNTS)
        yield Entry("time", 0, "time", _TIME)
        bodies, dimension = range(1, counts["N"] + 1), counts["NDM"]
        hinges, blocks = {}, {}
        for k in bodies:
            parent = _integer("L", "number of the parent; 0: inertial frame", str(k - 1), (0, k - 1))
            hinges[k] = yield Entry("body", k, f"body {k}", (parent, *_FREE, _KIND))
        for k in bodies:
            blocks[k] = yield from _block(hinges[k]["kind"], k, dimension)
        for k in bodies:
            for word in OF_EVERY_BODY:
                yield _card_entry(CARDS[word], k, _offered(word, blocks[k]))
        for m, (what, unit) in enumerate(_coordinates(hinges, blocks), 1):
            state = (
                _real("q", "coordinate at the start", unit, "0"),
                _real("u", "speed at the start", f"{unit}/s", "0"),
            )
            yield Entry("state", m, f"coordinate {m}: {what}", state)
        for word in OPTIONAL:
            yield from _counted(CARDS[word], counts[word], blocks)
        shapes = yield Entry("shapes", 0, "shapes for pictures", (_count_cell(CARDS["GEOM"]),), True)
        yield from _counted(CARDS["GEOM"], shapes["GEOM"], blocks)
        yield from element_entries()

    def lines(self, records: Sequence[Record]) -> list[Line]:
        """The cards in the columns of their FORMATs."""
        return deck_lines(records)

    def read(self, source: DeckText, last: Record) -> Sequence[Fault]:
        """Read the deck, and build its tree."""
        deck = read_dafms(source)
        return [*deck.warnings, *build_dafms(deck, self.folder)[1]]


class _Block:
    """Elastic coordinates of a body: axes of its nodal displacements, and its number of nodes."""

    def __init__(self, axes: tuple[int, ...] = (), nodes: int = 0, beam: Beam | None = None):
        self.axes, self.nodes, self.beam = axes, nodes, beam


def _block(kind: str, k: int, dimension: int) -> Generator[Entry, Record, _Block]:
    """Yield the records of an elastic body."""
    if kind == "BEAM":
        beam = beam_of((yield Entry("beam", k, f"beam of body {k}", _BEAM)))
        if 1 in beam.axes and dimension == 2:
            raise _refused("deflection along axis 1 needs a deck with NDM = 3", id="DAFMS-031")
        beam_block(beam)
        return _Block(beam.axes, beam.nodes, beam)
    if kind == "RIGID":
        return _Block()
    counts = yield Entry("elastic", k, f"nodes of body {k}", _NODES)
    nodes, dofs = counts["NUMNP"], counts["NDF"]
    if nodes * dofs > MOST_TYPED:
        message = f"{nodes * dofs} elastic coordinates are too many to type (at most {MOST_TYPED})"
        raise _refused(f"{message}: use `flexmb beam --into`", id="DAFMS-024")
    axes = (2, 3) if dimension == 2 else (1, 2, 3)
    vectors = (("CO", "position from O_k", "m", None), ("PI", "force, inertial axes", "N", "0"))
    cells = tuple(_real(f"{key}.{a}", f"{what}, axis {a}", unit, default)
                  for key, what, unit, default in vectors for a in axes)  # fmt: skip
    for i in _to(nodes):
        yield Entry(f"node.{k}", i, f"node {i} of body {k}", cells)
    columns = tuple(
        _integer(f"h({j})", f"stored entries of column {j}", str(j), (1, j)) for j in _to(nodes * dofs)
    )
    heights = yield Entry("skyline", k, f"stiffness of body {k}", columns)
    for j, height in enumerate(heights.values, 1):
        stored = (_real(f"K({i},{j})", "stiffness", "N/m", width=_WIDE) for i in range(j - height + 1, j + 1))
        yield Entry(f"stiffness.{k}", j, f"stiffness of body {k}, column {j}", tuple(stored))
    masses = tuple(_real(f"BMI({i})", "nodal mass", "kg") for i in _to(nodes))
    yield Entry("nodal_mass", k, f"nodal masses of body {k}", masses)
    return _Block(tuple(range(4 - dofs, 4)), nodes)


def _refused(message: str, *, id: str) -> DeckError:
    return DeckError([Fault("error", message, id=id)])


def _to(last: int) -> range:
    return range(1, last + 1)


def _coordinates(hinges: Mapping[int, Record], blocks: Mapping[int, _Block]) -> Iterable[tuple[str, str]]:
    """Yield what each coordinate is, and its unit, in the order of card Y(L)."""
    for letter, motion, unit in (("NR", "rotation about", "rad"), ("NT", "translation along", "m")):
        for k, hinge in hinges.items():
            for a in (1, 2, 3):
                if hinge[f"{letter}.{a}"]:
                    yield f"{motion} axis {a}, hinge of body {k}", unit
    for k, block in blocks.items():
        for i in _to(block.nodes):
            for a in block.axes:
                yield f"displacement along axis {a}, node {i} of body {k}", "m"


def _offered(word: str, block: _Block) -> list[str]:
    """The share of a beam in mass and inertia, which Enter gives."""
    if block.beam is None or word not in ("MASS", "INER"):
        return []
    inertia = filled(block.beam.inertia, _REALS)
    return [filled(block.beam.mass, _REALS)] if word == "MASS" else [inertia, "0", inertia]


def _counted(card: Card, count: int, blocks: Mapping[int, _Block]) -> Entries:
    """Yield the records of a card, as many as its count says, with the tables that follow them."""
    several = {"single": [0], "bodies": list(blocks), "entries": list(_to(count)), "switch": []}
    for k in several[card.layout] if count else []:
        head = yield _card_entry(card, k)
        section, subject = f"{card.section}.{k}", f"{card.word} {k}"
        if card.word in TABLES:
            unit = "N m or N" if card.word == "TABM" else "N m"
            cells: tuple[Cell, ...] = (
                _real("t", "time", "s"),
                _real("f", "torque or force, linear between the points", unit),
            )
            for i in _to(head["NP"]):
                yield Entry(section, i, f"{subject}, point {i}", cells)
        elif card.word == "NROT" and head["K"] in blocks:
            for axis, row in enumerate(_rotations(blocks[head["K"]], head["I"]), 1):
                turned = f"rotation about axis {axis}"
                cells = tuple(
                    _real(f"phi.{m}", f"per unit of elastic coordinate {m}: {turned}", "rad/m",
                          filled(value, _WIDE) if value else "0", _WIDE)
                    for m, value in enumerate(row.tolist(), 1)
                )  # fmt: skip
                yield Entry(section, axis, f"{subject}, axis {axis}", cells)


def _rotations(block: _Block, node: int) -> np.ndarray:
    """Rotations (3, NM) of a node per unit of each elastic coordinate, as far as they are known."""
    if block.beam is not None and 1 <= node <= block.nodes:
        return block.beam.nodal_rotation(node)
    return np.zeros((3 if block.nodes else 0, len(block.axes) * block.nodes))


def _card_entry(card: Card, k: int, offered: Sequence[str] = ()) -> Entry:
    edits = fortran_format(card.format).edits[card.layout == "bodies" :]
    while card.head and len(edits) < len(card.items):
        edits += fortran_format(card.tail).edits
    cells = [_cell(card, *pair) for pair in zip(card.items, edits, strict=False)]
    if card.word == "GRAV":
        del cells[0]  # it is not used
    cells[: len(offered)] = [replace(cell, default=text) for cell, text in zip(cells, offered, strict=False)]
    subject = f"{card.word.strip()} {k}" if k else card.word.strip()
    return Entry(card.section, k, subject, tuple(cells))


def _cell(card: Card, item: Any, edit: Any) -> Cell:
    asked = card.word in _WITHOUT_ZERO or item.key in _ASKED
    default = None if asked else {"TOLR": "", "EULT": "1", "EULL": "1"}.get(card.word, "0")
    if item.key in ("e1", "e2", "e3"):
        default = "0"
    key = item.key
    # "PH.1" makes the three axes one question.
    if key[-1] in "123" and item.meaning.endswith(f"axis {key[-1]}") and not item.meaning.startswith("1:"):
        key = f"{key[:-1]}.{key[-1]}"
    within = (1, MOST_POINTS) if key == "NP" and card.word in TABLES else None
    letter = INTEGER if edit.letter == "I" else REAL
    return Cell(key, item.meaning, item.unit, letter, default, within=within, width=edit.width)
