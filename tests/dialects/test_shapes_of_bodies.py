"""Cards of shapes in all three dialects: read, placed, stored in the result, and refused in words.

Shapes are for pictures: `test_shapes_change_no_number` compares the tables of decks with and without.
"""

import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.check import check
from flexmb_cli.cli.run import run
from tests.fe.test_stl import binary

DECKS = Path(__file__).resolve().parents[2] / "decks"
YOUNG = """
GEOMETRY  { shapes alone }
GEOM 0 1  1 2 3
GEOM 4 3  0.3 6 0.2  0 1.85 0  1.570796326794897 0 0
stl sub/wedge.stl 2  0.001  0 0 1
END
"""
DAFMS = """GEOM
    2
    1    2       0.2       3.0
       0.0       1.5       0.0 1.5707963       0.0       0.0
    0    1       1.0       2.0       3.0
       0.0       0.0       0.0       0.0       0.0       0.0
END """
VSDF = """GEOM
    1 TUBE      0.02       0.2      0.01     0.075       0.0       0.0       0.0  1.570796
    0,SPHE,0.3,,,1,2,3
GSTL
    3,0.001,,,0.5
 sub/wedge.stl
END"""
WEDGE = (2e-3, 3e-3, 4e-3)
FORWARD = (1e-3, 1.5e-3, 0.502)
# A deck, what is added to it, and its shapes: body, middle and size (of the box around it).
CASES = {
    "young/IN4-BAR.dat": (
        lambda text: text + YOUNG,
        [(0, (0, 0, 0), (1, 2, 3)), (4, (0, 1.85, 0), (0.6, 6, 0.6)), (2, (1e-3, 1.5e-3, 1.002), WEDGE)],
    ),
    "dafms/spatial_rigid.DAT": (
        lambda text: text.replace("END ", DAFMS, 1),
        [(1, (0, 1.5, 0), (0.4, 3, 0.4)), (0, (0, 0, 0), (1, 2, 3))],
    ),
    "vsdf/slider_crank_flex.vsdf": (
        lambda text: text.replace("END", VSDF, 1),
        [(1, (0.075, 0, 0), (0.2, 0.04, 0.04)), (0, (1, 2, 3), 3 * (0.6,)), (3, FORWARD, WEDGE)],
    ),
}  # fmt: skip


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with an STL file in mm and the element files of VSDF decks."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/wedge.stl").write_bytes(binary())
    (tmp_path / "fe").symlink_to(DECKS / "vsdf/fe")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(folder, name):
    change, _ = CASES[name]
    path = folder / Path(name).name
    path.write_text(change((DECKS / name).read_text()))
    return path


def called(command, *words):
    return CliRunner().invoke(command, list(map(str, words)))


@pytest.mark.parametrize("name", CASES)
def test_the_result_holds_the_shapes_in_body_axes(folder, name):
    done = called(run, "-q", "--no-out", "--h5", "r.h5", *short(name), written(folder, name))
    assert done.exit_code == 0, done.output
    with h5py.File("r.h5") as file:
        body, position = file["shape/body"][:], file["shape/position"][:]
        corners = file["shape/vertices_of_triangle"][:] - 1
    assert corners.min() == 0 and corners.max() == len(position) - 1
    assert (body[corners] == body[corners[:, :1]]).all()
    for number, middle, size in CASES[name][1]:
        own = position[body == number]
        assert (own.max(axis=0) + own.min(axis=0)) / 2 == pytest.approx(middle, abs=1e-6)
        assert np.ptp(own, axis=0) == pytest.approx(size, abs=1e-6)


def short(name):
    """A few rows are enough."""
    key = {"dafms/spatial_rigid.DAT": "time.IT=2", "young/IN4-BAR.dat": "time.end=0.2"}.get(
        name, "time.end=0.01"
    )
    return ["--set", key]


@pytest.mark.parametrize("name", CASES)
def test_shapes_change_no_number(folder, name):
    tables = []
    for path in (written(folder, name), DECKS / name):
        if path.parent != folder:
            (folder / path.name).write_bytes(path.read_bytes())
        done = called(run, "-q", "--no-h5", "--out", "t.OUT", *short(name), path.name)
        assert done.exit_code == 0, done.output
        lines = (folder / "t.OUT").read_text().splitlines()
        tables.append([line for line in lines if re.match(r"\s*[-+0-9.]", line)][-8:])
    assert tables[0] == tables[1]


@pytest.mark.parametrize("name", CASES)
def test_every_number_of_a_shape_is_echoed(folder, name):
    reported = called(check, "--echo", written(folder, name)).output
    sizes = re.findall(r"shape\.[12]\.(?:a|SA) .*radius", reported)
    assert len(sizes) == 2
    if "dafms" not in name:
        assert re.search(r"shape_file\.1\.file +sub/wedge\.stl", reported)


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("GEOM 9 1 1 1 1", r"6: error: shape 1: body number 9 is outside 0\.\.4"),
        ("GEOM 1 6 1", r"8: error: shape 1: shape must be within 1\.\.5"),
        ("GEOM 1 2 1", r"1: error: shape 1: b of a cylinder must be above zero: length"),
        ("GEOM 1 5 1 2", r"12: error: shape 1: b of a sphere is not read: a sphere has 1 sizes"),
        ("GEOM 1 3 1 2 1.5", r"14: error: shape 1: c of a tube must be below the outer radius 1"),
        ("GEOM 1", r"1: error: shape 1: GEOM takes 3 to 11 numbers"),
        ("GEOM 1 5 1e40", r"10: error: shape 1: a of a sphere must be at most 1e\+12 m: radius; read 1e40"),
        ("GEOM 1 5 1 0 0 0 -1e40", r"18: error: shape 1: offset.y must be within 1e\+12 m of the body"),
        ("STL sub/wedge.stl 1 1e40", r"21: error: shape_file 1: the unit 1e40 m puts corners of sub/wedge"),
        ("STL none.stl 1 1", r"5: error: shape_file 1: none.stl: no such file"),
        ("STL sub/wedge.stl 1 0", r"21: error: shape_file 1: the unit must be above zero"),
        ("STL sub/wedge.stl", r"1: error: shape_file 1: STL takes 3 to 9 words \(file body unit"),
        ("MASS 1 1 0 0 0 1 1 1", r"1: error: MASS is not a shape; DYNAMICS in place of GEOMETRY opens"),
    ],
)  # fmt: skip
def test_wrong_cards_of_young_are_refused_at_their_place(folder, card, words):
    deck = (DECKS / "young/IN4-BAR.dat").read_text().rstrip().splitlines()
    Path("d.dat").write_text("\n".join([*deck, "GEOMETRY", card, "END"]))
    done = called(check, "d.dat")
    assert done.exit_code == 2
    assert re.search(f":{len(deck) + 2}:{words}", done.stderr)


def test_a_shape_that_nothing_opens_is_warned_of(folder):
    Path("d.dat").write_text((DECKS / "young/IN4-BAR.dat").read_text() + "\nGEOM 1 1 1 1 1\n")
    assert "GEOM is read as prose" in called(check, "d.dat").stderr


def test_shapes_stand_behind_dynamics_too(folder):
    deck = (DECKS / "young/dynamics/IN4-BAR-MASS.dat").read_text()
    head = deck[: deck.upper().rindex("END")] if re.search(r"(?m)^END", deck, re.I) else deck
    Path("d.dat").write_text(head + "\nSTL sub/wedge.stl 2 1\nGEOM 2 5 0.1\nEND\n")
    done = called(run, "-q", "--no-out", "--h5", "r.h5", "d.dat")
    assert done.exit_code == 0, done.stderr
    with h5py.File("r.h5") as file:
        assert set(file["shape/body"][:]) == {2} and "reaction/force" in file


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("vsdf/slider_crank_flex.vsdf", "    1 TUBE", "    2 TUBE", "body 2 is flexible: its nodes"),
        ("vsdf/slider_crank_flex.vsdf", "SPHE,0.3", "SPHE,", "a of a sphere must be above zero"),
        ("vsdf/slider_crank_flex.vsdf", "SPHE,0.3", "SPHE,1e300", "a of a sphere must be at most 1e+12 m"),
        ("vsdf/slider_crank_flex.vsdf", "3,0.001", "3,1e300", "the unit 1e300 m puts corners of"),
        ("vsdf/slider_crank_flex.vsdf", "SPHE,0.3", "EGG,0.3", "shape in field 2 must be one of BOX, CYLI"),
        ("vsdf/slider_crank_flex.vsdf", "wedge.stl", "fork.stl", "fork.stl: no such file in"),
        ("dafms/spatial_rigid.DAT", "    0    1       1.0", "    0    9       1.0", "IS must be within"),
        ("dafms/spatial_rigid.DAT", "    1    2       0.2", "    7    2       0.2", "number 7 is outside"),
        ("dafms/spatial_rigid.DAT", "       3.0\n", "\n", "SB of a cylinder must be above zero"),
    ],
)  # fmt: skip
def test_wrong_cards_are_refused(folder, name, old, new, words):
    path = written(folder, name)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    done = called(check, path)
    assert done.exit_code == 2
    assert words in done.stderr


@pytest.mark.parametrize("name", CASES)
def test_shapes_of_too_many_triangles_together_are_refused(name, folder, monkeypatch):
    """Three hundred lines that named one file of 200,000 triangles took gigabytes and minutes."""
    monkeypatch.setattr("flexmb_cli.dialects.body_shapes.MOST_OF_ALL_SHAPES", 20)
    done = CliRunner().invoke(check, [str(written(folder, name))])
    assert done.exit_code == 2
    assert "the shapes of a deck have at most 20 triangles together; draw fewer" in done.output
