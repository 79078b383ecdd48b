"""YOUNG deck to mechanism: every record checked by itself, then the mechanism as a whole.

Liang Yong, YOUNG dissertation (1996), chapter 5: the equations must be as many as the coordinates.
"""

from collections import defaultdict
from collections.abc import Sequence

from ...collector import without_collector
from ...deck.record import Deck, Record
from ...deck.shifted_lines import with_slip_named
from ...errors import Fault, ModelError
from ...model.diagnostics import Findings
from ...model.driver_angles import check_driver_angles
from ...model.joints import JOINT_TYPES
from ...model.mechanism import Mechanism, TimeGrid
from ...quick_dataclass import dataclass
from .dynamic_cards import FORWARD, analysis_of
from .equation_count import check_equation_count
from .parts import part_of
from .prescribed_coordinates import check_held_coordinates

_HOLDERS = ("ground", "simplified", "driver")
# What checks of the whole mechanism look through once or twice at most.
_UNKEPT = ("body", "ground", "point")


@without_collector()
def build_young(deck: Deck) -> tuple[Mechanism, list[Fault]]:
    """The mechanism that `deck` describes, and the doubts about it.

    Raises ModelError with all faults found, the deck's own warnings among them.
    """
    findings = Findings()
    parts = _parts(deck, findings)
    _refuse_if_faulty(deck, findings)
    mechanism = Mechanism(
        parts["body"],
        parts["time"][0],
        tuple(joint for kind in JOINT_TYPES for joint in parts[kind.name]),
        tuple(parts["simplified"]),
        tuple(parts["distance"]),
        tuple(parts["driver"]),
        parts["ground"],
        parts["point"],
    )
    check_held_coordinates(mechanism, findings)
    check_driver_angles(mechanism, findings)
    counted = Findings()
    # Forces may move what no equation does, and repeated equations take no part in the motion.
    if analysis_of(deck) != FORWARD:
        check_equation_count(mechanism, deck.one("counts").place, counted)
    _refuse_if_faulty(deck, findings, counted)
    return mechanism, findings.in_order


def faults_of_last(records: Sequence[Record], bodies: int, complete: bool = True) -> list[Fault]:
    """Faults and doubts that the last of `records` brings into a deck in the making of `bodies` bodies.

    The records before it are complete and without errors; the last may lack its later numbers
    (not `complete`).  What is known only of a whole deck (equations, assembly) is not looked at.
    """
    last = records[-1]
    part, faults = part_of(last, bodies, complete)
    findings = Findings(list(faults))
    if part and last.section in _HOLDERS and not faults:
        check_held_coordinates(_holders(records, bodies), findings)
    return findings.in_order


def _holders(records, bodies):
    made = {name: [] for name in _HOLDERS}
    for record in records:
        if record.section in made:
            made[record.section].append(part_of(record, bodies)[0])
    grounds, simplified, drivers = (tuple(made[name]) for name in _HOLDERS)
    return Mechanism((), TimeGrid(0.0, 0.0, 1.0), simplified=simplified, drivers=drivers, grounds=grounds)


def _parts(deck, findings):
    """The parts of the mechanism by section, in the deck's order."""
    bodies, parts = len(deck.section("body")), defaultdict(list)
    kept = isinstance(deck.records, tuple)
    for record in deck.records:
        part, faults = _kept_part(record, bodies) if kept else part_of(record, bodies)
        findings.faults += faults
        if part is not None and (kept or record.section not in _UNKEPT):
            parts[record.section].append(part)
    for section in _UNKEPT:
        parts[section] = tuple(parts[section]) if kept else _Parts(deck.section(section), bodies)
    return parts


def _kept_part(record, bodies):
    # A study makes thousands of decks that differ in a record or two, and share the others.
    if bodies not in record.made:
        record.made[bodies] = part_of(record, bodies)
    return record.made[bodies]


@dataclass(frozen=True)
class _Parts(Sequence):
    """Parts of a large deck, each made of its record, which has no fault, when it is looked at."""

    records: Sequence[Record]
    bodies: int

    def __len__(self) -> int:
        return len(self.records)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return tuple(self[k] for k in range(len(self))[index])
        return part_of(self.records[index], self.bodies)[0]


def _refuse_if_faulty(deck, findings, counted=None):
    # The counts stand first in the deck, and the notes that follow their fault stay with it.
    faults = [*(counted.faults if counted else ()), *findings.in_order]
    if any(fault.severity == "error" for fault in faults):
        raise ModelError((*deck.warnings, *with_slip_named(faults, deck.slips)))
