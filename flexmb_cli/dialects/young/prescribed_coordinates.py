"""Coordinates of single bodies that drivers, simplified constraints and grounds hold: once each.

Directions 1-3 are x, y, z of a body, 4-6 its Euler parameters e1, e2, e3 = sin(angle/2).  A
coordinate held twice at the same value is redundant (warning), at different values contradictory.
"""

import math
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from typing import Any

from ...errors import Place
from ...model.diagnostics import Findings
from ...model.mechanism import Driver, Ground, Mechanism

SAME_VALUE = 1e-12
MANY_HOLDS = 10_000  # holds
NO_ATTITUDE = 1e-9

_NAMES = {1: "x", 2: "y", 3: "z", 4: "the angle about x", 5: "the angle about y", 6: "the angle about z"}


@dataclass(frozen=True)
class _Hold:
    """One coordinate of one body held by the item `name`; `driver` when it moves it."""

    name: str
    body: int
    direction: int
    value: float
    place: Place | None
    driver: Driver | None = None

    @property
    def imposed(self) -> float:
        """Return what the equation imposes: the coordinate, or the Euler parameter."""
        return math.sin(self.value / 2) if self.direction > 3 else self.value


def check_held_coordinates(mechanism: Mechanism, findings: Findings) -> None:
    """Report coordinates held twice, and angles that no attitude has.

    1. A body is ground once.
    2. No coordinate is held at two values, or held and moved.
    3. A body has one rotational driver at most, and then no other angle than zero.
    4. The squares of e1, e2, e3 of one body do not exceed 1 together.
    """
    # One coordinate by itself can be held anywhere.
    for of_body in (several for several in _by_bodies(mechanism, findings) if len(several) > 1):
        _check_coordinates(of_body, findings)
        _check_rotational_drivers(of_body, findings)
        _check_attitude(of_body, findings)


def _sorted_places(held: Any) -> Any:
    """The places of numbers in ascending order of the numbers, equal ones as they stand."""
    if len(held) < MANY_HOLDS:
        return sorted(range(len(held)), key=held.__getitem__)
    # Small decks are read without numpy; of a large one a list of places would take six times the memory.
    import numpy as np

    return np.argsort(held, kind="stable").data


def _by_bodies(mechanism: Any, findings: Findings) -> Iterator[list[_Hold]]:
    """Return what holds each body; of the holds of a large deck those of one body at a time."""
    by_body: dict[int, list[_Hold]] = {}
    for hold in _of_grounds(_to_check(_first_grounds(mechanism, findings), mechanism)):
        by_body.setdefault(hold.body, []).append(hold)
    held = array("i", (item.body for item in chain(mechanism.simplified, mechanism.drivers)))
    order, given = _sorted_places(held), len(mechanism.simplified)
    for body, places in groupby(order, key=held.__getitem__):
        own = by_body.setdefault(body, [])
        own += (_of(mechanism, k, given) for k in places)
        yield by_body.pop(body)
    yield from by_body.values()


def _of(mechanism: Any, k: int, given: Any) -> _Hold:
    """The hold of simplified constraint k, or after all `given` ones of a driver."""
    if k < given:
        item = mechanism.simplified[k]
        return _Hold(item.name, item.body, item.direction, item.value, item.place)
    item = mechanism.drivers[k - given]
    return _Hold(item.name, item.body, item.direction, item.C, item.place, item)


def _first_grounds(mechanism: Mechanism, findings: Findings) -> Iterator[Ground]:
    first: dict[Any, Any] = {}
    for index, ground in enumerate(mechanism.grounds):
        earlier = first.setdefault(ground.body, index)
        if earlier == index:
            yield ground
            continue
        other = mechanism.grounds[earlier]
        if ground.values == other.values:
            message = f"body {ground.body + 1} is already {other.name}; these six equations are redundant"
            findings.warn(ground.name, message, ground.place, id="YOUNG-046")
        else:
            message = (
                f"body {ground.body + 1} is already {other.name}, at another position; remove one of them"
            )
            findings.error(ground.name, message, ground.place, id="YOUNG-047")


def _to_check(grounds: Iterator[Any], mechanism: Any) -> list[Ground]:
    """Return the grounds, few of maybe thousands, of bodies held by others, too, or with wrong angles."""
    others = {item.body for item in chain(mechanism.simplified, mechanism.drivers)}
    return [
        ground
        for ground in grounds
        if ground.body in others or sum(math.sin(angle / 2) ** 2 for angle in ground.values[3:]) > 1.0
    ]


def _of_grounds(grounds: Iterable[Ground]) -> Iterator[_Hold]:
    for ground in grounds:
        for direction, value in enumerate(ground.values, start=1):
            yield _Hold(ground.name, ground.body, direction, value, ground.place)


def _check_coordinates(holds: Sequence[_Hold], findings: Findings) -> None:
    first: dict[Any, Any] = {}
    for hold in holds:
        other = first.setdefault(hold.direction, hold)
        if other is not hold:
            _check_pair(other, hold, findings)


def _check_pair(first: _Hold, second: _Hold, findings: Findings) -> None:
    what = f"{_NAMES[second.direction]} of body {second.body + 1}"
    if _turning(first) and _turning(second):
        return  # reported as two rotational drivers
    if _moves(first) or _moves(second):
        if _function(first) == _function(second):
            message = f"{what} is already moved the same way by {first.name}; this equation is redundant"
            findings.warn(second.name, message, second.place, id="YOUNG-048")
            return
        verb = "moved" if first.driver else "held"
        message = f"{what} is already {verb} by {first.name}; remove one of them"
        findings.error(second.name, message, second.place, id="YOUNG-049")
    elif abs(first.imposed - second.imposed) <= SAME_VALUE * max(1.0, abs(first.imposed)):
        message = f"{what} is already held at this value by {first.name}; this equation is redundant"
        findings.warn(second.name, message, second.place, id="YOUNG-050")
    else:
        message = (
            f"{what} is already held at {first.value:.15g} by {first.name}; "
            f"{second.value:.15g} contradicts it"
        )
        findings.error(second.name, message, second.place, id="YOUNG-051")


def _moves(hold: _Hold) -> bool:
    return hold.driver is not None and (hold.driver.B != 0.0 or hold.driver.A != 0.0)


def _turning(hold: _Hold) -> bool:
    return hold.driver is not None and hold.direction > 3


def _function(hold: _Hold) -> Any:
    return hold.driver and (hold.driver.C, hold.driver.B, hold.driver.A)


def _check_rotational_drivers(holds: list[_Hold], findings: Findings) -> None:
    drivers = [hold for hold in holds if _turning(hold)]
    for second in drivers[1:]:
        first = drivers[0]
        message = (
            f"body {first.body + 1} is already turned by {first.name}; a body takes one rotational driver"
        )
        findings.error(second.name, message, second.place, id="YOUNG-052")
    for hold in holds if drivers else ():
        # The driver sets e0 and one of e1, e2, e3 to a cosine and a sine: the others must be zero.
        other = hold.direction > 3 and not hold.driver and hold.direction != drivers[0].direction
        if other and hold.imposed**2 > 2 * NO_ATTITUDE:
            message = (
                f"{drivers[0].name} turns body {hold.body + 1} about one axis, "
                f"so {_NAMES[hold.direction]} must be 0; read {hold.value:.15g}"
            )
            findings.error(hold.name, message, hold.place, id="YOUNG-053")


def _check_attitude(holds: list[_Hold], findings: Findings) -> None:
    angles = [hold for hold in holds if hold.direction > 3 and not hold.driver]
    total = sum({hold.direction: hold.imposed**2 for hold in angles}.values())
    if total > 1.0 + NO_ATTITUDE:
        last = [hold for hold in angles if hold.imposed][-1]
        message = (
            f"no attitude of body {last.body + 1} has these angles: the squares of sin(angle/2) "
            f"add up to {total:.6g}, more than 1"
        )
        findings.error(last.name, message, last.place, id="YOUNG-054")
