"""Frames a second of the report's viewer in headless Chromium without a graphics card.

Example: scripts/bench/run report_frames --triangles 20000 --modes 10
Counts the redraws of 3 s in which every frame shows another instant.
"""

import argparse
import json
import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from selenium import webdriver

from flexmb_cli.results.figures import report_page
from flexmb_cli.results.figures.element_bodies import ElementBody
from flexmb_cli.results.figures.report_scene import frame_rows, scene_data, stored_places
from flexmb_cli.results.figures.scene import Scene

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from scripts.brick_beam import Beam

MEASURE = """
const done = arguments[0], v = window.flexmb.viewer;
let filled = performance.now();
for (let k = 0; k < 20; k++) for (const one of v.surfaces) v.fill(one, k, v.colouring);
filled = (performance.now() - filled) / 20;
v.playing = true; v.ratio = 1;
for (let k = 0; k < 30; k++) v.show(k);  // the compiler warms up, the number of pixels settles
const begun = performance.now();
let count = 0, work = 0;
function step() {
  const from = performance.now();
  v.show(count % v.scene.time.length);
  work += performance.now() - from; count++;
  performance.now() - begun < 3000 ? requestAnimationFrame(step)
    : done([1000 * count / (performance.now() - begun), work / count, filled, v.shown]);
}
step();
"""


def plate(triangles: int, modes: int, instants: int) -> ElementBody:
    """A square plate of one layer of bricks, simply supported: its bending modes, with stresses like them."""
    count = round((triangles / 4) ** 0.5)
    placed, elements = Beam((1.0, 1.0, 0.02), (count, count, 1), "C3D8").mesh()
    places, chance = np.array(list(placed.values())), np.random.default_rng(1)
    n, still = len(places), np.zeros((instants, 3))
    turn = np.tile(np.eye(3), (instants, 1, 1))
    waves = [(i, j) for total in range(2, modes + 2) for i in range(1, total) for j in [total - i]][:modes]
    x, y = np.pi * places[:, 0], np.pi * places[:, 1]
    bent = np.stack([np.sin(i * x) * np.sin(j * y) / (i * i + j * j) for i, j in waves], axis=-1)
    shape = np.zeros((n, 3, modes))
    shape[:, 2] = 0.1 * bent
    return ElementBody(
        1, "plate", np.arange(1, n + 1), np.array(elements) - 1, places,
        shape, np.repeat(bent[:, None], 6, axis=1) * chance.normal(size=(1, 6, modes)),
        chance.normal(size=(instants, modes)), np.zeros((instants, modes)), still, turn, still, still,
        np.arange(1, len(elements) + 1),
    )  # fmt: skip


def page(body: ElementBody) -> str:
    """A page with the viewer alone."""
    instants, none = len(body.amplitude), np.zeros((len(body.amplitude), 0, 3))
    scene = Scene(np.linspace(0, 1, instants), (), (), none, none, (), none, np.zeros(3))
    whole = _with_extent(scene, body)
    every = frame_rows(instants, stored_places(whole, [body]))
    shown = replace(whole, time=whole.time[every], joints=none[every], points=whole.points[every])
    scene_data_ = scene_data(shown, [body], every)
    motion = (Path(report_page.__file__).parent / "viewer/motion.html").read_text()
    script = report_page.viewer_script()
    figures = json.dumps({"scene": scene_data_})
    style = "<style>:root{--canvas:#f4f5f7}canvas{width:1000px;height:560px}</style>"
    return (
        f"{style}{motion}<script id=figures type=application/json>{figures}</script><script>{script}</script>"
    )


def _with_extent(scene, body):
    """The scene with two points, so that it has a size."""
    ends = np.tile(body.undeformed[[0, -1]], (len(scene.time), 1, 1))
    return Scene(scene.time, (), (), scene.joints, scene.axes, ("a", "b"), ends, scene.gravity)


def main():
    """Print frames a second, the work of one frame and the size of the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name, value in (("triangles", 20_000), ("modes", 10), ("instants", 500)):
        parser.add_argument(f"--{name}", type=int, default=value)
    given = parser.parse_args()
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome")
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--disable-gpu",
        "--window-size=1100,800",
    ):
        options.add_argument(argument)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        path.write_text(page(plate(given.triangles, given.modes, given.instants)))
        browser = webdriver.Chrome(
            options=options, service=webdriver.ChromeService(shutil.which("chromedriver"))
        )
        browser.set_script_timeout(60)
        try:
            browser.get(path.as_uri())
            frames, work, filled, ratio = browser.execute_async_script(MEASURE)
        finally:
            browser.quit()
        size = path.stat().st_size / 1e6
    print(f"{frames:.1f} frames/s, {work:.1f} ms of work a frame, {filled:.1f} ms of it superposition")
    print(f"{1000 * ratio:.0f} by {560 * ratio:.0f} pixels drawn for 1000 by 560 shown")
    print(f"page {size:.1f} MB")


if __name__ == "__main__":
    main()
