"""Finite elements in pictures: outer faces, and the unstructured grid that VTK reads."""

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

from flexmb_cli.cli.export import export
from flexmb_cli.results.figures.element_bodies import face_edges, outer_faces_of_elements, triangles
from flexmb_cli.results.figures.report_scene import with_centres
from scripts.brick_beam import Beam
from tests.fe.elements.test_stress_results import result  # noqa: F401
from tests.results.figures.elastic_brick import POISSON, STRESS, YOUNG, write_brick

SIZE, CELLS = (0.3, 0.2, 0.1), (3, 2, 2)


def block(element):
    placed, elements = Beam(SIZE, CELLS, element).mesh()
    return np.array(list(placed.values())), np.array(elements) - 1


@pytest.mark.parametrize("element, count", [("C3D8", 32), ("C3D20", 32), ("C3D4", 64), ("C3D10", 64)])
def test_the_outer_faces_of_a_block_enclose_its_volume(element, count):
    """The divergence theorem: a sixth of the sum of a . (b x c) is the volume when faces look outwards."""
    places, cells = block(element)
    faces, _ = outer_faces_of_elements(cells)
    assert len(faces) == count
    a, b, c = (places[triangles(faces)[:, k]] for k in range(3))
    assert np.einsum("ti,ti->", a, np.cross(b, c)) / 6 == pytest.approx(np.prod(SIZE), rel=1e-12)
    x, y, z = SIZE
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(2 * (x * y + y * z + z * x), rel=1e-12)


def test_edges_of_faces_come_once():
    """A block of 3 x 2 x 2 bricks: 32 faces have 4 edges each, every one shared by two."""
    _, cells = block("C3D8")
    assert len(face_edges(outer_faces_of_elements(cells)[0])) == 64


@pytest.fixture
def steps(result, tmp_path):  # noqa: F811
    """What VTK reads of the slider-crank's steps, and the result."""

    target = tmp_path / "rod.vtkhdf"
    done = CliRunner().invoke(export, [str(result), "--to", "vtkhdf", "-o", str(target), "-q"])
    assert done.exit_code == 0, done.output
    reader, found = vtkHDFReader(), []
    reader.SetFileName(str(target))
    for step in range(3):
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutputDataObject(0)
        data = {
            grid.GetPointData().GetArrayName(k): vtk_to_numpy(grid.GetPointData().GetArray(k)).copy()
            for k in range(grid.GetPointData().GetNumberOfArrays())
        }
        data["points"] = vtk_to_numpy(grid.GetPoints().GetData()).copy()
        cells = grid.GetCellData()
        data |= {
            cells.GetArrayName(k): vtk_to_numpy(cells.GetArray(k)).copy()
            for k in range(cells.GetNumberOfArrays())
        }
        data["types"] = [grid.GetCellType(k) for k in range(grid.GetNumberOfCells())]
        data["cell"] = [grid.GetCell(0).GetPointId(k) for k in range(20)]
        found.append(data)
    with h5py.File(result) as file:
        yield found, file


def test_vtk_reads_elements_as_cells_that_move(steps):
    """Places by SciPy's rotation of r0 + Phi eta; the bricks are quadratic hexahedra (type 25 of VTK)."""
    found, file = steps
    assert found[2]["types"].count(25) == 8
    group, eta = file["elastic/body 2"], file["modal/body 2/amplitude"][:]
    for row in range(3):
        turn = Rotation.from_quat(file["body/euler_parameters"][row, 1][[1, 2, 3, 0]])
        moved = group["node_position"][:] + group["shape"][:] @ eta[row]
        wanted = file["body/position"][row, 1] + turn.apply(moved)
        n = len(wanted)
        np.testing.assert_allclose(found[row]["points"][:n], wanted, atol=1e-14)
        np.testing.assert_allclose(
            found[row]["deformation"][:n], turn.apply(group["shape"][:] @ eta[row]), atol=1e-16
        )
    numbers = group["node"][:]
    assert numbers[found[0]["cell"]].tolist() == group["cell"][0].tolist()


def test_vtk_reads_the_velocities_of_points(steps):
    """Against those of the output nodes, by the equations of motion: nodes 7, 45 and 83 of the rod."""
    found, file = steps
    numbers, wanted = file["elastic/body 2/node"][:], file["point/velocity"]
    for k, node in enumerate((7, 45, 83)):
        place = int(np.flatnonzero(numbers == node)[0])
        assert found[2]["velocity"][place] == pytest.approx(wanted[2, k], abs=1e-12)


def test_vtk_reads_the_stresses_of_nodes_and_none_of_rigid_bodies(steps):
    found, file = steps
    place = int(np.flatnonzero(file["elastic/body 2/node"][:] == 45)[0])
    wanted = file["stress/body 2/node_von_mises"][2, 0]
    assert found[2]["von_mises"][place] == pytest.approx(wanted, rel=1e-9)
    assert found[2]["stress"][place] == pytest.approx(file["stress/body 2/node_tensor"][2, 0], rel=1e-9)
    assert np.isnan(found[2]["von_mises"][found[2]["body"] != 2]).all()


def test_vtk_reads_principal_stresses_and_strains_of_nodes(steps):
    """Against the series of node 45, which the deck selects; none of rigid bodies."""
    found, file = steps
    place = int(np.flatnonzero(file["elastic/body 2/node"][:] == 45)[0])
    for name, path in (
        ("principal_stress", "stress/body 2/node_principal"),
        ("strain", "strain/body 2/node_tensor"),
    ):
        wanted = file[path][2, 0]
        assert found[2][name][place] == pytest.approx(wanted, abs=1e-9 * abs(wanted).max())
        assert np.isnan(found[2][name][found[2]["body"] != 2]).all()


def test_vtk_reads_energies_and_mean_stresses_of_elements(steps):
    """They stand at the bricks of the rod, cells of type 25, and are not a number elsewhere."""
    found, file = steps
    bricks = np.array(found[2]["types"]) == 25
    for name, path in (
        ("strain_energy", "strain/body 2/element_energy"),
        ("element_strain", "strain/body 2/element_tensor"),
        ("element_stress", "stress/body 2/element_tensor"),
        ("element_von_mises", "stress/body 2/element_von_mises"),
        ("element_principal_stress", "stress/body 2/element_principal"),
        ("element_principal_strain", "strain/body 2/element_principal"),
    ):
        for row in range(3):
            np.testing.assert_array_equal(found[row][name][bricks], file[path][row])
            assert np.isnan(found[row][name][~bricks]).all()


def test_a_bar_in_tension_has_its_closed_form_in_vtk(tmp_path):
    """sigma along x: principal stresses sigma, 0, 0, strains sigma / E and -nu sigma / E."""
    bar = write_brick(tmp_path / "r.h5", np.array([0.5, 0.5]))
    done = CliRunner().invoke(export, [str(bar), "--to", "vtkhdf", "-o", str(tmp_path / "r.vtkhdf"), "-q"])
    assert done.exit_code == 0, done.output
    with h5py.File(tmp_path / "r.vtkhdf") as file:
        data = {name: values[:8] for name, values in file["VTKHDF/PointData"].items()}
        assert "CellData" not in file["VTKHDF"]
    sigma = 0.5 * STRESS
    np.testing.assert_allclose(data["principal_stress"], np.tile([sigma, 0, 0], (8, 1)), atol=1e-9)
    strain = sigma / YOUNG * np.array([1, -POISSON, -POISSON, 0, 0, 0])
    np.testing.assert_allclose(data["strain"], np.tile(strain, (8, 1)), rtol=1e-12, atol=1e-20)
    np.testing.assert_allclose(data["principal_strain"], np.tile(strain[:3], (8, 1)), rtol=1e-9)


def test_the_middle_of_a_quadratic_face_is_interpolated_by_its_eight_nodes():
    """Quadratic functions of position are met exactly: the middle has their value."""
    places, cells = block("C3D20")
    faces, _ = outer_faces_of_elements(cells)

    def values(p):
        return np.stack([p[:, 0] * p[:, 1] - 3 * p[:, 2] + 2, p[:, 0] ** 2], axis=-1)

    found = with_centres(values(places), faces)[len(places) :]
    centres = places[faces[:, ::2]].mean(axis=1)
    np.testing.assert_allclose(found, values(centres), atol=1e-14)
