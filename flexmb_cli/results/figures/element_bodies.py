"""Finite-element bodies of a result, whose elements it holds: nodes, cells, motion and stresses over time."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import h5py
import numpy as np

from ...quick_dataclass import dataclass, replace
from ..hdf5.stored_result import Damaged, check_shapes
from ..hdf5.stress import MOST_STRESSES, von_mises
from .element_faces import FACES
from .scene import rotations

_SHAPES = {
    "node_position": "n3",
    "shape": "n3m",
    "stress_shape": "n6m",
    "node": "n",
    "cell": "ek",
    "element": "e",
}
_SERIES = ("amplitude", "rate", "origin", "turn", "velocity", "spin")


@dataclass(frozen=True, eq=False)
class ElementBody:
    """A body of n nodes, `cells` (m, k) of rows of nodes, and N modes; SI units.

    `undeformed` (n, 3), `shape` (n, 3, N), `stress_shape` (n, 6, N): body axes; `amplitude`, `rate` (T, N);
    `origin`, `velocity`, `spin` (T, 3): global axes; `turn` (T, 3, 3): body to global axes.
    """

    number: int
    name: str
    node_numbers: np.ndarray
    cells: np.ndarray
    undeformed: np.ndarray
    shape: np.ndarray
    stress_shape: np.ndarray
    amplitude: np.ndarray
    rate: np.ndarray
    origin: np.ndarray
    turn: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray

    def at(self, rows: slice) -> "ElementBody":
        """Return the body at some of its rows."""
        return replace(self, **{key: getattr(self, key)[rows] for key in _SERIES})

    def deformation(self, row: int) -> np.ndarray:
        """Elastic displacements (n, 3) of the nodes in a row, global axes."""
        return self.shape @ self.amplitude[row] @ self.turn[row].T

    def places(self, row: int) -> np.ndarray:
        """Positions (n, 3) of the nodes in a row, global axes."""
        return self.origin[row] + self.undeformed @ self.turn[row].T + self.deformation(row)

    def velocities(self, row: int) -> np.ndarray:
        """Velocities (n, 3) of the nodes in a row, global axes: v + omega x (x - r) + A Phi eta'."""
        arms = self.places(row) - self.origin[row]
        relative = self.shape @ self.rate[row] @ self.turn[row].T
        return self.velocity[row] + np.cross(self.spin[row], arms) + relative

    def stress(self, row: int) -> np.ndarray:
        """Stresses (n, 6) xx yy zz xy yz zx of the nodes in a row, body axes."""
        return self.stress_shape @ self.amplitude[row]


def element_bodies(result: h5py.File, names: tuple[str, ...], rows: slice) -> Iterator[ElementBody]:
    """The bodies of `result` that have elements, in the deck's order.  Raises `Damaged`."""
    for number, name in enumerate(names, start=1):
        group = f"elastic/{name}"
        if f"{group}/cell" in result:
            yield _body(result, number, name, rows)


def largest_stress(bodies: Sequence[ElementBody]) -> float:
    """Return the largest equivalent stress at a node of `bodies` in any row, Pa; 0 without bodies."""
    return max((_largest(body.stress_shape, body.amplitude, von_mises) for body in bodies), default=0.0)


def largest_deformation(bodies: Sequence[ElementBody]) -> float:
    """Return the longest elastic displacement of a node of `bodies` in any row, m; 0 without bodies."""
    return max((_largest(body.shape, body.amplitude, _lengths) for body in bodies), default=0.0)


def _lengths(vectors: np.ndarray) -> np.ndarray:
    return np.sqrt(np.square(vectors).sum(axis=-1))


# What is not finite has no colour.
@np.errstate(all="ignore")
def _largest(shape: np.ndarray, amplitude: np.ndarray, measure: Callable[[np.ndarray], np.ndarray]) -> float:
    """Return the largest finite `measure` of `shape` (n, k, N) times a row of `amplitude` (T, N)."""
    most, rows = 0.0, max(1, MOST_STRESSES // max(1, math.prod(shape.shape[:2])))
    for first in range(0, len(amplitude), rows):
        values = measure(np.moveaxis(shape @ amplitude[first : first + rows].T, 1, -1))
        most = max(most, float(np.max(values, where=np.isfinite(values), initial=0.0)))
    return most


def _body(result: Any, number: Any, name: Any, rows: Any) -> ElementBody:
    group, modal = f"elastic/{name}", f"modal/{name}"
    shapes = {f"{group}/{key}": letters for key, letters in _SHAPES.items()}
    series = {f"{modal}/{key}": "tm" for key in ("amplitude", "rate")}
    missing = [path for path in (*shapes, *series) if path not in result]
    if missing:
        raise Damaged(f"/{missing[0]} is missing")
    check_shapes(result, shapes | series, {"t": len(result["time"])})
    numbers = result[f"{group}/node"][:]
    one = number - 1
    return ElementBody(  # type: ignore[call-arg]
        number,
        name,
        numbers,
        _rows_of(result[f"{group}/cell"][:], numbers, name),
        *(result[f"{group}/{key}"][:] for key in ("node_position", "shape", "stress_shape")),
        *(result[f"{modal}/{key}"][rows] for key in ("amplitude", "rate")),
        result["body/position"][rows, one],
        rotations(result["body/euler_parameters"][rows, one]),
        result["body/velocity"][rows, one],
        result["body/angular_velocity"][rows, one],
    )


def _rows_of(cells: np.ndarray, numbers: np.ndarray, name: str) -> np.ndarray:
    """Cells (m, k) of node numbers as rows of the body's nodes."""
    if cells.shape[1] not in FACES or not len(cells):
        raise Damaged(f"the elements of {name} have {cells.shape[1]} nodes")
    order = np.argsort(numbers)
    found = order[np.minimum(np.searchsorted(numbers[order], cells), len(order) - 1)]
    if (numbers[found] != cells).any():
        raise Damaged(f"the elements of {name} have nodes that the body has not")
    return found
