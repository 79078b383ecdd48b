"""Finite-element bodies of a result, whose elements it holds: nodes, cells, motion and stresses over time."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import h5py
import numpy as np

from ..hdf5.stored_result import Damaged, check_shapes
from ..hdf5.stress import POISSON, YOUNG
from .scene import rotations

# Corners of the faces, anticlockwise from outside, and the edges with their middles, nodes from 0.
_HEXAHEDRON = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_HEXAHEDRON_EDGES = (
    (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7),
)  # fmt: skip
_TETRAHEDRON = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
FACES = {4: _TETRAHEDRON, 8: _HEXAHEDRON, 10: _TETRAHEDRON, 20: _HEXAHEDRON}
_EDGES = {10: _TETRAHEDRON_EDGES, 20: _HEXAHEDRON_EDGES}
# Triangles of a face by its nodes in turn: corners alone, or a corner and the middle behind it.
_TRIANGLES = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2), (0, 2, 3)),
    6: ((0, 1, 5), (2, 3, 1), (4, 5, 3), (1, 3, 5)),
    8: ((0, 1, 7), (2, 3, 1), (4, 5, 3), (6, 7, 5), (1, 3, 5), (1, 5, 7)),
}


def outer_faces_of_elements(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces (f, s) that only one element has, and the rows (f,) of `cells` (m, k) that have them.

    A face has its nodes in turn, from outside; that of a quadratic element its middles between its corners.
    """
    faces = _rings(cells.shape[1])
    corners = 3 if cells.shape[1] in (4, 10) else 4
    every = cells[:, faces].reshape(-1, faces.shape[1])
    # Middles follow from the corners.
    keys = np.sort(every[:, :: faces.shape[1] // corners], axis=1)
    _, first, counts = np.unique(keys, axis=0, return_index=True, return_counts=True)
    outer = np.sort(first[counts == 1])
    return every[outer], outer // len(faces)


def _rings(nodes: int) -> np.ndarray:
    """Nodes of the faces of an element of so many nodes, in turn."""
    middles = {
        frozenset(edge): middle
        for middle, edge in enumerate(_EDGES.get(nodes, ()), start=4 if nodes == 10 else 8)
    }
    rings = []
    for face in FACES[nodes]:
        ring = []
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            ring += [a, middles[frozenset((a, b))]] if middles else [a]
        rings.append(ring)
    return np.array(rings)


def triangles(faces: np.ndarray) -> np.ndarray:
    """Triangles (t, 3) of faces (f, s)."""
    return faces[:, _TRIANGLES[faces.shape[1]]].reshape(-1, 3)


def face_edges(faces: np.ndarray) -> np.ndarray:
    """Lines (l, 2) along the edges of faces (f, s), each once."""
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


_SHAPES = {"node_position": "n3", "shape": "n3m", "node": "n", "cell": "ek", "element": "e"}
_CONSTANTS = (YOUNG, POISSON)
# Of the elements that `OUTS` selects: names of VTK's cell data, and axes behind those of time and element.
ELEMENT_SERIES = {
    "element_stress": ("stress", "element_tensor", "6"),
    "element_von_mises": ("stress", "element_von_mises", ""),
    "element_principal_stress": ("stress", "element_principal", "3"),
    "element_strain": ("strain", "element_tensor", "6"),
    "strain_energy": ("strain", "element_energy", ""),
}
_SERIES = ("amplitude", "rate", "origin", "turn", "velocity", "spin")


class HookesLaw(NamedTuple):
    """A material."""

    young: float  # Young's modulus, Pa
    poisson: float  # Poisson's ratio


@dataclass(frozen=True, eq=False)
class ElementBody:
    """A body of n nodes, `cells` (m, k) of rows of nodes, and N modes; SI units.

    `undeformed` (n, 3), `shape` (n, 3, N), `stress_shape` (n, 6, N), None without a material: body axes;
    `amplitude`, `rate` (T, N); `origin`, `velocity`, `spin` (T, 3): global axes; `turn` (T, 3, 3): body to
    global axes;
    `element_numbers` (m,): those of the file.
    `material`: None in results of earlier versions; `selected` (e,): rows of `cells` of the elements that
    `of_elements` is about, arrays (T, e, ...) by names of `ELEMENT_SERIES`.
    """

    number: int
    name: str
    node_numbers: np.ndarray
    cells: np.ndarray
    undeformed: np.ndarray
    shape: np.ndarray
    stress_shape: np.ndarray | None
    amplitude: np.ndarray
    rate: np.ndarray
    origin: np.ndarray
    turn: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    element_numbers: np.ndarray
    material: HookesLaw | None = None
    selected: np.ndarray | None = None
    of_elements: dict[str, np.ndarray] | None = None

    def at(self, rows: slice) -> "ElementBody":
        """Return the body at some of its rows."""
        of_elements = {key: values[rows] for key, values in (self.of_elements or {}).items()}
        return replace(self, of_elements=of_elements, **{key: getattr(self, key)[rows] for key in _SERIES})

    def deformation(self, row: int) -> np.ndarray:
        """Elastic displacements (n, 3) of the nodes in a row, global axes."""
        return self.shape @ self.amplitude[row] @ self.turn[row].T

    def places(self, row: int, scale: float = 1.0) -> np.ndarray:
        """Positions (n, 3) of the nodes in a row, global axes, deformed `scale` times as much."""
        undeformed_places: np.ndarray = self.origin[row] + self.undeformed @ self.turn[row].T
        return undeformed_places + scale * self.deformation(row)

    def velocities(self, row: int) -> np.ndarray:
        """Velocities (n, 3) of the nodes in a row, global axes: v + omega x (x - r) + A Phi eta'."""
        offsets = self.places(row) - self.origin[row]
        relative = self.shape @ self.rate[row] @ self.turn[row].T
        return self.velocity[row] + np.cross(self.spin[row], offsets) + relative

    def stress(self, row: int) -> np.ndarray:
        """Stresses (n, 6) xx yy zz xy yz zx of the nodes in a row, body axes; nan if not known."""
        if self.stress_shape is None:
            return np.full((len(self.undeformed), 6), np.nan)
        return self.stress_shape @ self.amplitude[row]


def element_bodies(result: h5py.File, names: tuple[str, ...], rows: slice) -> Iterator[ElementBody]:
    """The bodies of `result` that have elements, in the deck's order.  Raises `Damaged`."""
    for number, name in enumerate(names, start=1):
        group = f"elastic/{name}"
        if f"{group}/cell" in result:
            yield _body(result, number, name, rows)


def _body(result: h5py.File, number: int, name: str, rows: slice) -> ElementBody:
    group, modal = f"elastic/{name}", f"modal/{name}"
    shapes = {f"{group}/{key}": letters for key, letters in _SHAPES.items()}
    series = {f"{modal}/{key}": "tm" for key in ("amplitude", "rate")}
    missing = [path for path in (*shapes, *series) if path not in result]
    stress = f"{group}/stress_shape"
    if missing:
        raise Damaged(f"/{missing[0]} is missing")
    check_shapes(result, shapes | series | {stress: "n6m"}, {"t": len(result["time"])})
    numbers = result[f"{group}/node"][:]
    one = number - 1
    undeformed, shape = (result[f"{group}/{key}"][:] for key in ("node_position", "shape"))
    amplitude, rate = (result[f"{modal}/{key}"][rows] for key in ("amplitude", "rate"))
    body = ElementBody(
        number,
        name,
        numbers,
        _rows_of(result[f"{group}/cell"][:], numbers, name),
        undeformed,
        shape,
        result[stress][:] if stress in result else None,
        amplitude,
        rate,
        result["body/position"][rows, one],
        rotations(result["body/euler_parameters"][rows, one]),
        result["body/velocity"][rows, one],
        result["body/angular_velocity"][rows, one],
        result[f"{group}/element"][:],
        _material(result, group),
    )
    return _with_elements(result, body, rows)


def _material(result: h5py.File, group: str) -> HookesLaw | None:
    paths = [f"{group}/{key}" for key in _CONSTANTS]
    check_shapes(result, dict.fromkeys(paths, ""), {})
    if not all(path in result for path in paths):
        return None
    young, poisson = (float(result[path][()]) for path in paths)
    if not (0 < young < math.inf and -1 < poisson < 0.5):
        raise Damaged(f"/{group} has a material of E = {young:g} Pa and nu = {poisson:g}")
    return HookesLaw(young, poisson)


def _with_elements(result: h5py.File, body: ElementBody, rows: slice) -> ElementBody:
    """Return the body with what the result has of its elements along time."""
    number = f"stress/{body.name}/element"
    paths = {key: f"{kind}/{body.name}/{name}" for key, (kind, name, _) in ELEMENT_SERIES.items()}
    if number not in result or any(path not in result for path in paths.values()):
        return body
    shapes = {path: f"te{ELEMENT_SERIES[key][2]}" for key, path in paths.items()}
    check_shapes(result, {number: "e"} | shapes, {"t": len(result["time"])})
    places = {element: row for row, element in enumerate(body.element_numbers.tolist())}
    selected = result[number][:].tolist()
    if not places.keys() >= set(selected):
        raise Damaged(f"/{number} names elements that {body.name} has not")
    series = {key: result[path][rows] for key, path in paths.items()}
    return replace(body, selected=np.array([places[one] for one in selected]), of_elements=series)


def _rows_of(cells: np.ndarray, numbers: np.ndarray, name: str) -> np.ndarray:
    """Cells (m, k) of node numbers as rows of the body's nodes."""
    if cells.shape[1] not in FACES or not len(cells):
        raise Damaged(f"the elements of {name} have {cells.shape[1]} nodes")
    order = np.argsort(numbers)
    rows = order[np.minimum(np.searchsorted(numbers[order], cells), len(order) - 1)]
    if (numbers[rows] != cells).any():
        raise Damaged(f"the elements of {name} have nodes that the body has not")
    return rows
