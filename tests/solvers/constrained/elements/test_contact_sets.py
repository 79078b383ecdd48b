"""Contacts of many shapes in one line, against a line for each pair and closed forms."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.errors import AnalysisError
from flexmb_cli.model.arrays.contacts import PAIRS_OF_AN_END
from flexmb_cli.model.flexible_mechanism import NodePoint
from flexmb_cli.model.joint_elements import JointElements
from flexmb_cli.model.laws import CONTACT, Element, Touch
from flexmb_cli.model.mechanism import TimeGrid
from flexmb_cli.model.tree import Body, Hinge, Tree
from flexmb_cli.solvers.tree.analysis import TreeAnalysis
from tests.dialects.vsdf.test_elements import rows_of as vsdf_rows
from tests.solvers.constrained.element_decks import FREE
from tests.solvers.constrained.element_decks import rows_of as young_rows

DECKS = Path(__file__).parents[4] / "decks/vsdf"

RADIUS, MASS = 0.05, 0.5
LAW = "stiffness=1e4 damping=0.1 friction=0.3 creep=1e-2"


def places(count):
    """Centres of balls in a loose block above the plane z = 0, m."""
    cells = np.array([(x, y, z) for z in range(3) for y in range(3) for x in range(3)][:count], float)
    return (
        cells * 2.05 * RADIUS
        + (0.0, 0.0, 1.05 * RADIUS)
        + np.random.default_rng(1).uniform(-0.001, 0.001, (count, 3))
    )


def together(count, ball, floor):
    return (
        f"  CONTACT floor plane-sphere from={floor} normal=(0,0,1) to={ball(1, count)} radius_to={RADIUS}\n"
        f"    {LAW}\n  CONTACT pile sphere-sphere from={ball(1, count)} radius_from={RADIUS}\n"
        f"    to={ball(1, count)} radius_to={RADIUS} {LAW}\n"
    )


def one_by_one(count, ball, floor):
    lines = [
        f"  CONTACT floor{k} plane-sphere from={floor} normal=(0,0,1) to={ball(k, k)}\n"
        f"    radius_to={RADIUS} {LAW}"
        for k in range(1, count + 1)
    ]
    lines += [
        f"  CONTACT pair{i}-{j} sphere-sphere from={ball(i, i)} radius_from={RADIUS} to={ball(j, j)} "
        f"radius_to={RADIUS}\n    {LAW}"
        for i, j in combinations(range(1, count + 1), 2)
    ]
    return "\n".join(lines) + "\n"


def vsdf(count, lines, end, method):
    inertia = 0.4 * MASS * RADIUS**2
    cards = ["BODY", *(f" {k},RIGD" for k in range(1, count + 1)), "RIGI"]
    for k in range(1, count + 1):
        cards += [f" {k},{MASS},0,0,0", f" {inertia},{inertia},{inertia},0,0,0"]
    cards += ["NODE", *(f" {k},1,0,0,0" for k in range(1, count + 1)), "POSI"]
    cards += [f" {k},{','.join(map(repr, map(float, r)))}" for k, r in enumerate(places(count), 1)]
    deck = "VSDF PILE\n" + "\n".join(cards) + "\nGRAV\n 0,0,-9.81\n"
    text = lines(count, lambda i, j: f"{i}:1" if i == j else f"{i}-{j}:1", "0(0,0,0)")
    return vsdf_rows(deck, end, end / 4.0, f"ELEMENTS\n{text}", method)


@pytest.mark.long_motion
@pytest.mark.parametrize("method", ["RK45", "RAD5"])
def test_shapes_in_one_line_move_as_pairs_in_lines_of_their_own(method):
    """The second formulation is a line a pair: all forces are the same, summed in another order."""
    many, single = (vsdf(8, lines, 0.15, method) for lines in (together, one_by_one))
    error = 1e-9 if method == "RK45" else 1e-7
    assert many.position == pytest.approx(single.position, abs=error)
    assert many.contact_touches[-1].sum() == single.contact_touches[-1].sum() > 8
    assert many.dissipated == pytest.approx(single.dissipated, abs=error)
    floor = single.contact_force[:, :8].sum(axis=1)
    assert many.contact_force[:, 0] == pytest.approx(floor, abs=1e4 * error)
    assert many.element_coordinate[:, 0] == pytest.approx(
        single.element_coordinate[:, :8].min(axis=1), abs=error
    )


CUBE = np.array([(x, y, z) for z in (-0.05, 0.05) for y in (-0.05, 0.05) for x in (-0.05, 0.05)])
FACES = ((0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2),
         (2, 4, 6), (1, 3, 5), (3, 7, 5))  # fmt: skip


def test_a_mesh_falls_on_a_plane_as_the_box_that_it_is(tmp_path):
    """The convex hull of a cube in an STL file, in mm, has the corners of a box."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {' '.join(map(str, 1000.0 * CUBE[k]))}\n" for k in face)
        + "endloop\nendfacet\n"
        for face in FACES
    )
    (tmp_path / "cube.stl").write_text(f"solid cube\n{facets}endsolid cube\n")
    deck = FREE.replace("0 0 0 1 0 0 0\n1 0", "0 0 0.09 0.9 0.1 0.3 0.3\n1 0", 1)
    rows = {
        kind: young_rows(
            deck,
            "0 0.3 0.05",
            f"MASS 2 1 0 0 0 0.002 0.002 0.002\nGRAVITY 0 0 -9.81\nELEMENTS\n  CONTACT floor plane-{kind}\n"
            f"    from=0(0,0,0) normal=(0,0,1) to=2(0,0,0) {size} stiffness=1e4 damping=0.2 friction=0.3",
        )
        for kind, size in (
            ("box", "size_to=(0.1,0.1,0.1)"),
            ("mesh", f"file_to={tmp_path / 'cube.stl'} unit_to=0.001"),
        )
    }
    box, mesh = rows["box"], rows["mesh"]
    assert mesh.position == pytest.approx(box.position, abs=1e-7)
    assert mesh.contact_force[:, 0] == pytest.approx(box.contact_force.sum(axis=1), abs=1e-3)
    assert mesh.contact_touches[-1, 0] == box.contact_touches[-1].sum() > 2
    assert mesh.element_coordinate[:, 0] == pytest.approx(box.element_coordinate.min(axis=1), abs=1e-7)


def test_nodes_of_a_flexible_body_touch_in_one_line_as_in_lines_of_their_own():
    """A flexible pendulum falls on a plane 1 mm below it."""
    deck = (DECKS / "pendulum_pinned.vsdf").read_text(encoding="utf-8")
    deck = deck[: deck.index("TIME")].replace("fe/", f"{DECKS}/fe/")
    law = "normal=(0,0,1) stiffness=100 damping=0.1"
    one = f"  CONTACT floor plane-point from=0(0,0,-0.001) to=1:6-9 {law}\n"
    each = "".join(f"  CONTACT f{k} plane-point from=0(0,0,-0.001) to=1:{k} {law}\n" for k in range(6, 10))
    many, single = (vsdf_rows(deck, 0.05, 0.005, f"ELEMENTS\n{lines}", "RAD5") for lines in (one, each))
    assert single.contact_force[..., 2].max() > 0.01
    assert many.contact_force[:, 0] == pytest.approx(single.contact_force.sum(axis=1), abs=1e-5)
    assert many.element_energy[:, 0] == pytest.approx(single.element_energy.sum(axis=1), abs=1e-8)


def balls(places, hinges, law, end):
    """A tree of balls, each of which may touch each, at places (balls, 3) if they are free."""
    ends = [(k, NodePoint("", k, np.zeros(3), np.zeros((3, 0)))) for k in range(len(hinges))]
    touch = Touch(0, 0, ends[0][1], ends[0][1], "sphere", "sphere", radius_i=RADIUS, radius_j=RADIUS,
                  more_i=tuple(ends[1:]), more_j=tuple(ends[1:]), mutual=True)  # fmt: skip
    bodies = tuple(Body(f"ball {k}", MASS, np.eye(3) * 0.4 * MASS * RADIUS**2) for k in range(len(hinges)))
    elements = JointElements(forces=(Element("pile", CONTACT, touch, CONTACT.values(**law)),))
    count = sum(len(hinge.rotations) + len(hinge.translations) for hinge in hinges)
    q, y, grid = np.zeros(count), np.zeros(count), TimeGrid(0.0, end, end / 4.0)
    tree = Tree(bodies, hinges, q, y, grid, (0.0, 0.0, 0.0), elements=elements)
    for k, c in enumerate(tree.coordinates):
        tree.q[k] = places[c.body][c.axis - 1] if c.motion == "translation" else 0.0
    return TreeAnalysis(tree)


def free(count):
    return tuple(Hinge(-1, rotations=(1, 2, 3), translations=(1, 2, 3)) for _ in range(count))


def test_bodies_that_a_joint_connects_do_not_touch_in_a_line_of_many():
    """Balls on a chain of hinges overlap their neighbours by half a radius: no force, and nothing moves."""
    hinges = tuple(Hinge(k - 1, (1.5 * RADIUS if k else 0.0, 0.0, 0.0), rotations=(3,)) for k in range(4))
    rows = list(balls([], hinges, {"stiffness": 1e4}, 0.1).rows())
    assert np.concatenate([row.element_effort for row in rows]) == pytest.approx(np.zeros((5, 1)), abs=0.0)
    assert rows[-1].contact_touches[-1, 0] == 0.0


def test_three_balls_exchange_their_speeds():
    """Equal balls in a row, elastic: the first stops, the last leaves with its speed (momentum, energy)."""
    places = [(0.0, 0.0, 0.0), (3.0 * RADIUS, 0.0, 0.0), (6.0 * RADIUS, 0.0, 0.0)]
    analysis = balls(places, free(3), {"stiffness": 1e6}, 0.2)
    analysis.tree.y[
        [c.body == 0 and c.motion == "translation" and c.axis == 1 for c in analysis.tree.coordinates]
    ] = 1.0
    analysis = TreeAnalysis(analysis.tree)
    rows = list(analysis.rows())
    assert rows[-1].velocity[-1, :, 0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
    assert rows[-1].contact_touches[-1, 0] == 2.0


def test_a_crowd_that_there_is_no_room_for_ends_the_run():
    """30 balls in one place are 435 pairs; there is room for 12 each."""
    assert 30 * PAIRS_OF_AN_END < 435
    with pytest.raises(AnalysisError, match="lines of their own"):
        list(balls(np.zeros((30, 3)), free(30), {"stiffness": 1e4}, 0.1).rows())


def test_a_search_of_pairs_takes_time_in_proportion_to_the_shapes():
    """Balls 2.05 radii apart: those within the skin are the 6 nearest of each, however many there are."""
    side = 8
    grid = (
        np.stack(np.meshgrid(*3 * [np.arange(side)], indexing="ij"), axis=-1).reshape(-1, 3) * 2.05 * RADIUS
    )
    analysis = balls(grid, free(len(grid)), {"stiffness": 1e4}, 1e-3)
    list(analysis.rows())
    assert analysis.arrays.contacts.sets["count"][0] == 3 * side**2 * (side - 1)
    pairs = analysis.arrays.contacts.touches[: 3 * side**2 * (side - 1)]
    apart = np.linalg.norm(grid[pairs["end_i"]] - grid[pairs["end_j"]], axis=1)
    assert apart == pytest.approx(np.full(len(pairs), 2.05 * RADIUS), rel=1e-12)
