"""What is drawn of a result: where bodies, joints and points are, what joins them, how it is looked at."""

from dataclasses import replace
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli import solve
from flexmb_cli.deck.record import DeckText
from flexmb_cli.dialects.dafms.build import build_dafms
from flexmb_cli.dialects.dafms.reader import read_dafms
from flexmb_cli.model.mechanism import Joint
from flexmb_cli.results.figures.scene import different, gabriel_edges, read_scene, rotations, view_of
from flexmb_cli.results.hdf5.layout import (
    BODY_MOTION,
    EULER_PARAMETER,
    XYZ,
    Axis,
    Layout,
    Series,
    numbered_axis,
)
from flexmb_cli.results.hdf5.result_file import ResultFile
from flexmb_cli.results.hdf5.result_geometry import (
    SIDE,
    joint_geometry,
    node_geometry,
    shape_geometry,
    tree_geometry,
)
from flexmb_cli.results.quantities.quantities import ResultError, open_result
from tests.results.figures.turning_bar import tip, write_bar

TIMES = np.arange(7.0)
DECKS = Path(__file__).resolve().parents[3] / "decks"


@pytest.fixture
def scene(tmp_path, deck, mechanism, rows):
    def read(mechanism=mechanism, times=TIMES, rows_read=slice(None)):
        with open_result(write_bar(tmp_path / "r.h5", deck, mechanism, rows, times)) as file:
            return read_scene(file, rows_read)

    return read


def test_a_bar_is_a_line_from_its_joint_to_its_point(scene):
    bar = scene().bodies[1]
    assert (bar.name, bar.still, bar.edges.tolist()) == ("body 2", False, [[0, 1]])
    ends = {0: np.zeros((7, 3)), 1: tip(TIMES)}
    order = [0, 1] if np.allclose(bar.marks[:, 0], 0, atol=1e-12) else [1, 0]
    for mark, end in zip(order, (0, 1), strict=True):
        assert np.max(np.abs(bar.marks[:, mark] - ends[end])) < 1e-14


def test_a_body_that_never_moves_is_ground(scene):
    assert [body.still for body in scene().bodies] == [True, False]


def test_joints_at_rest_get_the_symbol_of_the_ground(tmp_path):
    """IN4-BAR: both revolute joints of the frame rest, the spherical and the universal one move."""
    solve(DECKS / "young/IN4-BAR.dat").save(tmp_path / "r.h5")
    with open_result(tmp_path / "r.h5") as file:
        whole, one = read_scene(file), read_scene(file, slice(0, 1))
    assert [whole.joint_names[k] for k in whole.supports] == ["revolute 1", "revolute 2"]
    assert one.supports.size == 0


def test_rows_can_be_thinned(scene):
    assert scene(rows_read=slice(0, 7, 3)).time.tolist() == [0.0, 3.0, 6.0]


def test_axes_of_joints_turn_with_the_first_body(scene, mechanism):
    hinge = Joint("revolute", "", 1, 0, (-1, 0, 0), (0, 0, 0), (3, 0, 0), (0, 0, 3))
    axes = scene(replace(mechanism, joints=(hinge,))).axes
    assert np.max(np.abs(axes[:, 0, 0] - 1.5 * tip(TIMES))) < 1e-14
    assert np.all(axes[:, 0, 1] == [0, 0, 3])


def test_nothing_can_be_drawn_without_rows(scene):
    with pytest.raises(ResultError, match="no bodies to draw"):
        scene(times=[])


@pytest.mark.parametrize("kept_as", ["displacement", "shape"])
def test_nodes_and_the_joints_at_them_move_with_the_flexible_body(tmp_path, deck, kept_as):
    """One body at (0, 0, 5), turned by 90 degrees about z: its y displacement is -x in global axes."""
    nodes, sway = np.array([(0.0, 0, 0), (1, 0, 0), (2, 0, 0)]), np.array([0.0, 0.1])
    of_body = (numbered_axis("body", ["beam"]), Axis("elastic/beam/node", (1, 2, 3), "node"))
    axes = [XYZ, EULER_PARAMETER, SIDE, *of_body, numbered_axis("joint", ["pin"])]
    shape = np.zeros((3, 3, 1))
    shape[2, 1] = 1.0
    values = {
        "time": np.arange(2.0),
        "body/position": np.tile((0.0, 0, 5), (2, 1, 1)),
        "body/euler_parameters": np.tile((np.sqrt(0.5), 0, 0, np.sqrt(0.5)), (2, 1, 1)),
    }
    series = [BODY_MOTION["position"], BODY_MOTION["euler_parameters"]]
    if kept_as == "shape":
        axes.append(Axis("modal/beam/mode", (1,), "mode"))
        series.append(Series("modal/beam/amplitude", ("modal/beam/mode",), "m", "amplitude"))
        values["modal/beam/amplitude"] = sway[:, None]
        elastic = shape_geometry("beam", nodes, shape.reshape(9, 1))
    else:
        series.append(Series("elastic/beam/displacement", ("elastic/beam/node", "xyz"), "m", "displacement"))
        values["elastic/beam/displacement"] = sway[:, None, None] * shape[None, ..., 0]
        elastic = (node_geometry("beam", nodes),)
    pin = joint_geometry([(0, -1)], [(nodes[2], (0, 0, 0))])
    result = ResultFile(
        tmp_path / "r.h5", deck, Layout("dynamic", 2, tuple(axes), tuple(series), (*elastic, *pin))
    )
    result.rows(values)
    result.close()
    with open_result(tmp_path / "r.h5") as file:
        drawn = read_scene(file)
    beam = next(body for body in drawn.bodies if body.name == "beam")
    assert beam.flexible
    assert beam.edges.tolist() == [[0, 1], [1, 2]]
    expected = [[(0, 0, 5), (0, 1, 5), (0, 2, 5)], [(0, 0, 5), (0, 1, 5), (-0.1, 2, 5)]]
    assert np.allclose(beam.marks, expected, atol=1e-15)
    assert np.allclose(drawn.joints[:, 0], np.array(expected)[:, 2], atol=1e-15)


def test_rotation_matrices_turn_a_vector_as_its_quaternion_does():
    """p v p* by the quaternion product, a second formulation."""
    rng = np.random.default_rng(5)
    p = rng.normal(size=(20, 4))
    p /= np.linalg.norm(p, axis=1, keepdims=True)
    v = rng.normal(size=3)
    for quaternion, matrix in zip(p, rotations(p), strict=True):
        turned = product_of(product_of(quaternion, (0.0, *v)), quaternion * (1, -1, -1, -1))
        assert np.allclose(matrix @ v, turned[1:], atol=1e-14)


def product_of(a, b):
    scalar = a[0] * b[0] - np.dot(a[1:], b[1:])
    return np.array([scalar, *(a[0] * np.array(b[1:]) + b[0] * np.array(a[1:]) + np.cross(a[1:], b[1:]))])


def test_neighbours_by_the_definition():
    """Gabriel and Sokal (1969): no third point within the sphere that has the two as poles."""
    points = np.random.default_rng(3).normal(size=(25, 3))
    expected = []
    for i, j in combinations(range(25), 2):
        centre, radius = (points[i] + points[j]) / 2, np.linalg.norm(points[i] - points[j]) / 2
        others = np.delete(points, [i, j], axis=0)
        if np.all(np.linalg.norm(others - centre, axis=1) > radius):
            expected.append([i, j])
    assert gabriel_edges(points).tolist() == expected


def test_a_mesh_of_bricks_is_drawn_by_the_edges_of_its_bricks():
    """4 x 3 x 2 nodes of unequal spacing: 3*3*2 + 4*2*2 + 4*3*1 lines along the axes, no diagonals."""
    nodes = np.array(list(product((0, 1, 2, 3), (0, 0.3, 0.6), (0, 2.0))), float)
    edges = gabriel_edges(nodes)
    assert len(edges) == 3 * 3 * 2 + 4 * 2 * 2 + 4 * 3 * 1
    assert all(np.count_nonzero(nodes[i] - nodes[j]) == 1 for i, j in edges)


def test_points_in_a_row_are_a_chain():
    assert gabriel_edges(np.outer((3, 0, 1, 2), (1, 2, 3))).tolist() == [[0, 3], [1, 2], [2, 3]]


def test_coinciding_points_are_drawn_once():
    assert different(np.array([(0, 0, 0), (1e-9, 0, 0), (1, 0, 0)]), 1e-7) == [0, 2]


def test_a_planar_mechanism_is_seen_along_its_normal_with_gravity_down():
    """A slider-crank in the yz plane of DAFMS, whose gravity is along +y."""
    places = np.array([(0, 0, 0), (0, 1, 0), (0, 0.3, 2)], float)
    view = view_of(places, np.array([0, 9.8, 0]))
    assert (view.up, view.eye) == ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0))


def test_a_plane_without_gravity_has_y_up():
    places = np.array([(0, 0, 0), (0.3, 1, 0), (2, 0, 0)], float)
    view = view_of(places, np.zeros(3))
    assert (view.up, view.eye) == ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize("gravity", [(0, 0, 0), (0, 0, -9.8)])
def test_in_space_z_is_up_and_the_viewer_stands_above(gravity):
    view = view_of(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.0)]), np.array(gravity, float))
    assert view.up == (0.0, 0.0, 1.0)
    assert view.eye[2] > 0


def test_a_tree_keeps_centres_gravity_and_where_its_nodes_are():
    """Thesis 4.4, two nodes a link: 2.5 kg at 0.5 m and 1.25 kg at 1 m of a beam of 5 kg; gravity: +y."""
    deck = Path(__file__).parents[3] / "decks" / "dafms" / "two_link_n2.DAT"
    tree, _ = build_dafms(read_dafms(DeckText("two_link_n2", deck.read_text(), "")))
    kept = {constant.path: constant.values for constant in tree_geometry(tree)}
    assert kept["body/centre"][0] == pytest.approx([0, (2.5 * 0.5 + 1.25 * 1.0) / 5.0, 0])
    assert kept["gravity"].tolist() == [0.0, 9.8, 0.0]
    assert kept["elastic/body 1/node_position"].tolist() == [[0.0, 0.5, 0.0], [0.0, 1.0, 0.0]]
    assert kept["point/body"].tolist() == [0, 1, 1, 1, 2, 2]
