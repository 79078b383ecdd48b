"""Draw the picture of a deck in the gallery from its result: the mechanism at some instants, and curves."""

from pathlib import Path

import h5py
import numpy as np

INSTANTS = 7  # of the mechanism
PANELS = 2  # of curves
MOST_ROWS = 1500  # of a curve
MARGIN = 1.15  # of half the size of the mechanism
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
GROUND_COLOUR = "#999999"


def draw(result: Path, picture: Path) -> None:
    """Draw the mechanism on the left, curves on the right; the mechanism alone where nothing moves."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    from flexmb_cli.results.figures.curves import Source, default_quantities, panels
    from flexmb_cli.results.quantities.quantities import resolve

    with h5py.File(result) as file:
        quantities = default_quantities(file)
        rows = slice(0, len(file["time"]), max(1, len(file["time"]) // MOST_ROWS))
        time = resolve(file, ["time"], str(result))[0]
        source = Source("", file, rows, time, quantities, energies_change=True)
        curves = panels([source])[:PANELS] if quantities else []
        figure = pyplot.figure(figsize=(9.5, 3.4) if curves else (4.5, 3.4), layout="constrained")
        grid = figure.add_gridspec(
            max(1, len(curves)), 2 if curves else 1, width_ratios=(1, 1.5) if curves else (1,)
        )
        _draw_mechanism(figure.add_subplot(grid[:, 0], projection="3d"), file)
        for k, panel in enumerate(curves):
            _draw_curves(figure.add_subplot(grid[k, 1]), panel, k == len(curves) - 1)
        figure.savefig(picture, dpi=100, metadata={"Software": None})
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
    axes.set_box_aspect(None, zoom=1.05)
    axes.view_init(elev=22, azim=-60)
    axes.tick_params(labelsize=5, pad=-4)
    axes.locator_params(nbins=4)
    for x in "xyz":
        getattr(axes, f"set_{x}label")(x, fontsize=7, labelpad=-9)


def _draw_curves(axes, panel, lowest):
    for k, curve in enumerate(panel.curves):
        axes.plot(
            curve.x,
            curve.y,
            label=curve.label,
            color=COLOURS[k % len(COLOURS)],
            lw=1,
            ls="-" if k < 6 else "--",
        )
    axes.set_ylabel(panel.y_label, fontsize=8)
    axes.tick_params(labelsize=7)
    axes.grid(True, lw=0.4, color="#cccccc")
    if len(panel.curves) > 1:
        axes.legend(fontsize=6, loc="center left", bbox_to_anchor=(1.0, 0.5))
    if lowest:
        axes.set_xlabel(panel.x_label, fontsize=8)
