"""Rows and state that a run takes over from the resume file of a stopped one, once it fits the run.

A checksum says that the file is as it was written, not that this run wrote it: blocks of values and the
state behind them must have the names, shapes and types that this run gives them, times must ascend and
positions be finite.  Other numbers are taken as they are.
"""

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np

from ..errors import Fault, ModelError
from ..results.hdf5.layout import TIME, Layout
from ..solvers.checkpoint import OtherRun, row_of, taken
from .checkpoint import ResumeFile

POSITION = "body/position"  # finite at singular positions, too, unlike accelerations


def restore(resume_file: ResumeFile, analysis: Any, layout: Layout) -> None:
    """Restore the analysis from the last checkpoint of a resume file whose blocks have the rows of `layout`.

    Raises ModelError where state or blocks are not of this run.
    """
    try:
        checkpoint = resume_file.last_checkpoint
        assert checkpoint is not None, "a run is resumed from a checkpoint"
        analysis.restore(checkpoint)
        shapes = _shapes_of(layout)
        rows, last = 0, -inf
        for values, _ in resume_file.stored():
            rows += _rows_of(values, shapes)
            last = _last_time(values, last)
        if rows != row_of(checkpoint):
            raise OtherRun("row")
    except OtherRun as found:
        message = (
            f"--resume: {resume_file.path} holds {found.args[0]!r} that this run cannot have written; "
            "run without --resume to start anew"
        )
        raise ModelError([Fault("error", message, id="RUN-040")]) from found


def _shapes_of(layout: Layout) -> dict[Any, Any]:
    """Return the shape of a row of every series, by its path."""
    length = {axis.path: len(axis.values) for axis in layout.axes}
    return {item.path: tuple(length[path] for path in item.axes) for item in (TIME, *layout.series)}


def _rows_of(values: Mapping[str, np.ndarray], shapes: Mapping[str, tuple[int, ...]]) -> Any:
    """Return how many rows a block has.  Raises OtherRun."""
    rows = values["time"].size
    for path, shape in shapes.items():
        taken(values, path, (rows, *shape), None)
    return rows


def _last_time(values: Any, last: float) -> float:
    """Return the last time of a block whose times ascend from behind `last`.  Raises OtherRun."""
    times = np.concatenate([[last], values["time"]])
    if not np.all(times[1:] > times[:-1]) or not np.isfinite(times[1:]).all():
        raise OtherRun("time")
    if not np.isfinite(values[POSITION]).all():
        raise OtherRun(POSITION)
    return float(times[-1])
