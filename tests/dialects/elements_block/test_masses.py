"""Masses of solids: closed forms, integrals of closed surfaces, and the same body in every dialect."""

from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.deck.text import decode
from flexmb_cli.dialects.elements_block import words
from flexmb_cli.dialects.recognise import dialect_named, read_deck
from flexmb_cli.errors import DeckError, ModelError
from flexmb_cli.fe.solid_masses import (
    about,
    combined,
    of_mass,
    placed,
    point_mass,
    polyhedron_mass,
    primitive_mass,
    surface_fault,
)
from flexmb_cli.model import shapes
from flexmb_cli.model.arrays.dynamic import inertia_matrix
from flexmb_cli.model.shapes import primitive

NOWHERE = (0.0, 0.0, 0.0)
# Masses and principal moments of handbooks (Meriam and Kraige, Dynamics, table D/4), density 1.
KNOWN = {
    ("sphere", (0.3, 0.0, 0.0)): (4 / 3 * np.pi * 0.027, [0.4 * 0.09] * 3),
    ("box", (0.2, 0.5, 0.7)): (0.07, [(0.25 + 0.49) / 12, (0.04 + 0.49) / 12, (0.04 + 0.25) / 12]),
    ("cylinder", (0.2, 0.6, 0.0)): (np.pi * 0.024, [(3 * 0.04 + 0.36) / 12] * 2 + [0.02]),
    ("tube", (0.2, 0.6, 0.1)): (np.pi * 0.018, [(3 * 0.05 + 0.36) / 12] * 2 + [0.025]),
    ("cone", (0.2, 0.6, 0.0)): (np.pi * 0.008, [3 / 80 * (4 * 0.04 + 0.36)] * 2 + [0.3 * 0.04]),
}


@pytest.mark.parametrize(("kind", "sizes"), KNOWN)
def test_primitives_have_the_moments_of_handbooks(kind, sizes):
    found, (mass, moments) = primitive_mass(kind, sizes), KNOWN[kind, sizes]
    assert found.mass == pytest.approx(mass, rel=1e-14)
    assert found.inertia == pytest.approx(mass * np.diag(moments), rel=1e-13, abs=1e-18)
    # A cone's centre lies a quarter of its height above its base.
    assert found.centre == pytest.approx((0, 0, -0.15 if kind == "cone" else 0), abs=1e-15)


def test_a_frustum_is_a_cone_without_its_tip():
    whole, tip = primitive_mass("cone", (0.4, 0.8, 0.0)), primitive_mass("cone", (0.2, 0.4, 0.0))
    tip = placed(tip, (0.0, 0.0, 0.2), NOWHERE)
    left = placed(primitive_mass("cone", (0.4, 0.4, 0.2)), (0.0, 0.0, -0.2), NOWHERE)
    both = combined([left, tip])
    assert both.mass == pytest.approx(whole.mass, rel=1e-14)
    assert both.centre == pytest.approx(whole.centre, abs=1e-15)
    assert both.inertia == pytest.approx(whole.inertia, rel=1e-13, abs=1e-17)


def test_a_surface_of_triangles_has_the_moments_of_its_solid():
    shape = primitive(1, "box", (0.2, 0.5, 0.7), (3.0, -2.0, 1.0), (0.3, -0.5, 1.1))
    found = polyhedron_mass(shape.vertices, shape.triangles)
    wanted = placed(primitive_mass("box", (0.2, 0.5, 0.7)), (3.0, -2.0, 1.0), (0.3, -0.5, 1.1))
    assert found.mass == pytest.approx(wanted.mass, rel=1e-12)
    assert found.centre == pytest.approx(wanted.centre, rel=1e-12)
    assert found.inertia == pytest.approx(wanted.inertia, rel=1e-9, abs=1e-12)


def test_a_tetrahedron_has_the_moments_of_tonon():
    """Tonon (2005), section 3: his tetrahedron, whose tensor about the centroid he prints."""
    corners = [(8.3322, -11.86875, 0.93355), (0.75523, 5, 16.37072), (52.61236, 5, -5.3858), (2, 5, 3)]
    found = polyhedron_mass(np.array(corners), np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]))
    assert found.centre == pytest.approx((15.92492, 0.78281, 3.72962), abs=1e-4)
    assert np.diag(found.inertia) == pytest.approx([43520.33257, 194711.28938, 191168.76173], rel=1e-6)
    assert found.inertia[1, 2] == pytest.approx(-4417.66150, rel=1e-6)


def test_parts_are_added_by_the_parallel_axis_theorem():
    half = of_mass(primitive_mass("box", (0.5, 0.2, 0.3)), 8.0)
    both = combined([placed(half, (x, 1.0, 2.0), NOWHERE) for x in (0.25, 0.75)])
    whole = of_mass(primitive_mass("box", (1.0, 0.2, 0.3)), 8.0)
    assert both.mass == pytest.approx(whole.mass) and both.centre == pytest.approx((0.5, 1.0, 2.0))
    assert both.inertia == pytest.approx(whole.inertia, rel=1e-13, abs=1e-16)
    ring = combined([point_mass(2.0, (np.cos(a), np.sin(a), 0.0)) for a in np.arange(8) * np.pi / 4])
    assert np.diag(ring.inertia) == pytest.approx([8.0, 8.0, 16.0])
    assert placed(ring, NOWHERE, (0.0, 0.0, 0.4)).inertia == pytest.approx(ring.inertia, abs=1e-12)


def test_open_and_inside_out_surfaces_are_faults():
    shape = primitive(1, "box", (0.2, 0.5, 0.7), NOWHERE, NOWHERE)
    assert surface_fault(shape.vertices, shape.triangles) == ""
    assert "is not closed: 3 edges" in surface_fault(shape.vertices, shape.triangles[1:])
    assert "is inside out" in surface_fault(shape.vertices, shape.triangles[:, ::-1])
    turned = np.vstack([shape.triangles[:1, ::-1], shape.triangles[1:]])
    assert surface_fault(shape.vertices, turned)
    flat = np.array([(0, 1, 2), (0, 2, 1)])
    assert "encloses no volume" in surface_fault(shape.vertices, flat)


YOUNG = """2 0 0 0 0 1 0 0 0 0 0 1
0 0 0 1 0 0 0
0 0 0 1 0 0 0
1 2 0 0 0 0 0 0 0 1 0 0 1 0
1 0 0 0 0 0 0
0 1 0.1
DYNAMICS forward
{mass}
GRAVITY 0 0 -9.81
{block}END
"""
DAFMS = """    1    3
DFMB
    1    0    0    0    0
    1    1    0    1    0
    0
    0
   10
       0.1
CONN
    0
MASS
    1{mass:>10}
INER
    1{inertia:>10}{inertia:>10}{inertia:>10}
Q(k)
    1       0.0       0.0       0.0
Y(L)
       0.0       0.0
GRAV
    0       0.0       0.0     -9.81
{block}END
STAR
STOP
"""
VSDF = """VSDF
BODY
    1 RIGD
{mass}NODE
1,1,0,0,0
TIME
1,0.1
{block}END
STAR
STOP
"""
LINES = """ELEMENTS
  MASS rod box body={k} density=2700 size=(0.6,0.02,0.03) centre=(0.3,0,0) angles=(0,0.4,0)
  MASS bob sphere body={k} mass=1.5 size=(0.05,0,0) centre=(0.6,0,0.1)
  MASS tip point body={k} mass=0.25 centre=(0.7,0.1,0)
"""


def model_of(text, folder=Path()):
    deck = read_deck(decode("x", text.encode()))
    return dialect_named(deck.dialect).build(deck, folder)[0]


def test_lines_give_the_same_body_in_every_dialect():
    rod = placed(of_mass(primitive_mass("box", (0.6, 0.02, 0.03)), 2700.0), (0.3, 0.0, 0.0), (0.0, 0.4, 0.0))
    bob = primitive_mass("sphere", (0.05, 0.0, 0.0))
    bob = placed(of_mass(bob, 1.5 / bob.mass), (0.6, 0.0, 0.1), NOWHERE)
    lines, tip = [rod, bob, point_mass(0.25, (0.7, 0.1, 0.0))], LINES.format(k=1)
    card = point_mass(0.5, NOWHERE)
    wanted = combined([*lines, card])
    young = model_of(YOUNG.format(mass="MASS 2 0.5 0 0 0 0 0 0", block=LINES.format(k=2))).masses[0]
    assert young.body == 1 and young.mass == pytest.approx(wanted.mass)
    assert young.centre == pytest.approx(wanted.centre)
    assert inertia_matrix(young.inertia) == pytest.approx(wanted.inertia, rel=1e-12, abs=1e-15)
    tree = model_of(DAFMS.format(mass="0.5", inertia="0.0", block=tip)).bodies[0]
    assert tree.mass == pytest.approx(wanted.mass) and tree.centre == pytest.approx(wanted.centre)
    shifted = wanted.inertia + about(wanted.mass, np.array(wanted.centre))
    assert tree.inertia == pytest.approx(shifted, rel=1e-12, abs=1e-15)
    body = model_of(VSDF.format(mass="RIGI\n1,0.5,0,0,0\n0.001,0.001,0.001\n", block=tip))
    ball = combined([*lines, type(card)(0.5, NOWHERE, 0.001 * np.eye(3))])
    assert body.bodies[0].m == pytest.approx(ball.mass)
    alone = model_of(VSDF.format(mass="", block=tip)).bodies[0]
    assert alone.m == pytest.approx(combined(lines).mass)


def stl(triangles, vertices):
    rows = ("".join(f"vertex {x} {y} {z}\n" for x, y, z in vertices[row]) for row in triangles)
    return (
        "solid x\n" + "".join(f"facet\nouter loop\n{row}endloop\nendfacet\n" for row in rows) + "endsolid x\n"
    )


def test_files_are_read_in_their_unit_and_open_ones_refused(tmp_path):
    shape = primitive(1, "box", (200.0, 500.0, 700.0), (30.0, 20.0, 10.0), NOWHERE)
    (tmp_path / "box.stl").write_text(stl(shape.triangles, shape.vertices))
    (tmp_path / "open.stl").write_text(stl(shape.triangles[2:], shape.vertices))
    line = "ELEMENTS\n  MASS part stl body=2 file={}.stl unit=0.001 density=1000\n"
    found = model_of(YOUNG.format(mass="", block=line.format("box")), tmp_path).masses[0]
    assert found.mass == pytest.approx(70.0) and found.centre == pytest.approx((0.03, 0.02, 0.01))
    with pytest.raises(ModelError, match=r"the surface in open.stl is not closed: 6 edges") as failure:
        model_of(YOUNG.format(mass="", block=line.format("open")), tmp_path)
    assert failure.value.faults[-1].place.line == 11


@pytest.mark.parametrize(
    ("line", "sentence"),
    {
        "MASS a point body=7 mass=1": "body number 7 is outside 1..2",
        "MASS a point body=2 mass=-1": "mass must be above 0",
        "MASS a point body=2 density=1": "point takes mass=",
        "MASS a box body=2 mass=1": "box takes size=; correct size",
        "MASS a box body=2 mass=1 density=2 size=(1,1,1)": "either mass= or density= must be given",
        "MASS a sphere body=2 mass=1 size=(1,1,0)": "size.y of a sphere is not read",
        "MASS a stl body=2 density=1 file=none.stl": "none.stl",
    }.items(),
)  # fmt: skip
def test_wrong_lines_are_faults(line, sentence):
    with pytest.raises(DeckError) as failure:
        model_of(YOUNG.format(mass="", block=f"ELEMENTS\n  {line}\n"))
    assert sentence in "".join(fault.message for fault in failure.value.faults)


def test_every_primitive_has_a_mass():
    assert words.SOLIDS == shapes.KINDS
