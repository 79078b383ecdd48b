"""The motion of a deck as arrays by name: solved in memory, or read from the HDF5 file of a run."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .deck.record import Deck
from .errors import COMPLETE, FAILED, Fault, sentences
from .extras import needed

if TYPE_CHECKING:
    import h5py
    import pandas
    import xarray
    from matplotlib.figure import Figure

    from .results.hdf5.layout import Layout
    from .results.quantities.quantities import Quantity


@dataclass(frozen=True)
class Result(Mapping[str, np.ndarray]):
    """The motion of a deck: `result["body/position"]` is an array (times, bodies, 3), as in the HDF5 file.

    A name of `flexmb table` works, too: `result["point.1.z"]` is an array (times,).  `status` is "complete",
    or "failed" with the reason in `message`.  A run that fails before its first row has no arrays.
    `layout` is that of a run in memory, `file` the one from which `open` read; a result has one of the two.
    """

    deck: "OpenDeck"
    arrays: dict[str, np.ndarray]
    layout: "Layout | None" = None
    status: str = COMPLETE
    message: str = ""
    warnings: tuple[Fault, ...] = ()
    file: str = ""
    resolved: "dict[str, list[Quantity]]" = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> "Result":
        """Return the result in the HDF5 file of a run, all its arrays in memory.

        Raises ResultError, a FlexmbError, for a file that is none; DeckError where its deck cannot be read.
        """
        from .results.hdf5.stored_result import attribute
        from .results.quantities.quantities import open_result, shortfall
        from .results.quantities.quantity_names import families

        with open_result(os.fspath(path)) as file:
            text, name = file["deck"].asstr()[()], attribute(file, "deck_name")
            deck = OpenDeck(_stored_deck(text, name, attribute(file, "dialect")), name)
            arrays = {family.path: file[family.path][...] for family in families(file)}
            status = attribute(file, "status", COMPLETE)
            return cls(deck, arrays, None, status, shortfall(file), file=os.fspath(path))

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a dataset by its path, or a quantity by its name; raises KeyError with near names."""
        if name in self.arrays:
            return self.arrays[name]
        return self._column(self._quantity(name))

    def __repr__(self) -> str:
        return f"Result of {self.deck.path!r}: {self.status}, {len(self.time)} rows of {len(self)} datasets"

    def __iter__(self) -> Iterator[str]:
        return iter(self.arrays)

    def __len__(self) -> int:
        return len(self.arrays)

    @property
    def time(self) -> np.ndarray:
        """The times of the rows, s (times,)."""
        return self.arrays.get("time", np.empty(0))

    def unit(self, name: str) -> str:
        """Return the SI unit of a dataset or a quantity, "1" for a pure number."""
        if name not in self.arrays:
            return self._quantity(name).unit
        with self._names() as file:
            return str(file[name].attrs["units"])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the HDF5 file that `flexmb run` writes; raises OutputError where it cannot be written."""
        from .results.files.replaced_file import write_whole
        from .results.hdf5.result_file import ResultFile

        if self.layout is None:
            write_whole(os.fspath(path), Path(self.file).read_bytes())
            return
        file = ResultFile(os.fspath(path), self.deck.deck, self.layout)
        if self.arrays:
            file.rows(self.arrays)
        if self.status == FAILED:
            file.mark(FAILED, self.message)
        file.note(sentences(fault for fault in self.warnings if fault.severity != "error"))
        file.close()

    def plot(self, *names: str, title: str = "", units: str = "") -> "Figure":
        """Return a figure of matplotlib with curves of quantities, of those of `flexmb plot` without names.

        `units` as after `--units`: "mm,MPa,deg".  Raises ResultError for an unknown name of a quantity,
        ValueError for one of a unit, MissingExtra if there is no matplotlib.
        """
        needed("matplotlib", "matplotlib", "plot", "Result.plot")
        from .deck.units import wishes_of
        from .results.figures.curves import Source, default_curves, panels
        from .results.figures.plots import fitted_figure
        from .results.quantities.quantities import resolve, time_quantity

        wishes = wishes_of(units.split(",")) if units else {}
        with self.stored() as file:
            chosen = resolve(file, names) if names else default_curves(file).quantities
            whole = slice(0, len(self.time), 1)
            source = Source("", file, whole, time_quantity(file), chosen, energies_change=not names)
            return fitted_figure(panels([source], wishes), title, None)

    def show(self, height: int = 640) -> "Page":
        """Return the page of `flexmb report`, which a notebook shows: motion in 3-D, curves, deck.

        `height` in pixels.
        """
        from .results.figures.contours import BodyLook
        from .results.figures.report_page import report_page

        with self.stored() as file:
            return Page(report_page(file, BodyLook()), height)

    def _repr_html_(self) -> str:
        """Return what a notebook shows: what was run, and the extremes of the curves of `flexmb plot`."""
        head = f"<p>{escape(repr(self))}{escape(f': {self.message}' if self.message else '')}</p>"
        if not len(self.time):
            return head
        from .results.figures.curves import default_curves

        with self.stored() as file:
            quantities = default_curves(file).quantities
        rows = [
            f"<tr><td>{escape(one.name)}</td><td>{escape(one.unit)}</td>"
            f"<td>{self._column(one).min():.6g}</td><td>{self._column(one).max():.6g}</td></tr>"
            for one in quantities
        ]
        heading = "<tr><th>quantity</th><th>unit</th><th>least</th><th>largest</th></tr>"
        return f"{head}<table>{heading}{''.join(rows)}</table>"

    def to_xarray(self) -> "xarray.DataTree":
        """Return the result as xarray opens its file: groups of labelled arrays; needs h5netcdf.

        Raises MissingExtra, a FlexmbError, with the command that installs what is missing.
        """
        needed("xarray", "xarray", "", "to_xarray", ("h5netcdf",))
        needed("h5netcdf", "h5netcdf", "", "to_xarray")
        import xarray

        with self._path() as path, xarray.open_datatree(path, engine="h5netcdf") as tree:
            return tree.load()

    def to_pandas(self, *names: str) -> "pandas.DataFrame":
        """Return a table with the time, s, as index, and a column for each number that the names mean.

        A name is that of a quantity or of a dataset; without names there are all.  The frame's
        `attrs["units"]` has the units by column.  Raises KeyError; MissingExtra where there is no pandas.
        """
        needed("pandas", "pandas", "", "to_pandas")
        import pandas

        named = (quantity for name in names or ("*",) for quantity in self._quantities(name))
        quantities = [quantity for quantity in named if names or quantity.dataset != "time"]
        columns = {quantity.name: self._column(quantity) for quantity in quantities}
        table = pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))
        table.attrs["units"] = {quantity.name: quantity.unit for quantity in quantities}
        return table

    def _column(self, quantity: "Quantity") -> np.ndarray:
        if not self.arrays:
            return np.empty(0)
        place: tuple[slice | int, ...] = (slice(None), *quantity.index)
        return self.arrays[quantity.dataset][place]

    def _quantity(self, name: str) -> "Quantity":
        quantities = self._quantities(name)
        if len(quantities) > 1:
            several = ", ".join(quantity.name for quantity in quantities[:6])
            raise KeyError(f"{name} is more than one number: {several} …; name one, or use to_pandas")
        return quantities[0]

    def _quantities(self, name: str) -> "list[Quantity]":
        """Return the quantities that a name selects."""
        if name not in self.resolved:
            from h5py import Dataset

            from .results.quantities.quantities import SHOWS_ALL, UNKNOWN, ResultError, resolve

            try:
                with self._names() as file:
                    of_dataset = isinstance(file.get(name), Dataset)
                    resolved = resolve(file, ["*" if of_dataset else name])
            except ResultError as fault:
                if fault.faults[0].id != UNKNOWN:
                    raise
                raise KeyError(str(fault).removesuffix(SHOWS_ALL)) from None
            self.resolved[name] = [each for each in resolved if not of_dataset or each.dataset == name]
        return self.resolved[name]

    @contextmanager
    def _names(self) -> "Iterator[h5py.File]":
        """Give a file with the datasets of this result, of one in memory without rows."""
        from .results.hdf5.result_file import empty_result
        from .results.quantities.quantities import open_result

        opened = open_result(self.file) if self.layout is None else empty_result(self.deck.deck, self.layout)
        with opened as file:
            yield file

    @contextmanager
    def stored(self) -> "Iterator[h5py.File]":
        """Give the file of this result, of one in memory a temporary one."""
        from .results.quantities.quantities import open_result

        with self._path() as path, open_result(path) as file:
            yield file

    @contextmanager
    def _path(self) -> Iterator[str]:
        import tempfile

        if self.file:
            yield self.file
            return
        with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
            self.save(path := os.path.join(folder, "result.h5"))
            yield path


@dataclass(frozen=True)
class Page:
    """A page of HTML in a frame of a notebook, `height` pixels high."""

    html: str
    height: int

    def __repr__(self) -> str:
        return f"Page of {len(self.html) / 1e3:.0f} kB"

    def _repr_html_(self) -> str:
        frame = f'width="100%" height="{self.height}" style="border: 0"'
        return f'<iframe srcdoc="{escape(self.html)}" {frame}></iframe>'


def _stored_deck(text: str, name: str, dialect: str) -> Deck:
    """Return the deck whose text a result keeps."""
    from .deck.text import decode
    from .dialects.recognise import read_deck

    return read_deck(decode(name, text.encode()), dialect)


@dataclass(frozen=True)
class OpenDeck:
    """A deck that was read; the finite-element files that it names are looked up beside its `path`.

    `changes`: numbers that differ from the deck's, "NAME=VALUE" each.
    """

    deck: Deck
    path: str
    changes: tuple[str, ...] = ()
    warnings: tuple[Fault, ...] = ()

    def __repr__(self) -> str:
        return f"OpenDeck({self.path!r}, {self.dialect}, {len(self.deck.records)} records)"

    @property
    def dialect(self) -> str:
        """The name of its dialect."""
        return self.deck.dialect

    @property
    def numbers(self) -> dict[str, float | int | str]:
        """Every number of the deck by the name that `changes` take, in SI units."""
        return {name: number.value for name, number in self.deck.numbers()}
