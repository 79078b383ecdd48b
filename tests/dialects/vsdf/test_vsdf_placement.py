"""PLAC: a body lies where its nodes are put."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.dialects.vsdf.vsdf_decks import build, changed, reported, supplied

POSE = "POSI\n    2       1.0\n"


def placed(*lines):
    """The two links, the second placed by its nodes 1 (0 0 0), 3 (0.5 0 0) and 2 (0 0 1)."""
    return changed((POSE, "".join(["PLAC\n", *(f"    2,{line}\n" for line in lines)])))


def test_one_node_is_put_at_its_point():
    model = build(placed("3,1.0,2.0,3.0"))
    assert model.bodies[1].global_position(3) == pytest.approx([1.0, 2.0, 3.0], abs=1e-15)
    assert model.bodies[1].p == (1.0, 0.0, 0.0, 0.0)


def test_three_nodes_turn_a_body_into_an_inclined_position():
    """Against a rotation by a vector off all axes (SciPy): every node ends where that takes it."""
    turn, shift = Rotation.from_rotvec([0.4, -0.7, 2.5]), np.array([0.3, -0.2, 0.9])
    nodes = {1: (0.0, 0.0, 0.0), 3: (0.5, 0.0, 0.0), 2: (0.0, 0.0, 1.0)}
    lines = [
        f"{n},{','.join(repr(float(x)) for x in turn.apply(place) + shift)}" for n, place in nodes.items()
    ]
    body = build(placed(*lines)).bodies[1]
    for node, place in nodes.items():
        assert body.global_position(node) == pytest.approx(turn.apply(place) + shift, abs=1e-14)
    assert pytest.approx(np.eye(3), abs=1e-14) == body.A @ body.A.T


def test_the_second_point_gives_a_direction_and_the_third_a_plane():
    body = build(placed("1,1.0,1.0,0.0", "3,1.0,3.0,0.0", "2,9.0,1.0,7.0")).bodies[1]
    assert body.global_position(3) == pytest.approx([1.0, 1.5, 0.0], abs=1e-15)
    direction = np.array([8.0, 0.0, 7.0]) / np.hypot(8, 7)
    assert body.global_position(2) == pytest.approx([1.0, 1.0, 0.0] + direction, abs=1e-14)


def test_a_flexible_body_is_placed_by_nodes_of_its_mesh():
    """The rod of the slider-crank as its deck has it, node 7 at (0.15, 0, 0)."""
    text = supplied(
        "slider_crank_flex",
        ("    2      0.15    -0.005     -0.01\n", ""),
        (
            "NODE\n",
            "PLAC\n    2    7      0.15\n    2   83      0.65\n    2   11      0.15     0.005\nNODE\n",
        ),
    )
    found, wanted = build(text).bodies[1], build(supplied("slider_crank_flex")).bodies[1]
    for node in (1, 45, 83):
        assert found.global_position(node) == pytest.approx(wanted.global_position(node), abs=1e-12)


def test_a_point_beside_its_node_is_warned_of():
    lines = "1,0.0,0.0,0.0", "3,0.6,0.0,0.0", "2,0.0,0.0,1.0"
    wanted = "node 3 is 0.5 m from node 1, and its point 0.6 m from the first one: the node lies 0.1 m beside"
    assert any(wanted in fault and "warning" in fault for fault in reported(placed(*lines)))


FAULTS = {
    ("9,0.0,0.0,0.0",): "placement 1: body 2 has no node 9",
    ("1,0.0,0.0,0.0", "3,1.0,0.0,0.0"): "2 cards place body 2; one node places it, three place and turn it",
    ("1,0.0,0.0,0.0", "3,1.0,0.0,0.0", "2,5.0,0.0,0.0"): "the three points that turn body 2 lie on one line",
    ("1,0.0,0.0,0.0", "3,1.0,0.0,0.0", "3,0.0,0.0,1.0"): "the three nodes that turn body 2 lie on one line",
}


@pytest.mark.parametrize("lines", FAULTS)
def test_what_does_not_place_a_body_is_told_at_its_card(lines):
    assert any(FAULTS[lines] in fault for fault in reported(placed(*lines)))


def test_a_body_is_placed_once():
    text = changed((POSE, f"{POSE}PLAC\n    2,1,0.0,0.0,0.0\n"))
    assert any("POSI is not read beside PLAC of body 2" in fault for fault in reported(text))
    text = changed((POSE, "PLAC\n    7,1,0.0,0.0,0.0\n"))
    assert any("body number 7 is outside 1..2" in fault for fault in reported(text))
