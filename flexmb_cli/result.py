"""The motion of a deck that was solved in memory, as arrays by name."""

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import COMPLETE, FAILED, Fault, sentences
from .extras import needed
from .quick_dataclass import dataclass, field

if TYPE_CHECKING:
    import pandas
    import xarray

    from .opened_deck import OpenDeck
    from .results.hdf5.layout import Layout


@dataclass(frozen=True)
class Result(Mapping[str, np.ndarray]):
    """The motion of a deck: `result["body/position"]` is an array (times, bodies, 3), as in the HDF5 file.

    A name of `flexmb table` works, too: `result["point.1.z"]` is an array (times,).  `status` is "complete",
    or "failed" with the reason in `message`.
    """

    deck: "OpenDeck"
    # By names of datasets; what a mapping's method of this name would give is `result[name]`.
    values: dict[str, np.ndarray]  # type: ignore[assignment]
    layout: "Layout"
    status: str = COMPLETE
    message: str = ""
    warnings: tuple[Fault, ...] = ()
    found: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a dataset by its path, or a quantity by its name; raises KeyError with near names."""
        if name in self.values:
            return self.values[name]
        quantity = self._quantity(name)
        return self.values[quantity.dataset][(slice(None), *quantity.index)]

    def __repr__(self) -> str:
        rows = len(self.values.get("time", ()))
        return f"Result of {self.deck.path!r}: {self.status}, {rows} rows of {len(self.values)} datasets"

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def __len__(self) -> int:
        return len(self.values)

    @property
    def time(self) -> np.ndarray:
        """The times of the rows, s (times,)."""
        return self.values["time"]

    def unit(self, name: str) -> str:
        """Return the SI unit of a dataset or a quantity, "1" for a pure number."""
        units = {item.path: item.units for item in self.layout.series} | {"time": "s"}
        return units[name] if name in units else self._quantity(name).unit

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the HDF5 file that `flexmb run` writes; raises OutputError where it cannot be written."""
        from .results.hdf5.result_file import ResultFile

        file = ResultFile(os.fspath(path), self.deck.deck, self.layout)
        if self.values:
            file.rows(self.values)
        if self.status == FAILED:
            file.mark(FAILED, self.message)
        file.note(sentences(fault for fault in self.warnings if fault.severity != "error"))
        file.close()

    def to_xarray(self) -> "xarray.DataTree":
        """Return the result as xarray opens its file: groups of labelled arrays; needs h5netcdf.

        Raises MissingExtra, a FlexmbError, with the command that installs what is missing.
        """
        import tempfile

        needed("xarray", "xarray", "", "to_xarray")
        needed("h5netcdf", "h5netcdf", "", "to_xarray")
        import xarray

        with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
            self.save(path := Path(folder) / "result.h5")
            with xarray.open_datatree(path, engine="h5netcdf") as tree:
                return tree.load()

    def to_pandas(self, *names: str) -> "pandas.DataFrame":
        """Return the quantities named, each a column, with the time as index; raises MissingExtra."""
        needed("pandas", "pandas", "", "to_pandas")
        import pandas

        columns = {
            quantity.name: self.values[quantity.dataset][(slice(None), *quantity.index)]
            for name in names
            for quantity in self._quantities(name)
        }
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))

    def _quantity(self, name: str) -> Any:
        quantities = self._quantities(name)
        if len(quantities) > 1:
            several = ", ".join(quantity.name for quantity in quantities[:6])
            raise KeyError(f"{name} is more than one number: {several} …; name one, or use to_pandas")
        return quantities[0]

    def _quantities(self, name: str) -> Any:
        """The quantities that a name means; they are looked up in a file without rows."""
        if name not in self.found:
            import tempfile

            import h5py

            from .results.hdf5.result_file import ResultFile
            from .results.quantities.quantities import SHOWS_ALL, ResultError, resolve

            with tempfile.TemporaryDirectory(prefix="flexmb-") as folder:
                path = os.path.join(folder, "empty.h5")
                ResultFile(path, self.deck.deck, self.layout).close()
                with h5py.File(path, "r") as file:
                    try:
                        self.found[name] = resolve(file, [name])
                    except ResultError as fault:
                        raise KeyError(str(fault).removesuffix(SHOWS_ALL)) from None
        return self.found[name]
