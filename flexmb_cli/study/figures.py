"""Pictures of a study by matplotlib: curves, maps, scatter plots, parallel coordinates."""

import io
from collections.abc import Callable
from typing import Any

import numpy as np

from ..results.figures.look import COLOURS
from ..results.figures.plots import HEIGHT, METADATA, RESOLUTION, WIDTH
from .cases_table import CasesTable

ONLY_ROUND_OFF = "varies by round-off only"
KINDS = ("auto", "curve", "map", "scatter", "parallel")
ROUND_OFF = 1e-10  # of the size of a result: what varies less is no influence of a parameter
MOST_LINES = 2000  # of parallel coordinates: more hide each other


def kind_for(cases: CasesTable) -> str:
    """Return the picture that suits: a curve over one parameter, a map over two, else a scatter plot."""
    if len(cases.varied) <= 1:
        return "curve"
    return "map" if cases.is_grid else "scatter"


def study_picture(cases: CasesTable, kind: str, form: str, title: str) -> bytes:
    """Return the picture as a file of `form`, one of `plots.FORMATS`.  Imports matplotlib.

    Raises ValueError, in words for the user, where the study does not suit the kind.
    """
    draw = {"curve": _curves, "map": _maps, "scatter": _scatter, "parallel": _parallel}[kind]
    return drawn(lambda figure: draw(figure, cases), form, title)


def drawn(draw: Callable[..., Any], form: str, title: str) -> bytes:
    """Return what `draw` puts on a figure, as a file of `form`."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "flexmb"
        figure = Figure(layout="constrained")
        draw(figure)
        figure.suptitle(title.replace("$", r"\$"))
        stream = io.BytesIO()
        figure.savefig(stream, format=form, dpi=RESOLUTION, metadata=METADATA[form])
    return stream.getvalue()


def _curves(figure: Any, cases: CasesTable) -> None:
    """Each result over the one parameter that varies."""
    if len(cases.varied) > 1:
        names = ", ".join(cases.varied)
        raise ValueError(f"a curve needs one parameter that varies, these do: {names}; take --kind scatter")
    name, x = next(iter((cases.varied or cases.parameters).items()))
    order = np.argsort(x, kind="stable")
    figure.set_size_inches(WIDTH, HEIGHT * len(cases.results) + 0.5)
    axes = figure.subplots(len(cases.results), squeeze=False, sharex=True)[:, 0]
    for axis, (label, values) in zip(axes, cases.results.items(), strict=True):
        axis.plot(x[order], values[order], color=COLOURS[0], marker=".", linewidth=1.3)
        axis.set_ylabel(_plain(label))
        if (flat := flat_range(values)) is not None:
            axis.set_ylim(*flat)
            axis.set_title(ONLY_ROUND_OFF, fontsize="small")
        axis.grid(True, linewidth=0.4, color="#cccccc")
    axes[-1].set_xlabel(_plain(name))


def _maps(figure: Any, cases: CasesTable) -> None:
    """Each result over two parameters, a cell for every pair of values."""
    if not cases.is_grid:
        raise ValueError("a map needs two parameters with every pair of values solved; take --kind scatter")
    (x_name, x), (y_name, y) = cases.varied.items()
    columns, rows = np.unique(x), np.unique(y)
    place = np.searchsorted(rows, y), np.searchsorted(columns, x)
    figure.set_size_inches(WIDTH, 4.2 * len(cases.results) + 0.5)
    axes = figure.subplots(len(cases.results), squeeze=False)[:, 0]
    for axis, (label, values) in zip(axes, cases.results.items(), strict=True):
        cells = np.full((rows.size, columns.size), np.nan)
        cells[place] = values
        drawn = axis.pcolormesh(columns, rows, cells, shading="nearest", cmap="viridis", rasterized=True)
        if (flat := flat_range(values)) is not None:
            drawn.set_clim(*flat)
            axis.set_title(ONLY_ROUND_OFF, fontsize="small")
        figure.colorbar(drawn, ax=axis, label=_plain(label))
        axis.set_xlabel(_plain(x_name))
        axis.set_ylabel(_plain(y_name))


def flat_range(values: np.ndarray) -> tuple[float, float] | None:
    """Return limits in which a result that varies by round-off only is flat; None where it varies more."""
    finite = values[np.isfinite(values)]
    if finite.size < 2:
        return None
    low, high = float(finite.min()), float(finite.max())
    size = max(abs(low), abs(high))
    if not 0 < high - low <= ROUND_OFF * size:
        return None
    return low - 0.05 * size, high + 0.05 * size


def _scatter(figure: Any, cases: CasesTable) -> None:
    """Each result over each parameter that varies."""
    across = cases.varied or cases.parameters
    figure.set_size_inches(max(WIDTH, 3.0 * len(across)), HEIGHT * len(cases.results) + 0.5)
    grid = figure.subplots(len(cases.results), len(across), squeeze=False, sharex="col", sharey="row")
    for row, (label, values) in enumerate(cases.results.items()):
        for column, (name, x) in enumerate(across.items()):
            axis = grid[row, column]
            axis.plot(x, values, ".", color=COLOURS[0], markersize=3, rasterized=len(x) > MOST_LINES)
            axis.grid(True, linewidth=0.4, color="#cccccc")
            if (flat := flat_range(values)) is not None:
                axis.set_ylim(*flat)
                axis.set_title(ONLY_ROUND_OFF, fontsize="small")
            if column == 0:
                axis.set_ylabel(_plain(label))
            if row == len(cases.results) - 1:
                axis.set_xlabel(_plain(name))


def _parallel(figure: Any, cases: CasesTable) -> None:
    """A line for every case through its parameters and results, coloured by the last result."""
    axes = {**(cases.varied or cases.parameters), **cases.results}
    last = next(reversed(cases.results))
    chosen = np.unique(np.linspace(0, len(cases.results[last]) - 1, MOST_LINES).astype(int))
    scaled = np.column_stack([_scaled(values)[chosen] for values in axes.values()])
    figure.set_size_inches(max(WIDTH, 1.8 * len(axes)), 4.5)
    axis = figure.subplots()
    import matplotlib

    colours = matplotlib.colormaps["viridis"](scaled[:, -1])
    for line, colour in zip(scaled, colours, strict=True):
        axis.plot(range(len(axes)), line, color=colour, linewidth=0.8, alpha=0.7)
    labels = [f"{_plain(name)}\n{values.min():.4g} to {values.max():.4g}" for name, values in axes.items()]
    axis.set_xticks(range(len(axes)), labels, fontsize="small")
    axis.set_yticks([])
    axis.grid(True, axis="x", linewidth=0.8, color="#888888")


def _scaled(values: np.ndarray) -> np.ndarray:
    low, high = np.nanmin(values), np.nanmax(values)
    return (values - low) / (high - low) if high > low else np.full(values.shape, 0.5)


def _plain(text: str) -> str:
    """Text that matplotlib does not take for mathematics."""
    return text.replace("$", r"\$")
