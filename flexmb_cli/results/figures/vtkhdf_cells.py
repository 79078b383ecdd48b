"""A result with finite elements as VTKHDF: cells of an unstructured grid whose points move.

VTKHDF 2.3, "Temporal UnstructuredGrid" (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/):
points of all steps stand one behind the other, the cells are given once and every step refers to them.
"""

from typing import Any

import h5py
import numpy as np

from ..hdf5.stress import von_mises
from .element_bodies import ElementBody
from .scene import GROUND, DrawnBody, Scene

# Types of VTK by the nodes of an element; nodes stand in the order of Abaqus in all four.
CELL_TYPES = {4: 10, 8: 12, 10: 24, 20: 25}
VERTEX, LINE = 1, 3
# Name of the point data: components of a point.
FIELDS = {"displacement": 3, "deformation": 3, "velocity": 3, "stress": 6, "von_mises": 1}


def write_cells(root: h5py.Group, scene: Scene, bodies: list[ElementBody]) -> None:
    """Fill the group VTKHDF: elements as cells, other bodies of the scene as lines between their marks.

    `displacement` is from the first row, `deformation` the elastic one, m, `velocity` m/s, in global axes;
    `stress` xx yy zz xy yz zx in the axes of its body, Pa, nan where a body has none.
    """
    drawn = [body for body in scene.bodies if body.number not in {one.number for one in bodies}]
    counts = [len(body.undeformed) for body in bodies] + [body.marks.shape[1] for body in drawn]
    _write_topology(root, bodies, drawn, counts)
    steps, count = len(scene.time), sum(counts)
    points = root.create_dataset("Points", (steps * count, 3), "f8")
    data = root.create_group("PointData")
    fields = {
        name: data.create_dataset(name, (steps * count, width) if width > 1 else (steps * count,), "f8")
        for name, width in FIELDS.items()
    }
    first = None
    for row in range(steps):
        places, values = _row(scene, bodies, drawn, row)
        first = places if first is None else first
        values["displacement"] = places - first
        at = slice(row * count, (row + 1) * count)
        points[at] = places
        for name, field in fields.items():
            field[at] = values[name]
    owners = [body.number for body in (*bodies, *drawn)]  # type: ignore[attr-defined]
    data["body"] = np.repeat(np.array(owners, np.int32), counts)
    _write_steps(root, scene.time, count)


def _row(
    scene: Scene, bodies: list[ElementBody], drawn: list[DrawnBody], row: int
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Points of a row and their data, but for the displacement."""
    places = [body.places(row) for body in bodies] + [body.marks[row] for body in drawn]
    rest = sum(body.marks.shape[1] for body in drawn)
    velocities = [body.velocities(row) for body in bodies]
    velocities += [_rigid_velocities(scene, body, row) for body in drawn]
    stress = np.concatenate([*(body.stress(row) for body in bodies), np.full((rest, 6), np.nan)])
    deformation = [body.deformation(row) for body in bodies] + [np.zeros((rest, 3))]
    return np.concatenate(places), {
        "deformation": np.concatenate(deformation),
        "velocity": np.concatenate(velocities),
        "stress": stress,
        "von_mises": von_mises(stress),
    }


def _rigid_velocities(scene: Any, body: Any, row: Any) -> np.ndarray:
    if body.number == GROUND or scene.velocity is None:
        return np.zeros_like(body.marks[row])
    one = body.number - 1
    arms = body.marks[row] - scene.origin[row, one]
    return scene.velocity[row, one] + np.cross(scene.spin[row, one], arms)


def _write_topology(root: Any, bodies: Any, drawn: Any, counts: Any) -> None:
    connectivity, lengths, types = [], [], []  # type: ignore[var-annotated]
    firsts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    for body, first in zip(bodies, firsts, strict=False):
        kind = CELL_TYPES[body.cells.shape[1]]
        _add(body.cells + first, kind, connectivity, lengths, types)
    for body, first in zip(drawn, firsts[len(bodies) :], strict=True):
        lone = np.arange(body.marks.shape[1])[:, None] if not len(body.edges) else np.zeros((0, 1), int)
        _add(body.edges + first, LINE, connectivity, lengths, types)
        _add(lone + first, VERTEX, connectivity, lengths, types)
    joined = np.concatenate(connectivity).astype(np.int64)
    root["NumberOfPoints"] = np.array([sum(counts)], np.int64)
    root["NumberOfCells"] = np.array([len(lengths)], np.int64)
    root["NumberOfConnectivityIds"] = np.array([len(joined)], np.int64)
    root["Connectivity"] = joined
    root["Offsets"] = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    root["Types"] = np.array(types, np.uint8)


def _add(
    cells: np.ndarray, kind: int, connectivity: list[np.ndarray], lengths: Any, types: list[int]
) -> None:
    connectivity.append(cells.ravel())
    lengths += [cells.shape[1]] * len(cells)
    types += [kind] * len(cells)


def _write_steps(root: h5py.Group, time: np.ndarray, count: int) -> None:
    steps = len(time)
    group = root.create_group("Steps")
    group.attrs["NSteps"] = np.int64(steps)
    group["Values"] = time
    at = np.arange(steps, dtype=np.int64) * count
    group["PartOffsets"] = np.zeros(steps, np.int64)
    group["NumberOfParts"] = np.ones(steps, np.int64)
    group["PointOffsets"] = at
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        group[name] = np.zeros((steps, 1), np.int64)
    offsets = group.create_group("PointDataOffsets")
    for name in FIELDS:
        offsets[name] = at
    offsets["body"] = np.zeros(steps, np.int64)
