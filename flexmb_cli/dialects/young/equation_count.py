"""The historic check that equations and coordinates are equal in number, body by body where it fails.

YOUNG dissertation (1996), chapter 5: 6 NBODY = 3 NSPHER + 4 NUNIVE + 5 NREVOL + 4 NCYLIN + 5 NTRANS
+ 5 NSCREW + NSIMPL + NSIMP2 + NDRIVE + 6 NGROUN.
"""

from array import array
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import chain, pairwise
from typing import Any

from ...errors import Place
from ...model.diagnostics import Findings
from ...model.joints import BY_NAME
from ...model.mechanism import Mechanism
from . import DIALECT

SHOWN_GROUPS = 8
SHOWN_BODIES = 6
MANY_BODIES = 10_000  # beyond, groups are named only where they are not in balance
_PER_BODY = 6
_PER_PLANAR_LOOP = 3  # equations of a loop of revolute and translational joints in a plane that repeat others
PLANAR = (
    "in a loop that moves in a plane, 3 equations of revolute and translational joints repeat others: make "
    "one revolute joint a spherical one (3 equations in place of 5) and another a cylindrical one (4), which "
    "moves the same, or add DYNAMICS forward with masses, where equations may repeat"
)


def check_equation_count(mechanism: Mechanism, place: Place | None, findings: Findings) -> None:
    """Report too few or too many equations at `place`, and notes on the groups of bodies concerned.

    Ground bodies do not connect: a group is what moves together.  A group with too few equations
    is movable even where another group has so many that the sum is right.
    """
    # Once: those of a large deck are made anew each time.
    grounded = array("i", (ground.body for ground in mechanism.grounds))
    if len(mechanism.bodies) > MANY_BODIES and _balanced(mechanism, grounded):
        return
    alone = _grounds_alone(mechanism, grounded)
    links = tuple(link for link in _links(mechanism, grounded) if link[1][0] not in alone)
    equations = sum(count for count, *_ in links) + _PER_BODY * len(alone)
    coordinates = _PER_BODY * len(mechanism.bodies)
    fixed = frozenset(grounded)
    groups = _groups(len(mechanism.bodies), fixed, alone, links)
    off = [group for group in groups if group.excess]
    if equations != coordinates:
        findings.error("counts", _total(equations, coordinates, len(mechanism.bodies)), place, id="YOUNG-023")
    elif any(group.excess < 0 for group in off):
        message = "the equations are as many as the coordinates, but in the wrong places"
        findings.error("counts", message, place, id="YOUNG-024")
    else:
        return
    for group in off[:SHOWN_GROUPS]:
        findings.note("", group.sentence, mechanism.bodies[group.bodies[0]].place, id="YOUNG-025")
    if any(_may_be_planar(mechanism, group) for group in off[:SHOWN_GROUPS]):
        findings.note("", PLANAR, place, id="YOUNG-082")
    if len(off) > SHOWN_GROUPS:
        findings.note(
            "", f"{len(off) - SHOWN_GROUPS} more groups of bodies are not in balance", place, id="YOUNG-026"
        )


def imbalance(counts: Mapping[str, int]) -> str:
    """Return the fault of the twelve counts of a YOUNG deck by themselves; "" when they are in balance."""
    coordinates = _PER_BODY * counts["NBODY"]
    equations = sum(BY_NAME[name].equations * counts[word] for word, name in DIALECT.joints.items())
    equations += _PER_BODY * counts["NGROUN"]
    return "" if equations == coordinates else _total(equations, coordinates, counts["NBODY"])


def _total(equations: int, coordinates: int, bodies: int) -> str:
    many = "few" if equations < coordinates else "many"
    return (
        f"{bodies} {'body has' if bodies == 1 else 'bodies have'} {coordinates} coordinates, but the "
        f"constraints and drivers give {_many(equations)}, {abs(equations - coordinates)} too {many}"
    )


def _grounds_alone(mechanism: Mechanism, grounded: Any) -> frozenset[int]:
    """Bodies that one ground holds and nothing else touches: in balance, and maybe by the million."""
    touched = {body for _, bodies in _links(mechanism, ()) for body in bodies}
    held: set[int] = set()
    twice: set[int] = set()
    for body in grounded:
        (twice if body in held else held).add(body)
    return frozenset(held - twice - touched)


def _links(mechanism: Any, grounded: Any) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Pairs (equations, bodies they touch); `grounded` is the body of each ground."""
    for joint in mechanism.joints:
        yield BY_NAME[joint.kind].equations, (joint.i, joint.j)
    for distance in mechanism.distances:
        yield 1, (distance.i, distance.j)
    for held in chain(mechanism.simplified, mechanism.drivers):
        yield 1, (held.body,)
    for body in grounded:
        yield _PER_BODY, (body,)


def _may_be_planar(mechanism: Mechanism, group: "_Group") -> bool:
    """Return whether a group has as many equations too many as its loops would repeat in a plane."""
    bodies = set(group.bodies)
    joints = [joint.kind for joint in mechanism.joints if joint.i in bodies or joint.j in bodies]
    loops = len(joints) - len(bodies)
    planar = set(joints) <= {"revolute", "translational"}
    return planar and loops > 0 and group.excess == _PER_PLANAR_LOOP * loops


def _balanced(mechanism: Any, grounded: Any) -> bool:
    """Return whether every group of bodies has as many equations as coordinates."""
    count = len(mechanism.bodies)
    root, fixed = array("i", range(count)), bytearray(count)
    for body in grounded:
        fixed[body] = 1
    for _, touched in _links(mechanism, ()):
        for a, b in pairwise(body for body in touched if not fixed[body]):
            root[_root(root, a)] = _root(root, b)
    excess = array("i", bytes(4 * count))
    for equations, touched in _links(mechanism, grounded):
        bearing = next((body for body in touched if not fixed[body]), touched[0])
        excess[_root(root, bearing)] += equations
    for body in range(count):
        excess[_root(root, body)] -= _PER_BODY
    return not any(excess)


@dataclass
class _Group:
    """Bodies that joints connect, and the equations on them with the bodies that bear each."""

    bodies: list[int] = field(default_factory=list)
    borne: list[tuple[int, list[int]]] = field(default_factory=list)

    @property
    def excess(self) -> int:
        """Equations more than coordinates, negative for too few."""
        return self.equations - _PER_BODY * len(self.bodies)

    @property
    def equations(self) -> int:
        """All equations on the group."""
        return sum(equations for equations, _ in self.borne)

    @property
    def sentence(self) -> str:
        """The group's balance for a note."""
        balance = f"{abs(self.excess)} too {'many' if self.excess > 0 else 'few'}"
        coordinates = _PER_BODY * len(self.bodies)
        text = f"{_named(self.bodies)}: {coordinates} coordinates, {_many(self.equations)}, {balance}"
        return text if len(self.bodies) == 1 else f"{text} ({self._shares})"

    @property
    def _shares(self) -> str:
        share = dict.fromkeys(self.bodies, 0.0)
        for equations, bodies in self.borne:
            for body in bodies:
                share[body] += equations / len(bodies)
        shown = ", ".join(f"body {body + 1}: {share[body]:g}" for body in self.bodies[:SHOWN_BODIES])
        more = ", …" if len(self.bodies) > SHOWN_BODIES else ""
        return f"a joint's equations shared between its bodies, {shown}{more}; 6 each are needed"


def _many(equations: int) -> str:
    return "1 equation" if equations == 1 else f"{equations} equations"


def _named(bodies: list[int]) -> str:
    numbers = [str(body + 1) for body in bodies[:SHOWN_BODIES]]
    if len(bodies) > SHOWN_BODIES:
        return f"bodies {', '.join(numbers)} and {len(bodies) - SHOWN_BODIES} more"
    if len(bodies) == 1:
        return f"body {numbers[0]}"
    return f"bodies {', '.join(numbers[:-1])} and {numbers[-1]}"


@lru_cache(maxsize=4)
def _groups(
    bodies: int, fixed: frozenset[int], alone: frozenset[int], links: tuple[tuple[Any, ...], ...]
) -> tuple[_Group, ...]:
    """The groups in the order of their first bodies, without the balanced ones of those `alone`.

    The variants of a study mostly have the same.
    """
    root = list(range(bodies))
    for _, touched in links:
        free = [body for body in touched if body not in fixed]
        for a, b in pairwise(free):
            root[_root(root, a)] = _root(root, b)
    groups: Any = defaultdict(_Group)
    for body in (body for body in range(bodies) if body not in alone):
        groups[_root(root, body)].bodies.append(body)
    for equations, touched in links:
        bearing = [body for body in touched if body not in fixed] or list(touched[:1])
        groups[_root(root, bearing[0])].borne.append((equations, bearing))
    return tuple(groups.values())


def _root(root: Any, body: int) -> int:
    while root[body] != body:
        root[body] = root[root[body]]
        body = root[body]
    return body
