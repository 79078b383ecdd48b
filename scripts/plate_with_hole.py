#!/usr/bin/env python3
"""Write a strap with a round hole in its middle, meshed by bricks of 20 nodes, as node and element table.

Example: scripts/plate_with_hole.py decks/vsdf/fe/strap.inp --rings 3 --sectors 8
The strap lies along x, its middle at the origin; elements are refined towards the hole.
"""

import argparse
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Strap:
    """Half of length and width, radius of the hole, thickness, m; elements across and along edges.

    `rings`: elements from the hole to the square about it; `sectors`: elements along a half side of the
    square; `ends`: elements from the square to each end; `growth`: thickness of the ring behind the last
    one by that of the first.
    """

    length: float = 0.15
    width: float = 0.02
    radius: float = 0.004
    thickness: float = 0.004
    rings: int = 3
    sectors: int = 2
    ends: int = 3
    growth: float = 6.5536

    def mesh(self) -> tuple[dict[int, tuple[float, float, float]], list[list[int]]]:
        """Positions by node number, and the nodes of the elements in the order of Abaqus."""
        patches = [self._around(k) for k in range(8)] + [self._end(side) for side in (-1, 1)]
        places: dict[tuple[float, float, float], int] = {}
        elements = [
            [self._number(places, node) for node in element] for patch in patches for element in patch
        ]
        return {number: place for place, number in places.items()}, elements

    def _number(self, places, place):
        # Corners that meet differ by round-off.
        key = tuple(round(float(x), 9) + 0.0 for x in place)
        return places.setdefault(key, len(places) + 1)

    def _around(self, k):
        """Elements between an eighth of the hole and the square of the strap's width about it."""
        first, last = k * math.pi / 4, (k + 1) * math.pi / 4

        def at(s, t):
            angle = first + (last - first) * t
            direction = np.array([math.cos(angle), math.sin(angle)])
            outer = self.width / max(abs(direction)) * direction
            # Elements grow outwards in a geometric series; the second power keeps middles in the middle.
            return (1 - s) * self.radius * direction + s * outer

        return self._patch(at, [self._graded(i) for i in range(self.rings + 1)], self.sectors)

    def _graded(self, i):
        ratio = self.growth ** (1 / self.rings)
        return (ratio**i - 1) / (ratio**self.rings - 1)

    def _end(self, side):
        """Elements from the square to an end, for both halves of the width."""

        def at(s, t):
            x = side * (self.width + s * (self.length - self.width))
            half = math.tan((t - 0.5) * math.pi / 2)
            return np.array([x, side * half * self.width])

        steps = [i / self.ends for i in range(self.ends + 1)]
        return self._patch(at, steps, 2 * self.sectors)

    def _patch(self, at, steps, count):
        """Elements between lines s of `steps` and `count` intervals of t; the plane, then the thickness."""
        h = self.thickness / 2
        for low, high in itertools.pairwise(steps):
            for j in range(count):
                t0, t1 = j / count, (j + 1) / count
                corners = [(low, t0), (high, t0), (high, t1), (low, t1)]
                flat = [at(s, t) for s, t in corners]
                middles = [at((low + high) / 2, t0), at(high, (t0 + t1) / 2), at((low + high) / 2, t1)]
                middles.append(at(low, (t0 + t1) / 2))
                yield [
                    *((*p, -h) for p in flat), *((*p, h) for p in flat),
                    *((*p, -h) for p in middles), *((*p, h) for p in middles), *((*p, 0.0) for p in flat),
                ]  # fmt: skip

    def input(self) -> str:
        """Node and element tables of CalculiX and Abaqus."""
        nodes, elements = self.mesh()
        lines = ["*NODE", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in nodes.items())]
        lines.append("*ELEMENT, TYPE=C3D20")
        for number, element in enumerate(elements, start=1):
            words = list(map(str, (number, *element)))
            lines += [", ".join(words[:11]) + ",", ", ".join(words[11:])]
        return "\n".join(lines) + "\n"


def main():
    """Write the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", type=Path)
    for name in ("rings", "sectors", "ends"):
        parser.add_argument(f"--{name}", type=int, default=getattr(Strap, name))
    given = parser.parse_args()
    given.file.write_text(Strap(rings=given.rings, sectors=given.sectors, ends=given.ends).input())


if __name__ == "__main__":
    main()
