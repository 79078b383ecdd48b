#!/usr/bin/env python3
"""Write a straight beam of solid elements for CalculiX, which writes its mass and stiffness matrices.

Example: scripts/brick_beam.py rod --size 0.5 0.01 0.02 --cells 12 1 1 --element C3D8I --solve
leaves rod.inp, rod.mas, rod.sti and rod.dof: node table, matrices and their rows for a VSDF deck.
C3D20R needs two cells across: a single row of them moves without strain.
"""

import argparse
import itertools
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

# Corners and middles of edges of a brick in steps of half a cell; ABAQUS and CalculiX number them so.
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
MIDDLES = [
    *[(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0)],
    *[(1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)],
    *[(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)],
]
# The six tetrahedra of a brick about its diagonal: the corners that three steps along the axes pass.
TETRAHEDRA = [
    [(0, 0, 0), tuple(2 * (d == a) for d in range(3)), tuple(2 * (d in (a, b)) for d in range(3)), (2, 2, 2)]
    for a, b in [(0, 1), (1, 2), (2, 0)]
] + [
    [(0, 0, 0), tuple(2 * (d in (a, b)) for d in range(3)), tuple(2 * (d == b) for d in range(3)), (2, 2, 2)]
    for a, b in [(0, 1), (1, 2), (2, 0)]
]
EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]


def _with_middles(corners):
    """The ten nodes of a quadratic tetrahedron."""
    middles = [tuple((p + q) // 2 for p, q in zip(corners[a], corners[b], strict=True)) for a, b in EDGES]
    return corners + middles


# The elements that fill a cell, by the places of their nodes in it.
NODES = {
    "C3D8": [CORNERS],
    "C3D8I": [CORNERS],
    "C3D20": [CORNERS + MIDDLES],
    "C3D20R": [CORNERS + MIDDLES],
    "C3D4": TETRAHEDRA,
    "C3D10": [_with_middles(corners) for corners in TETRAHEDRA],
}


@dataclass(frozen=True)
class Beam:
    """A beam along x from the origin, its section in positive y and z; m, Pa, kg/m³."""

    size: tuple[float, float, float]
    cells: tuple[int, int, int]
    element: str = "C3D20R"
    young: float = 2.1e11
    poisson: float = 0.3
    density: float = 7850.0

    def mesh(self) -> tuple[dict[int, tuple[float, ...]], list[list[int]]]:
        """Positions by node number, section by section along x, and the nodes of every element."""
        origins = [
            (2 * i, 2 * j, 2 * k) for i, j, k in itertools.product(*(range(count) for count in self.cells))
        ]
        places = [
            [tuple(map(sum, zip(o, s, strict=True))) for s in element]
            for o in origins
            for element in NODES[self.element]
        ]
        order = sorted({place for element in places for place in element})
        number = {place: i for i, place in enumerate(order, start=1)}
        scale = [length / (2 * count) for length, count in zip(self.size, self.cells, strict=True)]
        nodes = {number[p]: tuple(a * s for a, s in zip(p, scale, strict=True)) for p in order}
        return nodes, [[number[place] for place in element] for element in places]

    def section(self, x: float) -> list[int]:
        """Nodes of the section at x."""
        return [node for node, place in self.mesh()[0].items() if abs(place[0] - x) < 1e-9 * self.size[0]]

    def input(self, clamped: tuple[int, ...] = (), eigenvalues: int = 0) -> str:
        """CalculiX input: matrix storage, or so many eigenvalues of the beam held at nodes `clamped`."""
        nodes, elements = self.mesh()
        lines = ["*NODE, NSET=NALL", *(f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in nodes.items())]
        lines.append(f"*ELEMENT, TYPE={self.element}, ELSET=EALL")
        for number, element in enumerate(elements, start=1):
            # A data line holds sixteen numbers; one that ends in a comma is continued.
            words = list(map(str, (number, *element)))
            lines += [
                ", ".join(words[:16]) + ("," if len(words) > 16 else ""),
                *filter(None, [", ".join(words[16:])]),
            ]
        lines += ["*MATERIAL, NAME=MAT", "*ELASTIC", f"{self.young!r}, {self.poisson!r}"]
        lines += ["*DENSITY", f"{self.density!r}", "*SOLID SECTION, ELSET=EALL, MATERIAL=MAT"]
        if clamped:
            lines += ["*BOUNDARY", *(f"{node}, 1, 3" for node in clamped)]
        solver = (
            ["*FREQUENCY", str(eigenvalues)] if eigenvalues else ["*FREQUENCY, SOLVER=MATRIXSTORAGE", "1"]
        )
        return "\n".join([*lines, "*STEP", *solver, "*END STEP"]) + "\n"


def run_calculix(folder: Path, job: str) -> None:
    """Run ccx on `job`.inp in `folder`; raises CalledProcessError, and OSError when it wrote nothing."""
    # One thread: sums come in the same order on every machine.
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run(["ccx", "-i", job], cwd=folder, env=environment, check=True, capture_output=True)
    if not any((folder / f"{job}.{suffix}").exists() for suffix in ("mas", "dat")):
        raise OSError(f"ccx ended without results for {job}.inp")


def main():
    """Write the input and, with --solve, run it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("job", type=Path, help="path of the files, without suffix")
    parser.add_argument("--size", type=float, nargs=3, required=True, metavar=("LENGTH", "WIDTH", "HEIGHT"))
    parser.add_argument("--cells", type=int, nargs=3, required=True, metavar=("NX", "NY", "NZ"))
    parser.add_argument("--element", choices=NODES, default="C3D20R")
    parser.add_argument("--young", type=float, default=2.1e11, help="Pa")
    parser.add_argument("--poisson", type=float, default=0.3)
    parser.add_argument("--density", type=float, default=7850.0, help="kg/m^3")
    parser.add_argument("--solve", action="store_true", help="run ccx")
    given = parser.parse_args()
    beam = Beam(
        tuple(given.size), tuple(given.cells), given.element, given.young, given.poisson, given.density
    )
    given.job.with_suffix(".inp").write_text(beam.input())
    if given.solve:
        if shutil.which("ccx") is None:
            sys.exit("scripts/brick_beam.py: ccx is not installed (Debian: calculix-ccx)")
        run_calculix(given.job.parent, given.job.name)


if __name__ == "__main__":
    main()
