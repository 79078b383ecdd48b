"""A result as VTKHDF, which ParaView (5.12 and newer) opens as a time series.

VTKHDF 2.3, "Temporal PolyData" (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/):
points of all steps stand one behind the other, the lines are given once and every step refers to them.
"""

import io
from dataclasses import replace

import h5py
import numpy as np

from ..hdf5.stored_result import attribute
from .element_bodies import ElementBody, element_bodies
from .scene import Scene, read_scene
from .vtkhdf_cells import write_cells

VERSION = (2, 3)
CELLS = ("Vertices", "Lines", "Strips", "Polygons")


def vtkhdf_bytes(result: h5py.File, rows: slice = slice(None)) -> bytes:
    """The file's bytes: bodies as lines, their marks as vertices; body numbers and displacements as arrays.

    Bodies with shapes are polygons; with bodies whose elements the result holds, all are cells of a grid.
    `displacement` is from the first row, m; `body` is the number in the deck, 0 for the ground.
    """
    scene = read_scene(result, rows)
    bodies = list(element_bodies(result, scene.body_names, rows))
    if bodies:
        return _grid(scene, bodies, result)
    shaped = {shape.number for shape in scene.shapes}
    scene = replace(scene, bodies=tuple(body for body in scene.bodies if body.number not in shaped))
    points = _points(scene)
    stream = io.BytesIO()
    with h5py.File(stream, "w", libver=("v108", "v108")) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, np.int64)
        # VTK wants a string of fixed length.
        root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", 8))
        _write_points(root, scene, points)
        _write_cells(root, scene)
        _write_steps(root, scene, points.shape[1])
        _write_remark(root, result)
    return stream.getvalue()


def _write_remark(root: h5py.Group, result: h5py.File) -> None:
    """Mark numbers of an emulation by a text among the data of the whole set."""
    if text := attribute(result, "emulation"):
        root.create_group("FieldData").create_dataset(
            "emulation", data=[text.encode("ascii", "replace")], dtype=h5py.string_dtype("ascii")
        )
        # Without these VTK reads a value of each step, beyond the end.
        steps = int(root["Steps"].attrs["NSteps"])
        root["Steps/FieldDataOffsets/emulation"] = np.zeros(steps, np.int64)
        root["Steps/FieldDataSizes/emulation"] = np.ones((steps, 2), np.int64)


def _points(scene: Scene) -> np.ndarray:
    """Marks of bodies (T, n, 3), and behind them the vertices of shapes."""
    parts = [body.marks for body in scene.bodies]
    for shape in scene.shapes:
        parts.append(np.stack([shape.places(row) for row in range(len(scene.time))]))
    return np.concatenate(parts, axis=1)


def _grid(scene: Scene, bodies: list[ElementBody], result: h5py.File) -> bytes:
    stream = io.BytesIO()
    with h5py.File(stream, "w", libver=("v108", "v108")) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, np.int64)
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        write_cells(root, scene, bodies)
        _write_remark(root, result)
    return stream.getvalue()


def _write_points(root: h5py.Group, scene: Scene, points: np.ndarray) -> None:
    root["NumberOfPoints"] = np.array([points.shape[1]], np.int64)
    root["Points"] = points.reshape(-1, 3)
    data = root.create_group("PointData")
    data["displacement"] = (points - points[:1]).reshape(-1, 3)
    owners = [(body.number, body.marks.shape[1]) for body in scene.bodies]
    owners += [(shape.number, len(shape.vertices)) for shape in scene.shapes]
    data["body"] = np.repeat(*np.array(owners, np.int32).T)


def _write_cells(root: h5py.Group, scene: Scene) -> None:
    """A vertex for every mark, a line for every edge, the triangles of shapes; the same for all steps."""
    edges, triangles, first = [np.zeros((0, 2), int)], [np.zeros((0, 3), int)], 0
    for body in scene.bodies:
        edges.append(body.edges + first)
        first += body.marks.shape[1]
    marks = np.arange(first).reshape(-1, 1)
    for shape in scene.shapes:
        triangles.append(shape.triangles + first)
        first += len(shape.vertices)
    cells = {"Vertices": marks, "Lines": np.concatenate(edges), "Polygons": np.concatenate(triangles)}
    for kind in CELLS:
        group, members = root.create_group(kind), cells.get(kind, np.zeros((0, 1), int))
        group["NumberOfCells"] = np.array([len(members)], np.int64)
        group["NumberOfConnectivityIds"] = np.array([members.size], np.int64)
        group["Connectivity"] = members.ravel().astype(np.int64)
        group["Offsets"] = np.arange(len(members) + 1, dtype=np.int64) * members.shape[1]


def _write_steps(root: h5py.Group, scene: Scene, count: int) -> None:
    steps = len(scene.time)
    group = root.create_group("Steps")
    group.attrs["NSteps"] = np.int64(steps)
    group["Values"] = scene.time
    at = np.arange(steps, dtype=np.int64) * count
    group["PartOffsets"] = np.zeros(steps, np.int64)
    group["NumberOfParts"] = np.ones(steps, np.int64)
    group["PointOffsets"] = at
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        group[name] = np.zeros((steps, len(CELLS)), np.int64)
    offsets = group.create_group("PointDataOffsets")
    offsets["displacement"] = at
    offsets["body"] = np.zeros(steps, np.int64)
