"""Draw the pictures of a deck in the gallery from its result: the mechanism, and curves."""

import textwrap
from pathlib import Path

import h5py

from flexmb_cli.results.figures.contours import BodyLook
from flexmb_cli.results.figures.film import FilmLook, film_frames
from flexmb_cli.results.figures.look import COLOURS, GRID

PANELS = 2  # of curves
MOST_ROWS = 1500  # of a curve
DOTS = 160  # an inch: pictures of few inches, so that letters stay readable on phones
LABEL = 24  # letters of a line of a label, and of a legend in two columns
FRAME = FilmLook(560, 480, 1, letters=1 / 24)  # shown half as large
# Decks shown at their last instant alone, from a side and between other values: straps, so that the stress at
# the hole is seen, which is exceeded at their joints, single nodes.
LOOKS = {"strap": FilmLook(840, 440, 1, "z", BodyLook(ends=(0.0, 1.1e8)), letters=1 / 28)}


def draw(result: Path, mechanism: Path, curves: Path) -> bool:
    """Draw the mechanism and its curves; return False, and draw no curves, if nothing moves."""
    import matplotlib

    matplotlib.use("Agg")
    with h5py.File(result) as file:
        draw_mechanism(file, mechanism)
        drawn = _panels(file, str(result))
        if drawn:
            _curves(drawn, curves)
    return bool(drawn)


def draw_mechanism(file: h5py.File, picture: Path) -> None:
    """Write a frame of the film of `flexmb report --movie`."""
    from matplotlib import image

    look = next((look for name, look in LOOKS.items() if picture.name.startswith(name)), None)
    if look:
        frame = next(film_frames(file, look, slice(-1, None)))
    else:
        *_, frame = (frame for _, frame in zip(range(3), film_frames(file, FRAME), strict=False))
    image.imsave(picture, frame, metadata={"Software": None})


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


def _draw_curves(axis, panel):
    for k, curve in enumerate(panel.curves):
        look = {"color": COLOURS[k % len(COLOURS)], "ls": "-" if k < len(COLOURS) else "--"}
        axis.plot(curve.x, curve.y, label=curve.label, lw=1.2, **look)
    axis.set_ylabel(textwrap.fill(panel.y_label, LABEL))
    axis.grid(True, **GRID)
    if len(panel.curves) > 1:
        longest = max(len(curve.label) for curve in panel.curves)
        columns = 1 if longest > LABEL or len(panel.curves) <= 2 else 2
        axis.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=columns, frameon=False)
