"""Colours of elements reach to the largest value of all rows, also where one row alone has it."""

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.report import report
from flexmb_cli.results.figures import film
from flexmb_cli.results.figures.contours import BodyLook, contour_ranges
from flexmb_cli.results.figures.element_bodies import element_bodies
from flexmb_cli.results.figures.report_scene import report_scene
from flexmb_cli.results.figures.scene import read_scene
from tests.results.figures.elastic_brick import (
    ENERGY,
    LENGTH,
    POISSON,
    STRESS,
    YOUNG,
    select_elements,
    write_brick,
)
from tests.results.figures.test_report_page import browser, part, wait  # noqa: F401

ROWS, PEAK, AMPLITUDE = 601, 301, 0.25


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A thousandth of the peak in every other row."""
    amplitude = np.full(ROWS, AMPLITUDE / 1000)
    amplitude[PEAK] = -AMPLITUDE
    return write_brick(tmp_path_factory.mktemp("brick") / "r.h5", amplitude)


def test_the_page_has_the_largest_values_of_all_rows(path):
    with h5py.File(path) as file:
        data = report_scene(file)
    assert ROWS // 2 <= len(data["time"]) < ROWS
    most = {name: data["ranges"][name]["high"] for name in ("von Mises stress", "deformation")}
    assert most["von Mises stress"] == pytest.approx(AMPLITUDE * STRESS, rel=1e-12)
    assert most["deformation"] == pytest.approx(AMPLITUDE * LENGTH, rel=1e-12)


def test_ranges_of_a_bar_in_tension_and_compression(path):
    """sigma = 1 MPa times the amplitude along x and nothing else; eps = sigma / E, -nu sigma / E across.

    The largest amplitude is -0.25, the others 0.25 / 1000.  What is round-off is 0.
    """
    with h5py.File(path) as file:
        ranges = report_scene(file)["ranges"]
    found = {name: (ends["low"], ends["high"]) for name, ends in ranges.items()}
    low, high = -AMPLITUDE * STRESS, AMPLITUDE * STRESS / 1000
    across = -POISSON * low / YOUNG
    wanted = {
        "principal stress 1": (0, high), "principal stress 3": (low, 0), "stress xx": (low, high),
        "stress yy": (0, 0), "stress zx": (0, 0), "principal strain 1": (high / YOUNG, across),
        "strain xx": (low / YOUNG, high / YOUNG), "strain yy": (-POISSON * high / YOUNG, across),
        "strain xy": (0, 0),
    }  # fmt: skip
    for name, ends in wanted.items():
        scale = 1e-9 * max(1e-30, *map(abs, found["stress xx" if "stress" in name else "strain xx"]))
        assert found[name] == pytest.approx(ends, abs=scale), name
    assert found["principal stress 2"] == (0, 0) and ranges["strain xx"]["unit"] == ""


def test_numbers_that_are_not_finite_have_no_part_in_the_range(path, tmp_path):
    amplitude = np.full(ROWS, AMPLITUDE)
    amplitude[PEAK], amplitude[PEAK + 2] = np.nan, np.inf
    with h5py.File(write_brick(tmp_path / "r.h5", amplitude)) as file:
        ranges = report_scene(file)["ranges"]
    assert ranges["von Mises stress"]["high"] == pytest.approx(AMPLITUDE * STRESS, rel=1e-12)


def test_the_legend_of_a_film_has_the_largest_stress_of_all_rows(path):
    pytest.importorskip("matplotlib")
    with h5py.File(path) as file:
        scene = read_scene(file)
        bodies = list(element_bodies(file, scene.body_names, slice(None)))
    canvas = film._Canvas(scene, bodies, film.FilmLook(320, 200), contour_ranges(bodies))
    assert canvas.legend == "von Mises stress, 0 to 250 kPa"


@pytest.mark.processes
def test_the_legend_of_the_page_has_the_largest_values_of_all_rows(browser, path, tmp_path):  # noqa: F811
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert done.exit_code == 0, done.output
    browser.get((tmp_path / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    assert part(browser, "legend-text").text == "von Mises stress, 0 to 250 kPa"
    # What the pointer says of a node after its number: the stress of the first row.
    told = browser.execute_script("const v = window.flexmb.viewer; return v.valueAt(v.surfaces[0], 0)")
    assert told == ": 0.250 kPa"
    browser.execute_script("const v = window.flexmb.viewer; v.colouring = 'deformation'; v.show(0)")
    assert part(browser, "legend-text").text == "deformation, 0 to 0.500 m"


@pytest.mark.parametrize(
    "amplitude, row", [([0, 0.1, -0.3, 0.2], 2), ([0.01, 0.1, -0.3, 0.2], 0), ([0, 0, 0], 0)]
)
def test_a_page_without_stress_at_first_opens_at_the_largest(tmp_path, amplitude, row):
    """Von Mises stress of a bar in tension or compression is 1 MPa times the size of the amplitude."""
    with h5py.File(write_brick(tmp_path / "r.h5", np.array(amplitude, float))) as file:
        assert report_scene(file)["rest"] == row


@pytest.mark.processes
def test_the_page_opens_at_the_largest_stress_and_plays_from_the_first_frame(browser, tmp_path):  # noqa: F811
    """Row 2 of 0..3 is a time of 2 s of 3; a step back leads to 1 s."""
    path = write_brick(tmp_path / "r.h5", np.array([0, 0.1, -0.3, 0.2]))
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert done.exit_code == 0, done.output
    browser.get((tmp_path / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    assert part(browser, "time").text == "t = 2 s"
    played = "const v = window.flexmb.viewer; v.play(); v.pause(); return v.frame"
    assert browser.execute_script(played) == 0
    browser.execute_script("window.flexmb.viewer.show(2)")
    part(browser, "back").click()
    assert part(browser, "time").text == "t = 1 s"
    assert browser.execute_script(played) == 1


TENSOR = (3.0, -1.0, 2.0, 0.5, -2.5, 1.5)  # Pa, xx yy zz xy yz zx


@pytest.mark.processes
def test_the_page_derives_principal_stresses_and_strains_from_the_tensor(browser, path, tmp_path):  # noqa: F811
    """Against NumPy's eigenvalues of the 3 x 3 matrix and Hooke's law as a matrix."""
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert done.exit_code == 0, done.output
    browser.get((tmp_path / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    full = np.array(TENSOR)[[0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(3, 3)
    strain = (1 + POISSON) / YOUNG * full - POISSON / YOUNG * np.trace(full) * np.eye(3)
    wanted = {"stress": full, "strain": strain}
    ask = "const [name, law, tensor] = arguments; return measured(name, law)(...tensor)"
    for quantity, matrix in wanted.items():
        expected = [*np.linalg.eigvalsh(matrix)[::-1], *matrix[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]]
        names = [f"principal {quantity} {k}" for k in (1, 2, 3)]
        names += [f"{quantity} {c}" for c in ("xx", "yy", "zz", "xy", "yz", "zx")]
        found = [browser.execute_script(ask, name, [YOUNG, POISSON], TENSOR) for name in names]
        assert found == pytest.approx(expected, rel=1e-9), quantity
    offered = browser.execute_script(
        "return [...window.flexmb.viewer.part('colour').options].map(option => option.value)"
    )
    assert len(offered) == 1 + 3 + 6 + 3 + 6 + 1 + 1 and {*names} < {*offered}


@pytest.mark.processes
def test_the_page_colours_elements_by_their_energies_and_others_by_their_body(browser, tmp_path):  # noqa: F811
    """Three bricks in a row, of which the first two are selected; the second has the largest energy."""
    path = write_brick(tmp_path / "r.h5", np.array([0.0, 1.0, 0.5]), (3, 1, 1))
    select_elements(path, 1, 2)
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert done.exit_code == 0, done.output
    browser.get((tmp_path / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    browser.execute_script(
        "const v = window.flexmb.viewer; v.colouring = 'strain energy of the element'; v.show(1)"
    )
    assert part(browser, "legend-text").text == f"strain energy of the element, 0 to {1e6 * ENERGY:.0f} uJ"
    levels = "return [...window.flexmb.viewer.surfaces[0].flat].map(Math.floor)"
    # An end brick shows five faces, the middle one four, of two triangles each.
    assert sorted(browser.execute_script(levels)) == [85] * 10 + [255] * 8
    assert browser.execute_script("return window.flexmb.viewer.surfaces[0].unknown.length") == 3 * 10
    browser.execute_script("window.flexmb.viewer.show(2)")
    assert max(browser.execute_script(levels)) == 64


def test_a_film_is_coloured_by_what_is_asked_for(path, tmp_path):
    """Compression along x: principal stress 3 is at its lowest, stress yy is nowhere."""
    pytest.importorskip("matplotlib")
    with h5py.File(path) as file:
        scene = read_scene(file)
        bodies = list(element_bodies(file, scene.body_names, slice(None)))
    look = film.FilmLook(320, 200, bodies=BodyLook("principal stress 3"))
    canvas = film._Canvas(scene, bodies, look, contour_ranges(bodies))
    assert canvas.legend == "principal stress 3, -250 to 0 kPa"
    assert canvas.surfaces[0].values(PEAK) == pytest.approx(0, abs=1e-9)
    assert canvas.surfaces[0].values(PEAK + 1) == pytest.approx(1, abs=1e-9)
    done = CliRunner().invoke(report, [str(path), "--movie", str(tmp_path / "a.gif"), "--colours", "stress"])
    assert done.exit_code == 2 and "choose one of: von Mises stress, principal stress 1" in done.output


@pytest.mark.parametrize(
    "young, poisson", [(np.nan, 0.3), (0.0, 0.3), (np.inf, 0.3), (2e11, 0.6), (2e11, np.nan)]
)
def test_a_damaged_material_is_told(tmp_path, young, poisson):
    path = write_brick(tmp_path / "r.h5", np.zeros(3))
    with h5py.File(path, "r+") as file:
        file["elastic/body 2/young_modulus"][()] = young
        file["elastic/body 2/poisson_ratio"][()] = poisson
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert "/elastic/body 2 has a material of E =" in str(done.exception)
    assert not (tmp_path / "r.html").exists()


def test_results_without_a_material_have_stresses_and_no_strains(tmp_path):
    """Those of earlier versions."""
    path = write_brick(tmp_path / "r.h5", np.ones(3))
    with h5py.File(path, "r+") as file:
        del file["elastic/body 2/poisson_ratio"]
        data = report_scene(file)
    assert not [name for name in data["ranges"] if "strain" in name] and "stress xx" in data["ranges"]
    assert data["surfaces"][0]["material"] is None


def test_colours_that_a_result_has_not_are_refused(tmp_path):
    pytest.importorskip("imageio")
    path = write_brick(tmp_path / "r.h5", np.zeros(3))
    with h5py.File(path, "r+") as file:
        del file["elastic/body 2/young_modulus"]
    done = CliRunner().invoke(
        report, [str(path), "--movie", str(tmp_path / "a.gif"), "--colours", "strain xx"]
    )
    assert "it holds no strain xx; stresses and strains need a card MATL" in str(done.exception)
    assert not (tmp_path / "a.gif").exists()
