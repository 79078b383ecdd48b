"""Rows and state that a run takes over from the resume file of a stopped one, once it fits the run.

A checksum says that the file is as it was written, not that this run wrote it: blocks of values and the
state after them must have the names, shapes and types that this run gives them, times must ascend and
positions be finite.  The analysis checks what its kernels use as places and counts.  Other numbers are
taken as they are.
"""

from collections.abc import Iterator, Mapping
from math import inf, prod
from typing import Any

import numpy as np

from ..errors import Fault, ModelError, OutputError
from ..results.hdf5.layout import TIME, Layout
from ..solvers.checkpoint import OtherRun, row_of, taken
from .checkpoint import LARGEST_ENTRY, ResumeFile

ROWS_AT_ONCE = 1024  # of a block of any analysis, at most
POSITION = "body/position"  # finite at singular positions, too, unlike accelerations


def largest_entry(layout: Layout) -> int:
    """Return how many bytes an entry has at most: a block of rows, and matrices of the numbers of a row."""
    width = int(sum(prod(shape) for shape in _shapes_of(layout).values()))
    # Radau's method keeps most: three numbers for a pair of coordinates or equations, 14 MB of a VSDF chain
    # of 60 bodies, for which 211 MB are allowed here.
    return LARGEST_ENTRY + 8 * width * (ROWS_AT_ONCE + 4 * width)


def restore(resume_file: ResumeFile, analysis: Any, layout: Layout) -> None:
    """Restore the analysis from the last checkpoint of a resume file whose blocks have the rows of `layout`.

    Raises ModelError where state or blocks are not of this run.
    """
    try:
        checkpoint = resume_file.last_checkpoint
        assert checkpoint is not None, "a run is resumed from a checkpoint"
        analysis.restore(checkpoint)
        for _ in _checked_blocks(resume_file, layout):
            pass
    except OtherRun as found:
        message = (
            f"--resume: {resume_file.path} holds {found.args[0]!r} that this run cannot have written; "
            "run without --resume to start again"
        )
        raise ModelError([Fault("error", message, id="RUN-040")]) from found


def stored_blocks(resume_file: ResumeFile, layout: Layout) -> Iterator[Mapping[str, np.ndarray]]:
    """Yield the blocks of a resume file that `restore` has read, checked once more.

    Raises OutputError: whoever owns the file may change it in between.
    """
    try:
        yield from _checked_blocks(resume_file, layout)
    except OtherRun as found:
        message = f"{resume_file.path}: another program changed it while it was read; run again"
        raise OutputError(message, id="RUN-068") from found


def _checked_blocks(resume_file: ResumeFile, layout: Layout) -> Iterator[Mapping[str, np.ndarray]]:
    """Yield the blocks, which are of this run; raises OtherRun, at the end where rows are missing."""
    checkpoint = resume_file.last_checkpoint
    assert checkpoint is not None, "a run is resumed from a checkpoint"
    shapes, rows, last = _shapes_of(layout), 0, -inf
    for values, _ in resume_file.stored():
        rows += _rows_of(values, shapes)
        last = _last_time(values, last)
        yield values
    if rows != row_of(checkpoint):
        raise OtherRun("row")


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
    """Return the last time of a block whose times ascend from after `last`.  Raises OtherRun."""
    times = np.concatenate([[last], values["time"]])
    if not np.all(times[1:] > times[:-1]) or not np.isfinite(times[1:]).all():
        raise OtherRun("time")
    if not np.isfinite(values[POSITION]).all():
        raise OtherRun(POSITION)
    return float(times[-1])
