"""VSDF decks turned into mechanisms: frames, points with shapes, what the ground is given."""

import math

import numpy as np
import pytest

from flexmb_cli.dialects.vsdf.build import build_vsdf
from flexmb_cli.dialects.vsdf.joints import BY_WORD
from flexmb_cli.errors import ModelError
from flexmb_cli.fe.build_mechanism import euler_parameters, flexible_mechanism
from flexmb_cli.interface import read_deck
from tests.dialects.vsdf.vsdf_decks import DECKS, RIGID, build, changed, read, supplied

# Nine modes are the paper's pendulum and rod.
STRAPS = dict.fromkeys(("strap_coarse", "strap_medium", "strap_fine"), 3)
ROWS = dict.fromkeys(("beam_on_crank", "frame_on_shaft"), 16) | {"beam_elements": 10, "shell_panel": 8}
MODES = {
    "spinup": 12,
    "slider_crank_flex": 6,
    "slider_crank_stress": 6,
    "rotor": 6,
    "blade": 144,
    **STRAPS,
    **ROWS,
}


def mechanism(text):
    return reduced(build(text))


def reduced(model):
    found, warnings = flexible_mechanism(model, cached=False)
    assert warnings == []
    return found


@pytest.mark.parametrize("path", sorted(DECKS.glob("*.vsdf")), ids=lambda path: path.stem)
def test_supplied_decks_describe_mechanisms(path):
    model, faults = build_vsdf(read_deck(path).deck, path.parent)
    (flexible,) = (body for body in reduced(model).bodies if body.flexible)
    assert faults == []
    assert flexible.modes == MODES.get(path.stem, 9)


def test_the_pendulum_hangs_on_a_revolute_joint_along_y():
    """Joint edge: nodes 1, 3, 5 along y at the origin; the ground takes its points from them."""
    (joint,) = mechanism(supplied("pendulum")).joints
    assert joint.kind == "revolute"
    assert [point.body for point in (*joint.a, *joint.b)] == [-1, -1, 0, 0]
    assert [point.r0.tolist() for point in joint.a] == [[0.0, 0.0, 0.0], [0.0, 0.01, 0.0]]
    assert [point.r0.tolist() for point in joint.b] == [[0.0, 0.0, 0.0], [0.0, 0.01, 0.0]]
    assert [point.shape.shape for point in joint.b] == [(3, 9), (3, 9)]
    assert not joint.b[0].shape.any()
    assert joint.b[1].shape.any()
    assert math.isnan(joint.size)


def test_the_pinned_pendulum_has_three_nodes_at_their_first_places():
    pins = mechanism(supplied("pendulum_pinned")).pins
    assert [pin.target.tolist() for pin in pins] == [[0, 0, 0], [0, 0.005, 0], [0, 0.01, 0]]
    assert all(pin.directions == (True, True, True) for pin in pins)


def test_a_moved_and_turned_body_keeps_its_nodes_where_the_deck_puts_them():
    """POSI and EULP place the node table; the frame of nodes 49, 1, 50 is another one."""
    half = math.sqrt(0.5)
    text = supplied(
        "freeflying",
        ("    1   13    9", "   49    1   50"),
        ("VELO\n", f"POSI\n    1       1.0       2.0       3.0\nEULP\n1,{half},0,0,{half}\nVELO\n"),
    )
    found = mechanism(text)
    body = found.bodies[0]
    e0, e = body.p[0], body.p[1:]
    tilde = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    A = (2 * e0 * e0 - 1) * np.eye(3) + 2 * (np.outer(e, e) + e0 * tilde)
    places = {point.name: body.r + A @ point.r0 for point in found.outputs}
    # A quarter turn about z takes (x, y, z) to (-y, x, z): node 51 is at (0.1, 0.005, 0).
    np.testing.assert_allclose(places["body 1 node 1"], [1.0, 2.0, 3.0], atol=1e-12)
    np.testing.assert_allclose(places["body 1 node 51"], [0.995, 2.1, 3.0], atol=1e-12)


def test_initial_velocities_are_those_of_the_deck():
    body = mechanism(supplied("freeflying")).bodies[0]
    assert body.velocity.tolist() == [0.3, -0.1, 0.2]
    assert body.omega.tolist() == [1.0, 8.0, 2.0]


def test_momentum_and_energy_of_the_free_flying_rod_at_the_start():
    """Reference values: P, H about the inertial origin and the kinetic energy of the rigidly moving rod."""
    body = mechanism(supplied("freeflying")).bodies[0]
    w, v = body.omega, body.velocity
    P = body.m * v + np.cross(w, body.s0)
    H = np.cross(body.s0, v) + body.J0 @ w
    T = 0.5 * body.m * v @ v + v @ np.cross(w, body.s0) + 0.5 * w @ body.J0 @ w
    np.testing.assert_allclose(P, [0.091, -0.00195, -0.0507], atol=1e-11)
    np.testing.assert_allclose(H, [-2.3183e-4, 4.98983e-3, -1.1483e-4], atol=5e-9)
    assert pytest.approx(2.840608e-2, abs=5e-9) == T


def test_a_node_set_is_the_mean_of_its_nodes():
    found = mechanism(supplied("spinup"))
    (tip,) = found.outputs
    body = found.bodies[0].flexible
    np.testing.assert_allclose(tip.r0, [10.0, 0.0, 0.0], atol=1e-12)
    mean = sum(body.shape(node) for node in (121, 122, 123, 124)) / 4
    np.testing.assert_allclose(tip.shape, mean)


def test_a_rigid_body_has_its_inertia_about_its_origin():
    """Steiner: J0 = Jc + m (c·c E - c c'), here m = 2 kg, c = 0.5 m along x."""
    body = mechanism(RIGID).bodies[0]
    assert body.modes == 0
    np.testing.assert_allclose(body.J0, np.diag([0.1, 0.2 + 0.5, 0.2 + 0.5]))
    assert body.s0.tolist() == [1.0, 0.0, 0.0]


def test_lengths_at_rest_are_those_of_the_start_where_the_deck_is_silent():
    springs = "    1    0    1    2    3      10.0\n2,0,1,2,3,10.0,0.0,0.0\n"
    text = changed(("GRAV\n", f"SPRI\n{springs}GRAV\n"))
    first, second = mechanism(text).springs
    assert (first["rest"], second["rest"]) == (pytest.approx(1.5), 0.0)


def test_distances_are_those_of_the_start_where_the_deck_is_silent():
    text = changed(("    2 REVO    1    3    4    2    1    2\n", "    2 DIST    1    1    0    2    3\n"))
    assert mechanism(text).joints[1].size == pytest.approx(1.5)


KINDS = {
    "SPHE": ("spherical", "    3    0    2    1    0"),
    "UNIV": ("universal", "    3    4    2    1    3"),
    "CYLI": ("cylindrical", "    3    4    2    1    2"),
    "TRAN": ("translational", "    3    4    2    1    2    1    3"),
    "SCRW": ("screw", "    3    4    2    1    2    1    3      0.01"),
    "FIXD": ("fixed", "    3    4    2    1    2    1    3"),
    "RSPH": ("revolute-spherical", "    3    4    2    3    0"),
}


@pytest.mark.parametrize("word", KINDS)
def test_every_kind_of_joint_has_the_points_it_needs(word):
    kind, nodes = KINDS[word]
    # Node 3 of body 2 lies where a weld has node 1 of body 1.
    text = changed(
        ("    2 REVO    1    3    4    2    1    2\n", f"    2 {word}    1{nodes}\n"),
        ("    2    3       0.5", "    2    3      -1.0"),
    )
    joint = mechanism(text).joints[1]
    assert joint.kind == kind
    needed = BY_WORD[word]
    assert (len(joint.a), len(joint.b)) == (needed.points_on("i"), needed.points_on("j"))


def test_faults_of_all_bodies_are_told_together():
    text = """\
VSDF TWO BAD BODIES
BODY
    1 FLEX    9    1   13    9
    2 FLEX    9    1   13    9
FEMN
    1 TXT  fe/pendulum_nodes.txt
    2 TXT  fe/pendulum_nodes.txt
FEMM
    1 MM   fe/none.mtx
    2 MM   fe/pendulum_M.mtx
FEMK
    1 MM   fe/pendulum_K.mtx
    2 MM   fe/spinup_K.mtx
TIME
       1.0       0.1
END
STAR
"""
    with pytest.raises(ModelError) as stopped:
        flexible_mechanism(build_vsdf(read(text), DECKS)[0], cached=False)
    assert [(fault.place.line, fault.sentence) for fault in stopped.value.faults] == [
        (9, f"body 1: none.mtx: no such file in {DECKS / 'fe'}"),
        (
            13,
            "body 2: spinup_K.mtx has 372 rows; the 54 nodes of the table need 162, three each; "
            "has it other nodes, or rotations of beams and shells?",
        ),
    ]


@pytest.mark.parametrize("seed", range(8))
def test_euler_parameters_of_every_rotation_give_it_back(seed):
    random = np.random.default_rng(seed)
    p = random.normal(size=4) if seed < 4 else np.eye(4)[seed - 4]
    p = p / np.linalg.norm(p)
    p = -p if p[0] < 0 else p
    e0, e = p[0], p[1:]
    tilde = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    A = (2 * e0 * e0 - 1) * np.eye(3) + 2 * (np.outer(e, e) + e0 * tilde)
    np.testing.assert_allclose(euler_parameters(A), p, atol=1e-12)


def test_loads_at_one_node_share_its_shapes():
    """With a copy of the node's shapes for each, a deck of 8 MB of forces took 827 MB."""
    text = supplied("pendulum").replace("\nEND", "\nFORC\n" + 20 * "    1   51       1.0\n" + "END", 1)
    points = {id(force.point) for force in mechanism(text).forces}
    assert len(points) == 1
