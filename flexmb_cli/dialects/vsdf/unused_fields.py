"""Fields of VSDF cards that are filled but not read: they are reported, since a value there is likely a slip.

A written 0 is what an empty field means, and is let pass.
"""

from collections.abc import Iterator
from typing import Any

from ...deck.many_records import DeckValues, column, places_by, without_any
from ...deck.record import Record
from ...model.diagnostics import Findings
from ...model.time_functions import SPIN_UP, TABLE
from .joints import BY_WORD
from .motions import OF_FUNCTIONS

_OF_FUNCTION = {SPIN_UP: ("c0", "c1"), TABLE: ("c0",)} | dict.fromkeys(OF_FUNCTIONS, ("c0",))
_FUNCTIONS = {SPIN_UP: "law 2 reads c0 and c1", TABLE: "law 4 reads the table's number c0"}
_FUNCTIONS |= dict.fromkeys(OF_FUNCTIONS, "law 5 or 6 reads the function's number c0")
_VALUES = {
    "force": ("F.x", "F.y", "F.z"),
    "torque": ("M.x", "M.y", "M.z"),
    "spring": ("k", "c"),
    "joint_spring": ("k", "c"),
    "damping": ("alpha", "beta", "ratio"),
}


def refuse_unread(values: DeckValues, findings: Findings) -> None:
    """Faults for fields that mean nothing where they stand, and for cards without any value."""
    for section, unread in _UNREAD.items():
        for record in values.section(section):
            for key, reason in unread(record):
                _refuse(record, key, reason, findings)
    for section, keys in _VALUES.items():
        for record in without_any(values.section(section), keys):
            message = f"{', '.join(keys)} are all empty, so the card does nothing"
            findings.error(record.subject, message, record.at(keys[0]).place, id="VSDF-083")
    _warn_of_switched_off(values, findings)


def _refuse(record: Record, key: str, reason: str, findings: Findings) -> None:
    number = record.at(key)
    if number.value:
        message = f"{key} is {number.text} and is not read: {reason}; leave the field empty"
        findings.error(record.subject, message, number.place, id="VSDF-084")


def _of_body(record: Record) -> Iterator[tuple[str, str]]:
    if record["kind"] == "RIGD":
        yield "modes", "a RIGD body has no modes"
        for key in ("n1", "n2", "n3"):
            yield key, "a RIGD body has no reference nodes, its axes are those of its RIGI and NODE cards"


def _of_joint(record: Record) -> Iterator[tuple[str, str]]:
    word, kind = record["kind"], BY_WORD[record["kind"]]
    for letter, count in (("a", kind.points_on("i")), ("b", kind.points_on("j"))):
        nodes = f"{count} node{'s' if count > 1 else ''} on {letter}"
        for i in range(count + 1, 4):
            yield f"{letter}{i}", f"{word} has {nodes}"
    if not kind.size:
        yield "size", f"{word} has neither pitch nor distance"


def _of_motion(record: Record) -> Iterator[tuple[str, str]]:
    function = record["law"]
    for key in ("c0", "c1", "c2", "c3"):
        if function in _OF_FUNCTION and key not in _OF_FUNCTION[function]:
            yield key, _FUNCTIONS[function]


def _of_stiffening(record: Record) -> Iterator[tuple[str, str]]:
    if record["on"] and not record.at("E").text:
        yield "nu", "Poisson's ratio belongs to Young's modulus E, which is empty"


def _of_spring(record: Record) -> Iterator[tuple[str, str]]:
    if not record.at("k").text:
        yield "length", "a length at rest belongs to the stiffness k, which is empty"


def _of_joint_spring(record: Record) -> Iterator[tuple[str, str]]:
    if not record.at("k").text:
        yield "q0", "a position at rest belongs to the stiffness k, which is empty"


_UNREAD = {
    "body": _of_body,
    "joint": _of_joint,
    "motion": _of_motion,
    "spring": _of_spring,
    "joint_spring": _of_joint_spring,
    "stiffening": _of_stiffening,
}


def _warn_of_switched_off(values: DeckValues, findings: Findings) -> None:
    for record in values.section("stiffening"):
        if not record["on"] and record["E"]:
            message = "E and nu are not used: stiffening is switched off, on is 0"
            findings.warn(record.subject, message, record.at("E").place, id="VSDF-085")


def warn_of_tables(values: DeckValues, tables: dict[int, Any], findings: Findings) -> None:
    """Warnings of `tables` without faults that neither a motion nor a load names."""
    used = {record["c0"] for record in values.section("motion") if record["law"] == TABLE}
    for section in ("force", "torque"):
        loads = values.section(section)
        used |= set(column(loads, "table").tolist() if values.many else (load["table"] for load in loads))
    used |= {line["points"] for line in values.section("elements") if "points" in line}
    idle = {number for number, function in tables.items() if function is not None} - used
    cards = values.section("table")
    first = {number: places[0] for number, places in places_by(cards, "table").items() if number in idle}
    for k in first.values():
        number = cards[k].at("table")
        message = (
            "nothing uses it; a motion of law 4 names a table in c0, a force or a torque in its last field, "
            "a line FUNCTION by points="
        )
        findings.warn(f"table {number.value}", message, number.place, id="VSDF-086")
