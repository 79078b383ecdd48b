"""Nodes that cards of a VSDF deck give to rigid bodies and the ground, and sets of any body's nodes."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ...deck.many_records import MANY_RECORDS, DeckValues
from ...deck.record import Record
from ...model.diagnostics import Findings
from ...model.fe_model import Arm


def given_nodes(values: DeckValues, k: int, findings: Findings) -> Mapping[int, np.ndarray]:
    """Places (3,) of the nodes of body k (0: the ground), m in its axes, by their numbers."""
    places = values.places_of_body("node", k)
    if not len(places):
        return {}
    numbers = values.column("node", "node")[places].astype(int).tolist()
    positions = np.column_stack([values.column("node", f"r.{axis}")[places] for axis in "xyz"]).astype(float)
    if min(numbers) < 1 or len(set(numbers)) < len(numbers):
        cards = values.section("node")
        _report_numbers((cards[place] for place in places), k, findings)
    if len(numbers) > MANY_RECORDS:
        return ManyNodes(numbers, positions)
    return dict(zip(numbers, positions, strict=True))


def _report_numbers(cards: Iterable[Record], k: int, findings: Findings) -> None:
    """Report nodes of body k whose number another has, or none may have."""
    seen = set()
    for record in cards:
        number = record["node"]
        if number in seen:
            owner = f"body {k}" if k else "the ground"
            findings.error(
                record.subject, f"{owner} already has a node {number}", record.at("node").place, id="VSDF-075"
            )
        if number < 1:
            message = f"node numbers begin at 1; read {number}"
            findings.error(record.subject, message, record.at("node").place, id="VSDF-076")
        seen.add(number)


def sets_of(
    values: DeckValues, k: int, nodes: Mapping[int, Any], findings: Findings
) -> dict[int, tuple[int, ...]]:
    """The sets of body k, whose `nodes` are: their nodes by the sets' numbers."""
    sets: dict[int, list[int]] = {}
    seen: dict[int, set[int]] = {number: set() for number in _of_several_cards(values, k)}
    for record in values.of_body("node_set", k):
        number = record.at("set")
        members = members_of(record, nodes, k, findings)
        _check_once(record, seen.get(number.value, set()), findings)
        if number.value in nodes:
            message = f"{number.value} is a node of body {k}; a set needs a number of its own"
            findings.error(record.subject, message, number.place, id="VSDF-077")
        elif number.value < 1:
            findings.error(
                record.subject, f"sets are numbered from 1; read {number.text}", number.place, id="VSDF-078"
            )
        elif members:
            sets.setdefault(number.value, []).extend(members)
    return {number: tuple(members) for number, members in sets.items()}


def arms_of(
    values: DeckValues, k: int, nodes: Mapping[int, Any], sets: Mapping[int, Any], findings: Findings
) -> dict[int, Arm]:
    """The arms of body k by the numbers of their ends, which neither nodes nor sets have."""
    arms: dict[int, Arm] = {}
    for record in values.of_body("arm_node", k):
        number, on = record.at("node"), record.at("on")
        if number.value in nodes or number.value in sets or number.value in arms or number.value < 1:
            message = f"{number.text} is a number of body {k} already, or below 1; an arm needs its own"
            findings.error(record.subject, message, number.place, id="VSDF-219")
        elif on.value not in nodes:
            findings.error(record.subject, f"body {k} has no node {on.text}", on.place, id="VSDF-220")
        else:
            arms[number.value] = Arm(on.value, np.array(record.vector("r"), float), record.place)
    return arms


def _of_several_cards(values: DeckValues, k: int) -> Iterator[int]:
    """Return the numbers of the sets of body k that more than one card gives."""
    places = values.places_of_body("node_set", k)
    if len(places) > 1:
        numbers, counts = np.unique(values.column("node_set", "set")[places], return_counts=True)
        yield from map(int, numbers[counts > 1])


def _check_once(record: Record, seen: set[int], findings: Findings) -> None:
    """A set is the mean of its nodes: one that it names twice would count double."""
    for number in record.numbers[2:]:
        if number.value in seen:
            findings.error(
                record.subject, f"node {number.value} is in the set already", number.place, id="VSDF-079"
            )
        seen.add(number.value)


def members_of(record: Record, nodes: Mapping[int, Any], k: int, findings: Findings) -> tuple[int, ...]:
    """The nodes a card lists that exist; the others are faults."""
    members = []
    for number in record.numbers:
        if not number.key.startswith("node"):
            continue
        if number.value in nodes:
            members.append(number.value)
        else:
            findings.error(
                record.subject, f"body {k} has no node {number.value}", number.place, id="VSDF-080"
            )
    return tuple(members)


class ManyNodes(Mapping[int, np.ndarray]):
    """Places of many nodes, (node, 3), by their numbers."""

    def __init__(self, numbers: list[int], positions: np.ndarray):
        given = np.array(numbers)
        self._order = np.argsort(given, kind="stable")
        self._numbers, self._positions = given[self._order], positions

    def __len__(self) -> int:
        return len(self._numbers)

    def __iter__(self) -> Iterator[int]:
        return iter(self._numbers[self._order.argsort()].tolist())

    def __getitem__(self, number: int) -> np.ndarray:
        place = int(self._numbers.searchsorted(number))
        if place == len(self) or self._numbers[place] != number:
            raise KeyError(number)
        return self._positions[self._order[place]]
