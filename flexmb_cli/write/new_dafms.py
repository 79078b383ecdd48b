"""What `flexmb new dafms` asks for: the records of the reader's table of cards, body by body.

A flexible body is typed number by number or made from a uniform beam (`model/beam.py`).  The deck
itself is written by `dafms_deck.py`.  Cards with tables of their own (TABM, TABL, NROT) are not asked for.
"""

from collections.abc import Sequence

from ..errors import DeckError, Fault
from ..model.beam import Beam
from ..read import number
from ..read.dafms_cards import CARDS, Card
from ..read.deck import Record
from ..read.fortran_card import fortran_format
from .dafms_deck import OF_EVERY_BODY, OPTIONAL, beam_of, deck_lines, faults_of_fields
from .fortran_fields import filled
from .questions import INTEGER, REAL, TEXT, WORD, Cell, Entry

MOST = 1000
MOST_TYPED = 60
"""Largest number of elastic coordinates whose stiffness is asked for entry by entry."""
MOST_OF_BEAM = 446  # the last whose skyline addresses fit I5

_KINDS = ("RIGID", "BEAM", "TYPED")
_TITLE = Entry("title", 0, "title", (Cell("text", "one line on the mechanism", letter=TEXT, default=""),))
_TIME = Entry(
    "time",
    0,
    "time",
    (Cell("IT", "number of output intervals", letter=INTEGER), Cell("H", "length of an interval", "s")),
)
_CARDS_WITHOUT_ZERO = ("MASS", "METH", "SPRI", "DAMP", "MOTR")
_RANGES = {"IDS": (0, 1), "IGS": (0, 1), "METH": (1, 4), "A": (1, 6), "NDM": (2, 3), "NDF": (1, 3)}


def _count_cell(card):
    if card.layout == "entries":
        meaning = f"number of entries, {card.section.replace('_', ' ')}"
    else:
        meaning = f"1: with the card, {card.section.replace('_', ' ')}"
    if card.word == "GRAV":
        meaning += "; without it 9.8 m/s^2 along +axis 2"
    return Cell(card.word, meaning, letter=INTEGER, default="0")


_COUNTS = Entry(
    "counts",
    0,
    "counts",
    (
        Cell("N", "number of bodies", letter=INTEGER),
        Cell("NDM", "dimension, 2 or 3", letter=INTEGER, default="3"),
        *(_count_cell(CARDS[word]) for word in OPTIONAL),
    ),
)


class DafmsForm:
    """The questions of a DAFMS deck."""

    dialect = "dafms"

    def entries(self, values: dict[str, str]) -> list[Entry]:
        """Title, counts, time, hinges, elastic blocks, the cards of each body, the start, other cards."""
        answers = _Answers(values)
        entries = [_TITLE, _COUNTS]
        if not all(0 <= answers.integer(f"counts.{c.key}", -1) <= MOST for c in _COUNTS.cells):
            return entries
        bodies = range(1, answers.integer("counts.N") + 1)
        entries += [_TIME, *(_body_entry(k) for k in bodies)]
        for k in bodies:
            entries += _block_entries(answers, k)
        for k in bodies:
            entries += [_with_beam(_card_entry(CARDS[word], k), answers, k) for word in OF_EVERY_BODY]
        entries += [_state_entry(m, what) for m, what in enumerate(_coordinates(answers, bodies), 1)]
        for word in OPTIONAL:
            entries += _optional_entries(CARDS[word], answers.integer(f"counts.{word}"), bodies)
        return entries

    def faults(self, records: Sequence[Record], complete: bool) -> list[Fault]:
        """Ranges, columns that a number does not fit, a beam that is none; `flexmb check` knows the rest."""
        last = records[-1]
        if last.section == "title":
            return _faults_of_title(last)
        found = [fault for value in last.numbers for fault in _outside(records, last, value)]
        found += faults_of_fields(last)
        if complete and not found and last.section == "beam":
            found = _faults_of_beam(last, records[1]["NDM"])
        if complete and not found and last.section == "elastic":
            size = last["NUMNP"] * last["NDF"]
            message = f"{size} elastic coordinates, at most {MOST_TYPED} are asked for: `flexmb beam --into`"
            found = [Fault("error", message, last.place, last.subject)] if size > MOST_TYPED else []
        return found

    def lines(self, records: Sequence[Record]) -> list[tuple[str, str]]:
        """The cards in the columns of their FORMATs."""
        return deck_lines(records)


class _Answers:
    """Answers so far as integers; what is missing or misspelt counts as `default`."""

    def __init__(self, values):
        self.values = values

    def integer(self, name, default=0):
        try:
            return number.integer(self.values[name])[0]
        except (KeyError, number.Misspelt):
            return default

    def kind(self, k):
        return self.values.get(f"body.{k}.kind", "").upper()

    def beam(self, k):
        """The beam of body `k`, None before all of it is known."""
        texts = {cell.key: self.values.get(f"beam.{k}.{cell.key}") for cell in _beam_entry(k).cells}
        try:
            return beam_of({key: float(number.real(t)[0]) if t else None for key, t in texts.items()})
        except (DeckError, number.Misspelt, TypeError, ValueError):
            return None

    def axes(self, k):
        """Axes of the nodal displacements of body `k` and its number of nodes."""
        if self.kind(k) == "BEAM" and (beam := self.beam(k)):
            return beam.axes, beam.nodes
        if self.kind(k) != "TYPED":
            return (), 0
        freedoms, nodes = self.integer(f"elastic.{k}.NDF"), self.integer(f"elastic.{k}.NUMNP")
        sensible = 1 <= freedoms <= 3 and 1 <= nodes * freedoms <= MOST_TYPED
        return (tuple(range(4 - freedoms, 4)), nodes) if sensible else ((), 0)


def _flags(letter, motion):
    return [
        Cell(f"{letter}.{a}", f"{motion} free, axis {a}; a flag", letter=INTEGER, default="0")
        for a in (1, 2, 3)
    ]


def _body_entry(k):
    cells = (
        Cell("L", "number of the parent; 0: inertial frame", letter=INTEGER, default=str(k - 1)),
        *_flags("NT", "translation of the hinge"),
        *_flags("NR", "rotation of the hinge"),
        Cell("kind", "RIGID, a uniform BEAM, or nodes and stiffness TYPED", "", WORD, "RIGID", _KINDS),
    )
    return Entry("body", k, f"body {k}", cells)


def _beam_entry(k):
    cells = (
        Cell("length", "length, clamped at its first end, along axis 2", "m"),
        Cell("nodes", "elements, each with a node at its end", letter=INTEGER),
        Cell("EI", "bending stiffness for deflection along axis 3", "N m^2"),
        Cell("rho", "mass per length", "kg/m"),
        Cell("offset", "clamped end from O_k", "m", default="0"),
        Cell("EA", "axial stiffness; adds displacement along axis 2", "N", default=""),
        Cell("EI_1", "bending stiffness for deflection along axis 1; needs EA", "N m^2", default=""),
        Cell("tip_mass", "mass added to the last node", "kg", default="0"),
    )
    return Entry("beam", k, f"beam of body {k}", cells)


def _block_entries(answers, k):
    if answers.kind(k) == "BEAM":
        return [_beam_entry(k)]
    if answers.kind(k) != "TYPED":
        return []
    counts = (
        Cell("NUMNP", "number of nodes", letter=INTEGER),
        Cell("NDF", "elastic freedoms of a node: 1 axis 3, 2 axes 2 and 3, 3 all", letter=INTEGER),
    )
    entries = [Entry("elastic", k, f"nodes of body {k}", counts)]
    freedoms, nodes = answers.axes(k)
    size = len(freedoms) * nodes
    if not size:
        return entries
    axes = (2, 3) if answers.integer("counts.NDM") == 2 else (1, 2, 3)
    entries += [_node_entry(k, i, axes) for i in range(1, nodes + 1)]
    heights = [Cell(f"h({j})", f"stored entries of column {j}", "", INTEGER, str(j)) for j in _to(size)]
    entries.append(Entry("skyline", k, f"stiffness of body {k}", tuple(heights)))
    for j in _to(size):
        height = answers.integer(f"skyline.{k}.h({j})")
        rows = range(max(1, j - height + 1), j + 1) if height > 0 else ()
        if rows:
            cells = tuple(Cell(f"K({i},{j})", "stiffness", "N/m") for i in rows)
            entries.append(Entry(f"stiffness.{k}", j, f"stiffness of body {k}, column {j}", cells))
    masses = tuple(Cell(f"BMI({i})", "nodal mass", "kg") for i in _to(nodes))
    return [*entries, Entry("nodal_mass", k, f"nodal masses of body {k}", masses)]


def _to(last):
    return range(1, last + 1)


def _node_entry(k, i, axes):
    cells = [Cell(f"CO.{a}", f"position from O_k, axis {a}", "m") for a in axes]
    cells += [Cell(f"PI.{a}", f"force, inertial axes, axis {a}", "N", default="0") for a in axes]
    return Entry(f"node.{k}", i, f"node {i} of body {k}", tuple(cells))


def _coordinates(answers, bodies):
    """What each coordinate is, in the order of card Y(L)."""
    for letter, motion in (("NR", "rotation about"), ("NT", "translation along")):
        for k in bodies:
            for a in (1, 2, 3):
                if answers.integer(f"body.{k}.{letter}.{a}") == 1:
                    yield f"{motion} axis {a}, hinge of body {k}"
    for k in bodies:
        axes, nodes = answers.axes(k)
        yield from (f"displacement along axis {a}, node {i} of body {k}" for i in _to(nodes) for a in axes)


def _state_entry(m, what):
    unit = "rad" if what.startswith("rotation") else "m"
    cells = (
        Cell("q", "coordinate at the start", unit, default="0"),
        Cell("u", "speed at the start", f"{unit}/s", default="0"),
    )
    return Entry("state", m, f"coordinate {m}: {what}", cells)


def _optional_entries(card, count, bodies):
    if not count or card.layout == "switch":
        return []
    if card.layout == "single":
        return [_card_entry(card, 0)]
    numbers = bodies if card.layout == "bodies" else _to(count)
    return [_card_entry(card, k) for k in numbers]


def _card_entry(card: Card, k: int) -> Entry:
    edits = fortran_format(card.format).edits[card.layout == "bodies" :]
    edits += fortran_format(card.tail).edits if card.tail else ()
    skipped = card.word == "GRAV"  # its first number is not used
    pairs = list(zip(card.items, edits, strict=False))[skipped:]
    cells = tuple(_cell(card, item, edit) for item, edit in pairs)
    subject = f"{card.word.strip()} {k}" if k else card.word.strip()
    return Entry(card.section, k, subject, cells)


def _cell(card, item, edit):
    letter = INTEGER if edit.letter == "I" else REAL
    default = None if card.word in _CARDS_WITHOUT_ZERO or item.key in ("K", "A", "KA") else "0"
    if card.word == "TOLR":
        default = ""
    if item.key == "e4":
        default = "1"
    key = item.key
    # "PH.1" makes the three axes one question.
    if key[-1] in "123" and item.meaning.endswith(f"axis {key[-1]}") and not item.meaning.startswith("1:"):
        key = f"{key[:-1]}.{key[-1]}"
    return Cell(key, item.meaning, item.unit, letter, default)


def _with_beam(entry, answers, k):
    """The share of a beam in MASS and INER of its body is offered."""
    beam = answers.beam(k) if answers.kind(k) == "BEAM" else None
    if beam is None or entry.section not in ("mass", "inertia"):
        return entry
    inertia = filled(beam.inertia, 10)
    offered = [filled(beam.mass, 10)] if entry.section == "mass" else [inertia, "0", inertia]
    cells = zip(entry.cells, offered, strict=True)
    changed = tuple(Cell(c.key, c.meaning, c.unit, c.letter, default) for c, default in cells)
    return Entry(entry.section, entry.number, entry.subject, changed)


def _faults_of_title(record):
    message = f"the heading card has room for 75 characters; read {len(record['text'])}"
    return [Fault("error", message, record.place, "title")] if len(record["text"]) > 75 else []


def _outside(records, record, value):
    least, most = _range(records, record, value.key)
    if least is None or least <= value.value <= most:
        return []
    message = f"{value.key} must be within {least}..{most}; read {value.text}"
    return [Fault("error", message, value.place, record.subject)]


def _range(records, record, key):
    """Least and most value of an integer; (None, None) where only its columns bound it."""
    bodies = records[1]["N"] if len(records) > 2 else MOST
    if record.section == "counts" and key != "NDM":
        several = key == "N" or CARDS[key].layout == "entries"
        return (int(key == "N"), MOST if several else 1)
    if key.startswith(("NT.", "NR.")) or (record.section == "closure" and key in ("C1", "C2", "C3")):
        return 0, 1
    if key.startswith("h("):
        return 1, int(key[2:-1])
    if record.section == "beam" and key == "nodes":
        return 1, MOST_OF_BEAM
    if key not in ("L", "K", "KA", "KB", "IT", "NUMNP"):
        return _RANGES.get(key, (None, None))
    own = {"L": (0, record.number - 1), "KB": (0, bodies), "IT": (1, 99_999), "NUMNP": (1, MOST_TYPED)}
    return own.get(key, (1, bodies))


def _faults_of_beam(record, dimension):
    try:
        beam: Beam = beam_of({n.key: n.value if n.text else None for n in record.numbers})
    except DeckError as failure:
        return [Fault("error", fault.message, record.place, record.subject) for fault in failure.faults]
    message = ""
    if 1 in beam.axes and dimension == 2:
        message = "deflection along axis 1 needs a deck with NDM = 3"
    elif beam.nodes * len(beam.axes) > MOST_OF_BEAM:
        message = f"more than {MOST_OF_BEAM} elastic coordinates: their skyline addresses do not fit I5"
    return [Fault("error", message, record.place, record.subject)] if message else []
