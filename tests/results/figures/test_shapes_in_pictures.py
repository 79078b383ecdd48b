"""Shapes of rigid bodies in pictures: carried by their bodies, in the page and in VTKHDF, from the result
alone.
"""

import base64
from dataclasses import replace

import h5py
import numpy as np
import pytest

from flexmb_cli.model.shapes import BOX, Shape, primitive
from flexmb_cli.results.figures.report_scene import scene_data
from flexmb_cli.results.figures.scene import read_scene
from flexmb_cli.results.figures.vtkhdf import vtkhdf_bytes
from flexmb_cli.results.hdf5.stored_result import Damaged
from tests.results import conftest
from tests.results.figures.turning_bar import tip, write_bar

TIMES = np.arange(4.0)
# A blade on the turning bar, whose origin is its middle, as long as the bar; a block on the ground.
BLADE = Shape(2, np.array([[-1.0, 0, 0], [1, 0, 0], [1, 0.5, 0]]), np.array([[0, 1, 2]]))
BLOCK = primitive(0, BOX, (1.0, 2.0, 3.0), (0.0, 0.0, -5.0), (0.0, 0.0, 0.0))


@pytest.fixture
def path(tmp_path):
    deck, mechanism = conftest.deck.__wrapped__(), conftest.mechanism.__wrapped__()
    shaped = replace(mechanism, shapes=(BLADE, BLOCK))
    return write_bar(tmp_path / "r.h5", deck, shaped, conftest.turning_rows, TIMES)


def blade_at(t):
    """Its corners by the closed form of the bar's free end; the third one stands half a metre beside it."""
    end = tip([t])[0]
    return np.array([[0, 0, 0], end, end + (0, 0.5, 0)])


def test_shapes_move_with_their_bodies(path):
    with h5py.File(path) as file:
        ground, blade = read_scene(file).shapes
    assert (ground.number, ground.name, blade.number, blade.name) == (0, "ground", 2, "body 2")
    for row, t in enumerate(TIMES):
        np.testing.assert_allclose(blade.places(row), blade_at(t), atol=1e-12)
        np.testing.assert_array_equal(ground.places(row), BLOCK.vertices)


def test_the_view_holds_the_shapes(path):
    with h5py.File(path) as file:
        places = read_scene(file).places
    assert places[:, 2].min() == -6.5
    assert places[:, 1].max() == pytest.approx(1.0)


def test_the_page_draws_the_shapes_in_place_of_lines(path):
    with h5py.File(path) as file:
        data = scene_data(read_scene(file), [])
    assert [one["name"] for one in data["surfaces"]] == ["ground", "body 2"]
    assert not {"ground", "body 2"} & {one["name"] for one in data["bodies"]}
    nodes = np.frombuffer(base64.b64decode(data["surfaces"][1]["nodes"]), "<f4").reshape(-1, 3)
    np.testing.assert_array_equal(nodes, BLADE.vertices)


def test_vtk_reads_the_shapes_as_polygons_that_move(path, tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    with h5py.File(path) as file:
        (tmp_path / "r.vtkhdf").write_bytes(vtkhdf_bytes(file))
    reader = vtkHDFReader()
    reader.SetFileName(str(tmp_path / "r.vtkhdf"))
    for step, t in enumerate(TIMES):
        reader.SetStep(step)
        reader.Update()
        mesh = reader.GetOutputDataObject(0)
        assert mesh.GetPolys().GetNumberOfCells() == 12 + 1
        owner = vtk_to_numpy(mesh.GetPointData().GetArray("body"))
        corners = [mesh.GetCell(mesh.GetNumberOfCells() - 1).GetPointId(k) for k in range(3)]
        assert (owner[corners] == 2).all()
        np.testing.assert_allclose(vtk_to_numpy(mesh.GetPoints().GetData())[corners], blade_at(t), atol=1e-12)


@pytest.mark.parametrize(
    ("dataset", "index", "value", "words"),
    [
        ("shape/vertices_of_triangle", (0, 0), 999, "a vertex outside"),
        ("shape/vertices_of_triangle", (0, 0), 5, "joins two bodies"),
        ("shape/body", 0, 7, "a body outside 0..2"),
        ("shape/position", (0, 0), np.nan, "not finite"),
    ],
)
def test_damaged_shapes_are_told(path, dataset, index, value, words):
    with h5py.File(path, "r+") as file:
        file[dataset][index] = value
        with pytest.raises(Exception, match=words) as reported:
            read_scene(file)
    assert isinstance(reported.value, Damaged) or value != value
