"""A result with finite elements as VTKHDF: cells of an unstructured grid whose points move.

VTKHDF 2.3, "Temporal UnstructuredGrid" (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/):
points of all steps stand one behind the other, the cells are given once and every step refers to them.
"""

from typing import Any

import h5py
import numpy as np

from ..hdf5.stress import principal_stresses, strains, von_mises
from .body_shapes import BodyShape
from .element_bodies import ELEMENT_SERIES, ElementBody
from .scene import GROUND_NUMBER, DrawnBody, Scene

# Types of VTK by the nodes of an element; nodes stand in the order of Abaqus in all four.
CELL_TYPES = {4: 10, 8: 12, 10: 24, 20: 25}
VERTEX, VTK_LINE, TRIANGLE = 1, 3, 5
PRINCIPAL_STRAIN = "element_principal_strain"
# Name of the point data: components of a point.
FIELDS = {
    "displacement": 3, "deformation": 3, "velocity": 3, "stress": 6, "von_mises": 1, "principal_stress": 3,
    "strain": 6, "principal_strain": 3,
}  # fmt: skip


def write_cells(root: h5py.Group, scene: Scene, bodies: list[ElementBody]) -> None:
    """Fill the group VTKHDF: elements as cells, triangles of shapes, other bodies as lines between marks.

    `displacement` is from the first row, `deformation` the elastic one, m, `velocity` m/s, in global axes;
    `stress` and `strain` xx yy zz xy yz zx in the axes of its body, nan where a body has none.  Cells have
    what the deck selects of the elements, nan elsewhere.
    """
    shown = {*(one.number for one in bodies), *(shape.number for shape in scene.shapes)}
    drawn = [body for body in scene.bodies if body.number not in shown]
    counts = [len(body.undeformed) for body in bodies] + [body.marks.shape[1] for body in drawn]
    counts += [len(shape.vertices) for shape in scene.shapes]
    shown_bodies: list[ElementBody | DrawnBody | BodyShape] = [*bodies, *drawn, *scene.shapes]
    _write_topology(root, shown_bodies, counts)
    steps, count = len(scene.time), sum(counts)
    points = root.create_dataset("Points", (steps * count, 3), "f8")
    data = root.create_group("PointData")
    known = {name: width for name, width in FIELDS.items() if _known(name, bodies)}
    fields = {
        name: data.create_dataset(name, (steps * count, width) if width > 1 else (steps * count,), "f8")
        for name, width in known.items()
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
    owners = [body.number for body in shown_bodies]
    data["body"] = np.repeat(np.array(owners, np.int32), counts)
    _write_cell_data(root, bodies, steps)
    _write_steps(root, scene.time, count)


def _known(field: str, bodies: list[ElementBody]) -> bool:
    """Return whether a body has what the field is about."""
    if "strain" in field:
        return any(body.material for body in bodies)
    stressed = "stress" in field or field == "von_mises"
    return not stressed or any(body.stress_shape is not None for body in bodies)


def _write_cell_data(root: h5py.Group, bodies: list[ElementBody], steps: int) -> None:
    """Write what the result has of elements along time; the cells of `bodies` come first."""
    if not any(body.of_elements for body in bodies):
        return
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


def _row(
    scene: Scene, bodies: list[ElementBody], drawn: list[DrawnBody], row: int
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Points of a row and their data, but for the displacement."""
    rigid = [(body.number, body.marks[row]) for body in drawn]
    rigid += [(shape.number, shape.places(row)) for shape in scene.shapes]
    places = [body.places(row) for body in bodies] + [own for _, own in rigid]
    rest = sum(len(own) for _, own in rigid)
    velocities = [body.velocities(row) for body in bodies]
    velocities += [_rigid_velocities(scene, number, own, row) for number, own in rigid]
    none = np.full((rest, 6), np.nan)
    stress = np.concatenate([*(body.stress(row) for body in bodies), none])
    strain = np.concatenate([*(_strain(body, row) for body in bodies), none])
    deformation = [body.deformation(row) for body in bodies] + [np.zeros((rest, 3))]
    return np.concatenate(places), {
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
    finite, found = np.isfinite(tensor).all(axis=1), np.full((len(tensor), 3), np.nan)
    found[finite] = principal_stresses(tensor[finite])
    return found


def _strain(body: ElementBody, row: int) -> np.ndarray:
    stress = body.stress(row)
    return strains(stress, body.material) if body.material else np.full_like(stress, np.nan)


def _rigid_velocities(scene: Scene, number: int, places: np.ndarray, row: int) -> np.ndarray:
    if number == GROUND_NUMBER or scene.origin is None or scene.velocity is None or scene.spin is None:
        return np.zeros_like(places)
    one = number - 1
    offsets = places - scene.origin[row, one]
    found: np.ndarray = scene.velocity[row, one] + np.cross(scene.spin[row, one], offsets)
    return found


def _cells_of(body: Any) -> tuple[Any, Any]:
    """Type and nodes (m, k) of the cells of a body, of its lines or single marks, or of its shapes."""
    if isinstance(body, ElementBody):
        return CELL_TYPES[body.cells.shape[1]], body.cells
    if isinstance(body, BodyShape):
        return TRIANGLE, body.triangles
    return (VTK_LINE, body.edges) if len(body.edges) else (VERTEX, np.arange(body.marks.shape[1])[:, None])


def _write_topology(
    root: h5py.Group, bodies: "list[ElementBody | DrawnBody | BodyShape]", counts: list[int]
) -> None:
    connectivity: list[np.ndarray] = []
    lengths: list[int] = []
    types: list[int] = []
    firsts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    for body, first in zip(bodies, firsts, strict=True):
        kind, cells = _cells_of(body)
        _add(cells + first, kind, connectivity, lengths, types)
    joined = np.concatenate(connectivity).astype(np.int64)
    root["NumberOfPoints"] = np.array([sum(counts)], np.int64)
    root["NumberOfCells"] = np.array([len(lengths)], np.int64)
    root["NumberOfConnectivityIds"] = np.array([len(joined)], np.int64)
    root["Connectivity"] = joined
    root["Offsets"] = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    root["Types"] = np.array(types, np.uint8)


def _add(
    cells: np.ndarray, kind: int, connectivity: list[np.ndarray], lengths: list[int], types: list[int]
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
    for name in root["PointData"]:
        offsets[name] = at if name != "body" else np.zeros(steps, np.int64)
    if "CellData" in root:
        offsets_of_cells = group.create_group("CellDataOffsets")
        for name in root["CellData"]:
            offsets_of_cells[name] = np.arange(steps, dtype=np.int64) * int(root["NumberOfCells"][0])
