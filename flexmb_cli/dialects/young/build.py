"""YOUNG deck to mechanism: every record checked by itself, then the mechanism as a whole.

Liang Yong, YOUNG dissertation (1996), chapter 5: the equations must be as many as the coordinates.
"""

from collections import defaultdict
from functools import partial
from typing import Any

from ...deck.lazy import Chained, Made
from ...deck.record import Deck
from ...deck.shifted_lines import with_slip_named
from ...errors import Fault, FaultList, ModelError
from ...memory import without_collector
from ...model.diagnostics import Findings
from ...model.driver_angles import check_driver_angles
from ...model.mechanism import Mechanism
from ..elements_block.line import CONSTRAINING, lines_of
from .dynamic_cards import FORWARD, analysis_of
from .equation_count import check_equation_count
from .parts import part_of
from .prescribed_coordinates import check_held_coordinates
from .sections import YOUNG_JOINTS

_SECTIONS = ("body", "simplified", "distance", "driver", "ground", "point")


@without_collector()
def build_young(deck: Deck) -> tuple[Mechanism, list[Fault]]:
    """The mechanism that `deck` describes, and the warnings about it.

    Raises ModelError with all faults found, the deck's own warnings among them.
    """
    findings = Findings()
    parts = _parts(deck, findings)
    _refuse_if_faulty(deck, findings)
    mechanism = Mechanism(
        parts["body"],
        parts["time"][0],
        parts["joint"],
        parts["simplified"],
        parts["distance"],
        parts["driver"],
        parts["ground"],
        parts["point"],
    )
    check_held_coordinates(mechanism, findings)
    check_driver_angles(mechanism, findings)
    counted = Findings()
    # Forces may move what no equation does, and repeated equations take no part in the motion.  Cards that
    # bring in equations are checked where these stand in the model.
    analysis = analysis_of(deck)
    constraining = any(line.word in CONSTRAINING for line in lines_of(deck))
    if analysis is None or (analysis != FORWARD and not constraining):
        check_equation_count(mechanism, deck.one("counts").place, counted)
    _refuse_if_faulty(deck, findings, counted)
    return mechanism, findings.in_order


def _parts(deck: Deck, findings: Findings) -> dict[Any, Any]:
    """The parts of the mechanism by section, in the deck's order; "joint": all joints."""
    bodies, parts = len(deck.section("body")), defaultdict(list)
    are_plain = isinstance(deck.records, tuple)
    for record in deck.records:
        part, faults = _kept_part(record, bodies) if are_plain else part_of(record, bodies)
        findings.faults += faults
        if part is not None and (are_plain or record.section == "time"):
            parts[record.section].append(part)
    if are_plain:
        parts["joint"] = [joint for kind in YOUNG_JOINTS for joint in parts[kind.name]]
        return {name: tuple(parts[name]) for name in (*_SECTIONS, "joint", "time")}
    # A large deck: each part, which has no fault, is made of its record again when it is looked at.
    make = partial(_part, bodies)
    by_section = {name: Made(deck.section(name), make) for name in _SECTIONS}
    joints = Chained([Made(deck.section(kind.name), make) for kind in YOUNG_JOINTS])
    return {**by_section, "joint": joints, "time": tuple(parts["time"])}


def _part(bodies: int, record: Any) -> Any:
    return part_of(record, bodies)[0]


def _kept_part(record: Any, bodies: int) -> tuple[Any, FaultList]:
    # A study makes thousands of decks that differ in a record or two, and share the others.
    if bodies not in record.made:
        record.made[bodies] = part_of(record, bodies)
    return record.made[bodies]


def _refuse_if_faulty(deck: Deck, findings: Findings, counted: Findings | None = None) -> None:
    # The counts stand first in the deck, and the notes that follow their fault stay with it.
    faults = [*(counted.faults if counted else ()), *findings.in_order]
    if any(fault.severity == "error" for fault in faults):
        raise ModelError((*deck.warnings, *with_slip_named(faults, deck.slips)))
