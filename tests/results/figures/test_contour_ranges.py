"""Colours of elements reach to the largest value of all rows, also where one row alone has it."""

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.report import report
from flexmb_cli.results.figures import film
from flexmb_cli.results.figures.element_bodies import element_bodies
from flexmb_cli.results.figures.report_scene import report_scene
from flexmb_cli.results.figures.scene import read_scene
from tests.results.figures.elastic_brick import LENGTH, STRESS, write_brick
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
    assert data["ranges"]["von Mises stress"] == pytest.approx(AMPLITUDE * STRESS, rel=1e-12)
    assert data["ranges"]["deformation"] == pytest.approx(AMPLITUDE * LENGTH, rel=1e-12)


def test_numbers_that_are_not_finite_have_no_part_in_the_range(path, tmp_path):
    amplitude = np.full(ROWS, AMPLITUDE)
    amplitude[PEAK], amplitude[PEAK + 2] = np.nan, np.inf
    with h5py.File(write_brick(tmp_path / "r.h5", amplitude)) as file:
        ranges = report_scene(file)["ranges"]
    assert ranges["von Mises stress"] == pytest.approx(AMPLITUDE * STRESS, rel=1e-12)


def test_the_legend_of_a_film_has_the_largest_stress_of_all_rows(path):
    pytest.importorskip("matplotlib")
    with h5py.File(path) as file:
        scene = read_scene(file)
        bodies = list(element_bodies(file, scene.body_names, slice(None)))
    canvas = film._Canvas(scene, bodies, film.FilmLook(320, 200))
    assert canvas.legend == "von Mises stress, 0 to 2.5e+05 Pa"


@pytest.mark.processes
def test_the_legend_of_the_page_has_the_largest_values_of_all_rows(browser, path, tmp_path):  # noqa: F811
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert done.exit_code == 0, done.output
    browser.get((tmp_path / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    assert part(browser, "legend-text").text == "von Mises stress, 0 to 2.50e+5 Pa"
    browser.execute_script("const v = window.flexmb.viewer; v.colouring = 'deformation'; v.show(0)")
    assert part(browser, "legend-text").text == "deformation, 0 to 0.500 m"
