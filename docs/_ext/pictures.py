"""Run the decks of the documentation and draw its pictures, the gallery and the page of the sources.

    python docs/_ext/pictures.py [--gif]

`--gif` draws the animated picture of the README alone (docs/pictures/four-bar.gif, kept in the repository).
"""

import subprocess
import sys
from pathlib import Path

from deck_runs import DOCS, RESULTS, TOP, digest, flexmb, program, solved
from gallery import gallery

PICTURES = DOCS / "pictures"
REPRODUCTION = TOP / "scripts" / "reproduction"
PUBLISHED = TOP / "tests" / "published"
# Pictures of the tutorial: deck, quantities, other options, file.
FIGURES = [
    ("young/IN4-BAR.dat", ["body.3.velocity"], ["--width", "110"], "four-bar-velocity.svg"),
    ("young/IN4-BAR.dat", ["point.1.z"], ["--x", "point.1.y", "--width", "80"], "four-bar-path.png"),
    (
        "dafms/two_link_n2.DAT",
        ["elastic.1.node2.z", "elastic.2.node2.z"],
        ["--to", "0.5", "--width", "110"],
        "two-link-tips.svg",
    ),
    ("vsdf/pendulum.vsdf", ["point.1.position"], ["--width", "110"], "pendulum.svg"),
]


# Those of a study: the study, result, other options, file.
STUDY_FIGURES = [("studies/rssr.toml", "path", ["--width", "85"], "study.png")]


def figures() -> None:
    """Draw the pictures of the tutorial."""
    results = solved([TOP / "decks" / deck for deck, *_ in FIGURES])
    smooth = TOP / "decks/young/IN4-BAR.dat"
    paths = solved([smooth], "--set", "time.step=0.01")
    for deck, names, options, target in FIGURES:
        found = paths[smooth] if "--x" in options else results[TOP / "decks" / deck]
        flexmb("plot", found, *names, *options, "-q", "-o", PICTURES / target)
    for study, result, options, target in STUDY_FIGURES:
        table = RESULTS / f"{Path(study).stem}.h5"
        flexmb("sweep", TOP / "decks" / study, "-q", "--fresh", "-o", table)
        flexmb("plot", table, result, *options, "-q", "-o", PICTURES / target)


def sources() -> None:
    """Run the examples of the three sources: docs/verification/reproduced.md and its pictures."""
    page = DOCS / "verification" / "reproduced.md"
    folder = PICTURES / "reproduction"
    inputs = [
        path for where in (REPRODUCTION, PUBLISHED) for path in where.rglob("*") if path.suffix != ".pyc"
    ]
    decks = [path for path in (TOP / "decks").rglob("*") if path.is_file()]
    stamp = digest([path for path in (*inputs, *decks) if path.is_file()], program())
    kept = RESULTS / "reproduced"
    if page.exists() and kept.exists() and kept.read_text() == stamp:
        return
    command = [sys.executable, REPRODUCTION / "page.py", folder, "--markdown", page]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")
    kept.write_text(stamp)


def gif():
    """Draw the four-bar of the YOUNG dissertation over one revolution of its crank."""
    import h5py
    import matplotlib
    import numpy as np

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.animation import FuncAnimation, PillowWriter

    deck = TOP / "decks/young/IN4-BAR.dat"
    folder = RESULTS / "gif"
    folder.mkdir(parents=True, exist_ok=True)
    flexmb("run", "-q", "--no-out", deck, "--set", "time.step=0.05", "--set", "time.end=2.0", folder=folder)
    with h5py.File(folder / "OUT4-BAR.h5") as result:
        position, p = result["body/position"][:], result["body/euler_parameters"][:]
        bodies, points = result["joint/body"][:], result["joint/point"][:]
    links = _links(position, p, bodies, points)
    figure = pyplot.figure(figsize=(4.6, 3.4), dpi=80)
    axes = figure.add_subplot(projection="3d")
    figure.subplots_adjust(0, 0, 1, 1)
    colours = ["#d1495b", "#2e4057", "#00798c"]
    everywhere = np.concatenate([link.reshape(-1, 3) for link in links])
    middle, half = (everywhere.max(0) + everywhere.min(0)) / 2, np.ptp(everywhere, axis=0).max() / 2
    limits = {f"{x}lim": (m - half, m + half) for x, m in zip("xyz", middle, strict=True)}
    grounded = np.concatenate([links[0][0, -1:], links[2][0, -1:]])

    def draw(k):
        axes.clear()
        axes.set(**limits)
        axes.set_box_aspect(None, zoom=1.15)
        axes.plot(*grounded.T, "^", color="#888888", markersize=11)
        axes.set_axis_off()
        axes.view_init(elev=22, azim=-60 + 10 * k / len(position))
        for link, colour in zip(links, colours, strict=False):
            axes.plot(*link[k].T, color=colour, linewidth=5, solid_capstyle="round", marker="o")
        axes.plot(*links[0][: k + 1, 0].T, color="#999999", linewidth=1)

    motion = FuncAnimation(figure, draw, frames=len(position) - 1)
    motion.save(PICTURES / "four-bar.gif", writer=PillowWriter(fps=20))


def _links(position, p, bodies, points):
    """Return the joint points of every moving body over time, each (time, point, 3), global axes."""
    import numpy as np

    moving = [b for b in range(position.shape[1]) if np.ptp(p[:, b], axis=0).max() > 1e-9]
    links = []
    for body in moving:
        local = [
            points[j, side] for j, pair in enumerate(bodies) for side in (0, 1) if pair[side] == body + 1
        ]
        links.append(np.stack([position[:, body] + _turned(p[:, body], s) for s in local], axis=1))
    return links


def _turned(p, s):
    """Return A(p) s for every time; p (time, 4) Euler parameters, s (3,) body axes."""
    import numpy as np

    e0, e = p[:, :1], p[:, 1:]
    return (2 * e0**2 - 1) * s + 2 * e * (e @ s)[:, None] + 2 * e0 * np.cross(e, s)


if __name__ == "__main__":
    RESULTS.mkdir(parents=True, exist_ok=True)
    PICTURES.mkdir(exist_ok=True)
    if "--gif" in sys.argv:
        gif()
        sys.exit()
    figures()
    gallery()
    sources()
