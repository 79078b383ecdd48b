"""Straight uniform beam along axis 2 of its body, clamped at O_k + offset, for the FE block of FMBD.DAT.

Euler–Bernoulli elements with Hermite (cubic) deflection; the nodal rotations are condensed statically
(Guyan), which is exact for the nodal deflections of a uniform beam; half of an element's mass goes to
each of its ends.

Skyline storage of a symmetric matrix, as DFIN of DAFMS reads it (thesis of Zhao, 1992, appendix C).

Columns of the upper triangle stand one after the other, each from its first stored row down to the
diagonal; `addresses` (n,) are those of the diagonals, counted from 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import DeckError, Fault


@dataclass(frozen=True)
class Beam:
    """A beam of `length` (m) in `nodes` equal elements, its first end clamped at `offset` (m) from O_k.

    `EI`: bending stiffness for deflection along axis 3, N m²; `EA`: axial stiffness, N, which adds the
    displacement along axis 2; `EI_1`: bending stiffness for deflection along axis 1, which needs `EA`
    too; `rho`: mass per length, kg/m; `tip_mass`: kg, added to the last node.
    """

    length: float
    nodes: int
    EI: float
    rho: float
    offset: float = 0.0
    EA: float | None = None
    EI_1: float | None = None
    tip_mass: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what is no beam."""
        faults = [
            Fault("error", f"{name} must be above zero, read {value:g}", None, "beam", id="DAFMS-001")
            for name, value in self._positive()
            if not 0 < value < float("inf")
        ]
        if not 0 <= self.tip_mass < float("inf") or not abs(self.offset) < float("inf"):
            faults.append(
                Fault(
                    "error",
                    "offset and tip mass must be finite, the mass not negative",
                    None,
                    "beam",
                    id="DAFMS-002",
                )
            )
        if self.EI_1 is not None and self.EA is None:
            faults.append(
                Fault(
                    "error",
                    "deflection along axis 1 needs EA: nodes have axes 3, 2-3 or 1-3",
                    None,
                    "beam",
                    id="DAFMS-003",
                )
            )
        if faults:
            raise DeckError(faults)

    def _positive(self) -> list[tuple[str, float]]:
        named = [(name, getattr(self, name)) for name in ("length", "nodes", "EI", "rho", "EA", "EI_1")]
        return [(name, value) for name, value in named if value is not None]

    @property
    def step(self) -> float:
        """Length of an element, m."""
        return self.length / self.nodes

    @property
    def axes(self) -> tuple[int, ...]:
        """Axes of the nodal displacements, ascending."""
        return (*((1,) if self.EI_1 else ()), *((2,) if self.EA else ()), 3)

    @property
    def positions(self) -> np.ndarray:
        """Distance of every node from O_k along axis 2, (nodes,), m."""
        return self.offset + self.length * np.arange(1, self.nodes + 1) / self.nodes

    @property
    def masses(self) -> np.ndarray:
        """Lumped masses (nodes,), kg; the root's half element is no node's."""
        masses = np.full(self.nodes, self.rho * self.step)
        masses[-1] = self.rho * self.step / 2 + self.tip_mass
        return masses

    @property
    def mass(self) -> float:
        """Mass of the whole beam with its tip mass, kg: its share of card MASS."""
        return self.rho * self.length + self.tip_mass

    @property
    def inertia(self) -> float:
        """About axis 1 or 3 at O_k: nodes, and the root's half element at its own place, kg m².

        The half element reaches h/2 from the clamped end; about that end it has rho h³/24, without
        which the coupled mass matrix would not be positive definite.
        """
        h, a = self.step, self.offset
        half = self.rho * ((a + h / 2) ** 3 - a**3) / 3
        return float(self.masses @ self.positions**2) + half

    @property
    def stiffness(self) -> np.ndarray:
        """Condensed matrix (NM, NM), node by node, axes ascending, clamped at the root, N/m."""
        n, count = self.nodes, len(self.axes)
        blocks = {1: self.EI_1 or 0.0, 3: self.EI}
        matrix = np.zeros((n * count, n * count))
        for i, axis in enumerate(self.axes):
            block = self._axial() if axis == 2 else blocks[axis] / self.step**3 * unit_bending(n)[0]
            matrix[i::count, i::count] = block
        return matrix

    def _axial(self) -> Any:
        matrix = 2 * np.eye(self.nodes) - np.eye(self.nodes, k=1) - np.eye(self.nodes, k=-1)
        matrix[-1, -1] = 1
        assert self.EA is not None, "axis 2 needs EA"
        return self.EA / self.step * matrix

    def nodal_rotation(self, node: int) -> np.ndarray:
        """Rotation (3, NM) of a node, counted from 1, per unit of each elastic coordinate, rad/m.

        The slope of a deflection along axis 3 turns about +axis 1, along axis 1 about -axis 3.
        """
        slope = unit_bending(self.nodes)[1][node - 1] / self.step
        count = len(self.axes)
        rotation = np.zeros((3, self.nodes * count))
        for i, axis in enumerate(self.axes):
            if axis == 3:
                rotation[0, i::count] = slope
            elif axis == 1:
                rotation[2, i::count] = -slope
        return rotation


def unit_bending(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Condensed stiffness and slopes, both (n, n), of a cantilever of `n` elements with h = EI = 1."""
    size = 2 * n + 2
    matrix = np.zeros((size, size))
    element = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], float)
    for first in range(0, 2 * n, 2):
        matrix[first : first + 4, first : first + 4] += element
    # The first node is the clamped end.
    deflections, turned = slice(2, size, 2), slice(3, size, 2)
    slopes = -np.linalg.solve(matrix[turned, turned], matrix[turned, deflections])
    condensed = matrix[deflections, deflections] + matrix[deflections, turned] @ slopes
    return (condensed + condensed.T) / 2, slopes


def full_matrix(addresses: Sequence[int], packed: Sequence[float]) -> np.ndarray:
    """The symmetric matrix (n, n) of `packed`; `addresses` must be valid (the reader has checked them)."""
    values = np.asarray(packed, float)
    matrix = np.zeros((len(addresses), len(addresses)))
    before = 0
    for column, address in enumerate(addresses):
        top = column + 1 - (address - before)
        matrix[top : column + 1, column] = values[before:address]
        matrix[column, top : column + 1] = values[before:address]
        before = address
    return matrix


def full_columns(matrix: np.ndarray) -> tuple[list[int], np.ndarray]:
    """Addresses and packed entries of `matrix` (n, n) with every column stored from its first row."""
    n = len(matrix)
    packed = [matrix[: column + 1, column] for column in range(n)]
    return [j * (j + 1) // 2 for j in range(1, n + 1)], np.concatenate(packed)
