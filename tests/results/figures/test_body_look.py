"""Colours, their range, and the scale of deformations: what the options choose, in films and on the page.

The body is three bricks in a row of 2 m, 0.1 m wide; its mode stretches them along x.
"""

import matplotlib
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.report import report
from flexmb_cli.results.figures.contours import largest_scale
from flexmb_cli.results.figures.film import CONTOURS_BEGIN, Texts, gif_durations
from tests.results.figures.elastic_brick import ENERGY, LENGTH, select_elements, write_brick
from tests.results.figures.test_report_page import browser, part, wait  # noqa: F401

AMPLITUDE = 0.01
ENERGIES = ("--colours", "strain energy of the element")
ORANGE = np.array([0xD5, 0x5E, 0x00]) / 255  # of body 2
PEAK = ENERGY * AMPLITUDE**2  # J, of element 2; a third of it in element 1, and none reported of element 3


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    found = write_brick(tmp_path_factory.mktemp("look") / "r.h5", np.array([AMPLITUDE, AMPLITUDE]), (3, 1, 1))
    select_elements(found, 1, 2)
    return found


def first_frame(path, tmp_path, *options):
    """The first frame (height, width, 3) of a film, from 0 to 1, that looks along y: x to the right."""
    pytest.importorskip("matplotlib")
    target = tmp_path / "a.gif"
    words = [str(path), "--movie", str(target), "-q", "--fps", "1", "--view", "y", "--size", "1600x400"]
    done = CliRunner().invoke(report, [*words, *options])
    assert done.exit_code == 0, done.output + str(done.exception)
    return pytest.importorskip("imageio.v3").imread(target)[0, ..., :3] / 255


def bar(frame):
    """Length and width of the bar in pixels, and its colours at 1/6, 1/2 and 5/6 of the length."""
    picture = frame[60:-60]
    rows, columns = np.nonzero(np.ptp(picture, axis=2) > 0.34)  # of traces 0.31, of joints 0
    middle, left, length = round(np.median(rows)), columns.min(), np.ptp(columns) + 1
    colours = [picture[middle - 3, round(left + part * length)] for part in (1 / 6, 1 / 2, 5 / 6)]
    return length, np.ptp(rows) + 1, [colour / colour.max() for colour in colours]


def contour(part):
    """Colour of viridis, its largest part 1, for a value at `part` of the range."""
    colour = np.array(matplotlib.colormaps["viridis"](CONTOURS_BEGIN + (1 - CONTOURS_BEGIN) * part)[:3])
    return colour / colour.max()


@pytest.mark.parametrize("options, parts", [((), (1 / 3, 1)), (("--range", f"0,{2 * PEAK}"), (1 / 6, 1 / 2))])
def test_a_film_shows_the_energies_of_elements(path, tmp_path, options, parts):
    """Element 1 has a third of the energy of element 2; of element 3 none is known: its body's orange."""
    _, _, colours = bar(first_frame(path, tmp_path, *ENERGIES, *options))
    for found, wanted in zip(colours, (*map(contour, parts), ORANGE / ORANGE.max()), strict=True):
        np.testing.assert_allclose(found, wanted, atol=0.06)


@pytest.mark.parametrize("scale, stretched", [(1, 0.02), (50, 1.0)])
def test_a_film_magnifies_deformations(path, tmp_path, scale, stretched):
    """The bar is 2 m long and 0.1 m wide, and its far end moves by 0.02 m: at 50 times this by 1 m."""
    length, width, _ = bar(first_frame(path, tmp_path, "--colours", "body", "--scale", str(scale)))
    assert length / width == pytest.approx((LENGTH + stretched) / 0.1, rel=0.08)


@pytest.mark.parametrize(
    "options, reported",
    [
        (["--scale", "1e300"], "scale from 0 to 310, where the largest is as large as the mechanism"),
        (["--scale", "-500"], "cannot be shown -500 times as large"),
        (["--range", "5,5"], "the first number must be smaller than the second"),
        (["--range", "5"], "expected two numbers, such as 0,1e8"),
        (["--range", "0,1", "--colours", "body"], "bodies that have a colour each show no values"),
    ],
)
@pytest.mark.parametrize("film", [True, False])
def test_what_cannot_be_shown_is_refused(path, tmp_path, options, reported, film):
    """0.02 m of deformation, and a mechanism that turns through a box of 6.2 m."""
    target = tmp_path / "a"
    words = ["--movie", f"{target}.gif"] if film else ["-o", f"{target}.html"]
    done = CliRunner().invoke(report, [str(path), *words, *options])
    assert done.exit_code and reported in done.output + str(done.exception)
    assert not list(tmp_path.iterdir())


def test_the_largest_scale_of_what_does_not_deform_is_a_number():
    assert largest_scale({}, 1.0) == largest_scale({"deformation": (0.0, 0.0)}, 1.0) == 1e12
    assert largest_scale({"deformation": (0.0, 5.0)}, 1.0) == 1


@pytest.mark.parametrize("rate", [7, 25, 30, 45])
def test_gif_files_last_as_long_as_the_motion(rate):
    """GIF 89a counts hundredths of a second: each end of a frame is the nearest one to k / rate."""
    durations = gif_durations(3 * rate, rate)
    assert sum(durations) == 3000 and all(duration % 10 == 0 for duration in durations)
    assert np.abs(np.cumsum(durations) - 1000 * np.arange(1, 3 * rate + 1) / rate).max() <= 5


def test_a_gif_at_30_frames_a_second_lasts_3_s(tmp_path):
    """91 frames of 1/30 s of a motion of 3 s; --fps 60 gives what browsers show, 50, and says so."""
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("imageio")
    moving = write_brick(tmp_path / "r.h5", np.linspace(0, 0.5, 200))
    for rate, seconds in ((30, 91 / 30), (60, 151 / 50)):
        words = [str(moving), "--movie", str(tmp_path / "a.gif"), "--fps", str(rate), "--size", "64x64"]
        done = CliRunner().invoke(report, words)
        assert done.exit_code == 0, done.output
        assert ("50 frames a second, the most that browsers show" in done.output) == (rate == 60)
        with image.open(tmp_path / "a.gif") as film:
            total = 0
            for k in range(film.n_frames):
                film.seek(k)
                total += film.info["duration"]
        assert total == pytest.approx(1000 * seconds, abs=5)


@pytest.mark.parametrize("size", [(64, 64), (96, 320), (640, 64), (1920, 1080)])
def test_texts_of_films_are_not_cut_and_grow_with_the_picture(size):
    """No ink reaches the right edge; letters of 12 pixels at 540 rows are 24 at 1080, and never below 7."""
    width, height = size
    texts = Texts(width, height, "strain energy of the element, 0 to 0.000211 J", np.zeros((256, 3)))
    picture = texts.written(np.full((height, width, 3), 255, np.uint8), "t = 0.165 s")
    dark = picture.min(axis=(0, 2)) < 200
    assert dark.any() and not dark[-2:].any()
    assert " ".join(texts.legend) == "strain energy of the element, 0 to 0.000211 J"
    assert texts.letters == pytest.approx(max(7, height / 45))


@pytest.fixture
def shown(browser, path, tmp_path):  # noqa: F811
    """The page, opened with the energies of elements, a range and a scale."""
    options = [*ENERGIES, "--range", f"0,{2 * PEAK}", "--scale", "50"]
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html"), *options])
    assert done.exit_code == 0, done.output
    browser.get((tmp_path / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    return browser


def typed(page, name, text):
    """Replace the number in a field, and leave it."""
    keys, field = pytest.importorskip("selenium.webdriver").Keys, part(page, name)
    field.send_keys(keys.CONTROL, "a")
    field.send_keys(keys.BACKSPACE, text, keys.TAB)
    return field.get_property("value"), part(page, "warning").text


@pytest.mark.processes
def test_the_page_opens_as_the_options_want_it_and_its_fields_are_checked(shown):
    legend = "strain energy of the element, 0 to 6.00e-8 J (of 0 to 3.00e-8); deformation × 50"
    assert part(shown, "legend-text").text == legend
    assert part(shown, "colour").get_property("value") == ENERGIES[1]
    assert typed(shown, "scale", "100") == ("100", "")
    for wrong in ("1e300", "-500", "1e"):
        value, told = typed(shown, "scale", wrong)
        assert (
            value == "100" and told == "The scale of the deformation is a number from 0 to 310; it stays 100."
        )
    assert typed(shown, "scale", "1") == ("1", "")
    assert "smaller than the second" in typed(shown, "low", "1")[1]
    assert typed(shown, "low", "1e-8") == ("1e-8", "")
    typed(shown, "low", "")
    typed(shown, "high", "")
    assert part(shown, "legend-text").text == "strain energy of the element, 0 to 3.00e-8 J"


@pytest.mark.processes
def test_fields_of_the_range_have_room_for_their_numbers_and_do_not_round_it(shown):
    """A field showed 10200000( of 1.02e8; a change of one end leaves the other as it was given."""
    choose = "const v = window.flexmb.viewer; v.chosen[v.colouring] = [-0.5, 102003456.5]; v.offerRange()"
    shown.execute_script(choose)
    assert part(shown, "high").get_property("value") == "1.02e8"
    assert typed(shown, "low", "0.25") == ("0.25", "")
    ends = "return [window.flexmb.viewer.wanted().low, window.flexmb.viewer.wanted().high]"
    assert shown.execute_script(ends) == [0.25, 102003456.5]


@pytest.mark.processes
def test_the_pointer_names_the_element_and_its_energy(shown):
    """At the middle of a face that the viewer sees: element 1, whose energy is a third of the largest."""
    ask = """
      const v = window.flexmb.viewer, one = v.surfaces[0], middles = [];
      v.look("y");
      one.columns.forEach((column, t) => {
        const corners = [0, 1, 2].map(k => 3 * one.known[3 * t + k]);
        const [x, y] = [0, 1].map(i => corners.reduce((sum, at) => sum + one.screen[at + i], 0) / 3);
        if (one.elements[column] === arguments[0]) middles.push([x, y]);
      });
      return middles.map(([x, y]) => v.nodeAt(0, x, y));
    """
    for number, energy in ((1, PEAK / 3), (2, PEAK)):
        told = shown.execute_script(ask, number)
        assert f" element {number}: {energy:.2e} J".replace("e-0", "e-") in told
