"""The datasets of an HDF5 file by their paths, of which none is kept open: libhdf5 takes 13 kB for each."""

from collections.abc import Iterator, Mapping

import h5py


class StoredDatasets(Mapping[str, h5py.Dataset]):
    """Every dataset of a file whose structure was checked; it is opened on access."""

    def __init__(self, file: h5py.File):
        self._file = file
        # A dictionary, as an ordered set.
        self._paths = dict.fromkeys(_paths_of_datasets(file))

    def __getitem__(self, path: str) -> h5py.Dataset:
        if path not in self._paths:
            raise KeyError(path)
        return self._file[path]

    def __contains__(self, path: object) -> bool:
        return path in self._paths

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)

    def leave_out(self, path: str) -> None:
        """Count a path no longer among the datasets, if it is one of them."""
        self._paths.pop(path, None)


def _paths_of_datasets(file: h5py.File) -> list[str]:
    found: list[bytes] = []

    # h5py cannot bear an exception in here.
    def note(name: bytes, described: h5py.h5o.ObjInfo) -> None:
        if described.type == h5py.h5o.TYPE_DATASET:
            found.append(name)

    h5py.h5o.visit(file.id, note, info=True)
    return [name.decode("utf-8", "surrogateescape") for name in found]
