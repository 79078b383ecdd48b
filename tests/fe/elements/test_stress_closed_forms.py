"""Stresses of supplied decks and of static loads against closed forms and published charts."""

import re

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.sparse.linalg import spsolve

from flexmb_cli.cli.run import run
from flexmb_cli.fe.elements.element_stiffness import BodyElements, assembled, element_stiffness
from flexmb_cli.fe.elements.solid_elements import FORMULATIONS, elasticity, solid_elements
from flexmb_cli.fe.elements.stress_shapes import nodal_stresses
from flexmb_cli.results.figures.element_bodies import outer_faces_of_elements
from scripts.brick_beam import Beam
from scripts.plate_with_hole import Strap
from tests.dialects.vsdf.vsdf_decks import DECKS

YOUNG = 2.1e11


def solved(places, elements, loads, held, poisson=0.3, formulation=0):
    """Nodal stresses (n, 6) of C3D20 meshes under nodal loads (n, 3) with freedoms held."""
    rows = np.array(elements) - 1
    made = solid_elements(places, rows, FORMULATIONS[20][formulation])
    D = elasticity(YOUNG, poisson)
    stiffness, internal = element_stiffness(made, D)
    K = assembled(stiffness, rows, len(places), 3)
    free = np.setdiff1d(np.arange(3 * len(places)), held)
    u = np.zeros(3 * len(places))
    K = K[free][:, free]
    u[free] = (
        np.linalg.solve(K, loads.ravel()[free])
        if isinstance(K, np.ndarray)
        else spsolve(K, loads.ravel()[free])
    )
    return nodal_stresses(BodyElements(made, D, internal, 0.0), u[:, None])[..., 0]


def pulled(places, elements, x, traction):
    """Loads of a uniform traction on the faces at x: -1/12 of a face's force at corners, 1/3 at middles."""
    loads = np.zeros(places.shape)
    for face in outer_faces_of_elements(np.array(elements) - 1)[0]:
        if np.allclose(places[face][:, 0], x):
            c = places[face[::2]]
            force = traction * np.linalg.norm(np.cross(c[1] - c[0], c[3] - c[0]))
            loads[face, 0] += force * np.where(np.arange(8) % 2, 1 / 3, -1 / 12)
    return loads


def test_a_cantilever_under_a_force_at_its_end_has_the_stress_of_beam_theory():
    """sigma = F (L - x) z/I at the middles of the elements' upper edges."""
    beam = Beam((0.5, 0.02, 0.04), (10, 1, 2), "C3D20R", YOUNG, 0.0)
    nodes, elements = beam.mesh()
    places = np.array(list(nodes.values()))
    tip = np.array(beam.section(0.5)) - 1
    loads = np.zeros(places.shape)
    loads[tip, 2] = 1000.0 / len(tip)
    root = np.array(beam.section(0.0)) - 1
    held = (3 * root[:, None] + np.arange(3)).ravel()
    stress = solved(places, elements, loads, held)
    inertia = 0.02 * 0.04**3 / 12
    for x in (0.125, 0.225, 0.325):
        upper = [n for n, p in enumerate(places) if abs(p[0] - x) < 1e-9 and abs(p[2] - 0.04) < 1e-9]
        assert upper
        assert stress[upper, 0] == pytest.approx(-1000.0 * (0.5 - x) * 0.02 / inertia, rel=2e-3)


def test_kirschs_hole_has_three_times_the_stress_at_its_sides_and_pressure_before_it():
    """Kirsch (1898): 3 S across the pull, -S along it; here d/W = 1/20, which adds 0.4 % to the first."""
    strap = Strap(0.04, 0.02, 0.001, 0.001, rings=8, sectors=3, ends=2, growth=60.0)
    nodes, elements = strap.mesh()
    places = np.array(list(nodes.values()))
    loads = pulled(places, elements, 0.04, 1.0) - pulled(places, elements, -0.04, 1.0)
    held = _six(places, (-0.04, 0, 0), (0.04, 0, 0), (0, 0.02, 0))
    # Thin, and free to contract: plane stress.
    stress = solved(places, elements, loads, held, formulation=1)
    side = [n for n, p in enumerate(places) if np.allclose(p, (0, 0.001, 0), atol=1e-8)]
    front = [n for n, p in enumerate(places) if np.allclose(p, (0.001, 0, 0), atol=1e-8)]
    assert stress[side, 0] == pytest.approx(3.012, rel=0.015)
    assert stress[front, 1] == pytest.approx(-1.0, abs=0.06)


def _six(places, *points):
    """Freedoms that hold a body: all of the first node, y z of the second, z of the third."""
    first, second, third = (int(np.argmin(np.linalg.norm(places - p, axis=1))) for p in points)
    return [3 * first, 3 * first + 1, 3 * first + 2, 3 * second + 1, 3 * second + 2, 3 * third + 2]


def ran(name, folder):
    """The result of a supplied deck."""
    done = CliRunner().invoke(run, [str(DECKS / f"{name}.vsdf"), "-q", "-o", str(folder)])
    assert done.exit_code == 0, done.output
    assert "warning" not in done.output
    return folder / f"{name}.h5"


@pytest.mark.long_motion
def test_the_blade_has_the_stress_of_a_turning_bar(tmp_path):
    """rho omega² (L² - x²)/2; the linear fit inside an element of length h adds rho omega² h²/12 at its ends.

    At x = h two elements meet, with fits of one error. Opposite edges are averaged, since the blade sways.
    """
    with h5py.File(ran("blade", tmp_path)) as result:
        stress = result["stress/body 1/node_tensor"][-1, :, 0]
    pull, fit = 7850.0 * 100.0**2, 0.25**2 / 12
    for pair, x in ((stress[:2], 0.0), (stress[2:], 0.25)):
        assert pair.mean() == pytest.approx(pull * ((1 - x**2) / 2 + fit), rel=1e-3)


@pytest.mark.long_motion
def test_the_stress_at_the_hole_of_the_strap_converges_with_the_mesh(tmp_path):
    """Peterson's Stress Concentration Factors (1974), chart for a hole in a strip, d/W = 0.2.

    Of the net section 2 + 0.284 c - 0.600 c² + 1.32 c³ with c = 1 - d/W; the reaction of the weight pulls,
    and the strap's own half, 0.7 % of it.
    """
    c, found = 0.8, []
    chart = (2 + 0.284 * c - 0.600 * c**2 + 1.32 * c**3) / c
    for name in ("coarse", "medium", "fine"):
        with h5py.File(ran(f"strap_{name}", tmp_path)) as result:
            force = np.linalg.norm(result["reaction/force"][-1, 1])
            found.append(result["stress/body 1/node_tensor"][-1, 0, 0] / (force / (0.04 * 0.004)))
    errors = 1 - np.array(found) / chart
    assert errors[2] < 0.02
    assert (errors[:-1] > 2 * errors[1:]).all()
    # The tutorial's numbers: its table; masses times radii, 7850 kg/m3 and 20 kg.
    beyond = 7850 * 0.04 * 0.004 * 0.15 * 0.225 / (20 * 0.3)
    assert (round(beyond, 3), round(found[2] / (1 + beyond), 2)) == (0.007, 3.08)
    page = (DECKS.parents[1] / "docs/tutorial/finite-element-body.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| (?:`strap_\w+`|Peterson's chart) \|.*\| (\S+) \|$", page, re.MULTILINE)
    assert table == [f"{value:.2f}" for value in (*found, chart)]


@pytest.mark.long_motion
def test_the_gallery_shows_the_stress_at_the_hole_of_the_strap(tmp_path, monkeypatch):
    """Colours up to 1.1e8 Pa: the hole's edge has 3.1 times the 3.4e7 Pa of the gross section.

    Contours of viridis beyond 0.85 are yellow; seven eighths of the strap around the hole have a third.  The
    weight is drawn by a shape that is narrower than the strap, 40 mm.
    """
    image = pytest.importorskip("matplotlib.image")
    monkeypatch.syspath_prepend(str(DECKS.parents[1] / "docs/_ext"))
    from deck_picture import draw

    path = ran("strap_fine", tmp_path)
    draw(path, tmp_path / "strap_fine.vsdf.png", tmp_path / "curves.png")
    picture = image.imread(tmp_path / "strap_fine.vsdf.png")[..., :3]
    picture = picture[60:]  # below the legend
    strap = np.argwhere(np.ptp(picture, axis=2) > 0.2)
    row, column = ((strap.min(axis=0) + strap.max(axis=0)) / 2).astype(int)
    around = picture[row - 30 : row + 30, column - 60 : column + 60]
    yellow = (around[..., 0] > 0.45) & (around[..., 1] > 0.75) & (around[..., 2] < 0.45)
    assert 3 <= yellow.sum() < 200
    with h5py.File(path) as result:
        weight = result["shape/position"][:]
    assert np.abs(weight[:, :2]).max() < 0.02


@pytest.mark.long_motion
def test_the_rod_of_the_slider_crank_bends_under_its_own_inertia(tmp_path):
    """Edges of its middle have opposite stresses but for the pull; element energies are the body's."""
    with h5py.File(ran("slider_crank_stress", tmp_path)) as result:
        stress = result["stress/body 2/node_tensor"][:, :, 0]
        elements = result["stress/body 2/element_tensor"][:, :, 0]
        energies, strain = result["strain/body 2/element_energy"][:].sum(axis=1), result["energy/strain"][:]
        largest = result["stress/body 2/max_von_mises"][:]
    assert np.abs(stress).max() > 1e6
    assert np.abs(stress[:, 0] + stress[:, 2]).max() < 0.2 * np.abs(stress).max()
    np.testing.assert_allclose(energies[1:], strain[1:], rtol=1e-5)
    assert (largest >= np.abs(elements).max(axis=1) * 0.9).all()
