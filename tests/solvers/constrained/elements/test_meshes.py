"""Balls on meshes of triangles: a tessellated plane is a plane, a bowl guides a ball as a pendulum."""

import itertools
import math

import numpy as np
import pytest
from scipy.special import ellipk

from flexmb_cli.kernels.contact_mesh import nearest_on_mesh
from flexmb_cli.model.arrays.contacts import TOUCH, ContactTable
from tests.solvers.constrained.element_decks import ARM
from tests.solvers.constrained.elements.test_bristles import faults_of
from tests.solvers.constrained.elements.test_contacts import DIALECTS, EXPLICIT, IMPLICIT, ball, on_plane


def written(path, triangles):
    """A text file of STL with triangles (n, 3, 3)."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {' '.join(map(repr, map(float, corner)))}\n" for corner in triangle)
        + "endloop\nendfacet\n"
        for triangle in triangles
    )
    path.write_text(f"solid mesh\n{facets}endsolid mesh\n")
    return path


def grid(xs, ys, height):
    """Triangles of a surface over a grid."""
    found = []
    for x, x2 in itertools.pairwise(xs):
        for y, y2 in itertools.pairwise(ys):
            a, b, c, d = ((*p, height(*p)) for p in ((x, y), (x2, y), (x2, y2), (x, y2)))
            found += [(a, b, c), (a, c, d)]
    return np.array(found)


@pytest.mark.parametrize("triangle", [0, 17])
def test_the_nearest_point_is_that_of_all_triangles(triangle):
    """Against a search over barycentric coordinates of every triangle, from any triangle found before."""
    rng = np.random.default_rng(5)
    triangles = rng.normal(size=(40, 1, 3)) + 0.4 * rng.normal(size=(40, 3, 3))
    table, record = ContactTable(), np.zeros(1, TOUCH)[0]
    table.mesh(triangles.reshape(-1, 9))
    contacts = table.arrays()
    for p in 1.5 * rng.normal(size=(30, 3)):
        record["triangle"] = triangle
        found = nearest_on_mesh(contacts, record, tuple(p))
        distance = np.linalg.norm(np.array(found) - p)
        assert distance == pytest.approx(min(distance_of(p, each) for each in triangles), abs=1e-12)
        assert distance_of(found, triangles[record["triangle"]]) == pytest.approx(0.0, abs=1e-12)


def distance_of(p, corners):
    """Distance of p from a triangle: of its plane inside, else of its edges."""
    a, b, c = corners
    shares = np.linalg.lstsq(np.column_stack([b - a, c - a]), p - a, rcond=None)[0]
    if shares.min() >= 0.0 and shares.sum() <= 1.0:
        return np.linalg.norm(a + shares[0] * (b - a) + shares[1] * (c - a) - p)
    edges = ((a, b), (b, c), (c, a))
    return min(np.linalg.norm(x + min(max((p - x) @ (y - x) / ((y - x) @ (y - x)), 0), 1) * (y - x) - p)
               for x, y in edges)  # fmt: skip


@pytest.mark.parametrize("method", [EXPLICIT, IMPLICIT])
@pytest.mark.parametrize(
    "dialect", ["vsdf", *(pytest.param(name, marks=pytest.mark.long_motion) for name in ("young", "dafms"))]
)
def test_a_ball_on_a_tessellated_plane_rolls_as_on_the_plane(tmp_path, dialect, method):
    """It bounces, slides and rolls over edges and corners of 72 triangles, whose file is in mm."""
    ticks = np.linspace(-500.0, 1500.0, 7)
    path = written(tmp_path / "floor.stl", grid(ticks, ticks + 3.0, lambda x, y: 0.0))
    thrown = ball((0.0, 0.0, 0.1), (1.5, 0.7, 0.0), (0.0, 3.0, 0.0))
    law = "stiffness=1e5 exponent=1.5 damping=0.3 friction=0.3 rolling=0.001"
    mesh = on_plane(law).replace("plane-sphere", "mesh-sphere").replace(
        "normal=(0,0,1)", f"file_from={path} unit_from=0.001"
    )  # fmt: skip
    rows, expected = (DIALECTS[dialect](thrown, 0.6, 0.05, lines, method) for lines in (mesh, on_plane(law)))
    assert rows.position == pytest.approx(expected.position, abs=1e-8)
    assert rows.contact_touches[-1, 0] == expected.contact_touches[-1, 0] > 1.0


RADIUS, BALL, ANGLE = 1.0, 0.1, 0.6  # of the bowl, of the ball, m, and where that begins, rad


def bowl(n):
    """Triangles of a spherical bowl about the origin, up to 1.2 rad from its bottom."""

    def place(i, j):
        theta, phi = 1.2 * i / n, math.pi / 2.0 * j / n
        return math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), -math.cos(theta)

    found = []
    for i in range(n):
        for j in range(4 * n):
            a, b, c, d = place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)
            found += [(a, b, c), (a, c, d)] if i else [(a, b, c)]
    return RADIUS * np.array(found)


@pytest.mark.long_motion
def test_a_ball_slides_in_a_bowl_of_12640_triangles_as_a_pendulum(tmp_path):
    """After a period of a pendulum, 4 sqrt(L/g) K(sin²(a/2)), it is back; facets are off by their sagitta."""
    triangles, length = bowl(40), RADIUS - BALL
    path = written(tmp_path / "bowl.stl", triangles)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    planes = np.abs(np.sum(normals * triangles[:, 0], axis=1)) / np.linalg.norm(normals, axis=1)
    start = [length * x for x in (math.sin(ANGLE) * 0.8, math.sin(ANGLE) * 0.6, -math.cos(ANGLE))]
    period = 4.0 * math.sqrt(length / 9.81) * ellipk(math.sin(ANGLE / 2.0) ** 2)
    line = f"  CONTACT bowl mesh-sphere from=GROUND to=BALL file_from={path} unit_from=1 radius_to={BALL}\n"
    rows = DIALECTS["young"](
        ball(tuple(start), (0.0, 0.0, 0.0), radius=BALL, tolerance=1e-9),
        period,
        period / 20.0,
        f"{line}    stiffness=1e5 damping=1\n",
        EXPLICIT,
    )
    places = rows.position[:, 1]
    assert places[-1] == pytest.approx(start, abs=0.01)
    assert places[10] == pytest.approx([-start[0], -start[1], start[2]], abs=0.005)
    depth = 3.0 * 0.5 * 9.81 / 1e5
    off = np.linalg.norm(places, axis=1) - length
    assert np.abs(off).max() < np.max(RADIUS - planes) + depth
    assert rows.total == pytest.approx(np.full(21, rows.total[0]), abs=1e-5)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("mesh-sphere from=0(0,0,0) to=2(0,0,0) file_from=none.stl unit_from=1 radius_to=1", "none.stl"),
        ("mesh-sphere from=0(0,0,0) to=2(0,0,0) radius_to=1", "mesh-sphere needs file_from="),
        ("mesh-sphere from=2-3(0,0,0) to=2-3(0,0,0) file_from={mesh} unit_from=1 radius_to=1", "one mesh"),
        ("mesh-mesh from=0(0,0,0) to=2(0,0,0) file_from={mesh} unit_from=1", "mesh-mesh"),
        ("mesh-box from=0(0,0,0) to=2(0,0,0) file_from={mesh} unit_from=1 size_to=(1,1,1)", "mesh-box"),
    ],
)
def test_what_meshes_do_not_touch_is_named(tmp_path, line, message):
    path = written(tmp_path / "floor.stl", grid([0.0, 1.0], [0.0, 1.0], lambda x, y: 0.0))
    faults = faults_of(f"CONTACT c {line.format(mesh=path)} stiffness=1", ARM)
    assert any(message in fault.message for fault in faults)
