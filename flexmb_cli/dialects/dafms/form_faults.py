"""Answers that `flexmb new dafms` refuses at once: wrong ranges, columns, beams and tables.

`flexmb check`, which the finished deck must pass, finds all other faults.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...deck.questions import MOST_ASKED
from ...deck.record import Record
from ...errors import DeckError, Fault
from ..elements_block.form import LINES, faults_of_line
from ..elements_block.text import BLOCK
from .beam import Beam
from .cards import CARDS
from .deck_writer import beam_of, faults_of_fields
from .form_blocks import MOST_TYPED
from .form_cards import MOST_POINTS

if TYPE_CHECKING:
    from ...deck.record import Number


MOST_OF_BEAM = 446  # the last whose skyline addresses fit I5
_RANGES = {
    "IDS": (0, 1),
    "IGS": (0, 1),
    "IS": (1, 5),
    "METH": (1, 4),
    "A": (1, 6),
    "NDM": (2, 3),
    "NDF": (1, 3),
}


def faults_of(records: Sequence[Record], complete: bool) -> list[Fault]:
    """Faults of the last of `records`; `complete`: all of its values are given."""
    last = records[-1]
    if last.section == "title":
        made: list[Fault] = _faults_of_title(last)
        return made
    if last.section == LINES:
        return faults_of_line(records)
    found = [fault for value in last.numbers for fault in _outside(records, last, value)]
    found += faults_of_fields(last)
    if found:
        return found
    if last.section == CARDS["NROT"].section:
        return _faults_of_node(records, last)
    if complete and last.section == "beam":
        return _faults_of_beam(last, records[1]["NDM"])
    if complete and last.section == "elastic":
        return _faults_of_size(last)
    return _faults_of_time(records[-2], last) if len(records) > 1 else []


def _faults_of_size(record: Record) -> list[Fault]:
    size = record["NUMNP"] * record["NDF"]
    message = (
        f"{size} elastic coordinates are too many to type (at most {MOST_TYPED}): use `flexmb beam --into`"
    )
    return (
        [Fault("error", message, record.place, record.subject, id="DAFMS-024")] if size > MOST_TYPED else []
    )


def _faults_of_node(records: Sequence[Record], record: Record) -> list[Fault]:
    """A node that turns is one of a flexible body."""
    body, *node = record.numbers
    by_prefix = {earlier.prefix: earlier for earlier in records}
    kind = by_prefix[f"body.{body.value}"]["kind"]
    if kind == "RIGID":
        message = f"K = {body.value} is no flexible body"
        return [Fault("error", message, body.place, record.subject, id="DAFMS-025")]
    block = by_prefix[f"beam.{body.value}"] if kind == "BEAM" else by_prefix[f"elastic.{body.value}"]
    most = block["nodes"] if kind == "BEAM" else block["NUMNP"]
    if not node or 1 <= node[0].value <= most:
        return []
    message = f"I must be within 1..{most}; read {node[0].text}"
    return [Fault("error", message, node[0].place, record.subject, id="DAFMS-026")]


def _faults_of_time(before: Record, record: Record) -> list[Any]:
    """Points of a table come in the order of time; two at one time are a jump."""
    tables = tuple(f"{CARDS[word].section}." for word in ("TABM", "TABL"))
    if not record.section.startswith(tables) or before.section != record.section:
        return []
    if record["t"] >= before["t"]:
        return []
    time = record.at("t")
    message = f"t must not be before that of the point above, {before.at('t').text}; read {time.text}"
    return [Fault("error", message, time.place, record.subject, id="DAFMS-027")]


def _faults_of_title(record: Record) -> list[Any]:
    message = f"the heading card has room for 75 characters; read {len(record['text'])}"
    return (
        [Fault("error", message, record.place, "title", id="DAFMS-028")] if len(record["text"]) > 75 else []
    )


def _outside(records: Any, record: Record, value: "Number") -> list[Any]:
    least, most = _range(records, record, value.key)
    if least is None or least <= value.value <= most:
        return []
    message = f"{value.key} must be within {least}..{most}; read {value.text}"
    return [Fault("error", message, value.place, record.subject, id="DAFMS-029")]


def _range(records: list[Record], record: Record, key: str) -> tuple[int | None, int | None]:
    """Least and most value of an integer; (None, None) where only its columns bound it."""
    bodies = records[1]["N"] if len(records) > 2 else MOST_ASKED
    if record.section in ("counts", "elements") and key != "NDM":
        several = key in ("N", BLOCK) or CARDS[key].layout == "entries"
        return (int(key == "N"), MOST_ASKED if several else 1)
    if key.startswith(("NT.", "NR.")) or (record.section == "closure" and key in ("C1", "C2", "C3")):
        return 0, 1
    if key.startswith("h("):
        return 1, int(key[2:-1])
    if record.section == "beam" and key == "nodes":
        return 1, MOST_OF_BEAM
    if record.section == CARDS["TABL"].section and key == "A":
        return 1, 3
    if record.section in (CARDS["TABM"].section, CARDS["TABL"].section) and key == "NP":
        return 1, MOST_POINTS
    if key not in ("L", "K", "KA", "KB", "IT", "NUMNP"):
        return _RANGES.get(key, (None, None))
    own = {"L": (0, record.number - 1), "KB": (0, bodies), "IT": (1, 99_999), "NUMNP": (1, MOST_TYPED)}
    return own.get(key, (1, bodies))


def _faults_of_beam(record: Record, dimension: int) -> list[Fault]:
    try:
        beam: Beam = beam_of({n.key: n.value if n.text else None for n in record.numbers})
    except DeckError as failure:
        return [
            Fault("error", fault.message, record.place, record.subject, id=fault.id)
            for fault in failure.faults
        ]
    message = ""
    if 1 in beam.axes and dimension == 2:
        message = "deflection along axis 1 needs a deck with NDM = 3"
    elif beam.nodes * len(beam.axes) > MOST_OF_BEAM:
        message = f"more than {MOST_OF_BEAM} elastic coordinates: their skyline addresses do not fit I5"
    return [Fault("error", message, record.place, record.subject, id="DAFMS-031")] if message else []
