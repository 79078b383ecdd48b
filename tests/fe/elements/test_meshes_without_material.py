"""Bodies whose elements have no material: drawn by them in pages, films and VTKHDF, without stresses."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

from flexmb_cli.cli.export import export
from flexmb_cli.cli.report import report
from flexmb_cli.cli.run import run
from flexmb_cli.fe.flexible_bodies import flexible_body
from flexmb_cli.model.flexible_body import FEFile
from flexmb_cli.results.figures.report_scene import report_scene
from tests.dialects.vsdf.vsdf_decks import DECKS, build, supplied

SHORT = ("       0.5     0.005", "     0.002     0.001")


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Three instants of the slider-crank with CalculiX's rod of eight C3D20R, without MATL."""
    folder = tmp_path_factory.mktemp("mesh")
    (folder / "fe").symlink_to(DECKS / "fe")
    (folder / "rod.vsdf").write_text(supplied("slider_crank_flex", SHORT))
    done = CliRunner().invoke(run, [str(folder / "rod.vsdf"), "-q", "--no-out", "-o", str(folder)])
    assert done.exit_code == 0, done.output
    return folder / "rod.h5"


def test_vtk_shows_the_elements_of_a_body_without_material(path, tmp_path):
    """Eight quadratic hexahedra, type 25 of VTK, at r + A (r0 + Phi eta); no field of stresses."""

    done = CliRunner().invoke(export, [str(path), "--to", "vtkhdf", "-o", str(tmp_path / "r.vtkhdf"), "-q"])
    assert done.exit_code == 0, done.output
    reader = vtkHDFReader()
    reader.SetFileName(str(tmp_path / "r.vtkhdf"))
    reader.SetStep(2)
    reader.Update()
    grid = reader.GetOutputDataObject(0)
    assert [grid.GetCellType(k) for k in range(grid.GetNumberOfCells())].count(25) == 8
    data = grid.GetPointData()
    known = {data.GetArrayName(k) for k in range(data.GetNumberOfArrays())}
    assert known == {"displacement", "deformation", "velocity", "body"}
    with h5py.File(path) as file:
        group, eta = file["elastic/body 2"], file["modal/body 2/amplitude"][2]
        moved = group["node_position"][:] + group["shape"][:] @ eta
        turn = Rotation.from_quat(file["body/euler_parameters"][2, 1][[1, 2, 3, 0]])
        places = file["body/position"][2, 1] + turn.apply(moved)
        assert "stress_shape" not in group and len(group["element"]) == 8
    np.testing.assert_allclose(vtk_to_numpy(grid.GetPoints().GetData())[: len(places)], places, atol=1e-14)


def test_the_page_colours_such_a_body_by_its_deformation(path):
    with h5py.File(path) as file:
        scene = report_scene(file)
    (rod,) = [one for one in scene["surfaces"] if one["modes"]]
    assert rod["name"] == "body 2" and rod["stress"] == "" and rod["triangles"]
    assert list(scene["ranges"]) == ["deformation"] and scene["look"]["colours"] == "deformation"
    assert "body 2" not in [one["name"] for one in scene["bodies"]]


def test_films_of_such_a_body_know_deformations_and_say_what_stresses_need(path, tmp_path):
    pytest.importorskip("imageio")
    words = [str(path), "--movie", str(tmp_path / "a.gif"), "-q", "--fps", "1", "--size", "64x64"]
    done = CliRunner().invoke(report, [*words, "--colours", "deformation", "--scale", "10"])
    assert done.exit_code == 0, done.exception
    done = CliRunner().invoke(report, [*words, "--colours", "principal stress 1"])
    assert "it holds no principal stress 1; stresses and strains need a card MATL" in str(done.exception)


@pytest.mark.parametrize("deck, kind", [("pendulum_ccx", 8), ("pendulum_dmig", 8), ("pendulum", 0)])
def test_elements_come_from_the_file_of_the_nodes(deck, kind):
    """Sixteen bricks in CalculiX's INP and in ANSYS' EBLOCK; a table of nodes alone has none."""
    given = build(supplied(deck)).bodies[0].flexible
    mesh = flexible_body(given, cached=False)[0].mesh
    assert (mesh.rows.shape if mesh else None) == ((16, kind) if kind else None)


def test_elements_are_kept_with_the_body_and_found_again(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXMB_CACHE_DIR", str(tmp_path))
    given = build(supplied("pendulum_ccx")).bodies[0].flexible
    made, found = flexible_body(given)[0].mesh, flexible_body(given)[0].mesh
    assert len(list(tmp_path.rglob("*.body"))) == 1
    np.testing.assert_array_equal(made.rows, found.rows)
    np.testing.assert_array_equal(made.numbers, found.numbers)


def test_elements_that_cannot_be_drawn_are_no_fault(tmp_path):
    """A mesh of shells has no faces here, and the body moves by its matrices all the same."""
    text, path = (DECKS / "fe/calculix/pendulum.inp").read_text(), tmp_path / "pendulum.inp"
    path.write_text(text.replace("TYPE=C3D8I", "TYPE=S8R"))
    given = replace(build(supplied("pendulum_ccx")).bodies[0].flexible, mesh=FEFile(path, "INP"))
    assert flexible_body(given, cached=False)[0].mesh is None
