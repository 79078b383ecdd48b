"""Pictures of a study by matplotlib: curves, families, maps, scatter plots, parallel coordinates."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import h5py
import numpy as np

from ..results.figures.label_fitting import Letters
from ..results.figures.look import COLOURS, GRID, NARROWEST, PANEL, TICKS, Look
from ..results.figures.plots import HEIGHT, WIDTH, figure_bytes, fit_figure, shown
from ..results.figures.report_page import json_text, script_hash, shown_html
from ..results.quantities.quantities import ResultError
from .study_part import StudyPart
from .text import EXIT_CODE, CasesTable, StudyColumn, cases_table, chosen_columns, study_columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


ONLY_ROUND_OFF = "varies by round-off only"
KINDS = ("auto", "curve", "map", "scatter", "parallel")
ROUND_OFF = 1e-10  # of the size of a result: what varies less is no influence of a parameter
MAP_HEIGHT, PARALLEL_HEIGHT = 4.2, 4.0  # in
MOST_LINES = 2000  # of parallel coordinates: more hide each other


def kind_for(cases: CasesTable) -> str:
    """Return the picture that suits: a curve over one parameter, a map over two, else a scatter plot."""
    if len(cases.varied) <= 1:
        return "curve"
    return "map" if cases.is_grid else "scatter"


def study_picture(
    cases: CasesTable,
    kind: str,
    form: str,
    title: str,
    look: Look | None = None,
    report_missing: Callable[[str], object] = str,
) -> bytes:
    """Return the picture as a file of `form`, one of `plots.FORMATS`.  Imports matplotlib.

    `look`, `report_missing`: as of `plots.picture`.  Raises UnsuitedStudy where the study does not
    suit the type, ValueError where letters leave no room in print.
    """
    draw = {"curve": _curves, "map": _maps, "scatter": _scatter, "parallel": _parallel}[kind]
    return drawn(lambda figure: draw(figure, cases, look), form, title, look, report_missing)


class UnsuitedStudy(Exception):
    """A study does not suit a type of picture; the text says why, for the user."""


def drawn(
    draw: Callable[[Any], None],
    form: str,
    title: str,
    look: Look | None = None,
    report_missing: Callable[[str], object] = str,
) -> bytes:
    """Return what `draw` puts on a figure, as a file of `form`."""

    def make() -> "Figure":
        from matplotlib.figure import Figure

        figure = Figure(layout="constrained")
        draw(figure)
        if title or not look:
            figure.suptitle(shown(title, look))
        if look:
            fit_figure(figure, look)
        return figure

    return figure_bytes(make, form, look, report_missing)


def set_size(
    figure: "Figure", look: Look | None, panels: int, height: float = HEIGHT, width: float = WIDTH
) -> None:
    """Give the figure its size: on a screen that of `panels` of a height, in; in print the width on paper."""
    if look is None:
        figure.set_size_inches(width, height * panels + 0.5)
        return
    part = PANEL * max(1.0, height / HEIGHT)
    figure.set_size_inches(look.inches, look.inches * part * panels + 0.3)


def label_axis(axis: "Axes", which: Literal["x", "y"], label: str, look: Look | None) -> None:
    """Write the label of the axis "x" or "y".

    In print it is wrapped, and there are fewer ticks.
    """
    axis.set(**{f"{which}label": _label(label, look) if which == "y" else shown(label, look)})
    if look:
        axis.locator_params(axis=which, nbins=TICKS)


def _label(label: str, look: Look | None) -> str:
    """Return a vertical label, in print in lines that are no longer than a panel is high."""
    if look is None:
        return shown(label, look)
    return Letters("axes.labelsize").wrapped(label, PANEL * look.inches, partial(shown, look=look))


def _thickness(width: float, look: Look | None) -> dict[str, Any]:
    """Return the width of curves on a screen; in print that of the look, or of its style file."""
    return {} if look else {"linewidth": width}


def _curves(figure: "Figure", cases: CasesTable, look: Look | None) -> None:
    """Each result over the one parameter that varies."""
    if len(cases.varied) > 1:
        names = ", ".join(cases.varied)
        raise UnsuitedStudy(
            f"a curve needs one parameter that varies, these do: {names}; take --kind scatter"
        )
    name, x = next(iter((cases.varied or cases.parameters).items()))
    order = np.argsort(x, kind="stable")
    set_size(figure, look, len(cases.results))
    axes = figure.subplots(len(cases.results), squeeze=False, sharex=True)[:, 0]
    for axis, (label, values) in zip(axes, cases.results.items(), strict=True):
        axis.plot(x[order], values[order], color=COLOURS[0], marker=".", **_thickness(1.3, look))
        label_axis(axis, "y", label, look)
        if (flat := flat_range(values)) is not None:
            axis.set_ylim(*flat)
            axis.set_title(ONLY_ROUND_OFF, fontsize="small")
        axis.grid(True, **GRID)
    label_axis(axes[-1], "x", name, look)


def _maps(figure: "Figure", cases: CasesTable, look: Look | None) -> None:
    """Each result over two parameters, a cell for every pair of values."""
    if not cases.is_grid:
        raise UnsuitedStudy(
            "a map needs two parameters with every pair of values solved; take --kind scatter"
        )
    (x_name, x), (y_name, y) = cases.varied.items()
    columns, rows = np.unique(x), np.unique(y)
    place = np.searchsorted(rows, y), np.searchsorted(columns, x)
    set_size(figure, look, len(cases.results), MAP_HEIGHT)
    axes = figure.subplots(len(cases.results), squeeze=False)[:, 0]
    for axis, (label, values) in zip(axes, cases.results.items(), strict=True):
        cells = np.full((rows.size, columns.size), np.nan)
        cells[place] = values
        drawn_cells = axis.pcolormesh(
            columns, rows, cells, shading="nearest", cmap="viridis", rasterized=True
        )
        if (flat := flat_range(values)) is not None:
            drawn_cells.set_clim(*flat)
            axis.set_title(ONLY_ROUND_OFF, fontsize="small")
        add_key(figure, drawn_cells, axis, label, look)
        label_axis(axis, "x", x_name, look)
        label_axis(axis, "y", y_name, look)


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


def _scatter(figure: "Figure", cases: CasesTable, look: Look | None) -> None:
    """Each result over each parameter that varies."""
    across = cases.varied or cases.parameters
    set_size(figure, look, len(cases.results), width=max(WIDTH, 3.0 * len(across)))
    grid = figure.subplots(len(cases.results), len(across), squeeze=False, sharex="col", sharey="row")
    for row, (label, values) in enumerate(cases.results.items()):
        for column, (name, x) in enumerate(across.items()):
            axis = grid[row, column]
            axis.plot(x, values, ".", color=COLOURS[0], markersize=3, rasterized=len(x) > MOST_LINES)
            axis.grid(True, **GRID)
            if (flat := flat_range(values)) is not None:
                axis.set_ylim(*flat)
                axis.set_title(ONLY_ROUND_OFF, fontsize="small")
            if column == 0:
                label_axis(axis, "y", label, look)
            if row == len(cases.results) - 1:
                label_axis(axis, "x", name, look)


def _parallel(figure: "Figure", cases: CasesTable, look: Look | None) -> None:
    """A line for every case through its parameters and results, coloured by the last result."""
    axes = {**(cases.varied or cases.parameters), **cases.results}
    last = next(reversed(cases.results))
    chosen = np.unique(np.linspace(0, len(cases.results[last]) - 1, MOST_LINES).astype(int))
    scaled = np.column_stack([_scaled(values)[chosen] for values in axes.values()])
    set_size(figure, look, 1, PARALLEL_HEIGHT, max(WIDTH, 1.8 * len(axes)))
    axis = figure.subplots()
    colours = colours_of(cases.results[last])
    for line, colour in zip(scaled, colours.to_rgba(cases.results[last][chosen]), strict=True):
        axis.plot(range(len(axes)), line, color=colour, alpha=0.7, **_thickness(0.8, look))
    labels = [_axis_label(name, values, len(axes), look) for name, values in axes.items()]
    axis.set_xticks(range(len(axes)), labels, fontsize="small")
    axis.set_yticks([])
    axis.grid(True, axis="x", linewidth=0.8, color="#888888")
    add_key(figure, colours, axis, last, look)


def colours_of(values: np.ndarray) -> Any:
    """Return the colours of values from the least to the largest, as matplotlib wants them for a key."""
    import matplotlib
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    return ScalarMappable(Normalize(np.nanmin(values), np.nanmax(values)), matplotlib.colormaps["viridis"])


def add_key(figure: "Figure", colours: Any, axis: "Axes", label: str, look: Look | None) -> None:
    """Put a scale of the colours beside `axis`."""
    figure.colorbar(colours, ax=axis, label=_label(label, look))


def _axis_label(name: str, values: np.ndarray, axes: int, look: Look | None) -> str:
    """Return name and range below an axis of parallel coordinates, in print no wider than its share."""
    lines = [name, f"{values.min():.4g} to {values.max():.4g}"]
    if look:
        letters = Letters("xtick.labelsize")
        lines = [letters.wrapped(line, NARROWEST * look.inches / axes) for line in lines]
    return shown("\n".join(lines), look)


def _scaled(values: np.ndarray) -> np.ndarray:
    low, high = np.nanmin(values), np.nanmax(values)
    return (values - low) / (high - low) if high > low else np.full(values.shape, 0.5)


TIMES = "result/time"
DASHES = ("-", "--", ":", "-.")  # for the values of the second parameter, if they are so few
MOST_CASE_CURVES = 500  # evenly chosen of more cases: further ones hide each other


@dataclass(frozen=True)
class CurveFamily:
    """Series by their headings, arrays (cases, rows), over `times` (cases, rows), and the solved cases."""

    cases: CasesTable
    times: np.ndarray
    series: dict[str, np.ndarray]


def names_series(table: h5py.File, patterns: Iterable[str], file: str) -> bool:
    """Return whether `patterns` name series of cases only."""
    patterns = list(patterns)
    named = _named(table, patterns, file) if patterns else []
    return bool(named) and all(column.length for column in named)


def curve_family(table: h5py.File, patterns: Iterable[str], file: str) -> CurveFamily:
    """Return the series that `patterns` name; raises ResultError where times or solved cases are missing."""
    if TIMES not in table:
        raise ResultError(file, "its series have no times: solve the study again", id="STUDY-027")
    named = _named(table, patterns, file)
    solved = np.flatnonzero(table[EXIT_CODE][:] == 0)
    cases = cases_table(table, (), file, with_results=False)
    chosen = np.unique(np.linspace(0, len(solved) - 1, min(MOST_CASE_CURVES, len(solved))).astype(int))
    parameters = {name: values[chosen] for name, values in cases.parameters.items()}
    cases = CasesTable(cases.deck_name, parameters, {}, cases.failed)
    series = {column.label: table[column.path][solved[chosen]] for column in named}
    return CurveFamily(cases, table[TIMES][solved[chosen]], series)


def family_picture(
    family: CurveFamily,
    form: str,
    title: str,
    look: Look | None = None,
    report_missing: Callable[[str], object] = str,
) -> bytes:
    """Return the picture as a file of `form`; `look`, `report_missing`: as of `plots.picture`."""

    def draw(figure: "Figure") -> None:
        set_size(figure, look, len(family.series))
        axes = figure.subplots(len(family.series), squeeze=False, sharex=True)[:, 0]
        for axis, (label, values) in zip(axes, family.series.items(), strict=True):
            label_axis(axis, "y", label, look)
            axis.grid(True, **GRID)
            _draw_cases(figure, axis, family, values, look)
        label_axis(axes[-1], "x", "time [s]", look)

    return drawn(draw, form, title, look, report_missing)


def _draw_cases(
    figure: "Figure", axis: "Axes", family: CurveFamily, values: np.ndarray, look: Look | None
) -> None:
    from matplotlib import rcParams

    (name, parameter), *others = (family.cases.varied or family.cases.parameters).items()
    colours, width = colours_of(parameter), rcParams["lines.linewidth"] if look else 1.0
    second, dashes = others[0] if others else ("", np.zeros_like(parameter))
    sizes, style = np.unique(dashes, return_inverse=True)
    told_apart = 1 < sizes.size <= len(DASHES)
    curves = zip(family.times, values, colours.to_rgba(parameter), style, strict=True)
    for times, curve, colour, dash in curves:
        axis.plot(times, curve, DASHES[dash if told_apart else 0], color=colour, linewidth=width)
    if told_apart:
        for size, dash in zip(sizes, DASHES, strict=False):
            axis.plot(
                [], [], dash, color="black", linewidth=width, label=shown(f"{second} = {size:.4g}", look)
            )
        axis.legend(fontsize="small")
    add_key(figure, colours, axis, name, look)


def _named(table: h5py.File, patterns: Iterable[str], file: str) -> list[StudyColumn]:
    named = chosen_columns(study_columns(table), patterns, file)
    return [column for column in named if column.path.startswith("result/")]


PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>body {{ font-family: sans-serif; margin: 1em auto; max-width: 75em; padding: 0 1em }}
.plot {{ width: 100%; height: 30em }} pre {{ overflow-x: auto; background: #f4f4f4; padding: 1em }}</style>
<script>{library}</script></head><body>
<h1>{title}</h1><p>{counts}</p>
{part}<h2>Parallel coordinates</h2><div class="plot" id="parallel"></div>
<h2>Results</h2>{places}
<h2>Study</h2><pre>{study}</pre>
<script>{drawing}</script></body></html>
"""
DRAWING = """const figures = {figures};
for (const [place, figure] of Object.entries(figures))
  Plotly.newPlot(place, figure.data, figure.layout, {{responsive: true, displaylogo: false}});
"""
# Plotly sets styles of elements, draws parallel coordinates with functions that it composes of its own text
# ('unsafe-eval'), and hands the picture that a reader saves to the browser as data: or blob:.  It needs no
# network; a form, which default-src leaves free, could send the numbers to its makers.
POLICY = (
    "default-src 'none'; script-src {scripts} 'unsafe-eval'; style-src 'unsafe-inline'; "
    "img-src data: blob:; form-action 'none'; base-uri 'none'"
)


def study_page(cases: CasesTable, study: str, library: str, part: StudyPart | None = None) -> str:
    """Return the page; `study`: text of the study, `library`: plotly.js, `part`: of a fit or tolerances."""
    figures = {"parallel": _parallel_data(cases)} | (part.figures if part else {})
    figures |= {f"result{n}": _result(cases, name) for n, name in enumerate(cases.results)}
    places = "".join(f'<div class="plot" id="{name}"></div>' for name in figures if name.startswith("result"))
    solved = len(next(iter(cases.results.values())))
    counts = f"{solved} cases solved, {cases.failed} failed"
    drawing = DRAWING.format(figures=json_text(figures))
    return PAGE.format(
        policy=POLICY.format(scripts=f"{script_hash(library)} {script_hash(drawing)}"), library=library,
        title=shown_html(f"Study of {cases.deck_name}"), counts=counts, places=places,
        study=shown_html(study), drawing=drawing, part=part.text if part else "",
    )  # fmt: skip


def _parallel_data(cases: CasesTable) -> dict[str, Any]:
    columns = {**(cases.varied or cases.parameters), **cases.results}
    last = next(reversed(cases.results))
    dimensions = [{"label": shown_html(name), "values": _list(values)} for name, values in columns.items()]
    line = {"color": _list(cases.results[last]), "colorscale": "Viridis"}
    return {"data": [{"type": "parcoords", "dimensions": dimensions, "line": line}], "layout": {}}


def _result(cases: CasesTable, name: str) -> dict[str, Any]:
    """A curve over one parameter, else points over the first two, coloured by the result."""
    across = list((cases.varied or cases.parameters).items())
    values = _list(cases.results[name])
    layout: dict[str, Any] = {"title": {"text": shown_html(name)}}
    layout["xaxis"] = {"title": {"text": shown_html(across[0][0])}}
    trace: dict[str, Any] = {"type": "scatter", "mode": "markers", "x": _list(across[0][1]), "y": values}
    if len(across) == 1:
        order = np.argsort(across[0][1], kind="stable")
        trace |= {"mode": "lines+markers", "x": _list(across[0][1][order])}
        trace["y"] = _list(cases.results[name][order])
    else:
        marker = {"color": values, "colorscale": "Viridis", "showscale": True}
        trace |= {"y": _list(across[1][1]), "text": [f"{value:.6g}" for value in cases.results[name]]}
        trace |= {"marker": marker}
        layout["yaxis"] = {"title": {"text": shown_html(across[1][0])}}
    return {"data": [trace], "layout": layout}


def _list(values: np.ndarray) -> list[float | None]:
    return [value if np.isfinite(value) else None for value in values.tolist()]
