"""The part of a page that shows a fit: numbers with their intervals, history, targets and paths."""

from typing import Any

import h5py
import numpy as np

from ..results.figures.report_page import shown_html
from .study_part import StudyPart, place_of, table_html
from .text import EXIT_CODE

GROUP = "fit"


def fit_part(table: h5py.File) -> StudyPart | None:
    """Return what the page shows of the fit in an open table, None of another study."""
    if GROUP not in table:
        return None
    group = table[GROUP]
    figures: dict[str, Any] = {"history": _history(table)}
    text = f"<h2>Numbers</h2>{_numbers(group)}<h2>History</h2>{place_of('history')}"
    targets = group.get("target", {})
    for number, name in enumerate(targets):
        figures[f"target{number}"] = _target(targets[name])
        text += f"<h2>Target {shown_html(name)}</h2>{place_of(f'target{number}')}"
    return StudyPart(text, figures)


def _numbers(group: h5py.Group) -> str:
    columns = (group[name][:] for name in ("value", "standard_error", "low", "high"))
    rows = []
    for name, value, error, low, high in zip(group["number"].asstr()[:], *columns, strict=True):
        interval = f"{low:.9g} to {high:.9g}" if np.isfinite(low) else "none"
        cells = (shown_html(name), f"{value:.12g}", f"{error:.3g}" if np.isfinite(error) else "", interval)
        rows.append(cells)
    return table_html(("number", "value", "standard error", "95 % interval"), rows)


def _history(table: h5py.File) -> dict[str, Any]:
    """The cost of every variant that was solved, and the least so far."""
    solved = table[EXIT_CODE][:] == 0
    case, cost = table["case"][:][solved], table["result/cost"][:][solved]
    least = np.minimum.accumulate(cost).tolist()
    scale = "log" if np.all(cost > 0.0) else "linear"
    dots = {"type": "scatter", "mode": "markers", "x": case.tolist(), "y": cost.tolist(), "name": "variants"}
    line = {"type": "scatter", "mode": "lines", "x": case.tolist(), "y": least, "name": "least so far"}
    axes = {"xaxis": {"title": {"text": "case"}}, "yaxis": {"title": {"text": "cost"}, "type": scale}}
    return {"data": [dots, line], "layout": axes}


def _target(target: h5py.Group) -> dict[str, Any]:
    """A path of two quantities over each other, with equal scales; else each over the time."""
    curve, target_curve = target["curve"][:], target["wanted"][:]
    names = target["quantity"].asstr()[:]
    if curve.shape[1] == 2:
        traces = [_trace("lines", curve[:, 0], curve[:, 1], "motion"),
                  _trace("markers", target_curve[:, 0], target_curve[:, 1], "wanted")]  # fmt: skip
        titles = dict(zip(("xaxis", "yaxis"), names, strict=True))
        layout = {axis: {"title": {"text": shown_html(name)}} for axis, name in titles.items()}
        layout["yaxis"]["scaleanchor"] = "x"  # type: ignore[assignment]
        return {"data": traces, "layout": layout}
    traces = []
    for k in range(curve.shape[1]):
        name = shown_html(names[k])
        traces.append(_trace("lines", target["time"][:], curve[:, k], name))
        traces.append(_trace("markers", target["wanted_time"][:], target_curve[:, k], f"{name}, wanted"))
    return {"data": traces, "layout": {"xaxis": {"title": {"text": "time [s]"}}}}


def _trace(mode: str, x: np.ndarray, y: np.ndarray, name: str) -> dict[str, Any]:
    values = [value if np.isfinite(value) else None for value in y.tolist()]
    return {"type": "scatter", "mode": mode, "x": x.tolist(), "y": values, "name": name}
