"""A result as VTKHDF, which ParaView (5.12 and newer) opens as a time series.

VTKHDF 2.3, "Temporal PolyData" and "Temporal UnstructuredGrid"
(https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/): points of all steps stand one after the
other, the cells are given once and every step refers to them.
"""

import io
from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np

from ..hdf5.stored_result import attribute
from ..hdf5.stress import principal_stresses, strains, von_mises
from .element_bodies import ELEMENT_SERIES, ElementBody, element_bodies
from .scene import GROUND_NUMBER, BodyShape, DrawnBody, Scene, read_scene

VERSION = (2, 3)
CELLS = ("Vertices", "Lines", "Strips", "Polygons")
# Types of VTK by the nodes of an element; nodes stand in the order of Abaqus in all four.
CELL_TYPES = {4: 10, 8: 12, 10: 24, 20: 25}
VERTEX, VTK_LINE, TRIANGLE = 1, 3, 5
PRINCIPAL_STRAIN = "element_principal_strain"
# Name of the point data of elements: components of a point.
FIELDS = {
    "deformation": 3, "velocity": 3, "stress": 6, "von_mises": 1, "principal_stress": 3, "strain": 6,
    "principal_strain": 3,
}  # fmt: skip
Drawn = ElementBody | DrawnBody | BodyShape


def vtkhdf_bytes(result: h5py.File, rows: slice = slice(None)) -> bytes:
    """The file's bytes: bodies as lines, their marks as vertices; body numbers and displacements as arrays.

    Bodies with shapes are polygons; with bodies whose elements the result holds, all are cells of a grid.
    `displacement` is from the first row, m, global axes; `body` is the number in the deck, 0 for the ground.
    Grids have `deformation`, the elastic one, m, `velocity`, m/s, in global axes; `stress` and `strain` xx yy
    zz xy yz zx in the axes of its body, nan where a body has none; cells what the deck selects of elements.
    """
    scene = read_scene(result, rows)
    elements = list(element_bodies(result, scene.body_names, rows))
    bodies: list[Drawn] = [*elements, *scene.lined(elements), *scene.shapes]
    kind = b"UnstructuredGrid" if elements else b"PolyData"
    stream = io.BytesIO()
    with h5py.File(stream, "w", libver=("v108", "v108")) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(VERSION, np.int64)
        # VTK wants a string of fixed length.
        root.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
        counts = [_count(body) for body in bodies]
        (_write_grid if elements else _write_polygons)(root, bodies, counts)
        _write_points(root, scene, elements, bodies, counts)
        if any(body.of_elements for body in elements):
            _write_cell_data(root, elements, len(scene.time))
        _write_steps(root, scene.time, sum(counts), 1 if elements else len(CELLS))
        _write_remark(root, result)
    return stream.getvalue()


def _count(body: Drawn) -> int:
    """Return how many points a body has."""
    if isinstance(body, ElementBody):
        return len(body.undeformed)
    return int(body.marks.shape[1]) if isinstance(body, DrawnBody) else len(body.vertices)


def _places(body: Drawn, row: int) -> np.ndarray:
    """Points (n, 3) of a body in a row, global axes."""
    return body.marks[row] if isinstance(body, DrawnBody) else body.places(row)


def _write_points(
    root: h5py.Group, scene: Scene, elements: list[ElementBody], bodies: list[Drawn], counts: list[int]
) -> None:
    """Write the points of all rows and their data, row by row: they may be more than the memory holds."""
    steps, count = len(scene.time), sum(counts)
    known = {name: width for name, width in FIELDS.items() if _known(name, elements)} if elements else {}
    root["NumberOfPoints"] = np.array([count], np.int64)
    points, data = root.create_dataset("Points", (steps * count, 3), "f8"), root.create_group("PointData")
    fields = {
        name: data.create_dataset(name, (steps * count, width) if width > 1 else (steps * count,), "f8")
        for name, width in ({"displacement": 3} | known).items()
    }
    first = None
    for row in range(steps):
        places = np.concatenate([_places(body, row) for body in bodies])
        first = places if first is None else first
        values = {"displacement": places - first}
        values |= _row(scene, elements, bodies, places, row) if elements else {}
        at = slice(row * count, (row + 1) * count)
        points[at] = places
        for name, field in fields.items():
            field[at] = values[name]
    data["body"] = np.repeat(np.array([body.number for body in bodies], np.int32), counts)


def _known(field: str, bodies: list[ElementBody]) -> bool:
    """Return whether a body has what the field is about."""
    if "strain" in field:
        return any(body.material for body in bodies)
    stressed = "stress" in field or field == "von_mises"
    return not stressed or any(body.stress_shape is not None for body in bodies)


def _row(
    scene: Scene, elements: list[ElementBody], bodies: list[Drawn], places: np.ndarray, row: int
) -> dict[str, np.ndarray]:
    """Data of the points of a row but for the displacement."""
    velocities = [body.velocities(row) for body in elements]
    velocities += [_rigid_velocities(scene, body, row) for body in bodies[len(elements) :]]
    rest = len(places) - sum(map(_count, elements))
    none = np.full((rest, 6), np.nan)
    stress = np.concatenate([*(body.stress(row) for body in elements), none])
    strain = np.concatenate([*(_strain(body, row) for body in elements), none])
    deformation = [body.deformation(row) for body in elements] + [np.zeros((rest, 3))]
    return {
        "deformation": np.concatenate(deformation),
        "velocity": np.concatenate(velocities),
        "stress": stress,
        "von_mises": von_mises(stress),
        "principal_stress": _principal(stress),
        "strain": strain,
        "principal_strain": _principal(strain),
    }


def _principal(tensor: np.ndarray) -> np.ndarray:
    """Principal values (n, 3) of tensors (n, 6), nan where one is not finite."""
    finite, values = np.isfinite(tensor).all(axis=1), np.full((len(tensor), 3), np.nan)
    values[finite] = principal_stresses(tensor[finite])
    return values


def _strain(body: ElementBody, row: int) -> np.ndarray:
    stress = body.stress(row)
    return strains(stress, *body.material) if body.material else np.full_like(stress, np.nan)


def _rigid_velocities(scene: Scene, body: Drawn, row: int) -> np.ndarray:
    places, one = _places(body, row), body.number - 1
    known = scene.origin is not None and scene.velocity is not None and scene.spin is not None
    if body.number == GROUND_NUMBER or not known:
        return np.zeros_like(places)
    assert scene.origin is not None and scene.velocity is not None and scene.spin is not None
    offsets = places - scene.origin[row, one]
    return scene.velocity[row, one] + np.cross(scene.spin[row, one], offsets)


def _cells_of(body: Drawn, in_grid: bool) -> Iterator[tuple[int, Any]]:
    """Type and nodes (m, k) of the cells of a body: elements, triangles, or lines and marks.

    In a grid the marks of a body that has lines are no cells.
    """
    if isinstance(body, ElementBody):
        yield CELL_TYPES[body.cells.shape[1]], body.cells
    elif isinstance(body, BodyShape):
        yield TRIANGLE, body.triangles
    else:
        if len(body.edges):
            yield VTK_LINE, body.edges
        if not (in_grid and len(body.edges)):
            yield VERTEX, np.arange(body.marks.shape[1])[:, None]


def _numbered(bodies: list[Drawn], counts: list[int], in_grid: bool) -> list[tuple[int, np.ndarray]]:
    """Return the cells of all bodies, with the numbers that their points have in the file."""
    firsts = np.cumsum([0, *counts])[:-1]
    pairs = zip(bodies, firsts, strict=True)
    return [(kind, cells + first) for body, first in pairs for kind, cells in _cells_of(body, in_grid)]


def _write_polygons(root: h5py.Group, bodies: list[Drawn], counts: list[int]) -> None:
    """A vertex for every mark, a line for every edge, the triangles of shapes; the same for all steps."""
    every = _numbered(bodies, counts, False)
    for name, kind in zip(CELLS, (VERTEX, VTK_LINE, 0, TRIANGLE), strict=True):
        _write_cells(root.create_group(name), [cells for sides, cells in every if sides == kind])


def _write_grid(root: h5py.Group, bodies: list[Drawn], counts: list[int]) -> None:
    every = _numbered(bodies, counts, True)
    _write_cells(root, [cells for _, cells in every])
    root["Types"] = np.concatenate([np.full(len(cells), kind, np.uint8) for kind, cells in every])


def _write_cells(group: h5py.Group, parts: list[np.ndarray]) -> None:
    lengths = [np.full(len(cells), cells.shape[1]) for cells in parts]
    members = np.concatenate([np.zeros(0, np.int64), *(cells.ravel() for cells in parts)])
    offsets = np.cumsum(np.concatenate([[0], *lengths]))
    group["NumberOfCells"] = np.array([len(offsets) - 1], np.int64)
    group["NumberOfConnectivityIds"] = np.array([members.size], np.int64)
    group["Connectivity"] = members.astype(np.int64)
    group["Offsets"] = offsets.astype(np.int64)


def _write_cell_data(root: h5py.Group, bodies: list[ElementBody], steps: int) -> None:
    """Write what the result has of elements along time; the cells of `bodies` come first."""
    data, count = root.create_group("CellData"), int(root["NumberOfCells"][0])
    widths = {name: tuple(map(int, width)) for name, (_, _, width) in ELEMENT_SERIES.items()}
    for name, width in (widths | {PRINCIPAL_STRAIN: (3,)}).items():
        values, first = np.full((steps, count, *width), np.nan), 0
        for body in bodies:
            if body.of_elements and body.selected is not None:
                values[:, first + body.selected] = _of_elements(body.of_elements, name)
            first += len(body.cells)
        data[name] = values.reshape(-1, *values.shape[2:])


def _of_elements(known: dict[str, np.ndarray], name: str) -> np.ndarray:
    """Return a field of the elements; results of earlier versions have no principal strains."""
    if name != PRINCIPAL_STRAIN:
        return known[name]
    strain = known["element_strain"]
    return _principal(strain.reshape(-1, 6)).reshape(*strain.shape[:-1], 3)


def _write_steps(root: h5py.Group, time: np.ndarray, points: int, kinds: int) -> None:
    """Write where the points and the data of each step begin; the cells of so many `kinds` stay."""
    group, none, steps = root.create_group("Steps"), np.zeros(len(time), np.int64), np.arange(len(time))
    group.attrs["NSteps"] = np.int64(len(time))
    group["Values"] = time
    group["PartOffsets"] = none
    group["NumberOfParts"] = none + 1
    group["PointOffsets"] = steps * points
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        group[name] = np.zeros((len(time), kinds), np.int64)
    # A group that h5py makes on the way to a dataset has a time stamp.
    offsets = group.create_group("PointDataOffsets")
    for name in root["PointData"]:
        offsets[name] = none if name == "body" else steps * points
    if "CellData" in root:
        offsets = group.create_group("CellDataOffsets")
        for name in root["CellData"]:
            offsets[name] = steps * int(root["NumberOfCells"][0])


def _write_remark(root: h5py.Group, result: h5py.File) -> None:
    """Mark numbers of an emulation by a text among the data of the whole set."""
    if text := attribute(result, "emulation"):
        root.create_group("FieldData").create_dataset(
            "emulation", data=[text.encode("ascii", "replace")], dtype=h5py.string_dtype("ascii")
        )
        # Without these VTK reads a value of each step, beyond the end.
        steps = int(root["Steps"].attrs["NSteps"])
        root["Steps"].create_group("FieldDataOffsets")["emulation"] = np.zeros(steps, np.int64)
        root["Steps"].create_group("FieldDataSizes")["emulation"] = np.ones((steps, 2), np.int64)
