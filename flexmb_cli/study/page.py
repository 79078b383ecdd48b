"""An HTML page on a study: its table of results as pictures that can be turned over, by plotly."""

import html
import json
from typing import Any

import numpy as np

from .cases_table import CasesTable

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>body {{ font-family: sans-serif; margin: 1em auto; max-width: 75em; padding: 0 1em }}
.plot {{ width: 100%; height: 30em }} pre {{ overflow-x: auto; background: #f4f4f4; padding: 1em }}</style>
<script>{library}</script></head><body>
<h1>{title}</h1><p>{counts}</p>
<h2>Parallel coordinates</h2><div class="plot" id="parallel"></div>
<h2>Results</h2>{places}
<h2>Study</h2><pre>{study}</pre>
<script>const figures = {figures};
for (const [place, figure] of Object.entries(figures))
  Plotly.newPlot(place, figure.data, figure.layout, {{responsive: true, displaylogo: false}});
</script></body></html>
"""


def study_page(cases: CasesTable, study: str, library: str) -> str:
    """Return the page; `study` is the text of the study, `library` that of plotly.js."""
    figures = {"parallel": _parallel(cases)}
    figures |= {f"result{n}": _result(cases, name) for n, name in enumerate(cases.results)}
    places = "".join(f'<div class="plot" id="{name}"></div>' for name in figures if name != "parallel")
    solved = len(next(iter(cases.results.values())))
    counts = f"{solved} cases solved, {cases.failed} failed"
    return PAGE.format(
        title=html.escape(f"Study of {cases.deck_name}"), counts=counts, places=places, library=library,
        study=html.escape(study), figures=json.dumps(figures).replace("</", "<\\/"),
    )  # fmt: skip


def _parallel(cases: Any) -> "dict[str, list[dict[str, dict[Any, Any] | list[Any] | str]]]":
    columns = {**(cases.varied or cases.parameters), **cases.results}
    last = next(reversed(cases.results))
    dimensions = [{"label": html.escape(name), "values": _list(values)} for name, values in columns.items()]
    line = {"color": _list(cases.results[last]), "colorscale": "Viridis"}
    return {"data": [{"type": "parcoords", "dimensions": dimensions, "line": line}], "layout": {}}  # type: ignore[dict-item]


def _result(cases: Any, name: Any) -> Any:
    """A curve over one parameter, else points over the first two, coloured by the result."""
    across = list((cases.varied or cases.parameters).items())
    values = _list(cases.results[name])
    layout = {"title": {"text": html.escape(name)}, "xaxis": {"title": {"text": html.escape(across[0][0])}}}
    trace = {"type": "scatter", "mode": "markers", "x": _list(across[0][1]), "y": values}
    if len(across) == 1:
        order = np.argsort(across[0][1], kind="stable")
        trace |= {"mode": "lines+markers", "x": _list(across[0][1][order])}
        trace["y"] = _list(cases.results[name][order])
    else:
        marker = {"color": values, "colorscale": "Viridis", "showscale": True}
        trace |= {"y": _list(across[1][1]), "text": [f"{value:.6g}" for value in cases.results[name]]}
        trace |= {"marker": marker}
        layout["yaxis"] = {"title": {"text": html.escape(across[1][0])}}
    return {"data": [trace], "layout": layout}


def _list(values: np.ndarray) -> Any:
    return [value if np.isfinite(value) else None for value in values.tolist()]
