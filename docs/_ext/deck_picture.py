"""Draw the pictures of a deck in the gallery from its result: the mechanism at some instants, and curves."""

import textwrap
from pathlib import Path

import h5py
import numpy as np

from flexmb_cli.results.figures.contours import BodyLook
from flexmb_cli.results.figures.film import FilmLook

INSTANTS = 7  # of the mechanism
PANELS = 2  # of curves
MOST_ROWS = 1500  # of a curve
MARGIN = 1.15  # of half the size of the mechanism
PADS = {
    "x": (-3, -2),
    "y": (-3, 1),
    "z": (1, 1),
}  # points from an axis to its ticks, and from these to its label
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
GROUND_COLOUR = "#999999"
DOTS = 160  # an inch: pictures of few inches, so that letters stay readable on phones
LABEL = 24  # letters of a line of a label, and of a legend in two columns
FRAME = FilmLook(560, 480, 1, letters=1 / 24)  # shown half as large
# Decks shown at their last instant alone, from a side and between other values: straps, so that the stress at
# the hole is seen, which is exceeded at their joints, single nodes.
LOOKS = {"strap": FilmLook(840, 440, 1, "z", BodyLook(ends=(0.0, 1.1e8)), letters=1 / 28)}


def draw(result: Path, mechanism: Path, curves: Path) -> bool:
    """Draw the mechanism and its curves; return False, and draw no curves, where nothing moves."""
    import matplotlib

    matplotlib.use("Agg")
    with h5py.File(result) as file:
        if _has_surfaces(file):
            _film_frame(file, mechanism)
        else:
            _lines(file, mechanism)
        drawn = _panels(file, str(result))
        if drawn:
            _curves(drawn, curves)
    return bool(drawn)


def _has_surfaces(file):
    cells = "elastic" in file and any("cell" in body for body in file["elastic"].values())
    return cells or "shape" in file


def _film_frame(file, picture):
    """A frame of the film of `flexmb report --movie`: surfaces with stresses and shapes."""
    from matplotlib import image

    from flexmb_cli.results.figures.film import film_frames

    look = next((look for name, look in LOOKS.items() if picture.name.startswith(name)), None)
    if look:
        frame = next(film_frames(file, look, slice(-1, None)))
    else:
        *_, frame = (frame for _, frame in zip(range(3), film_frames(file, FRAME), strict=False))
    image.imsave(picture, frame, metadata={"Software": None})


def _lines(file, picture):
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(2.9, 2.5))
    # The box leaves room at its right and below for numbers and labels.
    _draw_mechanism(figure.add_axes((-0.04, 0.04, 0.97, 1.0), projection="3d"), file)
    figure.savefig(picture, dpi=DOTS, metadata={"Software": None})
    pyplot.close(figure)


def _panels(file, name):
    from flexmb_cli.results.figures.curves import Source, default_curves, panels
    from flexmb_cli.results.quantities.quantities import resolve

    quantities = default_curves(file).quantities
    rows = slice(0, len(file["time"]), max(1, len(file["time"]) // MOST_ROWS))
    time = resolve(file, ["time"], name)[0]
    source = Source("", file, rows, time, quantities, energies_change=True)
    return panels([source])[:PANELS] if quantities else []


def _curves(drawn, picture):
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(
        len(drawn), squeeze=False, sharex=True, figsize=(4.2, 0.8 + 1.8 * len(drawn)), layout="constrained"
    )
    for axis, panel in zip(axes[:, 0], drawn, strict=True):
        _draw_curves(axis, panel)
    axes[-1, 0].set_xlabel(drawn[-1].x_label)
    figure.savefig(picture, dpi=DOTS, metadata={"Software": None})
    pyplot.close(figure)


def _draw_mechanism(axes, file):
    from flexmb_cli.results.figures.scene import read_scene

    last = len(file["time"]) - 1
    scene = read_scene(file, slice(0, last + 1, max(1, last // (INSTANTS - 1))))
    instants = len(scene.time)
    for body in scene.bodies:
        colour = GROUND_COLOUR if body.still else COLOURS[(body.number - 1) % len(COLOURS)]
        for k in range(instants - 1, instants) if body.still else range(instants):
            faint = 1.0 if k == instants - 1 else 0.12 + 0.35 * k / max(1, instants - 1)
            marks = body.marks[k]
            for edge in body.edges:
                axes.plot(*marks[edge].T, color=colour, alpha=faint, lw=2 if len(body.edges) < 20 else 0.5)
            if k == instants - 1 and len(marks) < 20:
                axes.plot(*marks.T, "o", color=colour, ms=3)
    places = scene.places
    # Some room, so that nothing lies in the edges of the box.
    middle, half = (places.max(0) + places.min(0)) / 2, MARGIN * max(np.ptp(places, axis=0).max() / 2, 1e-9)
    axes.set(**{f"{x}lim": (m - half, m + half) for x, m in zip("xyz", middle, strict=True)})
    axes.set_box_aspect(None, zoom=0.95)
    axes.view_init(elev=22, azim=-60)
    axes.locator_params(nbins=3, steps=(1, 2, 5, 10))
    for x, (tick, label) in PADS.items():
        axes.tick_params(axis=x, labelsize=8, pad=tick)
        getattr(axes, f"{x}axis").set_major_formatter("{x:g}")
        getattr(axes, f"set_{x}label")(f"{x} [m]", fontsize=9, labelpad=label)


def _draw_curves(axis, panel):
    for k, curve in enumerate(panel.curves):
        look = {"color": COLOURS[k % len(COLOURS)], "ls": "-" if k < len(COLOURS) else "--"}
        axis.plot(curve.x, curve.y, label=curve.label, lw=1.2, **look)
    axis.set_ylabel(textwrap.fill(panel.y_label, LABEL))
    axis.grid(True, lw=0.4, color="#cccccc")
    if len(panel.curves) > 1:
        longest = max(len(curve.label) for curve in panel.curves)
        columns = 1 if longest > LABEL or len(panel.curves) <= 2 else 2
        axis.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=columns, frameon=False)
