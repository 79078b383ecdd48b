"""Run the decks of the documentation and draw its pictures and the gallery.

    python docs/_ext/pictures.py [--gif]

Results are kept in docs/_build/results while the decks and the package stay as they are.  `--gif` draws the
animated picture of the README as well (docs/pictures/four-bar.gif, kept in the repository).
"""

import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
TOP = DOCS.parent
RESULTS = DOCS / "_build" / "results"
PICTURES = DOCS / "pictures"
FOLDERS = {
    "YOUNG": ("young", "*.dat"),
    "YOUNG with dynamics": ("young/dynamics", "*.dat"),
    "DAFMS": ("dafms", "*.DAT"),
    "VSDF": ("vsdf", "*.vsdf"),
}
# Pictures of the tutorial: deck, quantities, other options, file.
FIGURES = [
    ("young/IN4-BAR.dat", ["body.3.velocity"], [], "four-bar-velocity.svg"),
    ("young/IN4-BAR.dat", ["point.1.z"], ["--x", "point.1.y"], "four-bar-path.png"),
    ("dafms/two_link_n2.DAT", ["elastic.1.node2.z", "elastic.2.node2.z"], [], "two-link-tips.svg"),
    ("vsdf/pendulum.vsdf", ["point.1.position"], [], "pendulum.svg"),
]


def flexmb(*arguments, folder=RESULTS):
    """Run a command of this checkout's flexmb and return what it prints."""
    environment = os.environ | {"PYTHONPATH": str(TOP)}
    command = [sys.executable, "-m", "flexmb_cli", *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True, text=True)
    return done.stdout


def result_of(deck: Path) -> Path:
    """Return the HDF5 result of a deck, solved anew if the deck has changed."""
    stamp = hashlib.sha256(deck.read_bytes()).hexdigest()[:12]
    folder = RESULTS / f"{deck.stem}-{stamp}"
    if not any(folder.glob("*.h5")):
        folder.mkdir(parents=True, exist_ok=True)
        flexmb("run", "-q", "--no-out", deck, folder=folder)
    return next(folder.glob("*.h5"))


def summary(deck: Path) -> str:
    """Return the lines of `check` that describe the model."""
    lines = flexmb("check", deck, folder=TOP).splitlines()[1:4]
    return " ".join(line.strip() for line in lines)


def purpose(deck: Path) -> str:
    """Return what the README beside the decks says of one."""
    for folder in (deck.parent, deck.parent.parent):
        page = folder / "README.md"
        if page.exists():
            for line in page.read_text(encoding="utf-8").splitlines():
                cells = [cell.strip() for cell in line.strip("|").split("|")]
                if len(cells) > 1 and re.search(rf"`{re.escape(deck.stem)}`", cells[0]):
                    return cells[1]
    return ""


def drawn(result: Path, picture: Path) -> bool:
    """Draw the default curves of a result; return False for a mechanism at rest, which has none."""
    if picture.exists() and picture.stat().st_mtime > result.stat().st_mtime:
        return True
    picture.parent.mkdir(parents=True, exist_ok=True)
    try:
        flexmb("plot", result, "-q", "--title", picture.stem, "-o", picture)
    except subprocess.CalledProcessError as refused:
        if "nothing" not in refused.stderr:
            raise
        return False
    return True


def gallery():
    """Write gallery.md with a picture and key numbers of every supplied deck."""
    text = ["# Gallery\n", "Every supplied deck, with the curves that `flexmb plot` draws by default.\n"]
    for title, (folder, pattern) in FOLDERS.items():
        text.append(f"## {title}\n")
        for deck in sorted((TOP / "decks" / folder).glob(pattern)):
            picture = PICTURES / "gallery" / f"{deck.stem}.svg"
            result = result_of(deck)
            text.append(f"### {deck.stem}\n\n{purpose(deck)}\n\n{summary(deck)}\n")
            if drawn(result, picture):
                text.append(
                    f"```{{image}} pictures/gallery/{picture.name}\n:alt: Curves of {deck.stem}\n```\n"
                )
    (DOCS / "gallery.md").write_text("\n".join(text), encoding="utf-8")


def figures():
    """Draw the pictures of the tutorial."""
    for deck, names, options, target in FIGURES:
        path = TOP / "decks" / deck
        if not (PICTURES / target).exists():
            flexmb("plot", result_of(path), *names, *options, "-q", "-o", PICTURES / target)


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
