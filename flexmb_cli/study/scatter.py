"""Scatter of a study's results by the tolerances of its parameters: by its sample and by sensitivities.

A sample is even between the ends of the ranges, so that the standard deviation of a number is the length of
its range over √12.  To first order σ² of a result is the sum of (∂r/∂p σ_p)² over the numbers.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from ..errors import DONE
from ..results.figures.look import Look
from ..results.figures.plots import HEIGHT, shown
from ..results.figures.report_page import shown_html
from .figures import UnsuitedStudy, drawn, label_axis, set_size
from .repeated_motion import RepeatedMotion
from .solver import CaseResult, CaseSolver
from .study import SERIES, Varied
from .study_part import StudyPart, place_of, table_html
from .table import Column

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GROUP = "scatter"
LEAST_NAMED = 0.005  # share of a number that is named in a line


@dataclass(frozen=True)
class Scatter:
    """Results `names` with their `units`, in the middle of all ranges; their `mean` in the sample.

    `linear`, `sampled`: standard deviations by sensitivities and of the sample; all (results,).
    `derivatives`, `shares` (results, numbers): by the `numbers`, and what each adds to linear².
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    numbers: tuple[str, ...]
    nominal: np.ndarray
    mean: np.ndarray
    linear: np.ndarray
    sampled: np.ndarray
    derivatives: np.ndarray
    shares: np.ndarray

    def ranked(self, k: int) -> list[tuple[str, float]]:
        """Return numbers and shares of result k, the largest first."""
        pairs = zip(self.numbers, self.shares[k].tolist(), strict=True)
        return sorted(pairs, key=lambda pair: -pair[1])

    def lines(self) -> Iterator[str]:
        """Yield a line for each result."""
        for k, (name, unit) in enumerate(zip(self.names, self.units, strict=True)):
            ranked = [f"{number} {share:.1%}" for number, share in self.ranked(k) if share > LEAST_NAMED]
            value = f"{self.nominal[k]:.9g}" + ("" if unit == "1" else f" {unit}")
            both = f"σ {self.linear[k]:.4g} by sensitivities, {self.sampled[k]:.4g} of the sample"
            yield f"{name} = {value}; {both}" + (f"; {', '.join(ranked)}" if ranked else "")

    def record(self) -> list[dict[str, Any]]:
        """Return a record for each result, for `--json`."""
        columns = {name: getattr(self, name).tolist() for name in ("nominal", "mean", "linear", "sampled")}
        return [
            {"result": name, "unit": self.units[k], "shares": dict(self.ranked(k))}
            | {key: values[k] for key, values in columns.items()}
            for k, name in enumerate(self.names)
        ]

    def datasets(self) -> list[tuple[Column, Any]]:
        """Return what the group `scatter` of the table holds."""
        texts = (("result", "names of the results"), ("number", "names of the numbers"))
        values = ("nominal", "in the middle of the ranges"), ("mean", "of the sample")
        deviations = ("linear", "standard deviation by sensitivities"), ("sampled", "that of the sample")
        matrices = ("derivatives", "of results by numbers"), ("shares", "of numbers in the square of linear")
        words = zip(texts, (list(self.names), list(self.numbers)), strict=True)
        return [
            *((Column(f"{GROUP}/{name}", "", what), names) for (name, what), names in words),
            *(
                (Column(f"{GROUP}/{name}", "1", what), getattr(self, name))
                for name, what in (*values, *deviations, *matrices)
            ),
        ]


def scatter_of(solver: CaseSolver, cases: Sequence[CaseResult]) -> Scatter | None:
    """Return the scatter of a study's results that are one number, None if no parameter has a tolerance.

    cases: those of the sample; failed ones are left out.  Raises FlexmbError if the middle of the ranges
    cannot be solved.
    """
    study = solver.study
    varied = [(k, item) for k, item in enumerate(study.parameters) if len(item.values) > 1]
    if not any(item.tolerance for _, item in varied):
        return None
    pairs = zip(study.results, solver.quantities, strict=True)
    single = [(item.name, quantity.unit) for item, quantity in pairs if item.take != SERIES]
    motion = RepeatedMotion(solver, [_middle(item) for item in study.parameters])
    deviations = np.array([_deviation(item) for _, item in varied])
    scales = np.maximum(np.abs([_middle(item) for _, item in varied]), deviations)
    places = (k for k, _ in varied)
    derivatives = np.column_stack([motion.derivatives(k, s) for k, s in zip(places, scales, strict=True)])
    parts = (derivatives * deviations) ** 2
    total = parts.sum(axis=1, keepdims=True)
    sample = np.array([case.values for case in cases if case.exit_code == DONE]).reshape(-1, len(single))
    shares = np.divide(parts, total, out=np.zeros_like(parts), where=total > 0.0)
    few = np.full(len(single), np.nan)
    return Scatter(
        tuple(name for name, _ in single), tuple(unit for _, unit in single),
        tuple(item.name for _, item in varied), motion.case.values,
        sample.mean(axis=0) if len(sample) else few, np.sqrt(total[:, 0]),
        sample.std(axis=0, ddof=1) if len(sample) > 1 else few, derivatives, shares,
    )  # fmt: skip


def _middle(item: Varied) -> float:
    if not item.values:
        return np.nan  # of a formula
    low, high = item.values[0], item.values[-1]
    return float(np.sqrt(low * high)) if item.logarithmic else 0.5 * (low + high)


def _deviation(item: Varied) -> float:
    low, high = item.values
    length = _middle(item) * np.log(high / low) if item.logarithmic else high - low
    return abs(float(length)) / float(np.sqrt(12.0))


def shares_picture(
    table: h5py.File, form: str, title: str, look: Look | None, report_missing: Callable[[str], object]
) -> bytes:
    """Return the shares of the numbers in σ² of every result as a file of `form`; arguments as `drawn`.

    Raises UnsuitedStudy if the study has no tolerances.
    """
    if GROUP not in table:
        raise UnsuitedStudy("no parameter of the study has a tolerance")
    results, numbers = (table[GROUP][name].asstr()[:].tolist() for name in ("result", "number"))
    shares = table[GROUP]["shares"][:]

    def draw(figure: "Figure") -> None:
        set_size(figure, look, 1, height=max(HEIGHT, 0.4 * len(results)))
        axis, left = figure.subplots(), np.zeros(len(results))
        for k, number in enumerate(numbers):
            label = shown(number, look)
            axis.barh([shown(name, look) for name in results], shares[:, k], left=left, label=label)
            left += shares[:, k]
        axis.invert_yaxis()
        label_axis(axis, "x", "share of σ²", look)
        axis.legend(fontsize="small")

    return drawn(draw, form, title, look, report_missing)


def scatter_part(table: h5py.File) -> StudyPart | None:
    """Return what the page shows of the scatter in an open table, None if it has none."""
    if GROUP not in table:
        return None
    group = table[GROUP]
    results, numbers = (group[name].asstr()[:].tolist() for name in ("result", "number"))
    columns = [group[name][:] for name in ("nominal", "mean", "linear", "sampled")]
    heads = ("result", "nominal", "mean", "σ by sensitivities", "σ of the sample")
    rows = [
        (shown_html(name), *(f"{value:.9g}" for value in values))
        for name, *values in zip(results, *columns, strict=True)
    ]
    text = f"<h2>Scatter by tolerances</h2>{table_html(heads, rows)}{place_of('shares')}"
    bars = [
        {"type": "bar", "name": shown_html(number), "x": [shown_html(name) for name in results],
         "y": share.tolist()}
        for number, share in zip(numbers, group["shares"][:].T, strict=True)
    ]  # fmt: skip
    layout = {"barmode": "stack", "yaxis": {"title": {"text": "share of σ²"}}}
    return StudyPart(text, {"shares": {"data": bars, "layout": layout}})
