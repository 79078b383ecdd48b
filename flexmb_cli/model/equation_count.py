"""The historic check that equations and coordinates are equal in number, body by body where it fails.

YOUNG dissertation (1996), chapter 5: 6 NBODY = 3 NSPHER + 4 NUNIVE + 5 NREVOL + 4 NCYLIN + 5 NTRANS
+ 5 NSCREW + NSIMPL + NSIMP2 + NDRIVE + 6 NGROUN.
"""

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise

from ..errors import Place
from .findings import Findings
from .joint_types import BY_NAME
from .mechanism import Mechanism

SHOWN_GROUPS = 8
SHOWN_BODIES = 6
_PER_BODY = 6


def check_equation_count(mechanism: Mechanism, place: Place | None, findings: Findings) -> None:
    """Report too few or too many equations at `place`, and notes on the groups of bodies concerned.

    Ground bodies do not connect: a group is what moves together.  A group with too few equations
    is movable even where another group has so many that the sum is right.
    """
    links = list(_links(mechanism))
    equations = sum(count for count, *_ in links)
    coordinates = _PER_BODY * len(mechanism.bodies)
    groups = _groups(mechanism, links)
    off = [group for group in groups if group.equations != _PER_BODY * len(group.bodies)]
    if equations != coordinates:
        findings.error("counts", _total(equations, coordinates, len(mechanism.bodies)), place)
    elif any(group.equations < _PER_BODY * len(group.bodies) for group in off):
        message = "the equations are as many as the coordinates, but in the wrong places"
        findings.error("counts", message, place)
    else:
        return
    for group in off[:SHOWN_GROUPS]:
        findings.note("", group.sentence, mechanism.bodies[group.bodies[0]].place)
    if len(off) > SHOWN_GROUPS:
        findings.note("", f"{len(off) - SHOWN_GROUPS} more groups of bodies are not in balance", place)


def _total(equations, coordinates, bodies):
    many = "few" if equations < coordinates else "many"
    return (
        f"{bodies} {'body has' if bodies == 1 else 'bodies have'} {coordinates} coordinates, but the "
        f"constraints and drivers give {equations} equations, {abs(equations - coordinates)} too {many}"
    )


def _links(mechanism) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Pairs (equations, bodies they touch)."""
    for joint in mechanism.joints:
        yield BY_NAME[joint.kind].equations, (joint.i, joint.j)
    for distance in mechanism.distances:
        yield 1, (distance.i, distance.j)
    for held in (*mechanism.simplified, *mechanism.drivers):
        yield 1, (held.body,)
    for ground in mechanism.grounds:
        yield _PER_BODY, (ground.body,)


class _Group:
    """Bodies that joints connect, the equations on them, and each body's share."""

    def __init__(self):
        self.bodies = []
        self.equations = 0
        self.shares = defaultdict(float)

    @property
    def sentence(self):
        """The group's balance for a note."""
        coordinates = _PER_BODY * len(self.bodies)
        excess = self.equations - coordinates
        balance = f"{abs(excess)} too {'many' if excess > 0 else 'few'}"
        text = f"{_named(self.bodies)}: {coordinates} coordinates, {self.equations} equations, {balance}"
        if len(self.bodies) == 1:
            return text
        shares = ", ".join(f"body {b + 1}: {self.shares[b]:g}" for b in self.bodies[:SHOWN_BODIES])
        more = ", …" if len(self.bodies) > SHOWN_BODIES else ""
        return f"{text} (a joint's equations shared between its bodies, {shares}{more}; 6 each are needed)"


def _named(bodies):
    numbers = [str(body + 1) for body in bodies[:SHOWN_BODIES]]
    if len(bodies) > SHOWN_BODIES:
        return f"bodies {', '.join(numbers)} and {len(bodies) - SHOWN_BODIES} more"
    if len(bodies) == 1:
        return f"body {numbers[0]}"
    return f"bodies {', '.join(numbers[:-1])} and {numbers[-1]}"


def _groups(mechanism, links):
    """The groups in the order of their first bodies."""
    fixed = {ground.body for ground in mechanism.grounds}
    root = list(range(len(mechanism.bodies)))
    for _, touched in links:
        free = [body for body in touched if body not in fixed]
        for a, b in pairwise(free):
            root[_root(root, a)] = _root(root, b)
    groups = defaultdict(_Group)
    for body in range(len(root)):
        groups[_root(root, body)].bodies.append(body)
    for equations, touched in links:
        bearing = [body for body in touched if body not in fixed] or touched[:1]
        group = groups[_root(root, bearing[0])]
        group.equations += equations
        for body in bearing:
            group.shares[body] += equations / len(bearing)
    return list(groups.values())


def _root(root, body):
    while root[body] != body:
        root[body] = root[root[body]]
        body = root[body]
    return body
