"""Curves as PNG, SVG or PDF by matplotlib: the same curves give the same bytes."""

import io
import warnings
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from .curves import Panel
from .look import COLOURS, PANEL, ROOMY, SQUARE_PART, TICKS, Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
DASHES = ("-", "--", ":", "-.", (0, (8, 2)), (0, (5, 1, 1, 1, 1, 1)), (0, (1, 4)), (0, (9, 3, 3, 3)))
THICKNESSES = (1.3, 2.6, 0.6)
LEGEND_ROWS = 14
WIDTH, HEIGHT, SQUARE, RESOLUTION = 8.0, 2.8, 6.0, 150
PRINTED = 300  # dots per inch, which journals ask for
# Signs that LaTeX takes for commands.
_LATEX = {sign: f"\\{sign}" for sign in "#$%&_{}"} | {"\\": r"\textbackslash{}", "^": r"\^{}", "~": r"\~{}"}
# No dates and no versions: pictures are compared in repositories.
METADATA = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def picture(
    panels: Sequence[Panel],
    form: str,
    title: str = "",
    look: Look | None = None,
    tell_missing: Callable[[str], object] = str,
) -> bytes:
    """The panels one below the other as a file of `form`, one of `FORMATS`.

    Colours tell quantities apart, dashes results, and quantities where there are no more colours; panels
    over time share its axis, and paths (both axes of one unit) have equal ones.  A `look` is for print;
    `tell_missing` is called with each of its font families that is not installed.
    Imports matplotlib; raises OSError for a style that there is not.
    """
    import matplotlib

    # A user's matplotlibrc shall not decide what flexmb draws.
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "flexmb"
        if look:
            for family in look.apply():
                tell_missing(family)
        figure = fitted_figure(panels, title, look)
        stream = io.BytesIO()
        figure.savefig(stream, format=form, dpi=PRINTED if look else RESOLUTION, metadata=METADATA[form])
    return stream.getvalue()


def fitted_figure(panels: Sequence[Panel], title: str, look: Look | None) -> "Figure":
    """Return the figure of `picture`, with the settings of matplotlib as they are.

    In print, legends of many curves and those that would cover a curve stand below their panels.  Raises
    ValueError where letters leave no room.
    """
    below = {k for k, panel in enumerate(panels) if len(panel.curves) > ROOMY}
    figure = _figure(panels, title, look, below)
    covering = _check_room(figure, look) - below if look else set()
    if not (look and covering):
        return figure
    figure = _figure(panels, title, look, below | covering)
    _check_room(figure, look)
    return figure


def _figure(panels: Sequence[Panel], title: str, look: Look | None, below: set[int]) -> "Figure":
    """The picture, legends of the panels `below` below them."""
    from matplotlib.figure import Figure

    width, heights, rest = _sizes(panels, look, below)
    figure = Figure(figsize=(width, sum(heights) + rest), layout="constrained")
    axes = figure.subplots(len(panels), squeeze=False, height_ratios=heights)[:, 0]
    for k, (panel, axis) in enumerate(zip(panels, axes, strict=True)):
        _draw(panel, axis, look)
        if len(panel.curves) > 1:
            _legend(panel, axis, look, k in below, k == len(panels) - 1)
    axes[-1].set_xlabel(_text(panels[-1].x_label, look))
    if title:
        figure.suptitle(_plain(title))
    return figure


def _check_room(figure: "Figure", look: Look) -> set[int]:
    """Return the panels whose legends cover curves.  Raises ValueError where letters leave no room."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        figure.draw_without_rendering()
    if any("constrained_layout not applied" in str(one.message) for one in caught):
        raise ValueError(
            f"letters of {look.size:g} points leave no room for curves in {look.width:g} mm: choose a wider "
            "picture, smaller letters or fewer curves"
        )
    return {k for k, axis in enumerate(figure.axes) if _covers(axis)}


def _covers(axis: "Axes") -> bool:
    legend = axis.get_legend()
    if legend is None:
        return False
    box = legend.get_window_extent()
    paths = (line.get_transform().transform_path(line.get_path()) for line in axis.lines)
    return any(path.intersects_bbox(box, filled=False) for path in paths)


def _sizes(panels: Any, look: Look | None, below: set[int]) -> tuple[float, list[float], float]:
    """Width of the picture, heights of its panels, and what legends and the lowest axis take, in."""
    if look is None:
        return WIDTH, [SQUARE if panel.same_unit else HEIGHT for panel in panels], 0.5
    heights = [look.inches * (SQUARE_PART if panel.same_unit else PANEL) for panel in panels]
    legends = sum(look.legend_height([curve.label for curve in panels[k].curves]) for k in below)
    return look.inches, heights, legends + 0.3


def _draw(panel: Panel, axis: Any, look: Any) -> None:
    results = 1 + max(curve.result for curve in panel.curves)
    for curve in panel.curves:
        drawn = style(curve.quantity, curve.result, results)
        if look:
            drawn["linewidth"] *= 0.75
        label = look.in_legend(curve.label) if look else curve.label
        axis.plot(curve.x, curve.y, label=_text(label, look), **drawn)
    axis.set_ylabel(_text(look.wrapped(panel.y_label) if look else panel.y_label, look))
    if look:
        axis.locator_params(nbins=TICKS)
        axis.locator_params(axis="x", nbins=look.ticks)
    axis.grid(True, linewidth=0.4, color="#cccccc")
    axis.margins(x=0.02)
    if panel.same_unit:
        axis.set_aspect("equal", adjustable="datalim")


def _legend(panel: Panel, axis: Any, look: Look | None, below: bool, lowest: bool) -> None:
    if look and below:
        columns = look.legend_columns([curve.label for curve in panel.curves])
        # Letters' heights that the numbers of the axis take, and its label.
        room = 4.0 if lowest else 2.0
        axis.legend(
            loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=room, ncols=columns, frameon=False
        )
    elif look:
        # It takes no room of its own: one that is larger than the panel covers curves.
        axis.legend(loc="best", frameon=False).set_in_layout(False)
    else:
        columns = -(-len(panel.curves) // LEGEND_ROWS)
        axis.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=columns)


def style(quantity: int, result: int = 0, results: int = 1) -> dict[str, Any]:
    """Colour, dashes and width of the curve of a quantity of one of `results`: no two alike among 192."""
    dashes = result + results * (quantity // len(COLOURS))
    return {
        "color": COLOURS[quantity % len(COLOURS)],
        "linestyle": DASHES[dashes % len(DASHES)],
        "linewidth": THICKNESSES[dashes // len(DASHES) % len(THICKNESSES)],
    }


def _text(text: str, look: Any) -> str:
    """Text as matplotlib, or LaTeX, shows it."""
    if look is None or not look.latex:
        return _plain(text)
    return "".join(_LATEX.get(sign, sign) for sign in text)


def _plain(text: str) -> str:
    """Text that matplotlib does not take for mathematics."""
    return text.replace("$", r"\$")
