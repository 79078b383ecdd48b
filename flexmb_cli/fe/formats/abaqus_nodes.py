"""Nodes of an input file of Abaqus or CalculiX: given, generated, in local systems, placed by an instance.

Abaqus Keywords Reference Guide, *NODE, *NGEN, *NFILL, *NSET, *SYSTEM, *PART, *INSTANCE.
"""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from .abaqus_input import Block, blocks, integers_of, reals_of, words_of
from .coordinate_systems import BASIC, rotation, spanned
from .included_files import Line
from .matrix_file import FEFileFault
from .node_table import node_of

# Nodes that *NGEN and *NFILL may make: a few numbers in a file can ask for any amount of memory.
MOST_GENERATED = 1_000_000
# Of the distance between nodes of one number, relative to it: *NFILL makes those of a side again.
SAME_PLACE = 1e-9
_UNREAD = "it makes, moves or hides nodes, and is not read; let a preprocessor write all nodes by *NODE"
_REFUSED = dict.fromkeys(("NCOPY", "NMAP", "IMPERFECTION", "IMPORT", "INCLUDE"), _UNREAD) | {
    "TRANSFORM": "matrices in turned nodal axes cannot be used; write the file and the matrices without it"
}


def abaqus_nodes(path: Path) -> list[tuple[int, Any, Line]]:
    """Return number, position and line of every node, in the order of the file.  Raises FEFileFault."""
    nodes = _Nodes()
    for block in blocks(path):
        if block.keyword in _REFUSED:
            raise block.line.fault(f"*{block.keyword}: {_REFUSED[block.keyword]}", id="FE-154")
        reader = nodes.readers.get(block.keyword)
        if reader:
            reader(block)
    unplaced = [name for name, places in nodes.parts.items() if places and name and name not in nodes.placed]
    if nodes.placed and unplaced:
        message = f"{path.name}: part {unplaced[0]} has no instance; remove the part"
        raise FEFileFault(message, id="FE-164")
    return nodes.found


class _Nodes:
    """The nodes read so far, and what the next ones are made of."""

    def __init__(self) -> None:
        self.found: list[tuple[int, Any, Line]] = []
        self.parts: dict[str, list[int]] = {"": []}  # places of their nodes in `found`
        self.placed: set[str] = set()  # parts that have an instance
        self.begin("")
        self.generated = 0
        self.readers: dict[str, Callable[[Block], None]] = {
            "NODE": self.node,
            "NGEN": self.ngen,
            "NFILL": self.nfill,
            "NSET": self.nset,
            "SYSTEM": self.local_system,
            "PART": lambda block: self.begin(block.options.get("NAME", "")),
            "END PART": lambda _: self.begin(""),
            "INSTANCE": self.instance,
            "END INSTANCE": lambda _: self.begin(""),
        }

    def begin(self, part: str) -> None:
        """Begin a part: numbers, sets and system of another do not count."""
        self.places: dict[int, int] = {}  # in `found`, by number
        self.sets: dict[str, list[Block | int]] = {}
        self.system, self.moved = BASIC, False
        self.part = self.parts.setdefault(part, [])

    def add(self, number: int, position: Any, line: Line) -> None:
        self.places[number] = len(self.found)
        self.part.append(len(self.found))
        self.found.append((number, position, line))

    def join(self, block: Block, numbers: Iterable[int]) -> None:
        if name := block.options.get("NSET"):
            self.sets.setdefault(name, []).extend(numbers)

    def node(self, block: Block) -> None:
        block.refuse_others("NSET", "SYSTEM", "INPUT")
        if self.moved:
            raise block.line.fault("nodes of a moved instance are not read; put them into its part", id="FE-167")
        type = block.options.get("SYSTEM", "R")
        if type not in ("R", "RC", "C", "S"):
            raise block.line.fault(f"SYSTEM={type} is unknown; R, C or S wanted", id="FE-155")
        system = self.system if type[0] == "R" else self.system._replace(type=type)
        for line in block.data:
            words = words_of(line)
            if len(words) > 4:
                message = f"three coordinates with decimal points wanted; read '{line.text.strip()[:40]}'"
                raise line.fault(message, id="FE-165")
            number, values = node_of(line, words)
            if type == "S":  # R, theta about the z axis, phi above the plane of x and y
                values = [values[0], 90.0 - values[2], values[1]]
            self.add(number, values if system is BASIC else system.basic(values), line)
            self.join(block, [number])

    def nset(self, block: Block) -> None:
        self.sets.setdefault(block.options.get("NSET", ""), []).append(block)

    def members(self, name: str) -> list[int]:
        """Return the nodes of a set in ascending order."""
        numbers: list[int] = []
        for item in self.sets.get(name.upper().strip("\"'"), ()):
            if isinstance(item, int):
                numbers.append(item)
                continue
            item.refuse_others("NSET", "GENERATE", "INTERNAL")
            for line in item.data:
                generated = "GENERATE" in item.options
                numbers.extend(self.counted(line, _steps(line)) if generated else integers_of(line, words_of(line)))
        return sorted(set(numbers))

    def counted(self, line: Line, numbers: range) -> range:
        self.generated += len(numbers)
        if self.generated > MOST_GENERATED:
            message = f"more than {MOST_GENERATED} nodes are generated; are the numbers right?"
            raise line.fault(message, id="FE-158")
        return numbers

    def ngen(self, block: Block) -> None:
        block.refuse_others("NSET")
        for line in block.data:
            numbers = _steps(line)
            self.between(block, line, numbers[0], numbers[-1], numbers[1:-1])

    def nfill(self, block: Block) -> None:
        block.refuse_others("NSET")
        for line in block.data:
            one, other, *rest = (*words_of(line), "", "")
            count, step = (*integers_of(line, [word for word in rest if word]), 0, 1)[:2]
            first, last = self.members(one), self.members(other)
            if not first or len(first) != len(last) or count < 1 or not step:
                message = "two sets of as many nodes, a number of intervals and an increment wanted"
                raise line.fault(message, id="FE-159")
            for a, b in zip(first, last, strict=True):
                self.between(block, line, a, b, range(a + step, a + count * step, step))

    def between(self, block: Block, line: Line, first: int, last: int, inner: range) -> None:
        """Add the nodes `inner` at equal distances on the way from node `first` to `last`."""
        for number in (first, last):
            if number not in self.places:
                raise line.fault(f"*{block.keyword}: node {number} is not defined before", id="FE-160")
        a, b = (np.array(self.found[self.places[number]][1]) for number in (first, last))
        for k, number in enumerate(self.counted(line, inner), start=1):
            position = a + k / (len(inner) + 1) * (b - a)
            known = self.found[self.places[number]][1] if number in self.places else np.inf
            if not np.abs(position - known).max() <= SAME_PLACE * np.abs(b - a).max():
                self.add(number, position.tolist(), line)
        self.join(block, (first, *inner, last))

    def local_system(self, block: Block) -> None:
        """Begin a system of origin a, b on its x axis, c on the side of its y axis; z stays without c."""
        block.refuse_others()
        a, b, c = np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        rows = [reals_of(line) for line in block.data]
        if rows and len(rows[0]) <= 3:
            a = _filled(rows[0], 3)
            b, c = a + b, a + c
        elif rows:
            a, b = _filled(rows[0], 6).reshape(2, 3)
            c = _filled(rows[1], 3) if rows[1:] else a + np.cross((0.0, 0.0, 1.0), b - a)
            b = b if rows[1:] else np.array([*b[:2], a[2]])
        axes = spanned(b - a, c - a)
        if axes is None:
            raise block.line.fault("the points of *SYSTEM lie on one line", id="FE-161")
        self.system = BASIC if not rows else BASIC._replace(origin=a, axes=axes)

    def instance(self, block: Block) -> None:
        """Move the nodes of a part by a translation, then by a rotation about the line from a to b."""
        block.refuse_others("NAME", "PART")
        part = block.options.get("PART", "")
        if part in self.placed:
            raise block.line.fault(f"part {part} has two instances; let a preprocessor join them", id="FE-162")
        self.begin("")
        self.placed.add(part)
        rows = [reals_of(line) for line in block.data]
        shift = _filled(rows[0] if rows else [], 3)
        a, b = _filled(rows[1][:6] if rows[1:] else [0.0, 0.0, 0.0, 1.0], 6).reshape(2, 3)
        degrees = rows[1][6] if rows[1:] and len(rows[1]) == 7 else 0.0
        if (a == b).all() or len(rows) > 2:
            message = "a translation, two points and an angle wanted, on two lines"
            raise block.line.fault(message, id="FE-163")
        places, self.moved = self.parts.get(part, []), bool(rows)
        R, positions = rotation(b - a, degrees), [self.found[place][1] for place in places]
        moved = (np.reshape(positions, (-1, 3)) + shift - a) @ R.T + a
        for place, position in zip(places, moved.tolist(), strict=True):
            self.found[place] = self.found[place][0], position, self.found[place][2]


def _filled(values: list[float], count: int) -> Any:
    """Return `values` with zeros up to `count`."""
    return np.array((values + [0.0] * count)[:count])


def _steps(line: Line) -> range:
    """Return the numbers first, first + step, ... last of a line."""
    first, last, step = (*integers_of(line, words_of(line)[:3]), 1, 1, 1)[:3]
    if not step or (last - first) % step or (last - first) // step < 0:
        message = f"an increment of {step} does not lead from {first} to {last}"
        raise line.fault(message, id="FE-157")
    return range(first, last + (1 if step > 0 else -1), step)
