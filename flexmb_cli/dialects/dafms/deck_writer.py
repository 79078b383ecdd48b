"""The answers of `flexmb new dafms` as the cards of FMBD.DAT, every number in the columns of its FORMAT.

Sequence and FORMATs: DAFMS thesis (Zhao, 1992), appendix C, and the reader's table of cards.
"""

from collections.abc import Sequence
from typing import Any

from ...deck.fortran_fields import filled
from ...deck.record import Number, Record
from ...errors import Fault
from ..elements_block.form import block_lines
from .beam import Beam
from .beam_cards import beam_block
from .card import Card
from .cards import CARDS

OF_EVERY_BODY = ("MASS", "INER", "Q(k)", "NOFP", "EULT", "EULL", "XI  ", "RC(K")
OPTIONAL: tuple[str, ...] = (
    "GRAV",
    "LOOP",
    "SPRI",
    "DAMP",
    "MOTR",
    "TABM",
    "PRES",
    "FORC",
    "TOQU",
    "TABL",
    "DESN",
)
OPTIONAL += ("PROD", "ELDA", "NROT", "GSTF", "UNCO", "TOLR", "METH")
ADDED = "GEOM"  # a card that FMBD.DAT did not have: its count is requested last

WIDE_REAL, _REAL, _INTEGER = 13, 10, 5
_WIDE_SECTIONS = ("stiffness.", "tolerance", "nodal_rotation.")


def _width(record: Record) -> int:
    """Columns of a real number; those of a beam stand in no card."""
    return WIDE_REAL if record.section.startswith(_WIDE_SECTIONS) else _REAL


def field(value: Number, width: int) -> str:
    """The columns of `value`: as typed where that fits and has a point, else respelled with one."""
    if isinstance(value.value, int):
        return f"{value.value:{_INTEGER}d}"
    if value.text == "" or ("." in value.text and len(value.text) <= width):
        return value.text.rjust(width)
    return filled(value.value, width).rjust(width)


def faults_of_fields(record: Record) -> list[Fault]:
    """Numbers that the columns of their FORMAT cannot hold as they were typed."""
    if record.section == "beam":
        return []
    faults = []
    for value in record.numbers:
        width = _INTEGER if isinstance(value.value, int) else _width(record)
        if isinstance(value.value, str) or _fits(value, width):
            continue
        message = f"{value.key} must fit {width} columns; read {value.text}"
        if not isinstance(value.value, int):
            message += f"; the nearest that fits is {filled(value.value, width)}"
        faults.append(Fault("error", message, value.place, record.subject, id="DAFMS-023"))
    return faults


def _fits(value: Number, width: int) -> bool:
    if isinstance(value.value, int):
        return len(str(value.value)) <= width
    if "." in value.text and len(value.text) <= width:
        return True
    return bool(float(filled(value.value, width)) == value.value)


def beam_of(numbers: dict[str, Any]) -> Beam:
    """The beam of the answers; DeckError when they make none."""
    names = ("length", "nodes", "EI", "rho", "offset", "EA", "EI_1", "tip_mass")
    return Beam(*(int(numbers[n]) if n == "nodes" else numbers[n] for n in names))


def deck_lines(records: Sequence[Record]) -> list[tuple[str, str]]:
    """The deck as pairs (line, prefix of the record that it came from or "")."""
    return _Deck(records).lines()


class _Deck:
    """Cards of a complete set of answers."""

    def __init__(self, records: Sequence[Record]):
        self.records = records
        self.by_prefix = {record.prefix: record for record in records}
        self.bodies = range(1, self.by_prefix["counts"]["N"] + 1)

    def lines(self) -> list[tuple[str, str]]:
        counts, title = self.by_prefix["counts"], self.by_prefix["title"]
        lines = [(f"{counts['N']:5d}{counts['NDM']:5d}", "counts")]
        lines += [(f"DFMB {title['text']}".rstrip(), "title"), *self._control()]
        for k in self.bodies:
            lines += self._block(k)
        lines += [("CONN", ""), *self._list([(self._body(k).at("L"), f"body.{k}") for k in self.bodies], 10)]
        for word in OF_EVERY_BODY:
            lines += self._card(CARDS[word])
        lines += self._state()
        for word in (*OPTIONAL, ADDED):
            if (counts if word in counts else self.by_prefix["elements"])[word]:
                lines += self._card(CARDS[word])
        return [*lines, *block_lines(self.records), ("END ", ""), ("STAR", ""), ("STOP", "")]

    def _body(self, k: int) -> Record:
        found: Record = self.by_prefix[f"body.{k}"]
        return found

    def _control(self) -> list[tuple[str, str]]:
        lines = [self._dofs(k, letter) for letter in ("NT", "NR") for k in self.bodies]
        sizes = [self._size(k) for k in self.bodies]
        for counts in zip(*sizes, strict=True):
            fields = [f"{count:5d}" for count in counts]
            lines += [("".join(fields[i : i + 10]), "") for i in range(0, len(fields), 10)]
        time = self.by_prefix["time"]
        return [*lines, *((field(n, _REAL), "time") for n in time.numbers)]

    def _dofs(self, k: int, letter: str) -> tuple[str, str]:
        flags = [self._body(k)[f"{letter}.{axis}"] for axis in (1, 2, 3)]
        return "".join(f"{n:5d}" for n in (k, sum(flags), *flags)), f"body.{k}"

    def _size(self, k: int) -> tuple[int, int]:
        """NUMNP and NDF."""
        if beam := self._beam(k):
            return beam.nodes, len(beam.axes)
        elastic = self.by_prefix.get(f"elastic.{k}") if self._body(k)["kind"] == "TYPED" else None
        return (elastic["NUMNP"], elastic["NDF"]) if elastic else (0, 0)

    def _beam(self, k: int) -> Any:
        if self._body(k)["kind"] != "BEAM":
            return None
        record = self.by_prefix[f"beam.{k}"]
        return beam_of({n.key: n.value if n.text else None for n in record.numbers})

    def _block(self, k: int) -> list[tuple[str, str]]:
        if beam := self._beam(k):
            text = beam_block(beam, self.by_prefix["counts"]["NDM"])
            return [(line, f"beam.{k}") for line in text.splitlines()]
        nodes, dofs = self._size(k)
        return self._typed(k, nodes * dofs) if nodes else []

    def _typed(self, k: int, size: int) -> list[tuple[str, str]]:
        nodes = [record for record in self.records if record.section == f"node.{k}"]
        half = len(nodes[0].numbers) // 2
        lines = [_indexed(record, record.numbers[:half]) for record in nodes]
        lines += [_indexed(record, record.numbers[half:]) for record in nodes]
        lines.append((f"{size:5d}", ""))
        addresses: list[Any] = []
        skyline = self.by_prefix[f"skyline.{k}"]
        for height in skyline.numbers:
            addresses.append((addresses[-1] if addresses else 0) + height.value)
        for numbers in (range(1, size + 1), addresses):
            fields = [f"{n:5d}" for n in numbers]
            lines += [("".join(fields[i : i + 10]), skyline.prefix) for i in range(0, size, 10)]
        columns = [record for record in self.records if record.section == f"stiffness.{k}"]
        lines += self._list([(n, record.prefix) for record in columns for n in record.numbers], 6, WIDE_REAL)
        masses = self.by_prefix[f"nodal_mass.{k}"]
        found: list[tuple[str, str]] = lines + self._list([(n, masses.prefix) for n in masses.numbers], 10)
        return found

    def _list(self, pairs: list[tuple[Number, str]], per_line: int, width: int = _REAL) -> list[Any]:
        """Numbers side by side; a line goes under the name of its first number's record."""
        chunks = [pairs[i : i + per_line] for i in range(0, len(pairs), per_line)]
        return [("".join(field(n, width) for n, _ in chunk), chunk[0][1]) for chunk in chunks]

    def _card(self, card: Card) -> list[tuple[str, str]]:
        records = [record for record in self.records if record.section == card.section]
        lines = [(card.word, "")]
        if card.layout == "entries":
            lines.append((f"{len(records):5d}", ""))
        for record in records:
            fields = [field(n, _width(record)) for n in record.numbers]
            if card.layout == "bodies":
                fields.insert(0, f"{record.number:5d}")
            if card.word == "GRAV":
                fields.insert(0, f"{0:5d}")
            first = card.head or len(fields)
            parts = [fields[:first], *(fields[k : k + 6] for k in range(first, len(fields), 6))]
            lines += [("".join(part), record.prefix) for part in parts if part]
            lines += self._rows(f"{card.section}.{record.number}")
        return lines

    def _rows(self, section: str) -> Any:
        """The table that follows a record: points of TABM and TABL, rotations of NROT."""
        for record in self.records:
            if record.section == section:
                yield from self._list([(n, record.prefix) for n in record.numbers], 6, _width(record))

    def _state(self) -> list[tuple[str, str]]:
        records = [record for record in self.records if record.section == "state"]
        pairs = [(record.at(key), record.prefix) for key in ("u", "q") for record in records]
        return [("Y(L)", ""), *self._list(pairs, 5)] if pairs else []


def _indexed(record: Record, numbers: Any) -> tuple[str, str]:
    return f"{record.number:5d}" + "".join(field(n, _REAL) for n in numbers), record.prefix
