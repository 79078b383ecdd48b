"""An HTML page on a study: its table of results as pictures that can be turned over, by plotly."""

from typing import Any

import numpy as np

from ..results.figures.report_page import json_text, script_hash, shown_html
from .text import CasesTable

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>body {{ font-family: sans-serif; margin: 1em auto; max-width: 75em; padding: 0 1em }}
.plot {{ width: 100%; height: 30em }} pre {{ overflow-x: auto; background: #f4f4f4; padding: 1em }}</style>
<script>{library}</script></head><body>
<h1>{title}</h1><p>{counts}</p>
<h2>Parallel coordinates</h2><div class="plot" id="parallel"></div>
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


def study_page(cases: CasesTable, study: str, library: str) -> str:
    """Return the page; `study` is the text of the study, `library` that of plotly.js."""
    figures = {"parallel": _parallel(cases)}
    figures |= {f"result{n}": _result(cases, name) for n, name in enumerate(cases.results)}
    places = "".join(f'<div class="plot" id="{name}"></div>' for name in figures if name != "parallel")
    solved = len(next(iter(cases.results.values())))
    counts = f"{solved} cases solved, {cases.failed} failed"
    drawing = DRAWING.format(figures=json_text(figures))
    return PAGE.format(
        policy=POLICY.format(scripts=f"{script_hash(library)} {script_hash(drawing)}"), library=library,
        title=shown_html(f"Study of {cases.deck_name}"), counts=counts, places=places,
        study=shown_html(study), drawing=drawing,
    )  # fmt: skip


def _parallel(cases: CasesTable) -> dict[str, Any]:
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
