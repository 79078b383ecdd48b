"""Nodes of an input file of Abaqus or CalculiX: given, generated, in local systems, placed by an instance.

Abaqus Keywords Reference Guide, *NODE, *NGEN, *NFILL, *NSET, *SYSTEM, *PART, *INSTANCE.
"""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .abaqus_input import Block, blocks, integers_of, reals_of, words_of
from .file_text import Line
from .matrix_file import FEFileFault
from .node_table import BASIC, Node, node_of, rotation, spanned

# Nodes that *NGEN and *NFILL may make: a few numbers in a file can ask for any amount of memory.
MOST_GENERATED = 1_000_000
# Of the distance between nodes of one number, relative to it: *NFILL makes those of a side again.
SAME_PLACE = 1e-9
_UNREAD = "it makes, moves or hides nodes, and is not read; let a preprocessor write all nodes by *NODE"
_HIDDEN = ("NCOPY", "NMAP", "IMPERFECTION", "IMPORT", "INCLUDE", "ADJUST", "SYMMETRIC")
_REFUSED = dict.fromkeys(_HIDDEN, _UNREAD) | {
    "TRANSFORM": "matrices in turned nodal axes cannot be used; write the file and the matrices without it"
}


def abaqus_nodes(path: Path) -> list[Node]:
    """Return number, position and line of every node, in the order of the file.  Raises FEFileFault."""
    return _read(path).nodes


def node_sets(path: Path) -> Callable[[str], list[int]]:
    """Return a function that gives the nodes, ascending, of a set by its name.  Raises FEFileFault."""
    return _read(path).members


def _read(path: Path) -> "_Nodes":
    nodes = _Nodes()
    for block in blocks(path):
        first = block.keyword.partition(" ")[0]
        if first in _REFUSED:
            raise block.line.fault(f"*{block.keyword}: {_REFUSED[first]}", id="FE-154")
        if block.keyword in nodes.readers:
            nodes.readers[block.keyword](block)
    unplaced = [name for name, part in nodes.parts.items() if name and part]
    if nodes.placed and unplaced:
        raise FEFileFault(f"{path.name}: part {unplaced[0]} has no instance; remove the part", id="FE-164")
    return nodes


class _Nodes:
    """The nodes read so far, and what the next ones are made of."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.parts: dict[str, list[int]] = {}  # places of their nodes in `nodes`
        self.generated, self.placed = 0, False
        self.begin()
        self.readers: dict[str, Callable[[Block], None]] = {
            "NODE": self.node,
            "NGEN": self.ngen,
            "NFILL": self.nfill,
            "NSET": self.nset,
            "SYSTEM": self.local_system,
            "PART": self.begin,
            "END PART": self.begin,
            "INSTANCE": self.instance,
            "END INSTANCE": self.begin,
        }

    def begin(self, block: Block | None = None) -> None:
        """Begin a part, or end it: numbers, sets and system of another do not count."""
        self.places: dict[int, int] = {}  # in `found`, by number
        self.sets: dict[str, list[Block | int]] = {}
        self.system, self.moved = BASIC, False
        self.part = self.parts.setdefault(block.options.get("NAME", "") if block else "", [])

    def add(self, number: int, position: Any, line: Line) -> None:
        self.places[number] = len(self.nodes)
        self.part.append(len(self.nodes))
        self.nodes.append((number, position, line))

    def join(self, block: Block, members: Iterable[Block | int]) -> None:
        if "NSET" in block.options:
            self.sets.setdefault(block.options["NSET"], []).extend(members)

    def node(self, block: Block) -> None:
        block.refuse_others("NSET", "SYSTEM", "INPUT")
        if self.moved:
            message = "nodes in a moved instance are not read; move them into its part"
            raise block.line.fault(message, id="FE-167")
        type = block.options.get("SYSTEM", "R")
        if type not in ("R", "RC", "C", "S"):
            raise block.line.fault(f"SYSTEM={type} is unknown; expected R, C or S", id="FE-155")
        system = self.system if type[0] == "R" else self.system._replace(type=type)
        for line in block.data:
            words = words_of(line)
            if len(words) > 4:
                message = f"expected three coordinates with decimal points; read '{line.text.strip()[:40]}'"
                raise line.fault(message, id="FE-165")
            number, values = node_of(line, words)
            if type == "S":  # R, theta about the z axis, phi above the plane of x and y
                values = [values[0], 90.0 - values[2], values[1]]
            self.add(number, values if system is BASIC else system.basic(values), line)
            self.join(block, [number])

    def nset(self, block: Block) -> None:
        self.join(block, [block])

    def members(self, name: str) -> list[int]:
        """Return the nodes of a set, ascending."""
        numbers: set[int] = set()
        for item in self.sets.get(name.upper().strip("\"'"), ()):
            if isinstance(item, int):
                numbers.add(item)
                continue
            item.refuse_others("NSET", "GENERATE", "INTERNAL")
            read = self.counted if "GENERATE" in item.options else integers_of
            numbers.update(*(read(line, words_of(line)) for line in item.data))
        return sorted(numbers)

    def counted(self, line: Line, words: list[str]) -> range:
        """Return the numbers first, first + step, ... last.  Raises FEFileFault for too many."""
        first, last, step = (*integers_of(line, words[:3]), 1, 1, 1)[:3]
        if not step or (last - first) % step or (last - first) // step < 0:
            message = f"an increment of {step} does not lead from {first} to {last}"
            raise line.fault(message, id="FE-157")
        self.count(line, (last - first) // step)
        return range(first, last + (1 if step > 0 else -1), step)

    def count(self, line: Line, number: int) -> None:
        self.generated += number
        if self.generated > MOST_GENERATED:
            message = f"more than {MOST_GENERATED} nodes are generated; are the numbers right?"
            raise line.fault(message, id="FE-158")

    def ngen(self, block: Block) -> None:
        block.refuse_others("NSET")
        for line in block.data:
            numbers = self.counted(line, words_of(line))
            self.between(block, line, numbers[0], numbers[-1], numbers[1:-1])

    def nfill(self, block: Block) -> None:
        block.refuse_others("NSET")
        for line in block.data:
            one, other, *rest = (*words_of(line), "")
            count, step = (*integers_of(line, [word for word in rest if word]), 0, 1)[:2]
            first, last = self.members(one), self.members(other)
            if not first or len(first) != len(last) or count < 1 or not step:
                message = "expected two sets of as many nodes, a number of intervals and an increment"
                raise line.fault(message, id="FE-159")
            self.count(line, count * len(first))
            for a, b in zip(first, last, strict=True):
                self.between(block, line, a, b, range(a + step, a + count * step, step))

    def between(self, block: Block, line: Line, first: int, last: int, inner: range) -> None:
        """Add the nodes `inner` at equal distances on the way from node `first` to `last`."""
        for number in (first, last):
            if number not in self.places:
                raise line.fault(f"*{block.keyword}: node {number} is not defined before", id="FE-185")
        a, b = (np.array(self.nodes[self.places[number]][1]) for number in (first, last))
        for k, number in enumerate(inner, start=1):
            position = a + k / (len(inner) + 1) * (b - a)
            known = self.nodes[self.places[number]][1] if number in self.places else np.inf
            if not np.abs(position - known).max() <= SAME_PLACE * np.abs(b - a).max():
                self.add(number, position.tolist(), line)
        self.join(block, (first, *inner, last))

    def local_system(self, block: Block) -> None:
        """Begin a system of origin a, b on its x axis, c on the side of its y axis; z stays without c."""
        block.refuse_others()
        rows = [reals_of(line, 6) for line in block.data[:2]]
        a, b = np.reshape(rows[0] if rows else np.zeros(6), (2, 3))
        if not rows or len(words_of(block.data[0])) <= 3:
            b = a + (1.0, 0.0, 0.0)
        if not rows[1:]:
            b = np.array([*b[:2], a[2]])
        c = np.array(rows[1][:3]) if rows[1:] else a + np.cross((0.0, 0.0, 1.0), b - a)
        axes = spanned(b - a, c - a)
        if axes is None:
            raise block.line.fault("the points of *SYSTEM lie on one line", id="FE-186")
        self.system = BASIC._replace(origin=a, axes=axes) if rows else BASIC

    def instance(self, block: Block) -> None:
        """Move the nodes of a part by a translation, then by a rotation about the line from a to b."""
        block.refuse_others("NAME", "PART")
        self.begin()
        part = block.options.get("PART", "?")
        if part not in self.parts:
            raise block.line.fault(f"part {part} is not defined before, or has two instances", id="FE-187")
        places, self.moved, self.placed = self.parts.pop(part), bool(block.data), True
        if not block.data:
            return
        shift = reals_of(block.data[0], 3)
        *line, degrees = reals_of(block.data[1], 7) if block.data[1:] else (0, 0, 0, 1, 0, 0, 0)
        a, b = np.reshape(line, (2, 3))
        if (a == b).all():
            raise block.line.fault("expected a translation, two points of an axis and an angle", id="FE-163")
        positions = np.reshape([self.nodes[place][1] for place in places], (-1, 3)) + shift - a
        for place, position in zip(places, positions @ rotation(b - a, degrees).T + a, strict=True):
            self.nodes[place] = self.nodes[place][0], position, self.nodes[place][2]
