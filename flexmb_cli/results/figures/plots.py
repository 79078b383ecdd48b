"""Curves as PNG, SVG or PDF by matplotlib: the same curves give the same bytes."""

import io
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from .curves import Panel
from .label_fitting import LABEL_LINE, Letters, fit_labels
from .look import COLOURS, HANDLE, NARROWEST, PANEL, ROOMY, SQUARE_PART, THICKNESS, TICKS, Look, settings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.typing import RcKeyType

CYCLE: tuple[dict[str, Any], ...] = tuple({"color": colour} for colour in COLOURS)
FORMATS = ("png", "svg", "pdf")
DASHES = ("-", "--", ":", "-.", (0, (8, 2)), (0, (5, 1, 1, 1, 1, 1)), (0, (1, 4)), (0, (9, 3, 3, 3)))
# Of curves by that of the first ones.
THICKNESSES = (1.0, 2.0, 0.6 / THICKNESS)
LEGEND_ROWS, LEGEND_LETTERS = 14, "small"
# Part of a screen's picture that the names of curves take before they are wrapped; what its panels keep, in.
NAMES_PART, PANEL_WIDTH = 0.4, 4.0
# Part of the height of a panel that its label takes before it is wrapped.
LABEL_PART = 0.9
LABEL_DEPTH = 0.2  # part of the width of a picture that a label with many lines takes
WIDTH, HEIGHT, SQUARE, RESOLUTION = 8.0, 2.8, 6.0, 150
PRINTED = 300  # dots per inch, which journals ask for
# Signs that LaTeX takes for commands.
_LATEX = {sign: f"\\{sign}" for sign in "#$%&_{}"} | {"\\": r"\textbackslash{}", "^": r"\^{}", "~": r"\~{}"}
MOST_LAYOUTS = 6  # of a figure, until labels fit
LEAST_PANEL = 0.15  # part of the width of a printed picture
SQUEEZED = 0.7  # part of the wanted height of panels
# No dates and no versions: pictures are compared in repositories.
METADATA = {
    "png": {"Software": "flexmb"},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def picture(
    panels: Sequence[Panel],
    form: str,
    title: str = "",
    look: Look | None = None,
    report_missing: Callable[[str], object] = str,
) -> bytes:
    """Return the panels one below the other as a file of `form`, one of `FORMATS`.

    Colours distinguish quantities; dashes distinguish results, and quantities beyond the last colour; panels
    over time share its axis, and paths (both axes of one unit) have equal ones.  A `look` is for print;
    `report_missing` is called with each of its font families that is not installed.
    Imports matplotlib; raises OSError for a style that there is not.
    """
    return figure_bytes(lambda: fitted_figure(panels, title, look), form, look, report_missing, settings())


def figure_bytes(
    make: "Callable[[], Figure]",
    form: str,
    look: Look | None,
    report_missing: Callable[[str], object],
    on_screens: "dict[RcKeyType, Any] | None" = None,
) -> bytes:
    """Return the figure that `make` gives, as a file, drawn with settings of `look` or `on_screens`."""
    import matplotlib

    # A user's matplotlibrc shall not decide what flexmb draws.
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "flexmb"
        matplotlib.rcParams.update(on_screens or {} if look is None else {})
        for family in look.apply() if look else ():
            report_missing(family)
        figure = make()
        stream = io.BytesIO()
        figure.savefig(stream, format=form, dpi=PRINTED if look else RESOLUTION, metadata=METADATA[form])
    return stream.getvalue()


def fitted_figure(panels: Sequence[Panel], title: str, look: Look | None) -> "Figure":
    """Return the figure of `picture`, with the settings of matplotlib as they are.

    In print, legends of many curves and those that would cover a curve stand below their panels, but where
    the style has a place for them.  Raises ValueError where letters leave no room.
    """
    from matplotlib import rcParams

    placed = look is not None and rcParams["legend.loc"] != "best"
    below = {k for k, panel in enumerate(panels) if len(panel.curves) > ROOMY and not placed}
    figure = _figure(panels, title, look, below)
    _fit(figure, panels, look)
    if not look:
        return figure
    hiding = {k for k, axis in enumerate(figure.axes) if (_overflows if placed else _covers)(axis)} - below
    if not hiding:
        return figure
    figure = _figure(panels, title, look, below | hiding)
    _fit(figure, panels, look)
    return figure


def _figure(panels: Sequence[Panel], title: str, look: Look | None, below: set[int]) -> "Figure":
    """The picture, legends of the panels `below` below them."""
    from matplotlib.figure import Figure

    show = partial(shown, look=look)
    width, heights, rest = _sizes(panels, look, below)
    letters = Letters("figure.titlesize")
    heading = letters.wrapped(title, LABEL_PART * width, show)
    # Other pictures have room for one line.
    rest += LABEL_LINE * letters.inches * (len(heading.splitlines()) if look else heading.count("\n"))
    figure = Figure(figsize=(width, sum(heights) + rest), layout="constrained")
    axes = figure.subplots(len(panels), squeeze=False, height_ratios=heights)[:, 0]
    labels = Letters("axes.labelsize")
    for k, (panel, axis) in enumerate(zip(panels, axes, strict=True)):
        _draw(panel, axis, look)
        text, points = labels.fitted(panel.y_label, LABEL_PART * heights[k], LABEL_DEPTH * width, show)
        axis.set_ylabel(text, fontsize=points)
        if len(panel.curves) > 1:
            _legend(panel, axis, look, k in below, k == len(panels) - 1)
    axes[-1].set_xlabel(labels.wrapped(panels[-1].x_label, NARROWEST * width, show))
    if heading:
        figure.suptitle(heading)
    return figure


def _fit(figure: "Figure", panels: Sequence[Panel], look: Look | None) -> None:
    if look and _grow(figure, _sizes(panels, look, set())[1]):
        _lay_out(figure)
    fit_figure(figure, look)
    if look and any(axis.bbox.width < LEAST_PANEL * figure.bbox.width for axis in figure.axes):
        raise _no_room(look)


def fit_figure(figure: "Figure", look: Look | None) -> None:
    """Lay the figure out, and again while labels change.  Raises ValueError where letters leave no room."""
    cramped = _lay_out(figure)
    try:
        for _ in range(MOST_LAYOUTS):
            if not fit_labels(figure):
                break
            cramped = _lay_out(figure)
    except ValueError:
        cramped = True
    if cramped and look:
        raise _no_room(look)


def _no_room(look: Look) -> ValueError:
    return ValueError(
        f"letters of {Letters('axes.labelsize').points:g} points leave no room for curves in "
        f"{look.width:g} mm: choose a wider picture, smaller letters or fewer curves"
    )


def _lay_out(figure: "Figure") -> bool:
    """Give everything its place; return whether there is too little room."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        figure.draw_without_rendering()
    return any("constrained_layout not applied" in str(one.message) for one in caught)


def _grow(figure: "Figure", heights: list[float]) -> bool:
    """Make a figure higher whose legends take much of the height of its panels; return whether they do."""
    height_asked = sum(heights)
    height_drawn = sum(axis.bbox.height for axis in figure.axes) / figure.dpi
    if height_drawn >= SQUEEZED * height_asked:
        return False
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + height_asked - height_drawn)
    return True


def _overflows(axis: "Axes") -> bool:
    """Return whether the legend is larger than its panel."""
    legend = axis.get_legend()
    if legend is None:
        return False
    box = legend.get_window_extent()
    return bool(box.width > axis.bbox.width or box.height > axis.bbox.height)


def _covers(axis: "Axes") -> bool:
    legend = axis.get_legend()
    if legend is None:
        return False
    box = legend.get_window_extent()
    paths = (line.get_transform().transform_path(line.get_path()) for line in axis.lines)
    return any(path.intersects_bbox(box, filled=False) for path in paths)


def _sizes(panels: Sequence[Panel], look: Look | None, below: set[int]) -> tuple[float, list[float], float]:
    """Width of the picture, heights of its panels, and what legends and the lowest axis take, in."""
    if look is None:
        return _screen_width(panels), [SQUARE if panel.same_unit else HEIGHT for panel in panels], 0.5
    heights = [look.inches * (SQUARE_PART if panel.same_unit else PANEL) for panel in panels]
    legends = sum(look.legend_height([curve.label for curve in panels[k].curves]) for k in below)
    return look.inches, heights, legends + 0.3


def _screen_width(panels: Sequence[Panel]) -> float:
    """Width of a picture for the screen, in: names of many curves in columns widen it."""
    letters = Letters(LEGEND_LETTERS)
    room = NAMES_PART * WIDTH
    names = [
        -(-len(panel.curves) // LEGEND_ROWS)
        * (
            min(room, max(letters.width(_plain(curve.label)) for curve in panel.curves))
            + HANDLE * letters.inches
        )
        for panel in panels
        if len(panel.curves) > 1
    ]
    return max(WIDTH, PANEL_WIDTH + max(names, default=0.0))


def _draw(panel: Panel, axis: "Axes", look: Look | None) -> None:
    from matplotlib import rcParams

    results = 1 + max(curve.result for curve in panel.curves)
    cycle, thickness = list(rcParams["axes.prop_cycle"]), rcParams["lines.linewidth"]
    letters = Letters(LEGEND_LETTERS)
    for curve in panel.curves:
        drawn = style(curve.quantity, curve.result, results, cycle, thickness)
        label = look.in_legend(curve.label) if look else letters.wrapped(curve.label, NAMES_PART * WIDTH)
        axis.plot(curve.x, curve.y, label=shown(label, look), **drawn)
    if look:
        axis.locator_params(nbins=TICKS)
    if panel.same_unit:
        axis.set_aspect("equal", adjustable="datalim")


def _legend(panel: Panel, axis: "Axes", look: Look | None, below: bool, lowest: bool) -> None:
    if look and below:
        columns = look.legend_columns([curve.label for curve in panel.curves])
        # Letters' heights that the numbers of the axis take, and its label.
        room = 4.0 if lowest else 2.0
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=room, ncols=columns)
    elif look:
        # It takes no room of its own: one that is larger than the panel covers curves.
        axis.legend().set_in_layout(False)
    else:
        columns = -(-len(panel.curves) // LEGEND_ROWS)
        axis.legend(fontsize=LEGEND_LETTERS, loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=columns)


def style(
    quantity: int,
    result: int = 0,
    results: int = 1,
    cycle: Sequence[dict[str, Any]] = CYCLE,
    thickness: float = THICKNESS,
) -> dict[str, Any]:
    """Return how the curve of a quantity of one of `results` is drawn: no two alike among 192.

    Properties of the `cycle` distinguish quantities; where it begins anew, and between results, dashes do,
    and beyond these multiples of the `thickness`.
    """
    dashes = result + results * (quantity // len(cycle))
    drawn = dict(cycle[quantity % len(cycle)])
    if dashes:
        drawn["linestyle"] = DASHES[dashes % len(DASHES)]
        drawn["linewidth"] = thickness * THICKNESSES[dashes // len(DASHES) % len(THICKNESSES)]
    return drawn


def shown(text: str, look: Look | None) -> str:
    """Text as matplotlib, or LaTeX, shows it."""
    if look is None or not look.latex:
        return _plain(text)
    return "".join(_LATEX.get(sign, sign) for sign in text)


def _plain(text: str) -> str:
    """Text that matplotlib does not take for mathematics."""
    return text.replace("$", r"\$")
