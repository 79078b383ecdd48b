"""The answers of `flexmb new dafms` as the cards of FMBD.DAT, every number in the columns of its FORMAT.

Sequence and FORMATs: DAFMS thesis (Zhao, 1992), appendix C, and the reader's table of cards.  What has not
been asked for yet is written as zero, so that the deck so far can be read.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import accumulate
from typing import Any

from ...deck.dialogue import Line
from ...deck.fortran_card import fortran_format
from ...deck.fortran_fields import filled
from ...deck.record import Number, Record
from ..elements_block.questions import block_lines
from .beam import Beam
from .beam_cards import beam_block
from .cards import CARDS, Card

OF_EVERY_BODY = ("MASS", "INER", "Q(k)", "NOFP", "EULT", "EULL", "XI  ", "RC(K")
OPTIONAL: tuple[str, ...] = (
    *("GRAV", "LOOP", "SPRI", "DAMP", "MOTR", "TABM", "PRES", "FORC", "TOQU", "TABL", "DESN"),
    *("PROD", "ELDA", "NROT", "GSTF", "UNCO", "TOLR", "METH"),
)
TABLES = ("TABM", "TABL")
# Of bodies whose cards are not known yet: no fault of theirs hides those of others.
_FIRST = ("MASS", "INER")

_WIDE_REAL, _REAL, _INTEGER = 13, 10, 5
_WIDE = ("stiffness.", "tolerance", "nodal_rotation.")


def beam_of(record: Record) -> Beam:
    """The beam of an answer; DeckError when it makes none."""
    given: dict[str, Any] = {n.key: n.value if n.text else None for n in record.numbers}
    names = ("length", "nodes", "EI", "rho", "offset", "EA", "EI_1", "tip_mass")
    return Beam(*(given[name] for name in names))


def deck_lines(records: Sequence[Record], block: Sequence[str] = ()) -> list[Line]:
    """The deck in pieces, none before there is a body; `block`: lines of elements that no record holds."""
    return _Deck(records).lines(block) if any(record.section == "body" for record in records) else []


def _field(record: Record, value: Number) -> tuple[str, str]:
    """The columns of `value`: as typed where that fits and has a point, else respelled with one."""
    name = f"{record.prefix}.{value.key}"
    if isinstance(value.value, int):
        return f"{value.value:{_INTEGER}d}", name
    width = _WIDE_REAL if record.section.startswith(_WIDE) else _REAL
    as_typed = value.text == "" or ("." in value.text and len(value.text) <= width)
    return (value.text if as_typed else filled(value.value, width)).rjust(width), name


def _fields(record: Record) -> Line:
    return [_field(record, value) for value in record.numbers]


def _rows(pieces: Iterable[tuple[str, str]], per_line: int) -> list[Line]:
    """Pieces side by side."""
    fields = list(pieces)
    return [fields[i : i + per_line] for i in range(0, len(fields), per_line)]


def _integers(values: Iterable[int], name: str = "") -> list[Line]:
    return _rows([(f"{value:{_INTEGER}d}", name) for value in values], 10)


class _Deck:
    """Cards of the answers so far; bodies are those that are answered."""

    def __init__(self, records: Sequence[Record]):
        self.records = records
        self.of: dict[str, list[Record]] = defaultdict(list)
        for record in records:
            self.of[record.section].append(record)
        self.counts = self.of["counts"][0]
        self.bodies = self.of["body"]
        self.beams = {record.number: beam_of(record) for record in self.of["beam"]}
        # A body whose block is not complete is rigid so far.
        typed = {record.number for record in self.of["nodal_mass"]}
        self.sizes = {r.number: (r["NUMNP"], r["NDF"]) for r in self.of["elastic"] if r.number in typed}
        self.sizes |= {k: (beam.nodes, len(beam.axes)) for k, beam in self.beams.items()}

    def lines(self, block: Sequence[str]) -> list[Line]:
        title = self.of["title"][0]
        lines: list[Line] = [*_integers([len(self.bodies), self.counts["NDM"]])]
        lines += [[("DFMB ", ""), *((n.text, "title.text") for n in title.numbers)], *self._control()]
        for body in self.bodies:
            lines += self._block(body.number)
        parents = [_field(body, body.at("L")) for body in self.bodies]
        lines += [[("CONN", "")], *_rows(parents, 10)]
        for word in OF_EVERY_BODY:
            lines += self._card(CARDS[word])
        lines += self._state()
        for word in (*OPTIONAL, "GEOM"):
            if self.of[CARDS[word].section] or (CARDS[word].layout == "switch" and self.counts[word]):
                lines += self._card(CARDS[word])
        lines += [*block_lines(self.records), *([(line, "")] for line in block)]
        return [*lines, *([(word, "")] for word in ("END ", "STAR", "STOP"))]

    def _control(self) -> list[Line]:
        lines: list[Line] = []
        for letter in ("NT", "NR"):
            for body in self.bodies:
                flags = [body.at(f"{letter}.{axis}") for axis in (1, 2, 3)]
                free = sum(flag.value for flag in flags)
                lines.append([*_integers([body.number, free])[0], *(_field(body, flag) for flag in flags)])
        for which in (0, 1):
            lines += _integers(self.sizes.get(body.number, (0, 0))[which] for body in self.bodies)
        return [*lines, *([field] for field in _fields(self.of["time"][0]))]

    def _block(self, k: int) -> list[Line]:
        if k in self.beams:
            text = beam_block(self.beams[k], self.counts["NDM"])
            return [[(line, f"beam.{k}.length")] for line in text.splitlines()]
        return self._typed(k) if k in self.sizes else []

    def _typed(self, k: int) -> list[Line]:
        nodes, half = self.of[f"node.{k}"], len(self.of[f"node.{k}"][0].numbers) // 2
        lines: list[Line] = []
        for part in (slice(half), slice(half, None)):
            lines += [[*_integers([node.number])[0], *_fields(node)[part]] for node in nodes]
        heights = next(record for record in self.of["skyline"] if record.number == k).values
        lines += _integers([len(heights)])
        for numbers in (range(1, len(heights) + 1), accumulate(heights)):
            lines += _integers(numbers, f"skyline.{k}.h(1)")
        lines += _rows((field for column in self.of[f"stiffness.{k}"] for field in _fields(column)), 6)
        masses = next(record for record in self.of["nodal_mass"] if record.number == k)
        return [*lines, *_rows(_fields(masses), 10)]

    def _card(self, card: Card) -> list[Line]:
        records = {record.number: record for record in self.of[card.section]}
        lines: list[Line] = [[(card.word, "")]]
        if card.layout == "entries":
            lines += _integers([len(records)])
        missing = [body.number for body in self.bodies if body.number not in records]
        for number in sorted([*records, *(missing if card.layout == "bodies" else ())]):
            ahead = _integers([number])[0] if card.layout == "bodies" else []
            if number not in records:
                lines.append([*ahead, *self._unknown(card)])
                continue
            fields: list[tuple[str, str]] = [
                *(_integers([0])[0] if card.word == "GRAV" else []),
                *_fields(records[number]),
            ]
            table = self.of[f"{card.section}.{number}"]
            if card.word in TABLES:
                # As many points as are answered.
                fields[-1] = f"{len(table) or 1:{_INTEGER}d}", fields[-1][1]
                lines += [fields, *(_fields(point) for point in table)]
                lines += [[("0.0".rjust(_REAL) * 2, "")]] * (not table)
                continue
            first = card.head or len(fields)
            lines += [[*ahead, *fields[:first]], *_rows(fields[first:], 6)]
            for row in table or self._no_rotations(card, records[number]):
                lines += _rows(_fields(row) if isinstance(row, Record) else row, 6)
        return lines

    def _unknown(self, card: Card) -> Line:
        """The numbers of a body before its questions: it has mass, and is not turned."""
        texts = ["0" if edit.letter == "I" else "0.0" for edit in fortran_format(card.format).edits[1:]]
        if card.word in _FIRST:
            texts = ["1.0"] * len(texts)
        if card.word in ("EULT", "EULL"):
            texts[-1] = "1.0"
        widths = (edit.width for edit in fortran_format(card.format).edits[1:])
        return [("".join(text.rjust(width) for text, width in zip(texts, widths, strict=True)), "")]

    def _no_rotations(self, card: Card, head: Record) -> list[Line]:
        """Rows of card NROT before their questions."""
        if card.word != "NROT":
            return []
        nodes, dofs = self.sizes.get(head["K"], (0, 0))
        return [[("0.0".rjust(_WIDE_REAL), "")] * (nodes * dofs)] * 3 if nodes else []

    def _state(self) -> list[Line]:
        flags = sum(
            body[f"{letter}.{axis}"] for body in self.bodies for letter in ("NT", "NR") for axis in (1, 2, 3)
        )
        count = flags + sum(nodes * dofs for nodes, dofs in self.sizes.values())
        known = self.of["state"]
        zeros = [("0.0".rjust(_REAL), "")] * (count - len(known))
        pieces = [piece for key in ("u", "q") for piece in (*(_field(r, r.at(key)) for r in known), *zeros)]
        return [[("Y(L)", "")], *_rows(pieces, 5)] if pieces else []
