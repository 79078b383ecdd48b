"""Series of a study as a family of curves: each case over its times, coloured by a parameter."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import h5py
import numpy as np

from ..results.quantities.quantities import ResultError
from .cases_table import CasesTable, cases_table
from .text import EXIT_CODE, StudyColumn, chosen_columns, study_columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..results.figures.look import Look

TIMES = "result/time"
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
    kept = {name: values[chosen] for name, values in cases.parameters.items()}
    cases = CasesTable(cases.deck_name, kept, {}, cases.failed)
    series = {_head(column): table[column.path][solved[chosen]] for column in named}
    return CurveFamily(cases, table[TIMES][solved[chosen]], series)


def family_picture(
    family: CurveFamily,
    form: str,
    title: str,
    look: "Look | None" = None,
    report_missing: Callable[[str], object] = str,
) -> bytes:
    """Return the picture as a file of `form`; `look`, `report_missing`: as of `plots.picture`."""
    from .figures import drawn, label_axis, set_size

    def draw(figure: "Figure") -> None:
        set_size(figure, look, len(family.series))
        axes = figure.subplots(len(family.series), squeeze=False, sharex=True)[:, 0]
        for axis, (label, values) in zip(axes, family.series.items(), strict=True):
            label_axis(axis, "y", label, look)
            axis.grid(True, linewidth=0.4, color="#cccccc")
            _draw_cases(figure, axis, family, values, look)
        label_axis(axes[-1], "x", "time [s]", look)

    return drawn(draw, form, title, look, report_missing)


def _draw_cases(
    figure: "Figure", axis: "Axes", family: CurveFamily, values: np.ndarray, look: "Look | None"
) -> None:
    from matplotlib import rcParams

    from .figures import add_key, colours_of

    name, parameter = next(iter((family.cases.varied or family.cases.parameters).items()))
    colours = colours_of(parameter)
    for times, curve, colour in zip(family.times, values, colours.to_rgba(parameter), strict=True):
        axis.plot(times, curve, color=colour, linewidth=rcParams["lines.linewidth"] if look else 1.0)
    add_key(figure, colours, axis, name, look)


def _named(table: h5py.File, patterns: Iterable[str], file: str) -> list[StudyColumn]:
    named = chosen_columns(study_columns(table), patterns, file)
    return [column for column in named if column.path.startswith("result/")]


def _head(column: StudyColumn) -> str:
    return f"{column.path.partition('/')[2]} [{column.unit}]"
