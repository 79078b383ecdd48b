"""The report's viewer beside snapshots of K3D: four scenes in headless Chromium without a graphics card.

Example: scripts/bench/run peers/viewers --instants 100
Prints the size of a page, the time to its first picture and frames a second, of K3D by SwiftShader, the
processor in place of a graphics card; and whether there is a picture if the browser has no WebGL.
"""

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

import h5py
import k3d
import numpy as np
from selenium import webdriver

TOP = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(TOP), str(TOP / "scripts" / "bench")]

from report_frames import page as plate_page  # noqa: E402
from report_frames import plate  # noqa: E402

from flexmb_cli import solve  # noqa: E402
from flexmb_cli.results.figures.contours import VON_MISES, nodal_values  # noqa: E402
from flexmb_cli.results.figures.element_bodies import element_bodies, outer_faces_of_elements, triangles  # noqa: E402
from flexmb_cli.results.figures.report_page import report_page  # noqa: E402
from flexmb_cli.results.figures.report_scene import colour_of  # noqa: E402
from flexmb_cli.results.figures.scene import read_scene  # noqa: E402

SCENES = ("young/IN4-BAR.dat", "young/dynamics/IN-ANDREWS.dat", "vsdf/slider_crank_stress.vsdf")
OURS = ("return window.flexmb && window.flexmb.ready", "window.flexmb.viewer.show({})")
THEIRS = (
    "window.K3DInstance && K3DInstance.then && K3DInstance.then(k => window.shown = k);"
    "return window.shown && shown.getWorld().renderer.info.render.frame > 0",
    "shown.setTime({}); shown.render()",
)
PLAY = """
const done = arguments[0], begun = performance.now(); let count = 0;
function step() {{
  {};
  count++;
  const spent = performance.now() - begun;
  spent < 3000 ? requestAnimationFrame(step) : done(1000 * count / spent);
}}
step();
"""


def snapshot(scene, bodies) -> str:
    """A page of K3D with the same bodies: lines as tubes, finite-element bodies with stresses, over time."""
    plot = k3d.plot(grid_visible=False)
    for body in scene.lined(bodies) if scene else ():
        plot += k3d.lines(
            _series(body.marks), body.edges.astype(np.uint32), indices_type="segment", shader="mesh",
            width=0.016 * scene.size, color=int(colour_of(body)[1:], 16),
        )  # fmt: skip
    for shape in scene.shapes if scene else ():
        rows = range(len(scene.time))
        places = np.array([shape.places(row, 1.0) for row in rows])
        plot += k3d.mesh(_series(places), shape.triangles, color=int(colour_of(shape)[1:], 16), side="double")
    for body in bodies:
        faces, _ = outer_faces_of_elements(body.cells)
        places = np.array([body.places(row, 1.0) for row in range(len(body.amplitude))])
        stress = nodal_values(body, body.amplitude)[VON_MISES].T
        ends = [float(stress.min()), float(stress.max())]
        plot += k3d.mesh(
            _series(places), triangles(faces), attribute=_series(stress), color_range=ends,
            color_map=k3d.matplotlib_color_maps.Viridis,
        )  # fmt: skip
    return plot.get_snapshot()


def _series(values):
    return {str(k): np.ascontiguousarray(each, np.float32) for k, each in enumerate(values)}


def pages(instants: int):
    """Yield name, our page, K3D's page and number of instants of each scene."""
    with tempfile.TemporaryDirectory() as folder:
        for deck in SCENES:
            path = Path(folder) / "r.h5"
            solve(TOP / "decks" / deck).save(path)
            with h5py.File(path) as file:
                scene = read_scene(file)
                bodies = list(element_bodies(file, scene.body_names, slice(None)))
                yield Path(deck).stem, report_page(file), snapshot(scene, bodies), len(scene.time)
    body = plate(20_000, 10, instants)
    yield "plate of 20,000 triangles", plate_page(body), snapshot(None, [body]), instants


def browser(*arguments: str) -> webdriver.Chrome:
    """Headless Chromium without a graphics card."""
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for argument in ("--headless=new", "--no-sandbox", "--window-size=1200,900", "--disable-gpu", *arguments):
        options.add_argument(argument)
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))


def first_picture(chrome: webdriver.Chrome, path: Path, ready: str, most: float = 60.0) -> float:
    """Return seconds from opening a page to its picture, nan if there is none."""
    begun = time.perf_counter()
    chrome.get(path.as_uri())
    while not chrome.execute_script(ready):
        if time.perf_counter() - begun > most:
            return float("nan")
        time.sleep(0.02)
    return time.perf_counter() - begun


def main() -> None:
    """Print a row for each scene and viewer."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--instants", type=int, default=100, help="of the plate")
    instants = parser.parse_args().instants
    graphics, none = browser("--enable-unsafe-swiftshader"), browser("--disable-3d-apis")
    print("| scene | viewer | page | first picture | frames/s | without WebGL |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, ours, theirs, count in pages(instants):
            for viewer, text, (ready, show) in (("flexmb", ours, OURS), ("K3D", theirs, THEIRS)):
                path = Path(folder) / "page.html"
                path.write_text(text, encoding="utf-8")
                begun = first_picture(graphics, path, ready)
                play = PLAY.format(show.format(f"count % {count}"))
                rate = graphics.execute_async_script(play) if begun == begun else 0.0
                bare = "picture" if first_picture(none, path, ready, 10.0) < 10.0 else "none"
                size = len(text.encode()) / 1000
                print(
                    f"| {name} | {viewer} | {size:.0f} kB | {begun:.2f} s | {rate:.0f} | {bare} |", flush=True
                )
    graphics.quit()
    none.quit()


if __name__ == "__main__":
    main()
