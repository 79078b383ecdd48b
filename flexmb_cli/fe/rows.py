"""Rows of a body's matrices that are more than x y z of every node: rotations, modal rows, rows left out.

A row is a node and a component, 1 to 3 a displacement along, 4 to 6 a rotation about, an axis of the node's
displacement frame, or a modal row (component 0), which has no point.  Rotations and modal rows have units of
their own: here they are scaled so that all rows are lengths of one order, L the largest distance from the
centre of the nodes.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from .formats.matrix_file import MODAL, ROTATIONS, TRANSLATIONS, FEFileFault, MatrixFile, check_labels
from .linear_algebra import as_array
from .nodal_matrices import check_finite, full_matrix

# Rows of a dense body: its matrices take 8 bytes for every two rows, its eigenvectors minutes.
MOST_DENSE_ROWS = 6000
ROWS_NAMED = 6


@dataclass(frozen=True)
class Rows:
    """Labels and places of rows: `nodes` (k,) place of the node in the table, -1 of modal rows.

    `directions` (k, 3) of the displacement or rotation and `positions` (k, 3), in one set of axes, from one
    origin, m; 0 for modal rows.  `labels` (k, 2): number of the node or point, component.
    """

    labels: np.ndarray
    nodes: np.ndarray
    directions: np.ndarray
    positions: np.ndarray

    @property
    def components(self) -> np.ndarray:
        """Components of the rows (k,), 0 of modal ones."""
        return self.labels[:, 1]

    @cached_property
    def shifting(self) -> np.ndarray:
        """Return which rows are displacements, (k,)."""
        return np.isin(self.components, TRANSLATIONS)

    @cached_property
    def turning(self) -> np.ndarray:
        """Return which rows are rotations, (k,)."""
        return np.isin(self.components, ROTATIONS)

    @property
    def rigid(self) -> np.ndarray:
        """Rows of unit translations along, and rotations about, the axes through the origin, (k, 6)."""
        shapes = np.zeros((len(self.labels), 6))
        shifting, turning = self.shifting, self.turning
        shapes[shifting, :3] = self.directions[shifting]
        shapes[shifting, 3:] = np.cross(self.positions[shifting], self.directions[shifting])
        shapes[turning, 3:] = self.directions[turning]
        return shapes

    def of(self, nodes: Any) -> np.ndarray:
        """Return the rows of node numbers, sorted."""
        return np.flatnonzero(np.isin(self.labels[:, 0], nodes) & (self.components > 0))

    def triples(self, first: int) -> dict[int, np.ndarray]:
        """Rows (3,) of nodes, by their place, that have the components `first`, + 1 and + 2."""
        rows_of_node: dict[int, np.ndarray] = {}
        for c in range(3):
            for row in np.flatnonzero(self.components == first + c):
                rows_of_node.setdefault(int(self.nodes[row]), np.full(3, -1))[c] = row
        return {node: rows for node, rows in rows_of_node.items() if (rows >= 0).all()}

    def seen_from(self, origin: np.ndarray, axes: np.ndarray) -> "Rows":
        """The same rows from `origin` (3,) in the axes that are the columns of `axes` (3, 3)."""
        placed = (self.positions - origin) @ axes
        return replace(self, directions=self.directions @ axes, positions=placed)

    def name(self, row: int) -> str:
        """Readable name of a row."""
        number, component = self.labels[row]
        return f"modal row {number}" if component == MODAL else f"node {number}, component {component}"

    def names(self, rows: np.ndarray) -> str:
        """Readable names of the first of some rows."""
        more = f" and {len(rows) - ROWS_NAMED} more" if len(rows) > ROWS_NAMED else ""
        return "; ".join(self.name(int(row)) for row in rows[:ROWS_NAMED]) + more


@dataclass(frozen=True)
class RowMatrices:
    """Mass and stiffness (k, k) of a body by rows, and the places of these in both files, -1: not there."""

    M: np.ndarray
    K: np.ndarray
    rows: Rows
    in_mass: np.ndarray  # (k,)
    in_stiffness: np.ndarray  # (k,)

    def seen_from(self, origin: np.ndarray, axes: np.ndarray) -> "tuple[RowMatrices, np.ndarray]":
        """The matrices for rows along `axes` (3, 3) of all nodes that have three; and B of old = B new."""
        rows = self.rows.seen_from(origin, axes)
        B = np.eye(len(self.M))
        directions = rows.directions.copy()
        for first in (1, 4):
            for triple in rows.triples(first).values():
                B[np.ix_(triple, triple)] = rows.directions[triple]
                directions[triple] = np.eye(3)
        rows = replace(rows, directions=directions)
        return replace(self, M=B.T @ self.M @ B, K=B.T @ self.K @ B, rows=rows), B

    def scales(self) -> np.ndarray:
        """Factors (k,) that make lengths of rotations and modal rows: row = factor times length."""
        r = self.rows
        factors = np.ones(len(self.M))
        shifted = r.positions[r.shifting]
        size = np.abs(shifted - shifted.mean(axis=0)).max() if len(shifted) else 1.0
        factors[r.turning] = 1.0 / (size or 1.0)
        diagonal, modal = self.M.diagonal(), r.components == MODAL
        largest = diagonal[r.shifting].max(initial=0.0) or 1.0
        heavy = modal & (diagonal > 0.0)
        factors[heavy] = np.sqrt(largest / diagonal[heavy])
        return factors


def is_general(files: list[MatrixFile], nodes: int) -> bool:
    """Return whether files have rows other than x y z of every one of so many nodes."""
    bare = [file.size >= 6 * nodes for file in files if file.equations is None]
    if bare:
        return all(bare)
    labels = [file.equations[_filled(file)][:, 1] for file in files if file.equations is not None]
    return any(np.isin(components, TRANSLATIONS, invert=True).any() for components in labels)


def _filled(file: MatrixFile) -> np.ndarray:
    """Return which rows of a file hold a number other than 0."""
    filled = np.zeros(file.size, dtype=bool)
    entries = file.values != 0.0
    filled[file.rows[entries]] = filled[file.columns[entries]] = True
    return filled


def labels_of(name: str, file: MatrixFile, numbers: np.ndarray) -> np.ndarray:
    """Labels (size, 2) of the rows of a file; without any, three a node, or six and modal rows after them."""
    if file.equations is not None:
        check_labels(name, file.equations, "; each row has a label of its own")
        return file.equations
    each = 3 if file.size == 3 * len(numbers) else 6
    nodal = each * len(numbers)
    if file.size < nodal:
        message = f"{name} has {file.size} rows, and {len(numbers)} nodes have three or six rows each"
        raise FEFileFault(message + "; name the rows by node and component", id="FE-147")
    labels = np.zeros((file.size, 2), dtype=np.int64)
    pairs = np.repeat(numbers, each), np.tile(np.arange(1, each + 1), len(numbers))
    labels[:nodal] = np.column_stack(pairs)
    labels[nodal:, 0] = numbers.max() + 1 + np.arange(file.size - nodal)
    return labels


def row_matrices(names: tuple[str, str], files: tuple[MatrixFile, MatrixFile], table: Any) -> RowMatrices:
    """Mass and stiffness, in this order in `names` and `files`, of the nodes of `table`, empty rows left out.

    `table` has numbers (n,), positions (n, 3) and displacement axes (n, 3, 3) or None.  Raises FEFileFault.
    """
    own = [labels_of(*pair, table.numbers)[_filled(pair[1])] for pair in zip(names, files, strict=True)]
    labels = np.unique(np.concatenate(own), axis=0)
    if len(labels) > MOST_DENSE_ROWS:
        raise FEFileFault(
            f"{names[1]} has {len(labels)} rows with rotations or modal rows: a body of these is computed "
            f"with full matrices, of at most {MOST_DENSE_ROWS} rows (this one would take "
            f"{5 * 8e-9 * len(labels) ** 2:.2g} GB); reduce it in its program (Guyan, Craig-Bampton)",
            id="FE-133",
        )
    (M, in_mass), (K, in_stiffness) = (
        in_rows(*pair, table.numbers, labels) for pair in zip(names, files, strict=True)
    )
    return RowMatrices(M, K, _rows(names[1], labels, table), in_mass, in_stiffness)


def in_rows(
    name: str, file: MatrixFile, numbers: np.ndarray, labels: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The matrix of a file for rows `labels` (k, 2), 0 in those that it lacks; their places in it, or -1.

    Raises FEFileFault, also for rows with entries that `labels` lack.
    """
    check_finite(name, file)
    own = labels_of(name, file, numbers)
    at = {tuple(label): k for k, label in enumerate(own.tolist())}
    filled = {tuple(label) for label in own[_filled(file)].tolist()}
    foreign = sorted(filled - set(map(tuple, labels.tolist())))
    if foreign:
        node, component = foreign[0]
        message = f"has {len(foreign)} rows that mass and stiffness lack: node {node}, component {component}"
        raise FEFileFault(f"{name} {message}; export all of them from one model", id="FE-330")
    place = np.array([at.get(tuple(label), -1) for label in labels.tolist()])
    there = np.flatnonzero(place >= 0)
    whole, full = np.zeros((len(labels), len(labels))), full_matrix(name, file)
    whole[np.ix_(there, there)] = as_array(full[place[there]][:, place[there]])
    return whole, place


def _rows(name: str, labels: np.ndarray, table: Any) -> Rows:
    order = np.argsort(table.numbers)
    place = order[np.searchsorted(table.numbers, labels[:, 0], sorter=order).clip(max=len(order) - 1)]
    known, modal = table.numbers[place] == labels[:, 0], labels[:, 1] == MODAL
    lost = np.flatnonzero(~known & ~modal)
    if len(lost):
        nodes = sorted({int(node) for node in labels[lost, 0]})
        more = ", …" if len(nodes) > ROWS_NAMED else ""
        raise FEFileFault(
            f"{name} has rows of nodes that the node table lacks: {', '.join(map(str, nodes[:ROWS_NAMED]))}"
            f"{more}; with rotations every node needs its place (negative numbers are of "
            "internal nodes of elements: condense them in their program)",
            id="FE-134",
        )
    place = np.where(modal, -1, place)
    directions, positions = np.zeros((2, len(labels), 3))
    own = np.flatnonzero(~modal)
    axes = np.broadcast_to(np.eye(3), (len(order), 3, 3)) if table.axes is None else table.axes
    directions[own] = axes[place[own], :, (labels[own, 1] - 1) % 3]
    positions[own] = table.positions[place[own]]
    return Rows(labels, place, directions, positions)
