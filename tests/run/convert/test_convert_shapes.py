"""Shapes of converted decks: in space where those of the old deck are, whatever the frames of the bodies."""

from pathlib import Path

import h5py
import mujoco
import numpy as np
import pytest

from flexmb_cli.interface import solve
from flexmb_cli.model.exchange.rigid_model import angles_of
from flexmb_cli.model.shapes import turning
from flexmb_cli.model.vectors import rotation_matrix
from flexmb_cli.results.figures.scene import read_scene
from flexmb_cli.run.convert import converted
from tests.fe.test_stl import binary

DECKS = Path(__file__).resolve().parents[3] / "decks"
# Behind DYNAMICS: a tube on the coupler, a wedge on the rocker, a cone on the grounded body 4, a box at rest.
ON_FOUR_BAR = """GEOM 2 3  0.25 12.2 0.2  0.1 0.2 0.3  1.57 0.2 -0.4
STL sub/wedge.stl 3 0.5  0 0 1  0.3 0.2 0.1
GEOM 4 4  0.3 2 0.1  0 1 0  0.5 -0.6 0.7
GEOM 0 1  1 2 3  0 0 -3
END"""
ON_CHAIN = """GEOM
    3
    1    2       0.2       0.3
       0.0      0.15       0.0      0.25      -0.5       0.7
    2    1       0.1       0.2       0.3
       0.1       0.0      -0.1       0.3       0.2       0.1
    0    5       0.5       0.0       0.0
       1.0       0.0       0.0       0.0       0.0       0.0
END """


@pytest.fixture
def four_bar(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/wedge.stl").write_bytes(binary())
    text = (DECKS / "young/dynamics/IN4-BAR-MASS.dat").read_text().replace("END", ON_FOUR_BAR)
    (tmp_path / "old.dat").write_text(text.replace("0 2.5 0.1", "0 0.2 0.1"))
    return tmp_path / "old.dat"


@pytest.fixture
def chain(tmp_path):
    text = (DECKS / "dafms/spatial_rigid.DAT").read_text().replace("END ", ON_CHAIN, 1)
    (tmp_path / "old.DAT").write_text(text)
    return tmp_path / "old.DAT"


def corners(path, row, scale=1.0):
    """All corners of all shapes in space, in one order (n, 3), m."""
    target = path.with_suffix(".h5")
    solve(path).save(target)
    with h5py.File(target) as file:
        places = np.concatenate([shape.places(row) for shape in read_scene(file).shapes])
    return in_order(scale * places)


def in_order(places):
    return places[np.lexsort(np.round(places, 4).T)]


def convert(old, form, suffix, **units):
    new = old.with_name(f"new{suffix}")
    new.write_text(converted(str(old), form, **units), encoding="utf-8")
    return new


@pytest.mark.parametrize("units", [{}, {"unit": "mm"}])
def test_shapes_stay_in_place_from_young_to_vsdf(four_bar, units):
    """The tube has 128 corners, the wedge 4 triangles, the cone 66, the box 8; -1 is the row at 0.2 s."""
    new = convert(four_bar, "vsdf", ".vsdf", **units)
    assert "copy them beside this deck" in new.read_text()
    for row in (0, -1):
        wanted, found = corners(four_bar, row, 0.001 if units else 1.0), corners(new, row)
        assert len(wanted) == len(found) > 128 + 66 + 8
        np.testing.assert_allclose(found, wanted, atol=1e-8)


def test_shapes_stay_in_place_from_a_tree_to_young_and_back(chain):
    """A row of the thesis' columns holds 1e-6 of a coordinate."""
    young = convert(chain, "young", ".dat")
    back = convert(young, "dafms", ".DAT")
    for row in (0, -1):
        wanted = corners(chain, row)
        np.testing.assert_allclose(corners(young, row), wanted, atol=1e-8)
        np.testing.assert_allclose(corners(back, row), wanted, atol=2e-6)


def test_shapes_stay_in_place_in_mujoco(chain):
    model = mujoco.MjModel.from_xml_string(converted(str(chain), "mjcf"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    found = []
    for geom in range(model.ngeom):
        begin, count = (array[model.geom_dataid[geom]] for array in (model.mesh_vertadr, model.mesh_vertnum))
        turned = model.mesh_vert[begin : begin + count] @ data.geom_xmat[geom].reshape(3, 3).T
        found.append(data.geom_xpos[geom] + turned)
    # MuJoCo keeps corners in single precision.
    np.testing.assert_allclose(in_order(np.concatenate(found)), corners(chain, 0), atol=1e-5)
    assert not model.geom_contype.any() and not model.geom_conaffinity.any()


def test_shapes_stay_in_place_in_exudyn(tmp_path):
    """The script's bodies as Exudyn holds them; theirs are places from the mass centre."""
    old = tmp_path / "b.dat"
    text = (DECKS / "young/dynamics/IN-BRICARD.dat").read_text()
    old.write_text(text.replace("END", "GEOM 2 1  1 2 3  0.1 0.2 0.3  0.4 0.5 0.6\nEND"))
    script = converted(str(old), "exudyn")
    made: dict = {}
    exec(script[: script.index("END, ROWS")], made)
    body = made["mbs"].GetObject(made["bodies"][1], True)
    node = made["mbs"].GetNode(body["nodeNumber"])["referenceCoordinates"]
    local = np.reshape(body["VgraphicsData"][0]["points"], (-1, 3))
    places = node[:3] + local @ rotation_matrix(node[3:7]).T
    # Exudyn keeps the three corners of every triangle, in single precision.
    found, wanted = (np.unique(np.round(each, 5), axis=0) + 0.0 for each in (places, corners(old, 0)))
    assert len(found) == 8
    np.testing.assert_allclose(found, wanted, atol=2e-5)


@pytest.mark.parametrize("angles", [(0.3, -0.7, 2.0), (0.4, np.pi / 2, 0.0), (3.0, -np.pi / 2, 0.0)])
def test_angles_are_found_from_the_matrix(angles):
    np.testing.assert_allclose(turning(angles_of(turning(angles))), turning(angles), atol=1e-11)
    np.testing.assert_allclose(angles_of(turning(angles)), angles, atol=1e-6)


def test_a_shape_of_a_file_is_left_out_of_a_tree_with_a_note(chain):
    young = convert(chain, "young", ".dat")
    (chain.parent / "wedge.stl").write_bytes(binary())
    young.write_text(young.read_text().replace("GEOM 0", "STL wedge.stl 1 0.5\nGEOM 0"))
    tree = converted(str(young), "dafms")
    assert "Shapes of STL files are left out" in tree
    assert "\nGEOM\n    3\n" in tree
