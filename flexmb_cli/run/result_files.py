"""The files of one run: printed tables of its dialect and the HDF5 result; all appear whole or not at all."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..deck.record import Deck
from ..dialects.recognise import dialect_named
from ..errors import OutputError
from ..results.files.file_names import STANDARD_OUTPUT, ResultPaths
from ..results.files.replaced_file import ReplacedText, make_folder, put_in_place
from ..results.hdf5.layout import Layout
from ..results.hdf5.result_file import ResultFile, empty_result
from ..results.quantities.quantities import resolve
from .outcome import Run, TextStream

if TYPE_CHECKING:
    import numpy as np

    from .solutions import Solution


class ResultFiles:
    """The files at `paths`; `with_errors`: the result also holds estimated errors."""

    def __init__(
        self, deck: Deck, solution: "Solution", paths: ResultPaths, run: Run, with_errors: bool = False
    ):
        self.paths = paths
        self.texts: list[Any] = []
        self.table: Any = None
        self.result: ResultFile | None = None
        self.begun = self.torn = False
        if paths.files:
            make_folder(run.options.folder)
        try:
            self._open_table(deck, solution, run)
            if paths.h5 is not None:
                self._open_result(deck, solution, run.options.only, with_errors)
        except BaseException:
            self.discard()
            raise

    def _open_table(self, deck: Deck, solution: "Solution", run: Run) -> None:
        out: TextStream | None = None
        if self.paths.out is not None and self.paths.out != STANDARD_OUTPUT:
            # Somebody else may have put a pipe in the place of a name that the deck gives.
            out = table = ReplacedText(self.paths.out, special=self.paths.out in self.paths.named)
            self.texts.append(table)
        elif self.paths.out is not None:
            out = run.stdout
        for path in self.paths.series:
            self.texts.append(ReplacedText(path, special=False))
        series = self.texts[len(self.texts) - len(self.paths.series) :]
        if out is not None or series:
            dialect, streams = dialect_named(deck.dialect), (out, *series)
            self.table = dialect.table(streams, deck, run.options.layout, solution.analysis)

    def _open_result(
        self, deck: Deck, solution: "Solution", only: tuple[Any, ...], with_errors: bool
    ) -> None:
        layout = solution.layout()
        if with_errors:
            from .error_estimate import with_errors as with_error_series

            layout = with_error_series(layout)
        if only:
            layout = selected(layout, deck, only)
        assert self.paths.h5 is not None, "a result is wanted"
        self.result = ResultFile(self.paths.h5, deck, layout)

    @property
    def unfinished(self) -> tuple[str, ...]:
        """Return where the files are until they are complete."""
        return tuple(file.temporary for file in self._all())

    def _begin(self) -> None:
        if self.table and not self.begun:
            self.begun = True
            self.table.begin()

    def rows(self, values: Mapping[str, "np.ndarray"]) -> None:
        """Write report rows, given by the paths of their datasets."""
        self.torn = True
        self._begin()
        if self.table:
            self.table.rows(values)
        if self.result:
            self.result.rows(values)
        self.torn = False

    def close(self, notes: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Put the finished files in their places; their names."""
        if self.result:
            self.result.note(notes)
        put_in_place(self._all())
        return self.paths.files

    def close_failed(
        self, message: str, no_convergence: bool, notes: tuple[str, ...] = ()
    ) -> tuple[str, ...]:
        """Keep the rows so far, marked as those of a failed run; the names of the files."""
        self._begin()
        if self.table:
            self.table.failed() if no_convergence else self.table.stopped()
        if self.result:
            self.result.mark("failed", message)
        return self.close(notes)

    def close_stopped(self, rows: int, reason: str, notes: tuple[str, ...] = ()) -> tuple[str, ...]:
        """Keep the rows so far, if all files have the same; else the results of an earlier run stay."""
        if rows == 0 or self.torn:
            self.discard()
            return ()
        return self.close_failed(reason, False, notes)

    def discard(self) -> None:
        """Leave no file; what standard output was given already is marked."""
        if self.begun and self.paths.out == STANDARD_OUTPUT:
            # It may be the very thing that fails, and what ended the run is reported, not this.
            with suppress(OSError, OutputError):
                self.table.stopped()
        for file in self._all():
            file.discard()

    def _all(self) -> list[Any]:
        return [*self.texts, *([self.result] if self.result else [])]


def selected(layout: Layout, deck: Deck, patterns: Iterable[str]) -> Layout:
    """Return `layout` with the datasets in which `patterns` name a quantity; all of them without any.

    Raises ResultError, with near names, for a pattern that fits nothing.
    """
    patterns = tuple(patterns)
    if not patterns:
        return layout
    with empty_result(deck, layout) as result:
        chosen = {quantity.dataset for quantity in resolve(result, patterns, where="--only ")}
    # The global error of a quantity lies below another group by the same path.
    ends = tuple(f"/{path}" for path in chosen)
    series = tuple(item for item in layout.series if f"/{item.path}".endswith(ends))
    return replace(layout, series=series)
