"""Curves as PNG, SVG or PDF by matplotlib: the same curves give the same bytes."""

import io
from collections.abc import Sequence

from .curves import Panel

FORMATS = ("png", "svg", "pdf")
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#B22222", "#6A3D9A")
DASHES = ("-", "--", ":", "-.", (0, (8, 2)), (0, (5, 1, 1, 1, 1, 1)), (0, (1, 4)), (0, (9, 3, 3, 3)))
THICKNESSES = (1.3, 2.6, 0.6)
LEGEND_ROWS = 14
WIDTH, HEIGHT, SQUARE, RESOLUTION = 8.0, 2.8, 6.0, 150
# No dates and no versions: pictures are compared in repositories.
METADATA = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def picture(panels: Sequence[Panel], form: str, title: str = "") -> bytes:
    """The panels one below the other as a file of `form`, one of `FORMATS`.

    Colours tell quantities apart, dashes results, and quantities where there are no more colours; panels
    over time share its axis, and paths (both axes of one unit) have equal ones.  Imports matplotlib.
    """
    import matplotlib
    from matplotlib.figure import Figure

    # A user's matplotlibrc shall not decide what flexmb draws.
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "flexmb"
        heights = [SQUARE if panel.same_unit else HEIGHT for panel in panels]
        figure = Figure(figsize=(WIDTH, sum(heights) + 0.5), layout="constrained")
        axes = figure.subplots(len(panels), squeeze=False, height_ratios=heights)[:, 0]
        for panel, axis in zip(panels, axes, strict=True):
            _draw(panel, axis)
        axes[-1].set_xlabel(_plain(panels[-1].x_label))
        figure.suptitle(_plain(title))
        stream = io.BytesIO()
        figure.savefig(stream, format=form, dpi=RESOLUTION, metadata=METADATA[form])
    return stream.getvalue()


def _draw(panel, axis):
    results = 1 + max(curve.result for curve in panel.curves)
    for curve in panel.curves:
        axis.plot(curve.x, curve.y, label=_plain(curve.label), **style(curve.quantity, curve.result, results))
    axis.set_ylabel(_plain(panel.y_label))
    axis.grid(True, linewidth=0.4, color="#cccccc")
    axis.margins(x=0.02)
    if panel.same_unit:
        axis.set_aspect("equal", adjustable="datalim")
    if len(panel.curves) > 1:
        columns = -(-len(panel.curves) // LEGEND_ROWS)
        axis.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=columns)


def style(quantity: int, result: int = 0, results: int = 1) -> dict:
    """Colour, dashes and width of the curve of a quantity of one of `results`: no two alike among 192."""
    dashes = result + results * (quantity // len(COLOURS))
    return {
        "color": COLOURS[quantity % len(COLOURS)],
        "linestyle": DASHES[dashes % len(DASHES)],
        "linewidth": THICKNESSES[dashes // len(DASHES) % len(THICKNESSES)],
    }


def _plain(text):
    """Text that matplotlib does not take for mathematics."""
    return text.replace("$", r"\$")
