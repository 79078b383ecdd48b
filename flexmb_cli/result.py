"""The motion of a deck that was solved in memory, as arrays by name."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .deck.record import Deck
from .errors import COMPLETE, FAILED, Fault, sentences
from .extras import needed

if TYPE_CHECKING:
    import pandas
    import xarray

    from .results.hdf5.layout import Layout
    from .results.quantities.quantities import Quantity


@dataclass(frozen=True)
class Result(Mapping[str, np.ndarray]):
    """The motion of a deck: `result["body/position"]` is an array (times, bodies, 3), as in the HDF5 file.

    A name of `flexmb table` works, too: `result["point.1.z"]` is an array (times,).  `status` is "complete",
    or "failed" with the reason in `message`.  A run that fails before its first row has no arrays.
    """

    deck: "OpenDeck"
    arrays: dict[str, np.ndarray]
    layout: "Layout"
    status: str = COMPLETE
    message: str = ""
    warnings: tuple[Fault, ...] = ()
    found: "dict[str, list[Quantity]]" = field(default_factory=dict, repr=False, compare=False)

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
        units = {item.path: item.units for item in self.layout.series} | {"time": "s"}
        return units[name] if name in units else self._quantity(name).unit

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the HDF5 file that `flexmb run` writes; raises OutputError where it cannot be written."""
        from .results.hdf5.result_file import ResultFile

        file = ResultFile(os.fspath(path), self.deck.deck, self.layout)
        if self.arrays:
            file.rows(self.arrays)
        if self.status == FAILED:
            file.mark(FAILED, self.message)
        file.note(sentences(fault for fault in self.warnings if fault.severity != "error"))
        file.close()

    def to_xarray(self) -> "xarray.DataTree":
        """Return the result as xarray opens its file: groups of labelled arrays; needs h5netcdf.

        Raises MissingExtra, a FlexmbError, with the command that installs what is missing.
        """
        import tempfile

        needed("xarray", "xarray", "", "to_xarray", ("h5netcdf",))
        needed("h5netcdf", "h5netcdf", "", "to_xarray")
        import xarray

        with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
            self.save(path := Path(folder) / "result.h5")
            with xarray.open_datatree(path, engine="h5netcdf") as tree:
                return tree.load()

    def to_pandas(self, *names: str) -> "pandas.DataFrame":
        """Return a table with the time, s, as index, and a column for each number that the names mean.

        A name is that of a quantity or of a dataset; without names there are all.  The frame's
        `attrs["units"]` has the units by column.  Raises KeyError; MissingExtra where there is no pandas.
        """
        needed("pandas", "pandas", "", "to_pandas")
        import pandas

        found = (quantity for name in names or ("*",) for quantity in self._quantities(name))
        wanted = [quantity for quantity in found if names or quantity.dataset != "time"]
        columns = {quantity.name: self._column(quantity) for quantity in wanted}
        table = pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))
        table.attrs["units"] = {quantity.name: quantity.unit for quantity in wanted}
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
        """Return the quantities that a name selects, found in a temporary HDF5 file without rows."""
        if name not in self.found:
            paths = {item.path for item in self.layout.series}

            from .results.hdf5.result_file import empty_result
            from .results.quantities.quantities import SHOWS_ALL, ResultError, resolve

            with empty_result(self.deck.deck, self.layout) as file:
                try:
                    found = resolve(file, ["*" if name in paths else name])
                except ResultError as fault:
                    raise KeyError(str(fault).removesuffix(SHOWS_ALL)) from None
            self.found[name] = [each for each in found if name not in paths or each.dataset == name]
        return self.found[name]


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
