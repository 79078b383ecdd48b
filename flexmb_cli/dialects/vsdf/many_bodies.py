"""Bodies and joints of a large deck as rows of numbers: kept as objects, they would take many times the deck.

Each is made again when it is looked at; the same numbers give the same body or joint.
"""

import math
from abc import abstractmethod
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np

from ...deck.lazy import Lazy
from ...errors import Place
from ...model.fe_model import End, NodeJoint, RigidMass, VsdfBody
from ...model.joints import BY_NAME

_KINDS = tuple(BY_NAME)
_MOST_MADE = 1000  # objects kept, since neighbours are looked at together
_NO_PLACE = (0, 0, 0)
_OF_BODY = 26  # numbers of a row: pose 7, velocities 6, mass 1, its centre 3, inertia 9
_OF_END = 5  # numbers of an end: body, node, point
_NO_POINT = (math.nan,) * 3


class _Many(Lazy):
    """Objects by rows; a slice is a tuple."""

    def __init__(self) -> None:
        self._places = array("q")  # lines, columns and widths in the deck, one after the other
        self._kept: dict[int, Any] = {}

    def _item(self, index: int) -> Any:
        if index not in self._kept:
            if len(self._kept) >= _MOST_MADE:
                self._kept.clear()
            self._kept[index] = self._make(index)
        return self._kept[index]

    @abstractmethod
    def _make(self, index: int) -> Any:
        """Return the object of a row."""

    def _place(self, row: int) -> Place | None:
        line, column, width = self._places[3 * row : 3 * row + 3]
        return Place(line, column, width) if line else None


class ManyBodies(_Many):
    """Bodies; `nodes_of` gives the nodes of a rigid one by its number in the deck, which is 1 more."""

    def __init__(self, bodies: Iterable[VsdfBody], nodes_of: Callable[[int], Mapping[int, np.ndarray]]):
        super().__init__()
        self._rows, self._nodes_of = array("d"), nodes_of
        self._whole: dict[int, VsdfBody] = {}  # those that are more than numbers
        for k, body in enumerate(bodies):
            self._take(k, body)

    def __len__(self) -> int:
        return len(self._rows) // _OF_BODY

    def _take(self, k: int, body: VsdfBody) -> None:
        rigid = body.rigid
        self._places.extend((*(body.place or _NO_PLACE), *(body.velocity_place or _NO_PLACE)))
        if rigid is None or body.flexible is not None or body.sets or body.name != _name(k):
            self._whole[k] = body
            self._rows.extend((0.0,) * _OF_BODY)
        else:
            motion = (*body.r, *body.p, *body.velocity, *body.omega)
            self._rows.extend((*motion, rigid.mass, *rigid.centre, *rigid.inertia.ravel().tolist()))

    def _make(self, index: int) -> VsdfBody:
        if index in self._whole:
            return self._whole[index]
        row = self._rows[_OF_BODY * index : _OF_BODY * (index + 1)].tolist()
        r, p, velocity, omega, c, J = (
            row[first:last] for first, last in ((0, 3), (3, 7), (7, 10), (10, 13), (14, 17), (17, 26))
        )
        return VsdfBody(
            _name(index),
            (r[0], r[1], r[2]),
            (p[0], p[1], p[2], p[3]),
            (velocity[0], velocity[1], velocity[2]),
            (omega[0], omega[1], omega[2]),
            rigid=RigidMass(row[13], (c[0], c[1], c[2]), np.array(J).reshape(3, 3)),
            nodes=_NodesWhenAsked(self._nodes_of, index + 1),
            place=self._place(2 * index),
            velocity_place=self._place(2 * index + 1),
        )


class _NodesWhenAsked(Mapping[int, np.ndarray]):
    """Nodes of a body, found when they are first looked at."""

    def __init__(self, nodes_of: Callable[[int], Mapping[int, np.ndarray]], number: int):
        self._nodes_of, self._number = nodes_of, number

    @cached_property
    def _nodes(self) -> Mapping[int, np.ndarray]:
        return self._nodes_of(self._number)

    def __len__(self) -> int:
        return len(self._nodes)

    def __iter__(self) -> Iterator[int]:
        return iter(self._nodes)

    def __getitem__(self, number: int) -> np.ndarray:
        return self._nodes[number]


def _name(index: int) -> str:
    return f"body {index + 1}"


class ManyJoints(_Many):
    """Joints between nodes."""

    def __init__(self, joints: Iterable[NodeJoint]):
        super().__init__()
        self._rows, self._starts = array("d"), array("q")  # numbers, and where those of each joint begin
        self._numbers = array("q")  # of the joints in the deck: those with faults are left out
        for joint in joints:
            self._take(joint)

    def __len__(self) -> int:
        return len(self._starts)

    def _take(self, joint: NodeJoint) -> None:
        self._starts.append(len(self._rows))
        self._numbers.append(int(joint.name.split()[1]))
        self._places.extend(joint.place or _NO_PLACE)
        ends = ((end.body, end.node, *(end.point or _NO_POINT)) for end in (*joint.a, *joint.b))
        head = (_KINDS.index(joint.kind), joint.size, len(joint.a), len(joint.b))
        self._rows.extend((*head, *chain.from_iterable(ends)))

    def _make(self, index: int) -> NodeJoint:
        first = self._starts[index]
        kind, size, a, b = self._rows[first : first + 4]
        middle, last = (first + 4 + _OF_END * int(count) for count in (a, a + b))
        return NodeJoint(
            f"joint {self._numbers[index]}",
            _KINDS[int(kind)],
            tuple(map(self._end, range(first + 4, middle, _OF_END))),
            tuple(map(self._end, range(middle, last, _OF_END))),
            size,
            self._place(index),
        )

    def _end(self, first: int) -> End:
        body, node, x, y, z = self._rows[first : first + _OF_END]
        return End(int(body), int(node), None if math.isnan(x) else (x, y, z))
