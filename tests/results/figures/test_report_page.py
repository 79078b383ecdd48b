"""The report page: self-contained, inert whatever the file says, and alive in Chromium."""

import html
import io
import json
import re
import shutil
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli.check import check
from flexmb_cli.cli.report import report
from flexmb_cli.results.figures import report_animation, report_camera
from flexmb_cli.results.figures.report_animation import MOST_FRAMES, animation, frame_rows
from flexmb_cli.results.figures.report_page import report_page
from flexmb_cli.results.figures.scene import read_scene
from flexmb_cli.results.figures.view import view_of
from flexmb_cli.results.quantities.quantities import ResultError, open_result
from tests.results import conftest
from tests.results.figures.turning_bar import tip, write_bar

DECKS = Path(__file__).resolve().parents[3] / "decks"
TIMES = np.arange(7.0)
HOSTILE = '</script><img src=x onerror="window.hacked=1"><script>window.hacked=1</script>\'"&\u2028'
DRIVER = shutil.which("chromedriver")
BROWSER = shutil.which("chromium") or shutil.which("google-chrome")


def unwrapped(fixture):
    return fixture.__wrapped__()


def write_result(path, times=TIMES, **marks):
    """The turning bar, from the fixtures of `conftest` without pytest's scopes."""
    deck, mechanism = unwrapped(conftest.deck), unwrapped(conftest.mechanism)
    grid = replace(mechanism.time, end=float(len(times) - 1))
    return write_bar(path, deck, replace(mechanism, time=grid), conftest.turning_rows, times, **marks)


def spoil(path):
    """Hostile text wherever a deck's or a file's words come to the page."""
    with h5py.File(path, "r+") as file:
        for name in (
            "deck_name",
            "dialect",
            "analysis",
            "message",
            "deck_sha256",
            "flexmb_version",
            "settings",
        ):
            file.attrs[name] = HOSTILE
        for kind in ("body", "point", "joint", "driver"):
            file[f"{kind}/name"][:] = [HOSTILE] * len(file[f"{kind}/name"])
        for name in ("audit/constraint_residual", "point/position", "body/position"):
            file[name].attrs["units"] = file[name].attrs["long_name"] = HOSTILE
        file["deck"][()] = HOSTILE
    return path


def page_on(path, library="window.Plotly = 1;"):
    with open_result(path) as result:
        return report_page(result, library)


def test_the_page_asks_the_network_for_nothing(tmp_path):
    page = page_on(write_result(tmp_path / "r.h5"))
    assert not re.search(r"(?:src|href)\s*=|@import|url\(", page)
    assert "default-src 'none'" in page


def test_words_of_the_file_are_text_and_nothing_else(tmp_path):
    page = page_on(spoil(write_result(tmp_path / "r.h5")))
    assert page.count("</script>") == 3
    assert "<img" not in page
    # Deck, its name in title, heading and table, names; with a mark for what cannot be printed.
    assert page.count(html.escape(HOSTILE.replace("\u2028", "\ufffd"))) >= 5


def test_nothing_in_the_page_turns_the_direction_of_writing_around(tmp_path):
    """Trojan Source (Boucher and Anderson, 2021): a deck is read otherwise than it is shown."""
    path = write_result(tmp_path / "r.h5")
    turning = "".join(map(chr, (0x202A, 0x202B, 0x202C, 0x202D, 0x202E, 0x2066, 0x2067, 0x2068, 0x2069)))
    marks = "\u200e\u200f\u061c"
    with h5py.File(path, "r+") as file:
        file["deck"][()] = f"1 1 0 {turning}{marks} 0\r\n\x1b[2J second line"
        file["audit"].move("constraint_residual", f"a{turning}")
        del file[f"audit/a{turning}"].attrs["long_name"]
        file.attrs["settings"] = f"a={turning}"
        file.attrs["deck_name"] = f"{turning}.dat"
    page = page_on(path)
    # The library that draws has its own, in strings of its program.
    own = page.partition('<script id="figures"')[0]
    assert not set(own) & set(turning + marks + "\x1b\r")
    assert "�[2J second line" in own


def test_a_failed_run_says_so_and_why(tmp_path):
    page = page_on(write_result(tmp_path / "r.h5", status="failed", message="it locks at t = 6.5 s"))
    assert '<p class="failed">' in page
    assert "it locks at t = 6.5 s" in page.split("<h2>")[0]


def test_a_run_without_rows_still_has_its_page(tmp_path):
    page = page_on(write_result(tmp_path / "r.h5", times=[], status="failed", message="no assembly"))
    assert "There are no rows to draw." in page
    assert "2 1 1 1 0 0 0 0 0 2 0 1" in page


def test_the_deck_is_echoed_number_by_number_in_a_fold(tmp_path):
    """IN2-1-1's first cards, with lines, names, units and meanings as `check --echo` prints them."""
    deck = (DECKS / "young/IN2-1-1.dat").read_text()
    path = write_result(tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        file["deck"][()], file.attrs["dialect"] = deck, "young"
    fold = re.search(r'<details id="echo">(.*?)</details>', page_on(path), re.DOTALL)[1]
    printed = CliRunner().invoke(check, [str(DECKS / "young/IN2-1-1.dat"), "--echo"]).output
    lines = html.unescape(re.search(r"<pre>(.*?)</pre>", fold, re.DOTALL)[1]).splitlines()
    assert len(lines) > 50 and lines[1:] == printed.splitlines()[1 : len(lines)]
    assert "As the deck's text has them." in fold


def test_a_deck_that_cannot_be_read_any_more_still_has_its_page(tmp_path):
    page = page_on(spoil(write_result(tmp_path / "r.h5")))
    assert "<p>This deck cannot be read: there is no dialect" in page


def test_the_same_result_gives_the_same_page(tmp_path):
    path = write_result(tmp_path / "r.h5")
    assert page_on(path) == page_on(path)


def test_a_file_without_deck_is_refused(tmp_path):
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["time"] = [0.0]
    with pytest.raises(ResultError, match="it has no deck"):
        page_on(tmp_path / "r.h5")


@pytest.mark.parametrize("rows", [1, 2, MOST_FRAMES, MOST_FRAMES + 1, 100_000])
def test_long_runs_are_thinned_evenly(rows):
    kept = range(*frame_rows(rows).indices(rows))
    assert kept[0] == 0
    assert min(rows, MOST_FRAMES // 2) <= len(kept) <= MOST_FRAMES


@pytest.mark.parametrize("rows", [301, 1001, 100_000])
def test_the_last_row_is_a_frame_where_an_even_stride_leads_to_it(rows):
    """300 = 3 · 100, 1000 = 8 · 125, 99999 = 813 · 123."""
    assert range(*frame_rows(rows).indices(rows))[-1] == rows - 1


def test_large_models_have_fewer_frames():
    assert 25 <= len(range(*frame_rows(1000, 4000).indices(1000))) <= 50


@pytest.mark.parametrize(
    ("times", "told"),
    [
        (1.19e-7 + 0.00357174 * np.arange(4), ["0", "0.00357", "0.00714", "0.01072"]),
        (0.1 * np.arange(4), ["0", "0.1", "0.2", "0.3"]),
        ([1000.0, 1000.0005, 1000.001], ["1000", "1000.0005", "1000.001"]),
        ([-1e-9, 2.0, 4.0], ["0", "2", "4"]),
        ([0.123456789012], ["0.123456789"]),
    ],
)
def test_times_at_the_slider_have_the_digits_that_tell_frames_apart(times, told):
    assert report_animation._rounded(np.array(times)) == told


def seen(corners, camera):
    """Height in the picture, -1 to 1, of places seen by plotly.js, which looks at the origin at 45 degrees.

    By the matrices of OpenGL: gluLookAt, gluPerspective.
    """
    eye, up = (np.array([camera[name][axis] for axis in "xyz"]) for name in ("eye", "up"))
    forward = -eye / np.linalg.norm(eye)
    side = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    look = np.eye(4)
    look[:3, :3] = side, np.cross(side, forward), -forward
    look[:3, 3] = -look[:3, :3] @ eye
    cotangent = 1.0 / np.tan(np.radians(45.0) / 2)
    _, y, z, _ = look @ np.vstack([corners.T, np.ones(len(corners))])
    return cotangent * y / -z


@pytest.mark.parametrize("sides", [(1.0, 1.0, 1.0), (1.0, 0.05, 0.7), (0.3, 1.0, 0.6), (0.1, 0.1, 1.0)])
@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.8), (0.0, 9.8, 0.0), (0.0, 0.0, 0.0)])
def test_the_corners_of_the_box_leave_room_for_the_names_of_its_axes(sides, gravity):
    """Names are a tenth of the picture's height off the box; the lowest corner was below the picture."""
    signs = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    scene = report_camera.looked_at(signs * sides, np.array(gravity))
    box = np.array([scene["aspectratio"][axis] for axis in "xyz"])
    assert 0.5 < np.max(np.abs(seen((signs - 0.5) * box, scene["camera"]))) < 0.8 + 1e-8


def test_energies_that_stay_at_zero_are_not_drawn_but_named(tmp_path):
    path = write_result(tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        for name, values in (("kinetic", TIMES), ("strain", 0 * TIMES), ("total", TIMES)):
            file[f"energy/{name}"] = values
            file[f"energy/{name}"].attrs["units"] = "J"
            file[f"energy/{name}"].dims[0].attach_scale(file["time"])
    shown = page_on(path)
    assert "<p>Not drawn, for they do not change: energy.strain.</p>" in shown
    figures = re.search(r'<script id="figures" type="application/json">(.*?)</script>', shown)[1]
    drawn = {curve["name"] for panel in json.loads(figures)["curves"] for curve in panel["data"]}
    assert {"energy.kinetic", "energy.total"} <= drawn
    assert "energy.strain" not in drawn


def test_frames_are_the_motion(tmp_path):
    """The bar's ends in every frame, by the closed form of `turning_bar`, to five digits of the picture."""
    with open_result(write_result(tmp_path / "r.h5")) as file:
        figure = animation(read_scene(file))
    bar = next(k for k, trace in enumerate(figure["data"]) if trace["name"] == "body 2")
    for frame, end in zip(figure["frames"], tip(TIMES), strict=True):
        drawn = np.array([frame["data"][bar][axis] for axis in "xyz"]).T
        assert np.min(np.linalg.norm(drawn - end, axis=1)) < 2e-5
        assert np.min(np.linalg.norm(drawn, axis=1)) < 2e-5


def test_a_missing_library_is_named_with_its_remedy(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "plotly.offline", None)
    done = CliRunner().invoke(report, [str(write_result(tmp_path / "r.h5"))])
    assert done.exception.exit_code == 2
    assert "flexmb report needs plotly, which" in str(done.exception)


@pytest.fixture(scope="module")
def browser():
    """Headless Chromium, driven by Selenium."""
    selenium = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
    if not (DRIVER and BROWSER):
        pytest.skip("Debian's chromium and chromium-driver are not installed")
    options = selenium.ChromeOptions()
    options.binary_location = BROWSER
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,1300"):
        options.add_argument(argument)
    # There is no graphics card in CI: WebGL by software.
    options.add_argument("--use-angle=swiftshader")
    options.add_argument("--enable-unsafe-swiftshader")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = selenium.Chrome(options=options, service=selenium.ChromeService(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def page(browser, tmp_path_factory):
    """The page on a result with hostile words, written by the command and shown."""
    pytest.importorskip("plotly", reason="plotly is not installed")
    folder = tmp_path_factory.mktemp("report")
    path = spoil(write_result(folder / "r.h5"))
    done = CliRunner().invoke(report, [str(path), "-o", str(folder / "r.html")])
    assert done.exit_code == 0, done.output
    browser.get((folder / "r.html").as_uri())
    wait(lambda: browser.execute_script("return window.flexmb && window.flexmb.ready"))
    return browser


def wait(condition, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "the page does not come this far"
        time.sleep(0.1)


def bar_tip(page):
    """Where the page draws the free end of the bar now: the end that is not at the origin."""
    ends = page.execute_script(
        "const t = document.getElementById('animation').data[0]; return [Array.from(t.x), "
        "Array.from(t.y), Array.from(t.z)]"
    )
    return max(np.array(ends, float).T, key=np.linalg.norm)


def canvas(page):
    return next(
        part for part in page.find_elements("css selector", "#animation canvas") if part.size["height"] > 100
    )


def pixels(page):
    """The 3-D canvas as numbers (height, width, 3)."""
    image = pytest.importorskip("PIL.Image")
    shot = canvas(page).screenshot_as_png
    return np.asarray(image.open(io.BytesIO(shot)).convert("RGB")).astype(int)


def rest(page):
    """Pause, and go to the first frame."""
    click(page, "pause")
    page.execute_async_script(
        "Plotly.animate('animation', ['0'], {mode: 'immediate', frame: {duration: 0, redraw: true},"
        " transition: {duration: 0}}).then(arguments[0])"
    )


def click(page, label):
    for button in page.find_elements("css selector", "#animation .updatemenu-button"):
        if label in button.text:
            button.click()


@pytest.mark.processes
def test_no_error_reaches_the_console_and_hostile_words_do_nothing(page):
    faults = [entry for entry in page.get_log("browser") if entry["level"] == "SEVERE"]
    assert faults == []
    assert page.execute_script("return window.hacked") is None
    assert page.find_elements("css selector", "img[src='x']") == []
    assert HOSTILE.replace("\u2028", "\ufffd") in page.find_element("css selector", "pre").get_property(
        "textContent"
    )
    assert page.execute_script("return performance.getEntriesByType('resource').length") == 0


@pytest.mark.processes
def test_the_picture_is_not_blank(page):
    """The bar's colour, and the grey of the axes, cover a part of the canvas."""
    rest(page)
    picture = pixels(page)
    blue = np.array([int("0072B2"[k : k + 2], 16) for k in (0, 2, 4)])
    orange = np.array([int("D55E00"[k : k + 2], 16) for k in (0, 2, 4)])
    near = [np.sum(np.max(np.abs(picture - colour), axis=-1) < 40) for colour in (blue, orange)]
    assert max(near) > 100
    assert np.sum(np.min(picture, axis=-1) < 250) > 1000


@pytest.mark.processes
def test_the_slider_moves_the_mechanism(page):
    """A click on the middle of the rail shows row 3 of 0..6."""
    actions = pytest.importorskip("selenium.webdriver").ActionChains
    rest(page)
    assert np.max(np.abs(bar_tip(page) - tip(TIMES)[0])) < 2e-5
    before = pixels(page)
    actions(page).move_to_element(
        page.find_element("css selector", "#animation .slider-rail-touch-rect")
    ).click().perform()
    wait(lambda: np.max(np.abs(bar_tip(page) - tip(TIMES)[3])) < 2e-5)
    wait(lambda: np.sum(np.any(np.abs(pixels(page) - before) > 40, axis=-1)) > 200)
    assert "t = 3 s" in page.find_element("css selector", "#animation .slider-label").text


@pytest.mark.processes
def test_the_times_below_the_slider_are_not_cut_off(page):
    """Of every label the lower edge is within the picture."""
    edges = page.execute_script(
        "const box = document.getElementById('animation').getBoundingClientRect();"
        "return Array.from(document.querySelectorAll('#animation .slider-labels text')).map("
        "text => box.bottom - text.getBoundingClientRect().bottom)"
    )
    assert len(edges) >= 7
    assert min(edges) >= 0


@pytest.mark.processes
@pytest.mark.parametrize("width", [500, 1200])
def test_buttons_slider_and_time_do_not_lie_on_each_other(page, width):
    page.set_window_size(width, 1300)
    wait(lambda: abs(page.execute_script("return window.innerWidth") - width) < 30)
    time.sleep(0.5)  # plotly.js draws anew once the size has settled
    boxes = page.execute_script(
        "const parts = ['.updatemenu-item-rect', '.slider-label:not(.slider-labels *)', '.slider-rail-rect'];"
        "return Array.from(document.querySelectorAll(parts.map(part => '#animation ' + part)))"
        ".map(part => part.getBoundingClientRect()).map(box => [box.left, box.right, box.top, box.bottom])"
    )
    page.set_window_size(1200, 1300)
    assert len(boxes) == 4
    for k, (left, right, top, bottom) in enumerate(boxes):
        for other in boxes[:k]:
            apart = left >= other[1] or right <= other[0] or top >= other[3] or bottom <= other[2]
            assert apart, (k, boxes)


@pytest.mark.processes
def test_play_runs_through_all_rows_and_pause_holds(page):
    rest(page)
    click(page, "play")
    wait(lambda: np.max(np.abs(bar_tip(page) - tip(TIMES)[6])) < 2e-5)
    rest(page)
    assert np.max(np.abs(bar_tip(page) - tip(TIMES)[0])) < 2e-5


@pytest.mark.processes
def test_dragging_turns_the_view(page):
    actions = pytest.importorskip("selenium.webdriver").ActionChains
    rest(page)
    before = pixels(page)
    actions(page).drag_and_drop_by_offset(canvas(page), 150, 60).perform()
    wait(lambda: np.sum(np.any(np.abs(pixels(page) - before) > 40, axis=-1)) > 200)


def test_hundreds_of_bodies_share_a_trace_a_colour(tmp_path):
    """Each of 200 copies of the bar is drawn, by eight traces."""
    with open_result(write_result(tmp_path / "r.h5")) as file:
        scene = read_scene(file)
    bar = scene.bodies[1]
    traces = animation(replace(scene, bodies=(bar,) * 200))["data"]
    crowd = [trace for trace in traces if trace["name"].startswith("bodies")]
    assert len(crowd) == 8
    assert sum(trace["x"].count(None) for trace in crowd) == 200


def test_a_damaged_result_is_told_and_leaves_no_page(tmp_path):
    path = write_result(tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        del file["body/euler_parameters"]
    pytest.importorskip("plotly", reason="plotly is not installed")
    done = CliRunner().invoke(report, [str(path), "-o", str(tmp_path / "r.html")])
    assert (type(done.exception), done.exception.exit_code) == (ResultError, 2)
    assert "damaged result" in str(done.exception)
    assert not (tmp_path / "r.html").exists()


def test_positions_that_are_no_numbers_are_not_drawn(tmp_path):
    path = write_result(tmp_path / "r.h5")
    with h5py.File(path, "r+") as file:
        file["body/position"][3, 1] = np.nan
    with pytest.raises(ResultError, match="not finite"):
        page_on(path)


def test_axes_seen_flat_are_named_by_their_last_number():
    """A square in yz, seen along x: a title would lie on the numbers of its axis."""
    square = np.array([(0, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1)], float)
    box = report_camera._box(square, view_of(square, np.zeros(3)))
    assert box["xaxis"]["visible"] is False
    for name in "yz":
        axis = box[f"{name}axis"]
        assert (axis["title"]["text"], axis["tickprefix"], axis["ticksuffix"]) == ("", f"{name} = ", " m")
        assert axis["showtickprefix"] == axis["showticksuffix"] == "last"
    corner = np.vstack([square, [(1, 0, 0)]])
    in_space = report_camera._box(corner, view_of(corner, np.zeros(3)))
    assert in_space["yaxis"]["title"]["text"] == "y [m]"
