"""The part of a result that `run --only` stores."""

import os
from collections.abc import Iterable
from dataclasses import replace

import h5py

from ...deck.record import Deck
from ..hdf5.layout import Layout
from ..hdf5.result_file import ResultFile
from .quantities import resolve


def selected(layout: Layout, deck: Deck, patterns: Iterable[str]) -> Layout:
    """Return `layout` with the datasets in which `patterns` name a quantity; all of them without any.

    Raises ResultError, with near names, for a pattern that fits nothing.
    """
    patterns = tuple(patterns)
    if not patterns:
        return layout
    import tempfile  # which takes its time, and few runs need it

    with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
        path = os.path.join(folder, "empty.h5")
        ResultFile(path, deck, layout).close()
        with h5py.File(path, "r") as result:
            chosen = {quantity.dataset for quantity in resolve(result, patterns, where="--only ")}
    # The global error of a quantity lies below another group by the same path.
    ends = tuple(f"/{path}" for path in chosen)
    series = tuple(item for item in layout.series if f"/{item.path}".endswith(ends))
    return replace(layout, series=series)
