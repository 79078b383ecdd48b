"""Films of results: frames, sizes and what they show; the extra is asked for before any work."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.report import report
from flexmb_cli.results.figures import film
from flexmb_cli.results.figures.film import CONTOURS_BEGIN, film_rows
from tests.results import conftest
from tests.results.figures.turning_bar import SPEED, write_bar

LAST = 3.0  # s: 3 s of film, in own time
VIEWER = Path(film.__file__).parent / "viewer"
ORANGE = np.array([0xD5, 0x5E, 0x00])  # of body 2


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    deck, mechanism = conftest.deck.__wrapped__(), conftest.mechanism.__wrapped__()
    times = np.linspace(0, LAST, 7)
    mechanism = replace(mechanism, time=replace(mechanism.time, end=LAST, step=0.5))
    return write_bar(tmp_path_factory.mktemp("film") / "r.h5", deck, mechanism, conftest.turning_rows, times)


def filmed(path, target, *options):
    done = CliRunner().invoke(report, [str(path), "--movie", str(target), "-q", *options])
    assert done.exit_code == 0, done.output
    return pytest.importorskip("imageio.v3").imread(target)[..., :3]


def bar_angle(frame):
    """Angle of the bar's pixels, rad, anticlockwise from the right."""
    seen = np.argwhere(np.abs(frame.astype(int) - ORANGE).sum(axis=2) < 60).astype(float)
    assert len(seen) > 100
    centred = seen - seen.mean(axis=0)
    row, column = np.linalg.svd(centred, full_matrices=False)[2][0]
    return np.arctan2(-row, column)


@pytest.mark.parametrize("form", ["gif", "mp4"])
def test_a_film_has_its_frames_and_shows_the_turning_bar(path, tmp_path, form):
    """3 s at 2 frames/s: a frame for each of the seven rows, in which the bar is at 1.047 rad/s times t.

    The viewer looks along y: x to the right, z upwards, and the bar's tip at (cos, 0, -sin) goes clockwise.
    """
    frames = filmed(path, tmp_path / f"a.{form}", "--fps", "2", "--size", "320x200", "--view", "y")
    assert frames.shape == (7, 200, 320, 3)
    assert (frames[0] != frames[-1]).any()
    for frame, time in ((0, 0.0), (2, 1.0), (6, 3.0)):
        missed = bar_angle(frames[frame]) + SPEED * time
        assert abs((missed + np.pi / 2) % np.pi - np.pi / 2) < 0.02


def test_the_axes_of_the_ground_stand_in_the_corner_as_the_view_has_them(path, tmp_path):
    """Seen along y, x goes to the right of the origin and z upwards; as grey as the ground is."""
    frame = filmed(path, tmp_path / "a.gif", "--fps", "1", "--size", "640x400", "--view", "y")[0].astype(int)
    letters = 400 * film.LETTERS
    x, y = (round(size - film.CORNER * letters) for size in (640, 400))
    part = round(0.6 * film.AXIS * letters)
    grey = [abs(frame[row, column] - 0x80).max() < 60 for row, column in ((y, x + part), (y - part, x))]
    white = [frame[row, column].min() > 240 for row, column in ((y, x - part), (y + part, x))]
    assert all(grey) and all(white)


def test_another_view_is_another_picture(path, tmp_path):
    start, aside = (filmed(path, tmp_path / "a.gif", "--fps", "1", "--view", view) for view in ("start", "x"))
    assert start.shape == aside.shape and (start != aside).any()


def test_frames_show_the_row_that_has_been_reached():
    time = np.array([0.0, 1.0, 2.0, 6.0])
    assert film_rows(time, 1) == [0, 1, 2, 2, 2, 2, 3]
    assert film_rows(np.array([5.0]), 1) == [0, 0, 0, 0]
    rows = film_rows(np.linspace(0, 1000, 11), 25)
    assert len(rows) == 15 * 25 + 1 and rows[0] == 0 and rows[-1] == 10


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--movie", "a.avi"], "a.avi: films are written as .mp4 or .gif files"),
        (["--movie", "-"], "a film cannot go to standard output; --movie names a file"),
        (["--movie", "a.gif", "--size", "10x10"], "two numbers from 64 to 4096"),
        (["--movie", "a.gif", "-o", "a.html"], "leave out -o"),
        (["--view", "x", "--fps", "5"], "--fps, --view: for films; give --movie, too"),
    ],
)
def test_what_is_no_film_is_refused(path, tmp_path, monkeypatch, words, told):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(report, [str(path), *words])
    assert done.exit_code == 2 and told in done.output
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("form", "module", "library"),
    [("mp4", "imageio_ffmpeg", "imageio-ffmpeg"), ("gif", "imageio", "imageio")],
)
def test_a_missing_extra_is_told_before_any_work(tmp_path, monkeypatch, form, module, library):
    """The result does not even exist."""
    monkeypatch.setitem(sys.modules, module, None)
    done = CliRunner().invoke(report, [str(tmp_path / "none.h5"), "--movie", str(tmp_path / f"a.{form}")])
    assert library in str(done.exception) and "install it with" in str(done.exception)
    assert "movie" in str(done.exception) or "imageio" in str(done.exception)


def test_contours_of_film_page_and_legend_begin_at_one_colour_that_is_seen_on_a_dark_page():
    """Matplotlib's viridis; its darkest fifth, of the page's own darkness, is left out."""
    page, raster = ((VIEWER / name).read_text() for name in ("page.html", "raster.js"))
    assert float(re.search(r"CONTOURS_BEGIN = ([\d.]+);", raster)[1]) == CONTOURS_BEGIN == 0.2
    stops = re.findall("#[0-9a-f]{6}", re.search(r"linear-gradient\((.*?)\)", page)[1])
    shades = [[int(stop[k : k + 2], 16) / 255 for k in (1, 3, 5)] for stop in stops]
    wanted = matplotlib.colormaps["viridis"](np.linspace(CONTOURS_BEGIN, 1, len(stops)))[:, :3]
    np.testing.assert_allclose(shades, wanted, atol=0.02)
