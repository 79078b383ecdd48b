"""The numbers of a study's table: parameters, results and which cases were solved."""

from collections.abc import Iterable
from dataclasses import dataclass

import h5py
import numpy as np

from ..results.quantities.quantities import ResultError
from .text import EXIT_CODE, StudyColumn, chosen_columns, study_columns


@dataclass(frozen=True)
class CasesTable:
    """Solved cases by columns, which are arrays (cases,): `parameters` and `results` by their headings."""

    deck_name: str
    parameters: dict[str, np.ndarray]
    results: dict[str, np.ndarray]
    failed: int

    @property
    def varied(self) -> dict[str, np.ndarray]:
        """The parameters with more than one value."""
        return {name: values for name, values in self.parameters.items() if np.unique(values).size > 1}

    @property
    def is_grid(self) -> bool:
        """Return whether two parameters vary and every pair of their values was solved once."""
        axes = list(self.varied.values())
        if len(axes) != 2:
            return False
        pairs = np.unique(np.column_stack(axes), axis=0)
        sizes = [np.unique(axis).size for axis in axes]
        return len(pairs) == len(axes[0]) == sizes[0] * sizes[1]


def cases_table(
    table: h5py.File, patterns: Iterable[str], file: str, with_results: bool = True
) -> CasesTable:
    """Return the solved cases of an open study; `patterns` choose results, without any all single numbers.

    Raises ResultError for a pattern that names none, a series, and a study without a solved case.
    """
    columns = study_columns(table)
    wanted = [column for column in chosen_columns(columns, patterns, file) if _is(column, "result")]
    series = [column.name for column in wanted if column.length]
    if with_results and (series or not wanted):
        message = (
            f"{series[0]} is a series of each case: draw it alone"
            if series
            else "no result with one number is named"
        )
        raise ResultError(file, f"{message}; name results that are one number a case", id="STUDY-004")
    solved = table[EXIT_CODE][:] == 0
    if not solved.any():
        raise ResultError(file, "nothing to draw: no case was solved", id="STUDY-019")
    parameters = [column for column in columns if _is(column, "parameter")]
    return CasesTable(
        table.attrs["deck_name"],
        {_head(column): table[column.path][:][solved] for column in parameters},
        {_head(column): table[column.path][:][solved] for column in wanted if with_results},
        int((~solved).sum()),
    )


def _is(column: StudyColumn, group: str) -> bool:
    return column.path.startswith(f"{group}/")


def _head(column: StudyColumn) -> str:
    return f"{column.path.partition('/')[2]} [{column.unit}]"
